"""Numbers as they are printed: a value is called what it is (docs/planning.md), and no 0 has a sign."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import cleancli
from cleancli.cli.main import run

SOURCES = Path(cleancli.__file__).parent
TELLING = ("api", "cli", "report", "results", "experiment")
"""Packages that tell numbers to people."""

POND = """
domain ponds {
  types      { pond }
  predicates { seen(?p - pond) }
  derived    { seen_ponds := count ?p - pond: seen(?p) }
  actions    { look(?p - pond) [cost = 1/1000000] }
  rule look_at: look(?p) { when not seen(?p) then 0.5: seen(?p)  rest: nothing }
  reward     { PAID - cost }
}
"""
LAKE = "problem lake { domain = ponds  objects { lake - pond }  init { }  horizon = 2 }"


@pytest.mark.parametrize(
    ("planner", "measure"),
    [("sst", "estimated"), ("exact", "policy"), ("uct", "policy"), ("prada", "factored")],
)
def test_the_value_is_called_what_it_is(planner: str, measure: str) -> None:
    """docs/planning.md: that of `sst` is an estimate."""
    plan = cleancli.plan(POND.replace("PAID", "seen_ponds"), LAKE, planner=planner, seed=1, samples=50)
    assert plan.measure == measure
    assert f"({measure}) by {planner}" in str(plan)


def test_what_stopping_is_worth_is_no_estimate() -> None:
    plan = cleancli.plan(POND.replace("PAID", "- seen_ponds"), LAKE, planner="sst", seed=1)
    assert (plan.plan, plan.measure) == ((), "policy")


def test_a_value_that_rounds_to_0_has_no_sign(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    domain, problem = tmp_path / "ponds.nid", tmp_path / "lake.nid"
    domain.write_text(POND.replace("PAID", "0 * seen_ponds"), encoding="utf-8")
    problem.write_text(LAKE, encoding="utf-8")
    files = [str(domain), str(problem)]
    assert run(["plan", *files, "--evaluate", "look(lake)", "--explain"]) == 0
    assert run(["simulate", *files, "--strategy", "random", "--episodes", "3"]) == 0
    told = capsys.readouterr().out
    assert "0.000" in told
    assert not re.search(r"-0\.0*(?![0-9])", told)


def test_no_number_is_formatted_so_that_0_may_have_a_sign() -> None:
    """`z` in a format makes a 0 of what rounds to one (Python's format specification)."""
    signed = re.compile(r":[+,]*\.(?:\{\w+\}|\d)[fg%]\}")
    found = [
        f"{path.relative_to(SOURCES)}: {text}"
        for package in TELLING
        for path in sorted((SOURCES / package).rglob("*.py"))
        for text in signed.findall(path.read_text(encoding="utf-8"))
        if not text.startswith(":,")
    ]
    assert found == []
