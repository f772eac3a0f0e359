"""What planners choose, between which candidates, and where a limit lies (docs/planning.md, planners.md)."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import pytest

from cleancli.compiler.semantics import exact_value
from cleancli.compiler.task import GroundAction, GroundOutcome, GroundRule, Task
from cleancli.language.model import OutcomeKind
from cleancli.planning.compiled_task import prepare
from cleancli.planning.evaluation.forecast import ForecastStep, forecast
from cleancli.planning.plan import Plan
from cleancli.planning.registry import PLANNERS
from support import from_text, small_tasks
from support.planned import planned

EIGHT = "objects { a b c d e f g h - area } init { %s } horizon = 8" % ", ".join(  # noqa: UP031
    f"{symbol}({name})" for name in "abcdefgh" for symbol in ("dirt", "scattered")
)


def true_value(task: Task, plan: Plan) -> float:
    return exact_value(task, [task.actions.index(action) for action in plan.actions])


# ---- prada+


@pytest.mark.parametrize(("asked", "tried"), [(400, 400), (1, 4), (401, 404)])
def test_four_chains_try_a_quarter_each(asked: int, tried: int) -> None:
    assert planned("prada+", small_tasks.weighted_task(1), samples=asked, solve=0, runs=0).samples == tried


def test_annealing_finds_what_as_many_draws_do_not() -> None:
    task = replace(from_text.task(small_tasks.SECTION_4, EIGHT), discount=0.95)
    drawn = planned("prada", task, samples=400, seed=1)
    annealed = planned("prada+", task, samples=400, seed=1, solve=0, runs=0)
    assert annealed.value > drawn.value + 0.05
    assert annealed.value > planned("prada+", task, samples=4, seed=1, solve=0, runs=0).value + 0.05


def test_the_best_of_the_chains_is_chosen() -> None:
    """Of four chains of one try two begin at the last plan, the others at the best of a single draw."""
    task = from_text.task(small_tasks.SECTION_4, EIGHT)
    good = planned("prada+", task, samples=4000, seed=1, solve=0, runs=0)
    for seed in range(4):
        poor = planned("prada+", task, samples=4, seed=seed, solve=0, runs=0)
        kept = planned("prada+", task, samples=4, seed=seed, solve=0, runs=0, previous=good.actions)
        assert kept.value > good.value - 0.1
        assert kept.value > poor.value


def test_actions_that_are_gone_are_left_out_of_the_last_plan() -> None:
    task = from_text.task(small_tasks.SECTION_4, small_tasks.TWO_SCATTERED)
    gone = (GroundAction("clean", ("z",), None), GroundAction("polish", (), None))
    last = (gone[0], *task.actions[:1], gone[1])
    assert planned("prada+", task, samples=40, solve=0, runs=0, previous=last).actions
    assert planned("prada+", task, samples=40, previous=last).actions


# ---- prada


def one_wipe(probability: str) -> Task:
    text = small_tasks.SECTION_4.replace("0.8: not dirt(?a)", f"{probability}: not dirt(?a)")
    return from_text.task(text, "objects { a - area } init { dirt(a) } horizon = 1")


@pytest.mark.parametrize("planner", ["prada", "aprada"])
@pytest.mark.parametrize(("probability", "margin", "long"), [
    ("0.04", 0.05, 0), ("0.06", 0.05, 1), ("0.26", 0.25, 1), ("0.01", 0.0, 1),
])  # fmt: skip
def test_a_plan_is_worth_more_than_the_margin(
    planner: str, probability: str, margin: float, long: int
) -> None:
    plan = planned(planner, one_wipe(probability), margin=margin, rule_threshold=0.0)
    assert len(plan.actions) == long
    assert plan.value == pytest.approx(float(Fraction(probability)) if long else 0.0)


def test_a_time_limit_ends_the_draws() -> None:
    task = from_text.task(small_tasks.SECTION_4, EIGHT)
    planned("prada", task, samples=10)
    plan = planned("prada", task, samples=10**8, time_limit=0.1)
    assert 0 < plan.samples < 10**8
    assert plan.seconds["search"] < 5
    assert planned("prada", task, samples=3000).samples == 3000


# ---- discount 0


@pytest.mark.parametrize("planner", ["prada", "prada+", "exact", "uct"])
def test_with_discount_0_the_next_step_alone_counts(planner: str) -> None:
    task = from_text.task(
        small_tasks.SECTION_4, "objects { a b - area } init { dirt(a), dirt(b) } discount = 0"
    )
    plan = planned(planner, task, samples=200)
    assert plan.actions[0].name == "clean"
    assert plan.value == pytest.approx(0.8, abs=0.1)
    assert true_value(task, plan) == pytest.approx(0.8)


@pytest.mark.parametrize("planner", sorted(PLANNERS))
@pytest.mark.parametrize("horizon", [0, -2])
def test_where_no_step_is_left_nothing_is_planned(planner: str, horizon: int) -> None:
    """A horizon that counts areas may have come to nothing, or below."""
    task = replace(from_text.task(small_tasks.SECTION_4, small_tasks.TWO_SCATTERED), horizon=horizon)
    plan = planned(planner, task, samples=50)
    assert (plan.actions, plan.value) == ((), 0)


# ---- what is expected of a step


def two_ways() -> Task:
    """An action with three rules: two have an outcome in common, one an outcome that is impossible."""
    task = small_tasks.random_task(0)

    def rule(index: int, value: int, *outcomes: tuple[str, tuple[tuple[int, int], ...]]) -> GroundRule:
        found = [GroundOutcome(Fraction(p), OutcomeKind.CHANGE, effects) for p, effects in outcomes]
        return GroundRule(index, 1, ((0, frozenset({value})),), tuple(found))

    return replace(
        task,
        variables=tuple(replace(v, values=("a", "b", "c")) for v in task.variables[:2]),
        initial=(0, 0),
        actions=task.actions[:2],
        discounts=task.discounts[:2],
        rewards=(),
        counted=None,
        rules=(
            GroundRule(0, 0, (), tuple(
                GroundOutcome(Fraction(1, 4 if value else 2), OutcomeKind.CHANGE, ((0, value),))
                for value in range(3)
            )),
            rule(4, 0, ("0.5", ((1, 1),)), ("0.5", ((1, 2),))),
            rule(7, 2, ("0.2", ((1, 0),)), ("0.8", ((1, 1),)), ("0", ((1, 2),))),
            rule(3, 1, ("0.5", ((1, 1),)), ("0.5", ((1, 2),))),
        ),
    )  # fmt: skip


def second(make: Callable[[], Task]) -> ForecastStep:
    return forecast(prepare(make()), [0, 1], 1).steps[1]


def test_rules_and_results_come_likeliest_first_and_of_equals_the_first() -> None:
    step = second(two_ways)
    assert step.rules == ((4, 0.5), (3, 0.25), (7, 0.25))
    assert [result.effects for result in step.results] == [((1, 1),), ((1, 2),), ((1, 0),)]
    chances = [result.probability for result in step.results]
    assert chances == pytest.approx([0.25 + 0.125 + 0.2, 0.25 + 0.125, 0.05])
    assert step.covered == pytest.approx(1)


@pytest.mark.parametrize("weights", sorted(set(itertools.permutations((1, 3, 3, 3, 3)))))
def test_what_is_certain_has_the_probability_1_whatever_is_rounded(weights: tuple[int, ...]) -> None:
    task = two_ways()
    outcomes = tuple(
        GroundOutcome(Fraction(n, 13), OutcomeKind.CHANGE, ((1, i % 3), (0, i // 3)))
        for i, n in enumerate(weights)
    )
    always = tuple(GroundRule(i, i, (), outcomes) for i in range(2))
    for step in forecast(prepare(replace(task, rules=always)), [0, 1], 1).steps:
        assert 1 - 1e-12 < step.covered <= 1


def test_what_is_impossible_is_no_result() -> None:
    task = two_ways()
    moved = replace(task, initial=(2, 0), rules=task.rules[1:])
    (step,) = forecast(prepare(moved), [1], 1).steps
    assert [result.effects for result in step.results] == [((1, 1),), ((1, 0),)]
    uncovered = replace(moved, rules=task.rules[1:2])
    (step,) = forecast(prepare(uncovered), [1], 1).steps
    assert (step.covered, step.rules, step.results) == (0, (), ())
