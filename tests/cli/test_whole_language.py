"""Commands on a domain that uses every construct, split over two files."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from cleancli.cli.main import run
from support.commands import said
from support.tower import BASE, DOMAIN, PROBLEM


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "base.nid").write_text(BASE, encoding="utf-8")
    (tmp_path / "tower.nid").write_text(DOMAIN, encoding="utf-8")
    (tmp_path / "two.nid").write_text(PROBLEM, encoding="utf-8")
    return tmp_path


def test_check_finds_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert said(capsys, "check", "tower.nid", "two.nid") == "0 mistakes in 2 files\n"


def test_plan_takes_what_the_problem_asks_for(capsys: pytest.CaptureFixture[str]) -> None:
    data = json.loads(said(capsys, "plan", "tower.nid", "two.nid", "--json"))
    assert (data["samples"], data["horizon"]) == (300, 4)
    assert sorted(data["plan"])[:2] == ["lift(b1)", "lift(b1)"]
    assert "wipe(b1)" in data["plan"]
    asked = json.loads(said(capsys, "plan", "tower.nid", "two.nid", "--json", "--samples", "200"))
    assert asked["samples"] == 200


def test_explain_says_why_in_the_words_of_the_file(capsys: pytest.CaptureFixture[str]) -> None:
    free = said(capsys, "explain", "tower.nid", "two.nid", "wipe(b1)")
    assert "covered by rule wipe_free (?b = b1, ?s = s1)" in free
    assert "1/2: not at(b1, s1), not dirty(b1)" in free or "0.5: not at(b1, s1), not dirty(b1)" in free
    buried = said(capsys, "explain", "tower.nid", "two.nid", "wipe(b2)")
    assert "not buried(?b)" in buried
    assert "buried(b2) is true" in buried


def test_explain_an_unclear_reference(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (files / "two.nid").write_text(PROBLEM.replace("below(b1, b2)", "wet(b2)"), encoding="utf-8")
    text = said(capsys, "explain", "tower.nid", "two.nid", "wipe(b2)")
    assert "there is (?o = b2)" in text
    (files / "two.nid").write_text(PROBLEM.replace(", below(b1, b2)", ""), encoding="utf-8")
    text = said(capsys, "explain", "tower.nid", "two.nid", "wipe(b2)")
    assert "these fit: (?s = s1) or (?s = s2)" in text


def test_show_and_compile_know_all_of_it(capsys: pytest.CaptureFixture[str]) -> None:
    shown = said(capsys, "show", "tower.nid", "two.nid")
    for expected in ("under(?a - box, ?b - box) := closure below", "spill = 0.25", "[static]", "cost 0.5"):
        assert expected in shown
    assert "with ?s - shelf: at(?b, ?s)" in shown
    assert "estimator decreasing_m, m 10, match shared" in shown
    assert "3 transitions of runs/tower-1 (sha256 9f86d081884c7d65)" in shown
    data = json.loads(said(capsys, "show", "tower.nid", "--json"))
    lines = [line.strip() for line in shown.splitlines()]
    for name in ("symbols", "derived", "counts"):
        start = lines.index(name) + 1
        assert data[name] == lines[start : start + len(data[name])], "as people are shown it"
    costs = {f"cost {each['cost']}" for each in data["actions"] if each["cost"] is not None}
    assert (
        costs == {" ".join(words.split()[:2]) for words in re.findall(r"  (cost .*)", shown)} == {"cost 0.5"}
    )
    counted = [{"name": "runs/tower-1", "sha256": "9f86d081884c7d65", "transitions": 3}]
    settings = {"estimator": "decreasing_m", "m": 10.0, "match": "shared", "forgetting": 0.0}
    assert data["learned"] == {**settings, "experience": counted}
    compiled = said(capsys, "compile", "tower.nid", "two.nid")
    assert "action lift(b1)" in compiled
    assert json.loads(said(capsys, "compile", "tower.nid", "two.nid", "--format", "json"))["actions"]


def test_learning_changes_the_file_that_holds_the_number(
    files: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = [["dirty", ["b1"], True], ["at", ["b1", "s1"], True], ["load", ["b1"], 0]]
    record = {
        "action": "wipe",
        "arguments": ["b1"],
        "objects": {"b1": "box", "s1": "shelf"},
        "before": before,
        "after": [*before, ["wet", ["b1"], True]],
    }
    (files / "experience.jsonl").write_text((json.dumps(record) + "\n") * 4, encoding="utf-8")
    text = said(capsys, "learn", "tower.nid", "experience.jsonl", "--replace", "--write")
    assert "wrote tower.nid" in text
    learned = (files / "parts" / "base.nid").read_text(encoding="utf-8")
    assert "[prior 0.25, seen 4]" in learned
    assert "0.9 [fixed]" in (files / "tower.nid").read_text(encoding="utf-8")
    said(capsys, "check", "tower.nid")
    again = said(capsys, "learn", "tower.nid", "experience.jsonl", "--write")
    assert "wrote" not in again


def test_outside_files_are_included_only_if_allowed(
    files: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    inner = files / "inner"
    inner.mkdir()
    text = DOMAIN.replace("parts/base.nid", "../parts/base.nid")
    (inner / "tower.nid").write_text(text, encoding="utf-8")
    assert run(["check", "inner/tower.nid"]) == 1
    assert "E109" in capsys.readouterr().out
    assert said(capsys, "--include-outside", "check", "inner/tower.nid") == "0 mistakes in 1 file\n"


def test_mistakes_found_when_grounding_show_their_line(
    files: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    many = " ".join(f"x{number}" for number in range(400))
    (files / "two.nid").write_text(PROBLEM.replace("b1 b2 - box", f"b1 b2 - box  {many} - shelf"))
    wide = DOMAIN.replace("lift(?b - box)", "lift(?b - box)  sort(?r ?s ?t - shelf)").replace(
        "  default", "  rule sort_any: sort(?r, ?s, ?t) { then 1: not at(b1, ?r) }\n  default"
    )
    (files / "tower.nid").write_text(wide.replace("  include", "  constants { b1 - box }\n  include"))
    (files / "two.nid").write_text((files / "two.nid").read_text().replace("objects { b1 b2", "objects { b2"))
    assert run(["plan", "tower.nid", "two.nid"]) == 1
    error = capsys.readouterr().err
    assert "E604" in error
    assert "rule sort_any: sort(?r, ?s, ?t)" in error, "the line is shown"
    assert "64,964,808" in error or "64964808" in error


def test_learn_tells_of_transitions_that_no_rule_covers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("coins.nid").write_text(
        "domain coins { types { coin } predicates { heads(?c - coin) }"
        " derived { up := count ?c - coin: heads(?c) } actions { flip(?c - coin) }"
        " rule one: flip(?c) { when heads(?c) then 0.5: not heads(?c) 0.5: nothing }"
        " reward { decrease(up) } }\n",
        encoding="utf-8",
    )
    entry = {"action": "flip", "arguments": ["c"], "objects": {"c": "coin"}, "after": []}
    lines = [json.dumps({**entry, "before": before}) for before in ([["heads", ["c"], True]], [])]
    Path("experience.jsonl").write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    text = said(capsys, "learn", "coins.nid", "experience.jsonl")
    assert "0.5455 [prior 0.5, seen 1]: not heads(?c)" in text
    assert "1 transition that no rule covers: the domain has no `default`" in text
