"""What outcomes pay (docs/language.md "Costs and rewards"), counted by planners and drawn in episodes."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from scipy import stats

import cleancli
from cleancli.compiler.dump import as_data, dump
from cleancli.compiler.semantics import exact_value
from cleancli.planning.compiled_task import prepare
from cleancli.planning.evaluation.belief_value import plan_value
from cleancli.planning.evaluation.forecast import forecast
from cleancli.planning.evaluation.value import exact, sampled
from cleancli.planning.kernels import annealing
from cleancli.simulation.symbolic_world import do, world_of
from support.from_text import checked, task
from support.planned import planned

TEXT = """
domain fishing {
  types      { pond }
  predicates { stocked(?p - pond)  torn() }
  actions    { cast(?p - pond) [cost = 1]  mend()  lure() [cost = 0.25] }

  rule cast_it: cast(?p) {
    when stocked(?p), not torn()
    then 0.5: not stocked(?p), reward += 5
         0.1: torn(), reward -= 0.5, cost += 2
         rest: nothing
  }
  rule mend_it: mend() {
    when torn()
    then 0.9: not torn()
         rest: cost += 1/3
  }
  rule lure_them: lure() {
    when not torn()
    then 0.25: reward += 0.5
         rest: reward += LURED
  }
  reward { - 2 * cost }
}
"""
INSIDE = "objects { p - pond } init { stocked(p) } horizon = 5 discount = 0.9"
DISCOUNT = Fraction(9, 10)
DEAR, EARNING = TEXT.replace("LURED", "0.1"), TEXT.replace("LURED", "0.6")
"""Luring fish costs more than it brings, or less."""


@cache
def best(stocked: bool, torn: bool, left: int, lured: Fraction) -> Fraction:
    """The text once more: a cost counts twice."""
    if left == 0:
        return Fraction(0)

    def later(stocked: bool, torn: bool) -> Fraction:
        return DISCOUNT * best(stocked, torn, left - 1, lured)

    ways = [Fraction(0)]
    if torn:
        ways.append(
            Fraction(9, 10) * later(stocked, False)
            + Fraction(1, 10) * (Fraction(-2, 3) + later(stocked, True))
        )
        return max(ways)
    ways.append(Fraction(-1, 2) + Fraction(1, 8) + Fraction(3, 4) * lured + later(stocked, torn))
    if stocked:
        caught, lost = 5 + later(False, False), Fraction(-9, 2) + later(True, True)
        ways.append(-2 + caught / 2 + lost / 10 + Fraction(4, 10) * later(True, False))
    return max(ways)


@pytest.mark.parametrize(("text", "lured"), [(DEAR, Fraction(1, 10)), (EARNING, Fraction(3, 5))])
def test_planners_find_what_is_best(text: str, lured: Fraction) -> None:
    found, wanted = task(text, INSIDE), best(True, False, 5, lured)
    assert planned("exact", found, arithmetic="rational").value == pytest.approx(float(wanted), abs=1e-12)
    for name in ("exact", "prada+", "uct"):
        assert planned(name, found, samples=20_000).value == pytest.approx(float(wanted), abs=1e-9), name
    shorter = task(text, INSIDE.replace("horizon = 5", "horizon = 3"))
    drawn = planned("sst", shorter, depth=3, branching=300)
    assert drawn.value == pytest.approx(float(best(True, False, 3, lured)), abs=0.5)


def test_waiting_is_a_choice_only_where_it_can_pay() -> None:
    assert not task(DEAR.replace("reward += 5", "reward += 2"), INSIDE).waiting
    assert task(EARNING, INSIDE).waiting
    assert {action.name for action in task(DEAR, INSIDE).actions} == {"cast", "mend", "lure"}


@pytest.mark.parametrize("text", [DEAR, EARNING])
def test_a_sequence_is_worth_the_same_by_all_that_value_it(text: str) -> None:
    found = task(text, INSIDE)
    number = {action.name: place for place, action in enumerate(found.actions)}
    names = ("cast", "mend", "lure", "cast")
    sequence, prepared = [number[name] for name in names], prepare(found)
    # by hand: the chances that it is torn or stocked before each step
    lured = Fraction(3, 4) * (Fraction(3, 5) if text is EARNING else Fraction(1, 10)) - Fraction(3, 8)
    cast = Fraction(-2) + Fraction(5, 2) - Fraction(45, 100)
    torn = Fraction(1, 100)  # after mending
    able = Fraction(4, 10) + Fraction(1, 10) * Fraction(9, 10)  # stocked and not torn before the last cast
    steps = (
        cast,
        Fraction(1, 10) * Fraction(1, 10) * Fraction(-2, 3),
        (1 - torn) * (lured + Fraction(1, 2)) - Fraction(1, 2),
        able * (cast + 2) - 2,
    )
    wanted = float(sum(paid * DISCOUNT**step for step, paid in enumerate(steps)))
    assert exact_value(found, sequence) == pytest.approx(wanted, abs=1e-12)
    assert exact(prepared, sequence) == pytest.approx(wanted, abs=1e-12)
    told = [step.reward for step in forecast(prepared, sequence, 1).steps]
    assert told == pytest.approx([float(each) for each in steps], abs=1e-12)
    runs = sampled(prepared, sequence, 3, 20_000)
    assert abs(runs.value - wanted) < 4.5 * runs.error
    means = [annealing.value(prepared, sequence, 40, seed) for seed in range(10)]
    assert abs(np.mean(means) - wanted) < 4.5 * np.std(means) / 3
    # PRADA takes `stocked` and `torn` as independent, which the first three steps do not ask about.
    belief = plan_value(found, sequence[:3], rule_threshold=0.0)
    assert belief == pytest.approx(exact_value(found, sequence[:3]), abs=1e-12)


def test_episodes_pay_what_is_drawn() -> None:
    domain, problem = checked(DEAR, INSIDE)
    world, rng = world_of(domain, problem), np.random.default_rng(4)
    cast = next(action for action in world.task.actions if action.name == "cast")
    seen: Counter[tuple[float, float]] = Counter()
    for _ in range(2000):
        step, _ = do(world, world.task.initial, cast, rng)
        seen[step.reward, step.cost] += 1
    declared = {(3.0, 1.0): 0.5, (-6.5, 3.0): 0.1, (-2.0, 1.0): 0.4}
    assert seen.keys() == declared.keys()
    counts = [seen[each] for each in declared]
    assert stats.chisquare(counts, [2000 * share for share in declared.values()]).pvalue > 1e-4


def test_without_a_horizon_costs_of_outcomes_count() -> None:
    inside = "objects { p - pond } init { stocked(p) torn() } goal { not stocked(p) } horizon = unlimited"
    text = DEAR.replace(" [cost = 1]", "")
    for arithmetic in ("float", "rational"):
        reached = planned("exact", task(text, inside), arithmetic=arithmetic).reached
        assert reached is not None
        # m = 1/30 + m/10 from torn, and c = (2 + m)/10 + 4c/10 from the state in which it is not
        mended = Fraction(1, 30) / Fraction(9, 10)
        cast = (Fraction(2, 10) + mended / 10) / (1 - Fraction(4, 10) - Fraction(1, 10))
        assert reached.probability == pytest.approx(1.0)
        assert reached.objective.value == "cost"
        assert reached.cost == pytest.approx(float(mended + cast), abs=1e-9)


def test_what_outcomes_pay_is_told() -> None:
    explained = cleancli.explain(DEAR, f"problem p {{ domain = fishing {INSIDE} }}", "cast(p)")
    assert [each.effects for each in explained.outcomes] == [
        ("not stocked(p)", "reward += 5"),
        ("torn()", "reward -= 0.5", "cost += 2"),
        (),
    ]
    assert "0.1: torn(), reward -= 0.5, cost += 2" in str(explained)
    found = task(DEAR, INSIDE)
    assert "    0.1: torn() [cost 4.5]\n" in dump(found)
    rules = as_data(found)["rules"]
    assert isinstance(rules, list)
    assert [each["cost"] for each in rules[0]["outcomes"]] == [-5.0, 4.5, 0.0]


def test_a_rule_that_only_costs_is_not_passed_over() -> None:
    text = """
    domain tolls {
      types      { road }
      predicates { used(?r - road)  far(?r - road) [static] }
      actions    { go(?r - road) }
      rule near_by: go(?r) { when not far(?r) then 1: used(?r) }
      rule far_off: go(?r) { when far(?r) then 0.5: cost += 3 rest: nothing }
      reward { 10 * goal - cost }
    }
    """
    inside = "objects { a b - road } init { far(b) } goal { used(a) } horizon = 2 discount = 1"
    domain, problem = checked(text, inside)
    found = task(text, inside)
    far = next(place for place, action in enumerate(found.actions) if action.objects == ("b",))
    assert exact_value(found, [far]) == -1.5
    assert plan_value(found, [far]) == -1.5
    world = world_of(domain, problem)
    drawn = {
        do(world, world.task.initial, found.actions[far], np.random.default_rng(s))[0].cost for s in range(9)
    }
    assert drawn == {0.0, 3.0}
