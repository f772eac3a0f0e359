"""A run folder as steps, time and figures."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import pytest

from cleancli.language.diagnostics.refused import Refused
from cleancli.recording.journal import Chance, Expected, FactEntry, Started
from cleancli.report.account import row_of
from cleancli.report.run import read_run
from cleancli.report.steps import chance_text, facts_text, likeliest, steps_of
from cleancli.report.timeline import timeline
from support.run_folders import RECORDS, SECONDS, header, write_run


def test_steps_tell_what_was_expected_and_what_happened() -> None:
    first, second, third = steps_of(RECORDS)
    assert first.call == "moveToContainerFast(a1)"
    assert (first.outcome, first.chance, facts_text(first.changed)) == (0, 0.6, "not dirt(a1)")
    assert first.plan is not None
    assert len(first.plan.steps) == 2
    assert [len(first.before), len(first.after)] == [2, 1]
    assert second.plan is None, "the second action of the same plan"
    assert second.failure == "it can't reach <there> & back"
    assert second.chance is None
    assert third.plan is not None
    assert (third.outcome, third.chance) == (None, 0.1), "what nothing explains is noise"


def test_an_action_that_a_crash_cut_short_is_told_as_such() -> None:
    (*_, last) = steps_of(RECORDS[:5])
    assert not last.finished
    assert last.chance is None
    assert last.expected.rule == "fast_medium"


def test_texts_are_those_of_a_rule_file() -> None:
    assert facts_text(
        [FactEntry("on", ("a", "b"), True), FactEntry("n", (), 3), FactEntry("s", ("a",), None)]
    ) == ("on(a, b), n := 3, no s(a)")
    assert chance_text(Chance(1.0, "nothing", ())) == "nothing changes"
    assert chance_text(Chance(1.0, "noise", ())) == "noise: anything else"
    assert likeliest(Expected(None, ())) is None


def test_time_follows_time_and_areas_are_counted() -> None:
    stretches, counts = timeline(RECORDS)
    assert all(a.start + a.seconds == pytest.approx(b.start) for a, b in pairwise(stretches))
    assert {s.number for s in stretches if s.kind in ("transits", "actions")} == {1, 2, 3}
    assert {s.number for s in stretches if s.kind == "planning"} == {0}
    for kind, seconds in SECONDS.items():
        assert sum(s.seconds for s in stretches if s.kind == kind) == pytest.approx(seconds)
    assert [count.areas for count in counts] == [2, 1, 0, 0]


def test_a_row_is_what_run_json_says(tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    row = row_of(read_run(run_folder))
    assert dict(row.seconds) == SECONDS
    assert row.total == pytest.approx(sum(SECONDS.values()))
    assert (row.problem, row.strategy, row.seed) == ("two_groups", "prada+", 1)
    assert (row.clean, row.actions, row.areas, row.left, row.particles) == (True, 3, 0, 1, 28)


def test_a_run_cut_short_has_the_time_of_its_journal(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "cut", RECORDS[:8], episode=None, truth=None)
    with (folder / "journal.jsonl").open("a", encoding="utf-8") as journal:
        journal.write('{"event": "act')
    row = row_of(read_run(folder))
    assert dict(row.seconds) == pytest.approx(
        {"planning": 0.3, "perceiving": 0.4, "transits": 3, "actions": 6}
    )
    assert row.total == pytest.approx(9.7)
    assert (row.clean, row.actions, row.areas, row.left) == (None, 1, 1, None)


def test_a_run_killed_before_it_began_is_a_run(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "none", (), 0, episode=None, truth=None, files=[])
    (folder / "journal.jsonl").unlink()
    row = row_of(read_run(folder))
    assert (row.total, row.actions, row.areas, row.problem) == (0, 0, None, "none")


def test_fields_of_later_versions_are_passed_over(tmp_path: Path) -> None:
    assert read_run(write_run(tmp_path / "later", news={"of": "tomorrow"})).header.seed == 1


@pytest.mark.parametrize(
    "text", [None, "", "{", "[]", '{"seed": "one"}', json.dumps({**header(), "episode": 3})]
)
def test_what_is_no_run_is_refused(text: str | None, tmp_path: Path) -> None:
    if text is not None:
        (tmp_path / "run.json").write_text(text, encoding="utf-8")
    with pytest.raises(Refused, match="E705"):
        read_run(tmp_path)


@pytest.mark.parametrize(("number", "reason"), [(0, "there is no format 0"), (2, "was written in format 2")])
def test_other_formats_are_refused_with_their_number(number: int, reason: str, tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text(json.dumps({**header(), "format": number}), encoding="utf-8")
    with pytest.raises(Refused) as refused:
        read_run(tmp_path)
    (mistake,) = refused.value.diagnostics
    assert mistake.code == "E705"
    assert reason in mistake.message


def test_begun_means_started() -> None:
    assert sum(isinstance(record, Started) for record in RECORDS) == len(steps_of(RECORDS))
