"""The planner: its inference against the plain reference, the paper's example, and its promises."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import domains
import numpy as np
import pytest
import reference

from cleancli.compiler.ground import ground
from cleancli.compiler.task import (
    GroundAction,
    GroundOutcome,
    GroundRule,
    RewardCondition,
    StateVariable,
    Task,
)
from cleancli.compiler.transition import exact_value, forward
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Fact, Object, OutcomeKind, Problem
from cleancli.planning.coverage import coverage, enough_samples
from cleancli.planning.plan import Options, Plan
from cleancli.planning.prada import plan_value
from cleancli.planning.prepared import prepare
from cleancli.planning.table import PLANNERS

ROOT = Path(__file__).parent.parent.parent


def prada(task: Task, options: Options) -> Plan:
    return PLANNERS["prada"](prepare(task), options)


def names(plan: Plan) -> list[str]:
    return [str(action) for action in plan.actions]


@pytest.mark.parametrize("make", [domains.random_task, domains.weighted_task])
@pytest.mark.parametrize("seed", range(25))
def test_inference_agrees_with_the_reference(seed: int, make: Callable[[int], Task]) -> None:
    task = make(seed)
    rng = np.random.default_rng(seed)
    for length in (0, 1, 2, 5, 12):
        actions = rng.integers(len(task.actions), size=length).tolist()
        assert plan_value(task, actions) == pytest.approx(reference.value(task, actions), abs=1e-9)


@pytest.mark.parametrize("seed", range(25))
def test_one_step_from_a_known_state_is_exact(seed: int) -> None:
    task = domains.weighted_task(seed)
    task = replace(task, rewards=task.rewards[:4])  # of one variable each, which a belief knows exactly
    for action in range(len(task.actions)):
        assert plan_value(task, [action]) == pytest.approx(exact_value(task, [action]), abs=1e-12)


def section_4(discount: float = 1.0) -> Task:
    return domains.task(domains.SECTION_4, domains.TWO_SCATTERED + f" horizon = 2 discount = {discount}")


def test_the_papers_example_is_valued_exactly() -> None:
    task = section_4(0.95)
    clean_a, clean_b, join = (domains.action(task, a) for a in ("clean(a)", "clean(b)", "join(a, b)"))

    def both_cleaned(*actions: int) -> float:
        distribution = {task.initial: 1.0}
        for action in actions:
            distribution = forward(task, distribution, action)
        return sum(mass for s, mass in distribution.items() if s[0] == s[1] == 0)

    assert [v.symbol for v in task.variables[:2]] == ["dirt", "dirt"]
    assert both_cleaned(join, clean_b) == pytest.approx(0.31)
    assert both_cleaned(clean_a, clean_b) == pytest.approx(0.25)
    assert exact_value(section_4(), [join, clean_b]) == pytest.approx(1.06)
    assert exact_value(section_4(), [clean_a, clean_b]) == pytest.approx(1.0)


def test_the_papers_example_is_planned_as_the_paper_says() -> None:
    task = section_4()
    plan = prada(task, Options(1000, 0))
    assert plan.actions[0].name == "join"
    assert plan.value == pytest.approx(1.06)


def test_rules_taken_as_independent_miss_the_papers_example() -> None:
    task = section_4()
    join = [domains.action(task, "join(a, b)"), domains.action(task, "clean(b)")]
    assert reference.value(task, join) == pytest.approx(1.06)
    assert reference.value(task, join, independent_rules=True) == pytest.approx(0.852)


def test_the_reference_reproduces_the_authors_implementation() -> None:
    """A plan that libPRADA values at 1.4024: two areas, one of them on the other's way to the container."""
    domain = load_domain(read_source(ROOT / "benchmarks" / "planning.nid"))
    facts = {Fact("dirt", ("a",)), Fact("dirt", ("b",)), Fact("size", ("a",), "medium")}
    facts |= {Fact("size", ("b",), "medium"), Fact("scattered", ("b",)), Fact("aligned", ("b",))}
    facts |= {Fact("near", ("a", "b")), Fact("traversal", ("b", "bin", "a"))}
    objects = (Object("a", "area"), Object("b", "area"))
    task = ground(domain, Problem("two", "benchmark", objects, frozenset(facts)))
    steps = ("pushStraightAlong(b, a)", "pushStraight(a)", "pushStraight(a)")
    push = [domains.action(task, step) for step in steps]
    assert reference.value(task, push, independent_rules=True) == pytest.approx(1.4024, abs=5e-5)


def test_samples_are_a_prefix_of_more_samples() -> None:
    task = section_4(0.95)
    task = replace(task, horizon=4)
    values = [prada(task, Options(samples, 7)).value for samples in (1, 5, 30, 200, 2000)]
    assert values == sorted(values)
    assert values[0] < values[-1]


def test_the_reported_value_is_the_plans() -> None:
    for seed in range(5):
        task = domains.random_task(seed)
        plan = prada(task, Options(500, seed))
        actions = [task.actions.index(action) for action in plan.actions]
        assert plan.value == pytest.approx(plan_value(task, actions), abs=1e-12)


def test_same_seed_same_plan_in_another_process() -> None:
    script = (
        "import domains; from cleancli.planning.prada import prada;"
        "from cleancli.planning.plan import Options;"
        "from cleancli.planning.prepared import prepare;"
        "p = prada(prepare(domains.random_task(5)), Options(300, 11));"
        "print([str(a) for a in p.actions], p.value)"
    )
    run = [sys.executable, "-c", script]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
    outputs = {
        subprocess.run(run, capture_output=True, text=True, check=True, env=environment).stdout
        for _ in range(2)
    }
    here = prada(domains.random_task(5), Options(300, 11))
    assert outputs == {f"{names(here)} {here.value}\n"}


def test_a_seeded_plan_stays_as_it_is() -> None:
    plan = prada(domains.random_task(5), Options(300, 11))
    assert (names(plan), round(plan.value, 9)) == (
        ["act4()", "act5()", "act5()", "act2()", "act1()"],
        0.39828351,
    )


def test_a_plan_for_the_shipped_problem() -> None:
    domain = load_domain(read_source(ROOT / "domains" / "cleaning.nid"))
    task = ground(domain, load_problem(read_source(ROOT / "problems" / "three_areas.nid"), domain))
    plan = prada(task, Options(2000, 1))
    assert 1 <= len(plan.actions) <= plan.horizon == 4
    assert set(plan.seconds) == {"lower", "compile", "search"}
    assert plan == replace(prada(task, Options(2000, 1)), seconds=plan.seconds)


@pytest.mark.parametrize(
    "problem",
    [
        "objects { a - area } init { }",
        "objects { } init { }",
    ],
)
def test_nothing_to_do_gives_an_empty_plan(problem: str) -> None:
    plan = prada(domains.task(domains.SECTION_4, problem), Options(100, 0))
    assert (plan.actions, plan.value) == ((), 0.0)


def test_no_time_gives_an_empty_plan() -> None:
    assert prada(replace(domains.random_task(0), horizon=0), Options(100, 0)).actions == ()


def test_one_area_is_cleaned_twice_since_it_may_fail() -> None:
    problem = "objects { a - area } init { dirt(a) }"
    plan = prada(domains.task(domains.SECTION_4, problem), Options(100, 0))
    assert names(plan) == ["clean(a)", "clean(a)"]
    # The belief takes it as independent of each other whether a rule applies and what a variable is.
    still_dirty = 0.8 * 0.2 + 0.2 * 0.2 * 0.2
    assert plan.value == pytest.approx(0.8 + 0.95 * (0.2 - still_dirty))
    assert exact_value(domains.task(domains.SECTION_4, problem), [0, 0]) == pytest.approx(0.8 + 0.95 * 0.16)


def test_useless_last_steps_and_worthless_plans_are_dropped() -> None:
    sure = domains.SECTION_4.replace("0.8: not dirt(?a) rest: nothing", "1: not dirt(?a)")
    plan = prada(domains.task(sure, "objects { a - area } init { dirt(a) } horizon = 5"), Options(100, 0))
    assert (names(plan), plan.value) == (["clean(a)"], 1.0)
    poor = domains.SECTION_4.replace("0.8:", "0.04:")
    problem = "objects { a - area } init { dirt(a) } horizon = 1"
    assert prada(domains.task(poor, problem), Options(100, 0)).actions == ()


def test_coverage_is_equation_3() -> None:
    task = section_4()
    pairs = 2 * len(task.actions)
    assert len(task.actions) == 4
    assert coverage(task, 16) == pytest.approx(16 / pairs**2)
    assert coverage(task, 10**6) == 1.0
    assert coverage(task, 0) == 0.0
    assert coverage(replace(task, horizon=5000), 10) == 0.0
    assert coverage(replace(task, horizon=0), 10) == 1.0
    assert coverage(replace(task, actions=(), rules=()), 10) == 1.0


def test_small_plan_spaces_get_fewer_samples() -> None:
    task = section_4()
    assert enough_samples(task, 10_000) == 10 * 8**2
    assert enough_samples(task, 100) == 100
    assert enough_samples(replace(task, horizon=5000), 10_000) == 10_000
    assert enough_samples(replace(task, actions=(), rules=()), 100) == 0


def test_action_indices_are_checked() -> None:
    with pytest.raises(AssertionError):
        plan_value(section_4(), [99])


def held(reward: float, cost: float, horizon: int, discount: float = 0.9) -> Task:
    """One action sets one variable with probability 1/2; `reward` is for each step after which it is set."""
    rule = GroundRule(
        0,
        0,
        ((0, frozenset({0})),),
        (
            GroundOutcome(Fraction(1, 2), OutcomeKind.CHANGE, ((0, 1),)),
            GroundOutcome(Fraction(1, 2), OutcomeKind.NOTHING, ()),
        ),
    )
    return Task(
        variables=(StateVariable("set", (), (False, True)),),
        initial=(0,),
        actions=(GroundAction("do", (), None, Fraction(cost)),),
        rules=(rule,),
        rewards=(RewardCondition(((0, frozenset({1})),), Fraction(0), Fraction(reward)),),
        constant_reward=Fraction(1, 4),
        goal=(),
        counted=None,
        lengthening=(),
        horizon=horizon,
        discount=discount,
        discounts=(discount,),
    )


def test_a_state_is_paid_for_up_to_the_horizon() -> None:
    task = held(reward=1, cost=0.1, horizon=3)
    nothing = 0.25 * (1 + 0.9 + 0.81)
    assert exact_value(task, []) == plan_value(task, []) == pytest.approx(nothing)
    once = nothing - 0.1 + 0.5 * (1 + 0.9 + 0.81)
    assert exact_value(task, [0]) == plan_value(task, [0]) == pytest.approx(once)
    late = exact_value(held(reward=1, cost=0.1, horizon=3), [0, 0, 0])
    assert late == pytest.approx(nothing - 0.1 * 2.71 + 0.5 + 0.9 * 0.75 + 0.81 * 0.875)


def test_a_plan_is_compared_with_doing_nothing() -> None:
    good = prada(held(reward=1, cost=0.1, horizon=3), Options(50, 0))
    assert good.actions
    assert good.value == pytest.approx(plan_value(held(1, 0.1, 3), [0] * len(good.actions)))
    for worse in (held(reward=1, cost=2.0, horizon=3), held(reward=-1, cost=0.0, horizon=3)):
        plan = prada(worse, Options(50, 0))
        assert plan.actions == ()
        assert plan.value == pytest.approx(exact_value(worse, []))


def test_a_sequence_is_kept_up_to_where_it_is_worth_most() -> None:
    task = held(reward=1, cost=0.6, horizon=6, discount=1.0)
    values = [plan_value(task, [0] * length) for length in range(7)]
    best = int(np.argmax(values))
    plan = prada(task, Options(200, 0))
    assert 0 < best < 6
    assert (len(plan.actions), plan.value) == (best, pytest.approx(values[best]))


def test_stopping_gains_nothing_over_an_action_that_does_nothing() -> None:
    task = held(reward=-1, cost=0.0, horizon=4)
    idle = replace(
        task, rules=(replace(task.rules[0], outcomes=(GroundOutcome(Fraction(1), OutcomeKind.NOISE, ()),)),)
    )
    for length in range(5):
        assert exact_value(idle, [0] * length) == pytest.approx(exact_value(idle, []))
        assert plan_value(idle, [0] * length) == pytest.approx(plan_value(idle, []))


def test_without_a_count_to_decrease_coverage_counts_actions() -> None:
    task = held(reward=1, cost=0.1, horizon=3)
    assert coverage(
        replace(task, actions=task.actions * 2, discounts=task.discounts * 2), 4
    ) == pytest.approx(4 / 2**3)
