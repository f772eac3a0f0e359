"""PRADA+: its runs against exact values, its search against all sequences, and its promises."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.semantics import exact_value
from cleancli.compiler.task import GroundOutcome, Task
from cleancli.language.model import OutcomeKind
from cleancli.planning.compiled_task import prepare
from cleancli.planning.kernels import annealing
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planners.prada import PradaOptions, prada
from cleancli.planning.planners.prada_plus import PradaPlusOptions, prada_plus
from support import from_text, small_tasks
from support.optimal import optimum

WORDS = 300


def search(task: Task, options: Options) -> Plan:
    """A plan of the search alone: as if too many states could be reached."""
    return prada_plus(prepare(task), options, PradaPlusOptions(solve=0, runs=0))


def indices(task: Task, plan: Plan) -> list[int]:
    return [task.actions.index(action) for action in plan.actions]


def spread(task: Task) -> float:
    """A bound of the standard deviation of a sequence's value: half of what values can range over."""
    most = sum(abs(r.decrease) + abs(r.state) for r in task.rewards) + sum(a.cost for a in task.actions)
    return float(most) * task.horizon


@pytest.mark.parametrize("seed", range(12))
def test_runs_are_worth_what_the_process_says(seed: int) -> None:
    task = small_tasks.weighted_task(seed)
    if seed % 2:
        task = small_tasks.timed(task)
    rng, prepared = np.random.default_rng(seed), prepare(task)
    for length in (0, 1, 3, 5):
        chosen = rng.integers(len(task.actions), size=length).tolist()
        means = [annealing.value(prepared, chosen, WORDS // 10, s) for s in range(10)]
        error = np.std(means, ddof=1) / np.sqrt(len(means)) + 1e-12
        assert abs(np.mean(means) - exact_value(task, chosen)) < stats.t.isf(1e-6, 9) * error


def one_rule(*probabilities: Fraction) -> Task:
    """One variable, which starts at 0; the only action sets it to i with the i-th probability."""
    task = small_tasks.random_task(0)
    values = tuple(map(str, range(len(probabilities) + 1)))
    outcomes = tuple(GroundOutcome(p, OutcomeKind.CHANGE, ((0, i + 1),)) for i, p in enumerate(probabilities))
    rule = replace(task.rules[0], action=0, condition=((0, frozenset({0})),), outcomes=outcomes)
    return replace(
        task,
        variables=(replace(task.variables[0], values=values),),
        initial=(0,),
        actions=task.actions[:1],
        discounts=(1.0,),
        rules=(rule,),
        rewards=(),
        horizon=1,
        discount=1.0,
    )


@pytest.mark.parametrize("shares", ["1/3 1/3 1/3", "0.7 0.2 0.05 0.05", "0 1 0", "0.999 0 0.001", "0.5 0.5"])
def test_outcomes_come_as_often_as_declared(shares: str) -> None:
    probabilities = [Fraction(share) for share in shares.split()]
    task, runs = one_rule(*probabilities), 64 * WORDS
    counts = []
    for index in range(len(probabilities)):
        reward = replace(small_tasks.decrease((0, frozenset({index + 1}))), decrease=Fraction(-1))
        share = annealing.value(prepare(replace(task, rewards=(reward,))), [0], WORDS, 5)
        counts.append(round(share * runs))
    assert sum(counts) == runs
    assert all(n == 0 for n, p in zip(counts, probabilities, strict=True) if p == 0)
    drawn = [(n, float(p) * runs) for n, p in zip(counts, probabilities, strict=True) if p > 0]
    if len(drawn) > 1:
        assert stats.chisquare(*zip(*drawn, strict=True)).pvalue > 1e-4


def test_uses_of_an_action_have_luck_of_their_own() -> None:
    task = from_text.task(small_tasks.SECTION_4, "objects { a - area } init { dirt(a) } horizon = 3")
    again = annealing.value(prepare(task), [0, 0, 0], WORDS, 1)
    assert again == pytest.approx(exact_value(task, [0, 0, 0]), abs=0.01)


def best_of_all(task: Task) -> tuple[float, Sequence[int]]:
    lengths = range(task.horizon + 1)
    every = itertools.chain.from_iterable(
        itertools.product(range(len(task.actions)), repeat=length) for length in lengths
    )
    return max((exact_value(task, actions), actions) for actions in every)


@pytest.mark.parametrize("seed", range(6))
def test_few_states_are_solved(seed: int) -> None:
    task = small_tasks.weighted_task(seed)
    plan = prada_plus(prepare(task), Options(), PradaPlusOptions())
    assert (plan.measure, plan.samples) == ("policy", 0)
    assert plan.value == pytest.approx(optimum(task)(task.initial, task.horizon)[0], abs=1e-9)
    assert plan.value >= search(task, Options(4000, seed)).value - 0.02 * abs(plan.value)


@pytest.mark.parametrize("seed", range(6))
def test_nearly_the_best_of_all_sequences_is_found(seed: int) -> None:
    task = replace(small_tasks.weighted_task(seed), horizon=3)
    best, _ = best_of_all(task)
    nothing = exact_value(task, [])
    found = exact_value(task, indices(task, search(task, Options(2000, seed))))
    assert found - nothing >= 0.98 * (best - nothing) - 0.05


def test_it_joins_where_the_factored_belief_of_libprada_does_not() -> None:
    text = small_tasks.TWO_SCATTERED + " horizon = 2 discount = 1"
    plan = search(from_text.task(small_tasks.SECTION_4, text), Options(500, 1))
    assert plan.actions[0].name == "join"
    assert plan.value == pytest.approx(1.06, abs=0.04)


COURIER = """
domain d {
  types      { street }
  constants  { north east south - street }
  predicates { wet(?s - street) delivered() lame() }
  actions    { shelter() cross() detour() }
  rule sun: shelter() {
    when wet(north)
    then 0.5: not wet(north), not wet(east), not wet(south)
         rest: nothing
  }
  rule dry: cross() { when not delivered(), forall ?s - street: not wet(?s) then 1: delivered() }
  rule long: detour() { when not delivered(), not lame() then 0.3: delivered(), lame() rest: lame() }
  reward { goal }
}
"""


@pytest.mark.parametrize("seed", range(6))
def test_a_gain_is_reached_by_way_of_equals(seed: int) -> None:
    """From a detour to shelter and crossing it is one change that gains nothing, and one more."""
    wet = "objects { } init { wet(north), wet(east), wet(south) }"
    plan = search(
        from_text.task(COURIER, f"{wet} goal {{ delivered() }} horizon = 2 discount = 1"),
        Options(1000, seed),
    )
    assert [str(action) for action in plan.actions] == ["shelter()", "cross()"]


@pytest.mark.parametrize("seed", range(4))
def test_it_is_no_worse_than_prada_with_as_many_sequences(seed: int) -> None:
    task = replace(small_tasks.weighted_task(seed), horizon=8)
    ours, theirs = (
        search(task, Options(2000, seed)),
        prada(prepare(task), Options(2000, seed), PradaOptions()),
    )
    value, other = (exact_value(task, indices(task, plan)) for plan in (ours, theirs))
    assert value >= other - 0.03 * abs(other)


def test_the_value_is_the_plans() -> None:
    for seed in range(5):
        task = small_tasks.weighted_task(seed)
        plan = search(task, Options(500, seed))
        assert plan.value == pytest.approx(exact_value(task, indices(task, plan)), abs=0.02 * spread(task))


def test_the_number_of_threads_changes_nothing() -> None:
    task = small_tasks.weighted_task(3)
    plans = [search(task, Options(1000, 5, threads=threads)) for threads in (1, 2, 3)]
    assert len({(plan.actions, plan.value) for plan in plans}) == 1


def test_the_last_plan_is_a_start() -> None:
    """A chain of one try can only come back with what it was given."""
    task = small_tasks.weighted_task(1)
    good = search(task, Options(4000, 1))
    again = search(task, Options(4, 2, previous=good.actions))
    assert exact_value(task, indices(task, again)) >= exact_value(task, indices(task, good)) - 0.02


def test_a_time_limit_is_kept() -> None:
    task = replace(small_tasks.weighted_task(2), horizon=8)
    search(task, Options(10))
    plan = search(task, Options(10**7, 1, time_limit=0.2))
    assert 0.19 < plan.seconds["search"] < 1.0
    assert plan.samples > 4000


def test_seeds_may_be_large() -> None:
    task = small_tasks.weighted_task(3)
    assert search(task, Options(100, 2**64 - 1)).actions == search(task, Options(100, 2**64 - 1)).actions


@pytest.mark.parametrize("problem", ["objects { a - area } init { }", "objects { } init { }"])
def test_nothing_to_do_gives_an_empty_plan(problem: str) -> None:
    plan = search(from_text.task(small_tasks.SECTION_4, problem), Options(100))
    assert (plan.actions, plan.value) == ((), 0.0)


def test_no_time_gives_an_empty_plan() -> None:
    assert search(replace(small_tasks.random_task(0), horizon=0), Options(100)).actions == ()
