"""What `check` says of many files and mistakes, as docs/commands.md has it: each once, 100 at most."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from cleancli.cli.main import run
from support.commands import said

BASE = """domain base {
  types      { area }
  predicates { dirt(?a - area) }
  derived    { dirty := count ?a - area: dirt(?a)  lost(?a - area) := dirt(?a), exists ?b - area: dirt(?a) }
  actions    { wipe(?a - area) }
  rule wipe_it: wipe(?a) { when dirt(?a) then 0.9: not dirt(?a)  rest: nothing }
  reward { decrease(dirty) }
}
"""
PROBLEM = "problem {0} {{ domain = base objects {{ a1 - area }} init {{ dirt(a1) }} }}\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("names", [["."], ["top.nid", "./base.nid", "p1.nid"], ["p1.nid", "p2.nid"]])
def test_a_mistake_is_said_once_however_many_files_lead_to_it(
    folder: Path, capsys: pytest.CaptureFixture[str], names: list[str]
) -> None:
    (folder / "base.nid").write_text(BASE.replace("not dirt(?a)", "not dort(?a)"), encoding="utf-8")
    (folder / "top.nid").write_text('domain top { include "base.nid" }', encoding="utf-8")
    for name in ("p1", "p2"):
        (folder / f"{name}.nid").write_text(PROBLEM.format(name), encoding="utf-8")
    text = said(capsys, "check", *names, code=1)
    assert text.count("error[E203]") == 1
    assert "1 mistake and 1 warning" in text
    assert text.count("warning[W202]: the variable `?b`") == 1


def test_equal_mistakes_at_two_places_are_two(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = PROBLEM.format("p").replace("dirt(a1)", "dirt(a2), dirt(a2)")
    (folder / "base.nid").write_text(BASE, encoding="utf-8")
    (folder / "p.nid").write_text(text, encoding="utf-8")
    assert said(capsys, "check", "p.nid", code=1).count("error[E205]") == 2


def test_another_domain_comes_first_and_alone(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (
        "problem p { objects { x1 x2 - room  x1 - room } init { at(x1) load(x2) = 3 wet(x9) }"
        " goal { forall ?r - room: clean(?r) } horizon = 3.5 domain = kitchen }"
    )
    (folder / "p.nid").write_text(text, encoding="utf-8")
    (folder / "base.nid").write_text(BASE, encoding="utf-8")
    printed = said(capsys, "plan", "base.nid", "p.nid", code=1)
    codes = [line.split("error[")[1][:4] for line in printed.splitlines() if "error[" in line]
    assert codes == ["E401", "E202", "E406"], "what follows from the domain is not listed, other mistakes are"
    assert "messages that may follow from this are left out" in printed


def test_another_domain_folds_nothing_where_nothing_follows(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "p.nid").write_text("problem p { domain = kitchen objects { a1 - area } }", encoding="utf-8")
    (folder / "base.nid").write_text(BASE, encoding="utf-8")
    printed = said(capsys, "plan", "base.nid", "p.nid", code=1)
    assert "E401" in printed
    assert "follow" not in printed


def _many(folder: Path, mistakes: int, warnings: int = 0) -> None:
    unused = "w{}(?a - area) := dirt(?a), exists ?b - area: dirt(?a)"
    declared = " ".join(unused.format(n) for n in range(warnings))
    wrong = " ".join(f"rule r{n}: wope(?a) {{ then 1: noise }}" for n in range(mistakes))
    text = BASE.replace(unused.replace("w{}", "lost"), declared).replace("reward", f"{wrong} reward")
    (folder / "base.nid").write_text(text, encoding="utf-8")


@pytest.mark.parametrize(("mistakes", "left"), [(100, 0), (101, 1), (300, 200)])
def test_a_hundred_messages(
    folder: Path, capsys: pytest.CaptureFixture[str], mistakes: int, left: int
) -> None:
    _many(folder, mistakes)
    text = said(capsys, "check", "base.nid", code=1)
    assert text.count("error[") == 100
    assert (f"{left} more mistake{'s' * (left != 1)}: --all shows all" in text) == (left > 0)
    assert text.endswith(f"{mistakes} mistakes in 1 file\n")
    assert said(capsys, "check", "base.nid", "--all", code=1).count("error[") == mistakes
    planned = said(capsys, "show", "base.nid", code=1)
    assert planned.count("error[") == 100
    assert (f"{left} more mistake" in planned) == (left > 0)


def test_mistakes_go_before_warnings_where_not_all_are_shown(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _many(folder, 40, warnings=90)
    text = said(capsys, "check", "base.nid", code=1)
    assert (text.count("error["), text.count("warning[")) == (40, 60)
    places = [tuple(map(int, place)) for place in re.findall(r"^base.nid:(\d+):(\d+): ", text, re.M)]
    assert len(places) == 100
    assert places == sorted(places), "what is shown stands in the order of the file"
    assert "30 more warnings: --all shows all" in text
    assert text.endswith("40 mistakes and 90 warnings in 1 file\n")


def test_programs_are_told_how_many_are_left_out(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _many(folder, 250)
    *found, note = json.loads(said(capsys, "check", "base.nid", "--json", code=1))
    assert [entry["level"] for entry in found] == ["error"] * 100
    assert (note["level"], note["left_out"], note["path"]) == ("note", 150, None)
    (sarif,) = json.loads(said(capsys, "check", "base.nid", "--format", "sarif", code=1))["runs"]
    assert len(sarif["results"]) == 100
    assert sarif["properties"] == {"leftOut": 150}
    (invocation,) = sarif["invocations"]
    (told,) = invocation["toolExecutionNotifications"]
    assert (invocation["executionSuccessful"], told["level"]) == (True, "note")
    assert "150 more are left out" in told["message"]["text"]
    assert len(json.loads(said(capsys, "check", "base.nid", "--json", "--all", code=1))) == 250
    sarif = json.loads(said(capsys, "check", "base.nid", "--format", "sarif", "--all", code=1))
    (everything,) = sarif["runs"]
    assert len(everything["results"]) == 250
    assert not {"properties", "invocations"} & everything.keys()


def test_bad_lines_by_the_thousand_print_little(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    facts = "\n".join(f"dirt(x{n})" for n in range(10_000))
    (folder / "base.nid").write_text(BASE, encoding="utf-8")
    (folder / "p.nid").write_text(PROBLEM.format("p").replace("dirt(a1)", facts), encoding="utf-8")
    text = said(capsys, "check", "p.nid", code=1)
    assert len(text) < 20_000
    assert "9900 more mistakes" in text


def test_a_name_of_a_million_letters_is_cut(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "base.nid").write_text(
        BASE.replace("dirt(?a) then", f"{'d' * 10**6}(?a) then"), encoding="utf-8"
    )
    assert len(said(capsys, "check", "base.nid", code=1)) < 20_000


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("chekc", "`check`"),
        ("Plan", "`plan`"),
        ("run", "`cleancli --help` lists the commands"),
        ("exec", "`execute`"),
        ("format", "`fmt`"),
        ("my.nid", "`cleancli check my.nid`"),
    ],
)
def test_a_command_that_does_not_exist(typed: str, meant: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([typed]) == 2
    said = capsys.readouterr().err
    assert f"No such command '{typed}'" in said
    assert meant in said
