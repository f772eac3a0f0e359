"""Layouts on which chance matters: plans weigh it, and plans that think it away (docs/measurements) go wrong,
in the symbolic world and on the fast stand-in for the table."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

import cleancli

ROOT = Path(__file__).parents[2]
DOMAINS = ROOT / "benchmarks" / "domains"

FOUR_GROUPS = """problem four_groups {
  domain = bow
  objects { a1 a2 a3 a4 - area }
  init { dirt(a1), dirt(a2), dirt(a3), dirt(a4) }
}
"""

RIM = """problem one_side {
  domain = rim
  objects { spread edge inner - area }
  init {
    dirt(spread), dirt(edge), dirt(inner), at_rim(edge)
    onward(spread, edge), onward(spread, inner)
  }
}
"""


def planned(domain: str, problem: str, planner: str | None) -> tuple[str, ...]:
    return cleancli.plan(DOMAINS / f"{domain}.nid", problem, planner=planner, objective="time").plan


@pytest.mark.parametrize("planner", ["likeliest", "all-outcomes"])
def test_who_thinks_chance_away_pushes_quickly(planner: str) -> None:
    assert all("Fast" in action for action in planned("bow", FOUR_GROUPS, planner))


@pytest.mark.parametrize("planner", ["likeliest", "all-outcomes"])
def test_who_thinks_chance_away_goes_over_the_rim(planner: str) -> None:
    assert "sweep2(spread, inner)" not in planned("rim", RIM, planner)


def test_who_weighs_chance_pushes_surely_and_keeps_off_the_rim() -> None:
    assert all("Straight" in action for action in planned("bow", FOUR_GROUPS, None))
    assert "sweep2(spread, inner)" in planned("rim", RIM, None)


def test_on_the_table_of_the_stand_in_plans_lose_nothing_and_others_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    run = importlib.import_module("strategies").run_stand_in
    domain = str(DOMAINS / "rim.nid")
    strategies = ("plan-2", "determinized", "determinized:likeliest")
    lost = {s: [run((domain, "rim", s, seed))["lost"] for seed in range(900, 912)] for s in strategies}
    assert sum(lost.pop("plan-2")) == 0
    assert all(sum(each) > 0 for each in lost.values()), lost
