"""The planner: its inference against the plain reference, the paper's example, and its promises."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numba import njit
from scipy import stats

from cleancli.compiler.ground import ground
from cleancli.compiler.lowering.belief_tables import Tables, lower
from cleancli.compiler.semantics import exact_value, forward, idle_worth
from cleancli.compiler.task import (
    GroundAction,
    GroundOutcome,
    GroundRule,
    RewardCondition,
    StateVariable,
    Task,
)
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Fact, Object, OutcomeKind, Problem
from cleancli.planning.compiled_task import prepare
from cleancli.planning.evaluation.belief_value import plan_value, worth_of
from cleancli.planning.evaluation.coverage import coverage, enough_samples
from cleancli.planning.kernels import belief as kernel
from cleancli.planning.kernels import belief_search
from cleancli.planning.plan import Options, Plan
from cleancli.planning.registry import PLANNERS
from support import from_text, reference_prada, small_tasks
from support.planned import planned
from support.random_domains import Generator
from support.shipped import shipped_domain, shipped_problem

ROOT = Path(__file__).parent.parent.parent


def prada(task: Task, options: Options) -> Plan:
    return PLANNERS["prada"](prepare(task), options)


def names(plan: Plan) -> list[str]:
    return [str(action) for action in plan.actions]


@pytest.mark.parametrize("make", [small_tasks.random_task, small_tasks.weighted_task])
@pytest.mark.parametrize("compat", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_inference_agrees_with_the_reference(seed: int, compat: bool, make: Callable[[int], Task]) -> None:
    task = make(seed)
    rng = np.random.default_rng(seed)
    for length in (0, 1, 2, 5, 12):
        actions = rng.integers(len(task.actions), size=length).tolist()
        for threshold in (0.0, 0.03, 0.2):
            value = plan_value(task, actions, rule_threshold=threshold, compat=compat)
            expected = reference_prada.value(task, actions, independent_rules=compat, threshold=threshold)
            assert value == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_rules_may_overlap_where_they_are_independent(seed: int) -> None:
    task = overlapping(seed)
    rng = np.random.default_rng(seed)
    for length in (1, 4, 9):
        actions = rng.integers(len(task.actions), size=length).tolist()
        expected = reference_prada.value(task, actions, independent_rules=True)
        assert plan_value(task, actions, compat=True) == pytest.approx(expected, abs=1e-9)


def overlapping(seed: int) -> Task:
    """A task in which many rules have lost a literal, and so exclude each other no more."""
    task = small_tasks.weighted_task(seed)
    rng = np.random.default_rng([seed, 2])
    return replace(
        task,
        rules=tuple(replace(r, condition=r.condition[int(rng.integers(2)) :]) for r in task.rules),
    )


@pytest.mark.parametrize("seed", range(10))
def test_a_belief_about_one_variable_is_exact(seed: int) -> None:
    """A rule that asks for a variable is taken to know it, so with one variable nothing is approximate."""
    rng = np.random.default_rng(seed)
    task = replace(small_tasks.random_task(seed), variables=(StateVariable("v", (), tuple("abcd")),))
    rules = []
    for action in range(len(task.actions)):
        first, last = sorted(rng.choice(5, size=2, replace=False).tolist())
        values = rng.permutation(4).tolist()
        for allowed in (values[:first], values[first:last], values[last:]):
            if allowed:
                rules.append(GroundRule(0, action, ((0, frozenset(allowed)),), _thirds(rng)))
    task = replace(
        task,
        initial=(int(rng.integers(4)),),
        rules=tuple(rules),
        rewards=tuple(
            replace(small_tasks.decrease((0, frozenset({x}))), state=Fraction(x)) for x in range(4)
        ),
    )
    for length in (1, 3, 8):
        actions = rng.integers(len(task.actions), size=length).tolist()
        exact = exact_value(task, actions)
        assert plan_value(task, actions, rule_threshold=0.0) == pytest.approx(exact, abs=1e-9)


def _thirds(rng: np.random.Generator) -> tuple[GroundOutcome, ...]:
    third, (x, y) = Fraction(1, 3), rng.integers(4, size=2).tolist()
    return (
        GroundOutcome(third, OutcomeKind.CHANGE, ((0, x),)),
        GroundOutcome(third, OutcomeKind.CHANGE, ((0, y),)),
        GroundOutcome(third, OutcomeKind.NOISE, ()),
    )


def test_slots_and_sums_of_an_action_or_a_rule_ascend() -> None:
    """Also of tasks with more variables than the smallest sets keep in order."""
    ascending = 0
    for seed in range(20):
        generator = Generator(seed)
        tables = lower(ground(generator.domain(), generator.problem()))
        for starts, entries in (
            (tables.guard_start, tables.guard),
            (tables.shift_start, tables.shift_slot),
            (tables.loss_start, tables.loss_slot),
            (tables.touched_slot_start, tables.touched_slot),
            (tables.touched_sum_start, tables.touched_sum),
            (tables.touched_reward_start, tables.touched_reward),
        ):
            parts = [entries[first:last].tolist() for first, last in pairwise(starts)]
            assert parts == [sorted(set(part)) for part in parts]
            ascending += sum(len(part) > 1 and part[-1] > 8 for part in parts)
    assert ascending > 100


@pytest.mark.parametrize("compat", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_a_belief_stays_one(seed: int, compat: bool) -> None:
    """Probabilities stay probabilities, and no step pays more than the bound for giving up says."""
    task = overlapping(seed) if compat else small_tasks.weighted_task(seed)
    tables = lower(task, independent=compat)
    belief = belief_search.new_belief(tables, 0.0)
    kernel.initialise(tables, np.asarray(task.initial, dtype=np.int32), belief)
    for action in np.random.default_rng(seed).integers(len(task.actions), size=200).tolist():
        paid, _ = kernel.advance(tables, belief, action)
        assert paid <= tables.most[action] + 1e-12
        assert belief.number.min() >= 0
        assert (belief.weight <= 1 + 1e-12).all()
        slots = belief.number[: tables.slot_start[-1]]
        assert np.add.reduceat(slots, tables.slot_start[:-1]) == pytest.approx(1.0, abs=1e-9)


@njit
def choices(t: Tables, belief: kernel.Belief, counts: np.ndarray, number: int) -> None:
    stream = np.uint64(1)
    for _ in range(number):
        action, stream = kernel.choose(t, belief, stream)
        counts[action] += 1


@pytest.mark.parametrize("likely", [0.9, 0.03])
def test_actions_are_drawn_in_proportion_to_their_weights(likely: float) -> None:
    """Also where all weights are so small that proposals fail, and all are weighed."""
    task = held(reward=1, cost=0.0, horizon=3)
    rule, number, draws = task.rules[0], 7, 20_000
    task = replace(
        task,
        variables=task.variables * number,
        initial=(0,) * number,
        actions=task.actions * number,
        rules=tuple(replace(rule, action=a, condition=((a, frozenset({0})),)) for a in range(number)),
        discounts=task.discounts * number,
    )
    tables = lower(task)
    belief = belief_search.new_belief(tables, 0.0)
    kernel.initialise(tables, np.zeros(number, dtype=np.int32), belief)
    weights = likely * np.linspace(0.0, 1.0, number)
    belief.number[tables.guard] = weights
    counts = np.zeros(number, dtype=np.int64)
    choices(tables, belief, counts, draws)
    assert counts[0] == 0
    expected = draws * weights[1:] / weights.sum()
    assert stats.chisquare(counts[1:], expected).pvalue > 1e-4


@pytest.mark.parametrize("compat", [False, True])
@pytest.mark.parametrize("seed", range(8))
def test_giving_up_samples_loses_no_plan(seed: int, compat: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    task = overlapping(seed) if compat else small_tasks.weighted_task(seed)
    options = Options(300, seed, compat=compat)
    plan = prada(task, options)
    monkeypatch.setattr(belief_search, "ceiling", lambda tables, discount, steps: np.full(steps + 1, np.inf))
    assert replace(prada(task, options), seconds=plan.seconds) == plan


@pytest.mark.parametrize("seed", range(4))
def test_threads_change_nothing(seed: int) -> None:
    task = replace(small_tasks.weighted_task(seed), counted=None)
    plans = [prada(task, Options(2500, seed, threads=threads)) for threads in (1, 2, 3)]
    assert plans[0].samples == 2500
    assert all(replace(plan, seconds=plans[0].seconds) == plans[0] for plan in plans)


def test_a_time_limit_ends_the_sampling() -> None:
    task = replace(small_tasks.random_task(3), horizon=40)
    plan = prada(task, Options(10**9, 0, time_limit=0.02))
    assert 0 < plan.samples < 10**9
    again = prada(task, Options(plan.samples, 0, time_limit=1000.0))
    assert replace(again, seconds=plan.seconds) == plan


@pytest.mark.parametrize("seed", range(25))
def test_one_step_from_a_known_state_is_exact(seed: int) -> None:
    task = small_tasks.weighted_task(seed)
    task = replace(task, rewards=task.rewards[:4])  # of one variable each, which a belief knows exactly
    for action in range(len(task.actions)):
        assert plan_value(task, [action]) == pytest.approx(exact_value(task, [action]), abs=1e-12)


def section_4(discount: float = 1.0) -> Task:
    return from_text.task(
        small_tasks.SECTION_4, small_tasks.TWO_SCATTERED + f" horizon = 2 discount = {discount}"
    )


def test_the_papers_example_is_valued_exactly() -> None:
    task = section_4(0.95)
    clean_a, clean_b, join = (small_tasks.action(task, a) for a in ("clean(a)", "clean(b)", "join(a, b)"))

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
    join = [small_tasks.action(task, "join(a, b)"), small_tasks.action(task, "clean(b)")]
    assert reference_prada.value(task, join) == pytest.approx(1.06)
    assert reference_prada.value(task, join, independent_rules=True) == pytest.approx(0.852)
    plan = prada(task, Options(1000, 0, compat=True))
    assert sorted(names(plan)) == ["clean(a)", "clean(b)"]
    assert plan.value == pytest.approx(1.0)


def test_the_reference_reproduces_the_authors_implementation() -> None:
    """A plan that libPRADA values at 1.4024: two areas, one of them on the other's way to the container."""
    domain = load_domain(read_source(ROOT / "benchmarks" / "planning.nid"))
    facts = {Fact("dirt", ("a",)), Fact("dirt", ("b",)), Fact("size", ("a",), "medium")}
    facts |= {Fact("size", ("b",), "medium"), Fact("scattered", ("b",)), Fact("aligned", ("b",))}
    facts |= {Fact("near", ("a", "b")), Fact("traversal", ("b", "bin", "a"))}
    objects = (Object("a", "area"), Object("b", "area"))
    task = ground(domain, Problem("two", "benchmark", objects, frozenset(facts)))
    steps = ("pushStraightAlong(b, a)", "pushStraight(a)", "pushStraight(a)")
    push = [small_tasks.action(task, step) for step in steps]
    assert reference_prada.value(task, push, independent_rules=True) == pytest.approx(1.4024, abs=5e-5)
    assert plan_value(task, push, compat=True) == pytest.approx(1.4024, abs=5e-5)


def test_samples_are_a_prefix_of_more_samples() -> None:
    task = section_4(0.95)
    task = replace(task, horizon=4)
    values = [prada(task, Options(samples, 7)).value for samples in (1, 5, 30, 200, 2000)]
    assert values == sorted(values)
    assert values[0] < values[-1]


def test_the_reported_value_is_the_plans() -> None:
    for seed in range(5):
        task = small_tasks.random_task(seed)
        plan = prada(task, Options(500, seed))
        actions = [task.actions.index(action) for action in plan.actions]
        assert plan.value == pytest.approx(plan_value(task, actions), abs=1e-12)


@pytest.mark.parametrize("independent", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_the_search_values_its_best_as_any_sequence_is_valued(seed: int, independent: bool) -> None:
    """Its value, and its earliness, by which equals are told apart: the search adds them up as it draws."""
    task = small_tasks.weighted_task(seed) if seed % 2 else small_tasks.random_task(seed)
    tables, horizon = lower(task, independent=independent), task.horizon
    value, early, found = belief_search._best_of(
        tables,
        np.array(task.initial, dtype=np.int32),
        0.0,
        np.uint64(seed),
        idle_worth(task.discount, horizon),
        belief_search.ceiling(tables, task.discount, horizon),
        (0, 400, -np.inf, -np.inf),
    )
    (worth,), (earliness,) = worth_of(task, tables, 0.0, [found])
    assert (value, early) == pytest.approx((worth, earliness), abs=1e-9)


def test_same_seed_same_plan_in_another_process() -> None:
    script = (
        "from support import small_tasks; from support.planned import planned;"
        "p = planned('prada', small_tasks.random_task(5), samples=300, seed=11);"
        "print([str(a) for a in p.actions], p.value)"
    )
    run = [sys.executable, "-c", script]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
    outputs = {
        subprocess.run(run, capture_output=True, text=True, check=True, env=environment).stdout
        for _ in range(2)
    }
    here = prada(small_tasks.random_task(5), Options(300, 11))
    assert outputs == {f"{names(here)} {here.value}\n"}


def test_a_seeded_plan_stays_as_it_is() -> None:
    plan = prada(small_tasks.random_task(5), Options(300, 11))
    assert (names(plan), round(plan.value, 9)) == (
        ["act5()", "act5()", "act0()", "act2()", "act2()"],
        0.384488144,
    )


def test_a_plan_for_the_shipped_problem() -> None:
    domain = shipped_domain("cleaning")
    task = ground(domain, shipped_problem("three_areas", domain))
    plan = prada(task, Options(2000, 1))
    assert plan.horizon == 4
    assert 1 <= len(plan.actions) <= 4
    assert set(plan.seconds) == {"lower", "compile", "search"}
    assert plan == replace(prada(task, Options(2000, 1)), seconds=plan.seconds)


@pytest.mark.parametrize("planner", ["aprada", "prada"])
@pytest.mark.parametrize(
    "problem",
    [
        "objects { a - area } init { }",
        "objects { } init { }",
        "objects { a - area } init { scattered(a) } goal { not dirt(a) }",
    ],
)
def test_nothing_to_do_gives_an_empty_plan(problem: str, planner: str) -> None:
    task = from_text.task(small_tasks.SECTION_4, problem)
    plan = PLANNERS[planner](prepare(task), Options(100, 0))
    assert (plan.actions, plan.value) == ((), 0.0)


@pytest.mark.parametrize("planner", ["aprada", "prada"])
def test_no_action_applies(planner: str) -> None:
    task = replace(held(reward=1, cost=0.0, horizon=3), initial=(1,))
    plan = PLANNERS[planner](prepare(task), Options(100, 0))
    assert plan.actions == ()
    assert plan.value == pytest.approx(exact_value(task, []))


@pytest.mark.parametrize("planner", ["aprada", "prada"])
@pytest.mark.parametrize(("sure", "value"), [(0, 0.0), (1, 1.0)])
def test_sure_and_impossible_outcomes(planner: str, sure: int, value: float) -> None:
    task = held(reward=0, cost=0.0, horizon=2)
    change, nothing = task.rules[0].outcomes
    outcomes = (replace(change, probability=Fraction(sure)), replace(nothing, probability=Fraction(1 - sure)))
    rewards = (RewardCondition(((0, frozenset({0})),), Fraction(1), Fraction(0)),)
    rules = (replace(task.rules[0], outcomes=outcomes),)
    task = replace(task, rules=rules, rewards=rewards, constant_reward=Fraction(0))
    for threshold in (0.0, 0.03, 1.0):
        plan = PLANNERS[planner](prepare(task), Options(100, 0, rule_threshold=threshold))
        assert (len(plan.actions), plan.value) == (sure, value)


def test_sixty_areas_within_the_time_limit() -> None:
    names = [f"a{index:02d}" for index in range(60)]
    facts = ", ".join(f"dirt({name})" for name in names)
    task = from_text.task(SIXTY, f"objects {{ {' '.join(names)} - area }} init {{ {facts} }}")
    prepared = prepare(task)
    prada(task, Options(1))
    for planner in ("prada", "aprada"):
        plan = PLANNERS[planner](prepared, Options(10**6, 0, time_limit=0.1))
        assert 0 < plan.samples < 10**6
        assert len(plan.actions) > 30
        assert plan.seconds["search"] < 2.0


SIXTY = small_tasks.SECTION_4.replace("join(?a ?b - area) }", "}").replace(
    small_tasks.SECTION_4[
        small_tasks.SECTION_4.index("  rule join") : small_tasks.SECTION_4.index("  default")
    ],
    "",
)


def test_no_time_gives_an_empty_plan() -> None:
    assert prada(replace(small_tasks.random_task(0), horizon=0), Options(100, 0)).actions == ()


def test_one_area_is_cleaned_twice_since_it_may_fail() -> None:
    problem = "objects { a - area } init { dirt(a) }"
    plan = prada(from_text.task(small_tasks.SECTION_4, problem), Options(100, 0))
    assert names(plan) == ["clean(a)", "clean(a)"]
    assert plan.value == pytest.approx(0.8 + 0.95 * 0.16)
    assert exact_value(from_text.task(small_tasks.SECTION_4, problem), [0, 0]) == pytest.approx(
        0.8 + 0.95 * 0.16
    )


def test_useless_last_steps_and_worthless_plans_are_dropped() -> None:
    sure = small_tasks.SECTION_4.replace("0.8: not dirt(?a) rest: nothing", "1: not dirt(?a)")
    plan = prada(from_text.task(sure, "objects { a - area } init { dirt(a) } horizon = 5"), Options(100, 0))
    assert (names(plan), plan.value) == (["clean(a)"], 1.0)
    poor = small_tasks.SECTION_4.replace("0.8:", "0.04:")
    problem = "objects { a - area } init { dirt(a) } horizon = 1"
    assert prada(from_text.task(poor, problem), Options(100, 0)).actions == ()


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
        step=None,
        untimed=("do",),
        waiting=True,
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
    assert len(plan.actions) == best
    assert plan.value == pytest.approx(values[best])


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


@pytest.mark.parametrize(("margin", "length"), [(0.04, 1), (0.05, 0), (0.06, 0), (0.0, 1)])
def test_a_plan_is_worth_more_than_stopping_by_more_than_the_margin(margin: float, length: int) -> None:
    domain = """
      domain d {
        types { area } predicates { dirt(?a - area) } derived { n := count ?a - area: dirt(?a) }
        actions { go(?a - area) } rule g: go(?a) { when dirt(?a) then 1: not dirt(?a) }
        reward { 0.05 * decrease(n) }
      }"""
    problem = "objects { a1 - area } init { dirt(a1) } horizon = 1 discount = 1"
    found = planned("prada", from_text.task(domain, problem), samples=100, margin=margin)
    assert len(found.actions) == length
