"""W201 advises to leave out only what nothing needs, as far as the files that are checked can tell."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cleancli.cli.main import run

DOMAIN = """domain d {
  types      { area shelf }
  constants  { bin spare - area }
  predicates { dirt(?a - area)  shiny(?a - area) [static]  noted(?a - area) }
  functions  { load(?a - area): 0..3 }
  derived    { left := count ?a - area: dirt(?a) }
  actions    { wipe(?a - area) }
  rule w: wipe(?a) { when dirt(?a) then 0.9: not dirt(?a)  0.1: nothing }
  reward { decrease(left) }
}
"""
PROBLEM = """problem p {
  domain = d
  objects { a - area }
  init { dirt(a), shiny(bin), load(a) = 1, load(bin) = 0, load(spare) = 0, noted(a), shiny(spare) }
  goal { shiny(bin), load(a) = 1, forall ?s - shelf: not dirt(a) }
}
"""
BASE = """domain base {
  types      { area }
  predicates { dirt(?a - area)  wet(?a - area) }
  parameters { often = 0.9  seldom = 0.1 }
  reward     { cost }
}
"""
MAIN = """domain main {
  include "base.nid"
  actions { wipe(?a - area) }
  rule w: wipe(?a) { when dirt(?a) then often: not dirt(?a)  rest: nothing }
}
"""


def unused(capsys: pytest.CaptureFixture[str], *files: str) -> set[str]:
    assert run(["check", *files]) == 0
    return set(re.findall(r"warning\[W201\]: the \w+ `(\w+)` is never used", capsys.readouterr().out))


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, text in (("d", DOMAIN), ("p", PROBLEM), ("base", BASE), ("main", MAIN)):
        (tmp_path / f"{name}.nid").write_text(text, encoding="utf-8")
    return tmp_path


def test_the_goal_of_a_problem_uses_what_it_names(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    alone = unused(capsys, "d.nid")
    assert {"shiny", "load", "noted", "shelf", "bin", "spare"} == alone
    # Facts that nothing asks for are no use.
    assert unused(capsys, "d.nid", "p.nid") == {"noted", "spare"}
    assert unused(capsys, str(folder / "p.nid"), "./d.nid") == {"noted", "spare"}
    (folder / "other.nid").write_text(PROBLEM.replace("domain = d", "domain = cleaning"), encoding="utf-8")
    assert run(["check", "d.nid", "other.nid"]) == 1
    assert capsys.readouterr().out.count("W201") == len(alone)


def test_a_domain_uses_what_it_includes(capsys: pytest.CaptureFixture[str]) -> None:
    assert unused(capsys, "base.nid") == {"dirt", "wet", "often", "seldom"}
    assert unused(capsys, "base.nid", "main.nid") == {"wet", "seldom"}


def test_the_advice_says_who_else_may_use_it(capsys: pytest.CaptureFixture[str]) -> None:
    run(["check", "d.nid", "base.nid"])
    told = re.findall(r"= help: (leave it out.*)", capsys.readouterr().out)
    assert told
    assert set(told) == {
        "leave it out, unless a problem's goal or a domain that includes this one uses it",
        "leave it out, unless a domain that includes this one uses it",
    }


def test_a_vocabulary_is_not_called_unused_but_for_types(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/diagnostics.md, W201 and W203: what rules that will be learned are to use stays."""
    rule = next(line for line in DOMAIN.splitlines(keepends=True) if "rule w" in line)
    (folder / "vocabulary.nid").write_text(DOMAIN.replace(rule, ""), encoding="utf-8")
    assert run(["check", "vocabulary.nid"]) == 0
    told = capsys.readouterr().out
    assert re.findall(r"warning\[(\w+)\]: (.*)", told) == [
        ("W201", "the type `shelf` is never used"),
        ("W203", "no action of this domain has a rule"),
    ]
    assert "learn --structure --vocabulary" in told
    (folder / "d.nid").write_text(DOMAIN.replace("wipe(?a - area) }", "wipe(?a - area)  wait() }"))
    assert run(["check", "d.nid"]) == 0
    assert "warning[W203]: the action `wait` has no rule" in capsys.readouterr().out
