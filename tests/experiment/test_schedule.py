"""What is finished is passed over, in whatever order episodes come; a study ends at the end of a block."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice

import pytest

from cleancli.experiment.episode import Episode, Finished
from cleancli.experiment.schedule import GivenUp, Known, due, number_due, rows, scheduled
from cleancli.experiment.series import Series
from cleancli.experiment.summary import cells_table, ending
from cleancli.experiment.until import known_to
from cleancli.language.diagnostics.refused import Refused
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.study.model import Study
from cleancli.study.row import Row, comparable
from support.studies import SYMBOLIC, opened, rows_here

STUDIES = opened(SYMBOLIC)
LONG = opened(SYMBOLIC.replace("runs      = 2", "runs = 5"))
PLAYED: dict[str, Finished] = {}
"""Every episode of both, carried out once."""
rows_here(LONG, PLAYED)
ALL = tuple(map(comparable, rows(STUDIES, PLAYED)))


def here(series: Sequence[Series], known: Known) -> Iterator[Finished]:
    """The pool of this process, which remembers."""
    for each in series:
        index, evidence = due(each, known)
        for episode in each[index:]:
            before = PLAYED[episode.before].evidence if episode.before else NO_EVIDENCE
            assert evidence == before, "what was seen is handed on"
            evidence = PLAYED[episode.key].evidence
            yield PLAYED[episode.key]


def test_the_pool_of_this_process_hands_on_what_was_seen() -> None:
    assert rows_here(STUDIES) == ALL


def test_the_rows_are_run_by_run_and_series_by_series() -> None:
    assert len(ALL) == number_due(STUDIES, {}) == 16
    assert [(row.run, row.episode) for row in ALL] == [
        (run, e) for run in (1, 2) for _ in range(4) for e in (1, 2)
    ]
    assert [row.key for row in ALL] == [e.key for b in STUDIES[0].blocks for s in b for e in s]


def test_another_order_gives_the_same_rows() -> None:
    def backwards(series: Sequence[Series], known: Known) -> Iterator[Finished]:
        return here(series[::-1], known)

    known: dict[str, Finished] = {}
    for _ in scheduled(STUDIES, known, backwards):
        pass
    assert tuple(map(comparable, rows(STUDIES, known))) == ALL


@pytest.mark.parametrize("number", [0, 1, 2, 5, 15, 16])
def test_one_that_was_stopped_goes_on(number: int) -> None:
    known: dict[str, Finished] = {}
    first = list(islice(scheduled(STUDIES, known, here), number))
    assert len(known) == number
    again = list(scheduled(STUDIES, known, here))
    assert len(first) + len(again) == 16
    assert not {e.row.key for e in first if isinstance(e, Finished)} & {
        e.row.key for e in again if isinstance(e, Finished)
    }
    assert tuple(map(comparable, rows(STUDIES, known))) == ALL


def test_studies_that_share_episodes_share_them() -> None:
    other = opened(SYMBOLIC.replace("symbolic", "other").replace("plan_1, plan_2", "plan_2"))
    known: dict[str, Finished] = {}
    assert len(list(scheduled((*STUDIES, *other), known, here))) == 16
    of_other = [row for row in rows((*STUDIES, *other), known) if row.study == "other"]
    assert [row.key for row in of_other] == [r.key for r in ALL if r.axes["strategy"] == "plan-2"]
    assert number_due(other, known) == 0


def test_more_runs_are_added_to_those_that_are_finished() -> None:
    known: dict[str, Finished] = {}
    list(scheduled(STUDIES, known, here))
    more = opened(SYMBOLIC.replace("runs      = 2", "runs = 3"))
    assert number_due(more, known) == 8
    assert len(list(scheduled(more, known, here))) == 8


def test_evidence_that_is_another_domains_is_refused() -> None:
    known: dict[str, Finished] = {}
    list(islice(scheduled(STUDIES, known, here), 3))
    learned = next(key for key, each in known.items() if each.row.axes["estimator"] != "none")
    known[learned] = replace(known[learned], evidence=Evidence(order=(7,)))
    with pytest.raises(Refused, match=r"E702.*has seen is none of its domain"):
        list(scheduled(STUDIES, known, here))


def test_an_episode_that_is_given_up_ends_its_series_and_is_told() -> None:
    def failing(series: Sequence[Series], known: Known) -> Iterator[Finished | GivenUp]:
        yield GivenUp(series[0][0], "lost")
        yield from here(series[1:], known)

    known: dict[str, Finished] = {}
    outcomes = list(scheduled(STUDIES, known, failing))
    assert sum(isinstance(each, GivenUp) for each in outcomes) == 1
    assert tuple(map(comparable, rows(STUDIES, known))) == ALL[2:]
    list(scheduled(STUDIES, known, here))
    assert tuple(map(comparable, rows(STUDIES, known))) == ALL


# ---- enough


@pytest.mark.parametrize("last", [1, 3, 5])
def test_a_study_ends_with_the_block_after_which_there_are_enough(last: int) -> None:
    seen = []

    def enough(study: Study, blocks: Sequence[Sequence[Row]]) -> bool:
        assert study.name == "symbolic"
        assert [{row.run for row in block} for block in blocks] == [{n + 1} for n in range(len(blocks))]
        assert {len(block) for block in blocks} == {8}
        seen.append(len(blocks))
        return len(blocks) == last

    known: dict[str, Finished] = {}
    assert len(list(scheduled(LONG, known, here, enough))) == 8 * last
    assert seen == list(range(1, last + 1))
    assert len(rows(LONG, known, enough)) == 8 * last


def test_rows_beyond_those_that_are_enough_do_not_count() -> None:
    assert {row.run for row in rows(LONG, PLAYED, lambda _, blocks: len(blocks) == 2)} == {1, 2}


def test_enough_is_decided_by_the_mean_of_each_cell() -> None:
    (study,) = opened("study s { scene = three_areas measure = actions runs = 1 }")
    row = replace(ALL[0], axes={"strategy": "plan-1"})

    def blocks(*actions: tuple[int, int]) -> list[list[Row]]:
        cells = ("plan-1", "plan-2")
        return [
            [replace(row, run=n, actions=a, axes={"strategy": c}) for c, a in zip(cells, each, strict=True)]
            for n, each in enumerate(actions)
        ]

    close, wide = [(10, 10), (11, 11)] * 10, [(10, 1), (11, 30)] * 10
    assert known_to(0.1)(study.study, blocks(*close))
    assert not known_to(0.1)(study.study, blocks(*wide))
    assert not known_to(0.001)(study.study, blocks(*close))
    assert not known_to(0.1)(study.study, blocks(*close[:2]))


def test_episodes_are_small_where_they_are_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    """Texts are most of an episode; of a cell they are the same objects."""
    series: list[Episode] = [e for b in STUDIES[0].blocks for s in b for e in s]
    assert len({id(e.texts.domain[0]) for e in series}) == 1


def test_a_line_a_cell_tells_what_the_study_came_to() -> None:
    (study,) = opened("study s { scene = three_areas measure = actions runs = 1 }")
    score = replace(study.study, measure="score")
    rows_of = [
        replace(row, axes={**row.axes, "rag.width": width}, actions=actions, clean=clean, score=share)
        for row, width, actions, clean, share in (
            (ALL[0], 0.08, 4, True, 1.0),
            (ALL[0], 0.08, 9, False, 0.5),
            (ALL[0], 0.12, 9, False, 0.25),
        )
    ]
    given_up = replace(rows_of[2], reason="the limit of 1800 seconds is reached")
    told = [*rows_of[:1], replace(rows_of[1], reason="nothing helps"), given_up, given_up]
    assert list(ending(study.study, told)) == [
        "not finished: the limit of 1800 seconds is reached 2, nothing helps 1"
        "; `max_seconds` of the study raises the limit"
    ]
    assert list(ending(study.study, told[:2])) == ["not finished: nothing helps 1"]
    assert not list(ending(study.study, rows_of[:1]))
    table = cells_table(study.study, rows_of)
    assert table.heads == ("rag.width", "episodes", "finished", "actions")
    assert table.rows == (("0.08", "2", "1", "4"), ("0.12", "1", "0", ""))
    assert cells_table(score, rows_of).rows == (("0.08", "2", "1", "0.75"), ("0.12", "1", "0", "0.25"))
    in_parts = [replace(row, part=part) for row, part in zip(rows_of, "aab", strict=True)]
    assert cells_table(study.study, in_parts).rows[1][:2] == ("b", "0.12")


def test_of_problems_the_table_tells_what_finished_and_no_two_columns_have_one_name() -> None:
    (study,) = opened("study s { scene = three_areas  measure = clean  runs = 1 }")
    own = [replace(ALL[0], axes={"simulator": "symbolic"}, clean=done) for done in (True, True, False, True)]
    for world, done in (("symbolic", "finished"), ("physics", "clean")):
        table = cells_table(study.study, [replace(row, axes={"simulator": world}) for row in own])
        assert table.heads == ("episodes", done, f"share {done}")
        assert table.rows == (("4", "3", "0.75"),)
    assert list(ending(study.study, own)) == [f"not finished: {own[2].reason} 1"]
