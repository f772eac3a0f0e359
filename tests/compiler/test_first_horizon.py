"""The horizon in the initial state, against that of the grounded task."""

from __future__ import annotations

import pytest

from cleancli.compiler.ground import ground
from cleancli.compiler.horizon import first_horizon
from support.from_text import domain, problem
from support.shipped import shipped_domain, shipped_problem

LAMPS = """
domain lamps {
  types      { lamp }
  predicates { on(?l - lamp) }
  derived    { lit := count ?l - lamp: on(?l) }
  actions    { press(?l - lamp) }
  rule press_it: press(?l) { when on(?l)  then 1: not on(?l) }
  reward { decrease(lit) }
}
"""


@pytest.mark.parametrize("horizon", ["", "horizon = 7", "horizon = 3 + lit"])
def test_it_is_that_of_the_task(horizon: str) -> None:
    lamps = domain(LAMPS)
    given = problem(lamps, f"objects {{ a b c - lamp }}  init {{ on(a), on(c) }}  {horizon}")
    assert first_horizon(lamps, given) == ground(lamps, given).horizon


def test_it_is_that_of_a_shipped_task() -> None:
    cleaning = shipped_domain("cleaning")
    given = shipped_problem("three_areas", cleaning)
    assert first_horizon(cleaning, given) == ground(cleaning, given).horizon == 4
