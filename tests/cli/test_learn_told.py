"""What `learn` says of how much it learned from: rules that are written, and what they were seen for."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cleancli.cli.main import run
from cleancli.experiment.store import LINES

DOMAIN = """domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp) }
  derived    { burning := count ?l - lamp: lit(?l) }
  actions    { press(?l - lamp) }
  rule go_out: press(?l) { when lit(?l) then 0.9: not lit(?l)  0.1: nothing }
  %s
  reward { decrease(burning) }
}
"""


@pytest.mark.parametrize(
    ("default", "told"),
    [
        ("", "2 transitions, 1 example for 1 of 1 rule\n1 transition that no rule covers: "),
        ("default { 1: nothing }", "2 transitions, 2 examples for 2 of 2 rules\n"),
    ],
)
def test_a_default_that_is_not_written_is_no_rule(
    default: str,
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("lamps.nid").write_text(DOMAIN % default, encoding="utf-8")
    lit = [["lit", ["l1"], True]]
    lines = [
        {"action": "press", "arguments": ["l1"], "objects": {"l1": "lamp"}, "before": before, "after": []}
        for before in (lit, [])
    ]
    Path("seen.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    assert run(["learn", "lamps.nid", "seen.jsonl"]) == 0
    assert told in capsys.readouterr().out


def learned(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """What `learn` prints of a lamp that went out and one that did not."""
    capsys.readouterr()
    Path("lamps.nid").write_text(DOMAIN % "", encoding="utf-8")
    before, after = [["lit", ["l1"], True]], list[object]()
    line = {
        "action": "press",
        "arguments": ["l1"],
        "objects": {"l1": "lamp"},
        "before": before,
        "after": after,
    }
    Path("seen.jsonl").write_text(json.dumps(line) + "\n", encoding="utf-8")
    assert run(["learn", "lamps.nid", "seen.jsonl", *words]) == 0
    return capsys.readouterr().out


def test_the_change_is_printed_where_nothing_is_written_or_where_it_is_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    alone = learned(capsys)
    assert "+  rule go_out: press(?l) { when lit(?l) then 0.9091 [prior 0.9, seen 1]" in alone
    diff = alone[: alone.index("1 transition,")]
    for writing, wrote in ((["--write"], "wrote lamps.nid\n"), (["--output", "new.nid"], "wrote new.nid\n")):
        Path("new.nid").unlink(missing_ok=True)
        assert learned(capsys, *writing) == alone[len(diff) :] + wrote
        Path("new.nid").unlink(missing_ok=True)
        assert learned(capsys, *writing, "--diff") == alone + wrote
    assert learned(capsys, "--diff") == alone
    data = json.loads(learned(capsys, "--json", "--diff"))
    assert data.pop("diff") + "\n" == diff
    assert data == json.loads(learned(capsys, "--json"))


@pytest.mark.parametrize("other", ["--check", "--explain"])
def test_where_nothing_is_learned_there_is_no_change_to_print(
    other: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    learned(capsys)
    assert run(["learn", "lamps.nid", "seen.jsonl", other, "--diff"]) == 2
    assert "learns nothing" in capsys.readouterr().err


def test_writing_what_nobody_learns_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["execute", "cleaning", "three_areas", "--write"]) == 2
    assert "--write writes what --learn has learned: ask for both" in capsys.readouterr().err


def test_runs_of_another_domain_in_a_folder_are_passed_over_and_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/learning.md; where no run is of the domain, or one is named, it is told what is wrong with it."""
    monkeypatch.chdir(tmp_path)
    Path("lamps.nid").write_text(DOMAIN % "", encoding="utf-8")
    for number, action in enumerate(("press", "press", "wipe"), start=1):
        folder = Path("runs") / f"r{number}"
        folder.mkdir(parents=True)
        for name, content in (("run.json", "{}"), ("journal.jsonl", ""), ("experience.jsonl", "")):
            (folder / name).write_text(content, encoding="utf-8")
        line = {"action": action, "arguments": ["l1"], "objects": {"l1": "lamp"}, "after": []}
        lines = [json.dumps({**line, "before": [["lit", ["l1"], True]], "seed": number})]
        (folder / "experience.jsonl").write_text("".join(f"{each}\n" for each in lines), encoding="utf-8")
    notes = []
    for more in ([], ["--structure"], ["--check"]):
        assert run(["learn", "lamps.nid", "runs", *more]) == 0
        notes.append(capsys.readouterr().out)
    assert all("runs: 1 run passed over, of actions that `lamps` has not\n" in told for told in notes)
    assert "\n2 transitions, " in notes[0]
    for other in (["runs/r3"], ["runs", "runs/r3"]):
        assert run(["learn", "lamps.nid", *other]) == 1
        assert "error[E701]" in capsys.readouterr().err


@pytest.mark.parametrize("structure", [[], ["--structure"]])
def test_a_study_is_told_once_to_keep_no_experience(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    structure: list[str],
) -> None:
    """docs/diagnostics.md, E701: whether its folder is given or its file."""
    monkeypatch.chdir(tmp_path)
    Path("lamps.nid").write_text(DOMAIN % "", encoding="utf-8")
    Path("luck").mkdir()
    row = {"row": {"study": "luck", "run": 1, "clean": False}}
    Path("luck", LINES).write_text(f"{json.dumps(row)}\n" * 60, encoding="utf-8")
    for given in ("luck", f"luck/{LINES}"):
        assert run(["learn", *structure, "lamps.nid", given]) == 1
        error = capsys.readouterr().err
        assert error.count("error[") == 1
        assert f"error[E701]: `luck/{LINES}` has the rows of a study, which keeps no experience" in error
        assert "simulate DOMAIN PROBLEM --record FILE" in error
