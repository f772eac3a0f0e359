"""`check` of a problem whose domain is wrong tells the mistakes of both, and none that merely follow."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.cli.main import run

DOMAIN = """domain ferry {
  types      { thing }
  constants  { dock - thing }
  predicates { over(?c - thing)  on(?c - thing) }
  functions  { fuel(): 0..4 }
  derived    { left := count ?c - thing: not over(?c) }
  actions    { load(?c - thing) }
  rule load_it: load(?c) { when not on(?c)  then 0.9: on(?c)  rest: nothing }
  reward { decrease(left) }
}
"""
RIGHT = """problem cars {
  domain = ferry
  objects { a b - thing }
  init { on(a), over(dock), fuel() = 2 }
  goal { over(a) }
  horizon = 2 + left
}
"""

IN_RULES = {
    "no such predicate": ("then 0.9: on(?c)", "then 0.9: onn(?c)"),
    "probabilities": ("0.9: on(?c)  rest: nothing", "0.9: on(?c)  0.3: nothing"),
    "syntax of a rule": ("when not on(?c)", "when when on(?c)"),
}
ELSEWHERE = {
    "no such type": ("over(?c - thing)", "over(?c - thin)"),
    "syntax of predicates": ("predicates { over", "predicates { - over"),
    "a type twice": ("types      { thing }", "types      { thing; thing }"),
    "syntax of types": ("types      { thing }", "types      { thing - - }"),
    "a range": ("fuel(): 0..4", "fuel(): 4..0"),
    "a count": ("not over(?c) }", "not ovr(?c) }"),
    "a brace": ("functions  { fuel(): 0..4 }", "functions  { fuel(): 0..4 "),
    "a constant": ("dock - thing", "dock - thin"),
    "an include": ("  types ", '  include "none.nid"\n  types '),
}


def checked(tmp_path: Path, capsys: pytest.CaptureFixture[str], change: tuple[str, str], problem: str) -> str:
    old, new = change
    assert old in DOMAIN
    (tmp_path / "ferry.nid").write_text(DOMAIN.replace(old, new, 1), encoding="utf-8")
    (tmp_path / "cars.nid").write_text(problem, encoding="utf-8")
    assert run(["check", str(tmp_path / "cars.nid")]) == 1
    out = capsys.readouterr().out
    assert "ferry.nid:" in out
    return out


@pytest.mark.parametrize("change", [*IN_RULES, *ELSEWHERE])
def test_nothing_is_told_of_a_right_problem(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: str
) -> None:
    assert "cars.nid" not in checked(tmp_path, capsys, (IN_RULES | ELSEWHERE)[change], RIGHT)


@pytest.mark.parametrize("change", IN_RULES)
def test_where_rules_are_wrong_names_of_the_problem_are_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: str
) -> None:
    wrong = RIGHT.replace("on(a)", "onn(a)").replace("goal { over(a) }", "goal { over(c) }")
    out = checked(tmp_path, capsys, IN_RULES[change], wrong)
    assert "cars.nid:4:10: error[E203]: unknown predicate or function `onn`" in out
    assert "cars.nid:5:15: error[E205]: unknown object `c`" in out


@pytest.mark.parametrize("change", [*IN_RULES, *ELSEWHERE])
def test_what_no_domain_allows_is_told_in_any_case(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: str
) -> None:
    wrong = RIGHT.replace("goal { over(a) }", "goal { over(a) ")
    out = checked(tmp_path, capsys, (IN_RULES | ELSEWHERE)[change], wrong)
    assert "cars.nid:5:8: error[E102]" in out or "cars.nid:1:14: error[E102]" in out
