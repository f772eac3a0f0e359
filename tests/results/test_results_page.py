"""The page of results: the same from the same rows, and everything that it must tell."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from cleancli.experiment.summary import cells_table
from cleancli.results.claims import CLAIMS
from cleancli.results.judged import judged
from cleancli.results.page import PAGE, Results, reason, results_of, results_page, write_results
from cleancli.statistics.verdict import Verdict
from cleancli.study.model import Comparison, Part, Study, Value
from cleancli.study.row import Row
from support.docs_numbers import sourced
from support.study_rows import drawn

STRATEGIES = ("plan-2", "reactive", "tsp")
MEANS: Mapping[Value, float] = {"plan-2": 1.0, "reactive": 2.0, "tsp": 1.02, "a": 30.0, "b": 100.0}


def against(second: str) -> Comparison:
    sides = {"strategy": ("plan-2",)}, {"strategy": (second,)}
    return Comparison(f"beside_{second}", "", "seconds", "less", *sides)


STUDY = Study(
    "made_up",
    "How strategies compare.",
    (Part("", {"scene": ("b", "a"), "strategy": STRATEGIES}),),
    (
        replace(against("reactive"), claim=2, where={"scene": ("b",)}),
        replace(against("tsp"), claim=4),
        replace(against("reactive"), name="tenth", claim=2, factor=0.1),
    ),
)


def rows_of(runs: int = 6, failing: Mapping[Value, float] | None = None) -> list[Row]:
    axes = {"scene": ("a", "b"), "strategy": STRATEGIES}
    return list(drawn(axes, MEANS, runs, failing=failing))


def results(*, runs: int = 6) -> Results:
    return results_of(STUDY, rows_of(runs))


def test_page_and_figures_are_the_same_bytes_in_whichever_order_rows_come(tmp_path: Path) -> None:
    rows = rows_of()
    found = []
    for name in ("one", "other"):
        Random(name).shuffle(rows)
        page = write_results([results_of(STUDY, rows)], tmp_path / name)
        assert page == tmp_path / name / PAGE
        files = sorted(path for path in (tmp_path / name).rglob("*") if path.is_file())
        found.append({str(path.relative_to(tmp_path / name)): path.read_bytes() for path in files})
    assert found[0] == found[1]
    assert set(found[0]) == {
        PAGE,
        *(f"results/made_up{end}" for end in (".svg", ".png", "_times.svg", "_times.png")),
    }


def test_pictures_that_the_page_shows_are_written(tmp_path: Path) -> None:
    page = write_results([results()], tmp_path).read_text(encoding="utf-8")
    shown = re.findall(r"!\[[^]]+\]\(([^)]+)\)", page)
    assert len(shown) == 2
    assert all((tmp_path / name).is_file() for name in shown)


def test_cells_come_as_the_study_lists_them() -> None:
    cells = re.findall(r"^\| ([ab]) \| ([\w-]+) \|", results_page([results()]), re.M)
    assert cells == [(scene, strategy) for scene in "ba" for strategy in STRATEGIES]


def test_comparisons_say_what_they_compare() -> None:
    scored = replace(STUDY, comparisons=(against("tsp"), replace(against("reactive"), measure="actions")))
    page = results_page([results_of(scored, rows_of())])
    assert "| comparison | measure | pairs |" in page
    assert re.search(r"^\| beside_tsp \| seconds \|", page, re.M)
    assert re.search(r"^\| beside_reactive \| actions \|", page, re.M)


def test_each_claim_has_its_verdict_and_what_decided_it() -> None:
    lines = dict(re.findall(r"^\| (\d) \| (.*) \|$", results_page([results()]), re.M))
    assert len(lines) == len(CLAIMS) == 9
    assert lines["2"].endswith("| lost | made_up: beside_reactive won; made_up: tenth lost")
    assert "| undecided |" in lines["4"]
    assert lines["9"].endswith("| not tested | ")


def test_every_number_of_the_page_has_its_source() -> None:
    """As tests/test_docs.py asks of all pages."""
    assert [number for number in sourced("results", results_page([results()])) if not number.source] == []


def test_rows_of_other_studies_are_left_out_and_parts_have_figures_of_their_own() -> None:
    rows = [*drawn({"scene": ("a",)}, MEANS, 5, part="wam"), *drawn({"scene": ("b",)}, MEANS, 5, part="reem")]
    study = Study("made_up", "", (Part("wam", {"scene": ("a",)}), Part("reem", {"scene": ("b",)})), ())
    found = results_of(study, rows)
    names = [figure.name for figures in found.figures.values() for figure in figures]
    assert names == ["made_up_wam", "made_up_wam_times", "made_up_reem", "made_up_reem_times"]
    assert results_of(Study("other", "", (), ()), rows).rows == ()


@pytest.mark.parametrize(
    ("said", "runs", "expected"),
    [
        (against("reactive"), 8, "all of the interval lies below 1"),
        (replace(against("reactive"), expect="more"), 8, "none of the interval lies above 1"),
        (replace(against("reactive"), expect="equal", factor=0.5, margin=0.1), 8, "lies between 0.4 and 0.6"),
        (replace(against("reactive"), expect="equal", factor=0.1, margin=0.1), 8, "0.2, all of it above 0.2"),
        (replace(against("reactive"), expect="equal", factor=2, margin=0.1), 8, "2.1, all of it below 1.9"),
        (against("nobody"), 8, "there are no rows to compare"),
        (against("reactive"), 4, "4 runs are too few; at least 5 are needed"),
        (against("reactive"), 1, "1 run is too few; at least 5 are needed"),
        (against("tsp"), 8, r"only a part of the interval lies below 1, and about \d+ more runs would"),
    ],
)
def test_reasons_are_told_in_words(said: Comparison, runs: int, expected: str) -> None:
    (found,) = judged([said], rows_of(runs))
    assert re.search(expected, reason(found))


def test_enough_runs_without_a_ratio_are_not_called_too_few() -> None:
    said = replace(against("reactive"), measure="clean", expect="more")
    none = [replace(row, clean=False) for row in rows_of(8)]
    (found,) = judged([said], none)
    assert found.verdict is Verdict.UNDECIDED
    assert reason(found).startswith("both are 0 in every run")
    (few,) = judged([said], [row for row in none if row.run < 5])
    assert reason(few) == "4 runs are too few; at least 5 are needed"


@pytest.mark.parametrize(
    ("expect", "margin", "verdict"), [("more", 0, "won"), ("less", 0, "lost"), ("equal", 0.2, "lost")]
)
def test_what_happens_at_all_is_more_than_nothing(expect: str, margin: float, verdict: str) -> None:
    """docs/statistics.md: where all of the second is 0, the mean of the first is set beside 0."""
    said = replace(against("reactive"), measure="clean", expect=expect, margin=margin)
    rows = [replace(row, clean=row.axes["strategy"] == "plan-2") for row in rows_of(8)]
    (found,) = judged([said], rows)
    assert found.verdict == verdict
    assert reason(found).endswith(", of the mean of the first: the second is 0 in every run")


def test_a_column_says_where_it_counts_what_others_leave_out() -> None:
    """As the page's introduction promises."""
    rows = [replace(row, clean=row.run > 2, actions=40 if row.run <= 2 else 4) for row in rows_of(8)]
    page = results_page([results_of(replace(STUDY, measure="clean", comparisons=()), rows)])
    assert "| actions until the episode is over, also where it did not end clean |" in page
    assert "| b | plan-2 | 8 | 2 | 0.75 [0.409, 0.929] | 13 [4, 26.5] |" in page
    page = results_page([results_of(replace(STUDY, comparisons=()), rows)])
    assert "| actions until the episode is over |" in page
    assert re.search(r"\| b \| plan-2 \| 8 \| 2 \| .* \| 4 \[4, 4\] \|", page)


def test_the_table_counts_the_pairs_that_are_as_expected() -> None:
    """`plan-2` takes half as long as `reactive` in each pair."""
    said = against("reactive")
    for expect, told in (("less", "less in 100%"), ("more", "more in 0%"), ("equal", "less in 100%")):
        study = replace(STUDY, comparisons=(replace(said, expect=expect),))
        assert f"| {told} |" in results_page([results_of(study, rows_of(8))])


def test_a_cell_that_a_planner_refused_has_no_mean() -> None:
    study = replace(STUDY, measure="clean", comparisons=())
    of_tsp = [replace(row, clean=False, reason="refused: no horizon") for row in rows_of(6)]
    rows = [a if b.axes["strategy"] != "tsp" else b for a, b in zip(rows_of(6), of_tsp, strict=True)]
    page = results_page([results_of(study, rows)])
    assert page.count("| refused | refused | refused |") == 2
    few = [*rows, replace(next(row for row in rows if row.axes["strategy"] == "tsp"), reason="nothing helps")]
    assert results_page([results_of(study, few)]).count("| refused | refused | refused |") == 1
    assert {line[-1] for line in cells_table(study, rows).rows} == {"1", "refused"}


def test_where_nobody_ended_clean_nothing_is_decided_and_that_is_said_first() -> None:
    rows = [replace(row, clean=False) for row in rows_of(8)]
    limited = replace(against(""), second={}, limit=1.0)
    for said in (against("reactive"), replace(against("reactive"), expect="equal", margin=0.1)):
        (found,) = judged([said], rows)
        assert (found.verdict, found.more) == (Verdict.UNDECIDED, None)
        assert reason(found) == "no episode of either side ended clean"
    for said in (limited, replace(limited, expect="more")):
        (found,) = judged([said], rows)
        assert (found.verdict, found.chance, reason(found)) == (
            Verdict.UNDECIDED,
            1.0,
            "no episode ended clean",
        )
    idle = [replace(row, actions=0) if row.axes["strategy"] == "reactive" else row for row in rows]
    (found,) = judged([against("reactive")], idle)
    assert reason(found) == "no episode of either side ended clean; the second did nothing at all"


def test_a_side_that_did_nothing_or_never_ended_clean_is_told_first() -> None:
    rows = rows_of(8)
    other = [row.axes["strategy"] == "reactive" for row in rows]
    never = [replace(row, clean=not is_other) for row, is_other in zip(rows, other, strict=True)]
    idle = [
        replace(row, actions=0 if is_other else 3, score=0.0 if is_other else 1.0)
        for row, is_other in zip(never, other, strict=True)
    ]
    (found,) = judged([against("reactive")], never)
    assert found.verdict is Verdict.WON
    assert reason(found).startswith("the second never ended clean; all of the interval lies below 1; 0 epi")
    (found,) = judged([against("reactive")], idle)
    assert reason(found).startswith("the second did nothing at all and never ended clean; all of")
    (scored,) = judged([replace(against("reactive"), measure="score", expect="more")], idle)
    assert reason(scored).startswith("the second did nothing at all; "), "a score counts failures as they are"


def test_what_no_number_of_runs_would_decide_is_told_as_such() -> None:
    (found,) = judged([against("tsp")], rows_of(8))
    near = replace(found, verdict=Verdict.UNDECIDED, more=None)
    assert "more than 10,000 runs would be needed" in reason(near)


def test_a_page_without_rows_says_so() -> None:
    page = results_page([results_of(STUDY, [])])
    assert "There are no rows yet." in page
    assert "episodes, seeds 101 to 106, with cleancli 1.0, pybullet 3.2.7." in results_page([results()])


def test_of_a_score_episodes_that_are_not_clean_are_told_and_count() -> None:
    rows = [replace(row, clean=False, score=0.9) for row in rows_of(1) if row.axes["scene"] == "a"]
    scored = replace(STUDY, measure="score", comparisons=())
    page = results_page([results_of(scored, rows)])
    assert re.search(r"^\| tsp \| 1 \| 1 \| 0\.9 \| \d+ \| 0 \|$", page, re.M), "and all their actions"
    assert "In all: scene a, episode 1." in page
    assert "claims" not in page
    assert "seed 101, with" in page


def test_why_episodes_did_not_end_clean_is_told_the_most_frequent_first() -> None:
    reasons = ("the limit of 1800 seconds is reached", "nothing helps", "nothing helps")
    rows = rows_of(6)
    failed = [replace(row, clean=False, reason=why) for row, why in zip(rows, reasons, strict=False)]
    page = results_page([results_of(STUDY, [*failed, *rows[3:]])])
    assert "Not clean: nothing helps 2, the limit of 1800 seconds is reached 1." in page
    assert "Not clean" not in results_page([results_of(STUDY, rows)])


def test_numbers_have_three_digits() -> None:
    seconds = (0.00123, 999.4, 999.6, 12345.0)
    rows = [replace(row, total=value) for row, value in zip(rows_of(4)[:4], seconds, strict=False)]
    page = results_page(
        [results_of(STUDY, [replace(r, axes={"scene": f"s{n}"}) for n, r in enumerate(rows)])]
    )
    assert re.findall(r"^\| s\d \| 1 \| 0 \| (\S+) \|", page, re.M) == ["0.00123", "999", "1,000", "12,345"]


def test_failures_are_told_with_the_reason() -> None:
    rows = rows_of(6, {"reactive": 0.5})
    (found,) = judged([against("reactive")], rows)
    failed = sum(not row.clean for row in rows)
    assert reason(found).endswith(f"; 0 episodes of the first and {failed} of the second did not end clean")
    (limited,) = judged([replace(against(""), first={"strategy": ("reactive",)}, second={}, limit=1e6)], rows)
    assert reason(limited).endswith(f"; {failed} episodes did not end clean")


def test_the_page_says_in_how_many_episodes_the_processor_was_shared() -> None:
    """docs/experiments.md, "Results": less than 90 % of a processor."""
    rows = [replace(row, cpu=0.9 * row.real) for row in rows_of()]
    assert "of a processor" not in results_page([results_of(STUDY, rows)])
    rows[3] = replace(rows[3], cpu=0.89 * rows[3].real)
    assert "In 1 episode the process had less than 90% of a processor" in results_page(
        [results_of(STUDY, rows)]
    )


@pytest.mark.parametrize(("slower", "told"), [(0.3, True), (2.0, False)])
def test_a_verdict_that_rests_on_failures_says_so(slower: float, told: bool) -> None:
    """docs/statistics.md: `tsp` fails every other time, and each failure counts as twice the longest."""
    means: Mapping[Value, float] = {"plan-2": 1.0, "tsp": slower, "a": 30.0}
    axes = {"scene": ("a",), "strategy": ("plan-2", "tsp")}
    rows = list(drawn(axes, means, 40, failing={"tsp": 0.6}))
    (found,) = judged([against("tsp")], rows)
    assert found.verdict is Verdict.WON
    assert found.sides is not None
    assert (found.sides.difference.value > 0) == told
    because = "because what did not end clean counts as twice the longest: where both ended clean, the diff"
    assert (because in reason(found)) == told


def test_of_the_symbolic_world_nothing_is_called_clean() -> None:
    axes = {"scene": ("a",), "strategy": ("plan-2", "reactive"), "simulator": ("symbolic",)}
    rows = list(drawn(axes, MEANS, 6, failing={"reactive": 0.5}))
    page = results_page([results_of(replace(STUDY, comparisons=(against("reactive"),)), rows)])
    told = page[page.index("## made_up") :]
    assert "Not finished: " in told
    assert "episodes not finished" in told
    assert "of the second did not finish." in told
    assert "clean" not in told
    assert "dirt" not in told
    (figure, *_) = results_of(replace(STUDY, measure="clean", comparisons=()), rows).figures[""]
    assert figure.shows == "the share of episodes that finished"
