"""Whether a task is solved or searched: what solving may cost, when it is given up, what is remembered."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cleancli.compiler.semantics import covering_rule, successors
from cleancli.compiler.task import GroundState, Task
from cleancli.planning.compiled_task import Prepared, prepare
from cleancli.planning.kernels import state_graph
from cleancli.planning.plan import Options
from cleancli.planning.planners import solving
from cleancli.planning.planners.solving import GivenUp, Limits, limits, projected, solution, within_reach
from cleancli.planning.registry import PLANNERS
from support import from_text, small_tasks
from support.optimal import optimum

AREAS = " ".join(f"a{i}" for i in range(8))
WIDE = f"objects {{ {AREAS} - area }} init {{ {', '.join(f'dirt({a})' for a in AREAS.split())} }} horizon = 8"


@pytest.fixture
def wide() -> Prepared:
    return prepare(from_text.task(small_tasks.SECTION_4, WIDE))


def test_solving_may_cost_what_the_searches_of_the_episode_would(wide: Prepared) -> None:
    assert limits(wide, Options(samples=10_000), 1.0).transitions == 8 * 10_000 * solving.PER_SAMPLE
    assert limits(wide, Options(samples=10_000), 0.5).transitions == 4 * 10_000 * solving.PER_SAMPLE
    timed = Options(samples=10_000, time_limit=0.1)
    assert limits(wide, timed, 1.0).transitions == pytest.approx(8 * 0.1 * solving.PER_SECOND)
    assert limits(wide, Options(samples=1), 1.0).transitions == solving.LEAST


def test_solving_takes_no_more_memory_than_there_is(wide: Prepared, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solving, "most_bytes", lambda: 1_000_000)
    few = limits(wide, Options(), 1.0)
    assert few.transitions * solving.TRANSITION_BYTES <= 500_000
    assert few.states * solving.STATE_BYTES <= 500_000
    long = limits(wide.at(wide.task.initial, 10_000), Options(), 1.0)
    assert long.transitions * solving.TRANSITION_BYTES <= 2**30
    found = within_reach(wide, few)
    assert isinstance(found, GivenUp)


def test_what_has_few_transitions_within_the_horizon_is_solved() -> None:
    task = replace(small_tasks.weighted_task(3), horizon=1)
    covered = [a for a in range(len(task.actions)) if covering_rule(task, task.initial, a)]
    few = sum(len(successors(task, task.initial, action)) for action in covered)
    assert solution(prepare(task), Limits(1_000, few, few)) is not None
    assert solution(prepare(task), Limits(1_000, few - 1, few - 1)) is None
    assert solution(prepare(replace(task, horizon=8)), Limits(1_000, few, few)) is None
    assert solution(prepare(task), Limits(1, few, few)) is None


def test_growth_is_taken_to_fall_on_as_it_fell() -> None:
    assert projected([8.0], 2) == 8  # one step tells nothing
    assert projected([4.0, 16.0], 2) == pytest.approx(20 + 64 + 256)
    assert projected([16.0, 64.0], 2) == pytest.approx(80 + 64 * 2 + 128 * 2**0.5)
    assert projected([16.0, 64.0, 32.0], 1) <= 112 + 32  # it shrinks, or at least grows no more
    assert projected([10.0, 10.0, 0.0], 5) == 20
    wavy = [2.0, 12.0, 24.0, 83.0, 155.0, 397.0, 702.0]
    assert projected(wavy, 5) < 30_000  # steps take turns in growing; 20,233 were found in the end


@pytest.fixture
def enumerated(monkeypatch: pytest.MonkeyPatch) -> list[state_graph.Enumeration]:
    """The enumerations that are made while the test runs."""
    made, init = list[state_graph.Enumeration](), state_graph.Enumeration.__init__

    def noted(self: state_graph.Enumeration, *given: object, **named: object) -> None:
        made.append(self)
        init(self, *given, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(state_graph.Enumeration, "__init__", noted)
    return made


def test_that_a_task_is_too_large_is_found_out_once(
    wide: Prepared, enumerated: list[state_graph.Enumeration]
) -> None:
    few = Limits(10**6, 30_000, 500)
    assert solution(wide, few) is None
    assert 5_000 < max(each.transitions for each in enumerated) < 10_000  # growth has told
    enumerated.clear()
    for left in (7, 6, 5):
        assert solution(wide.at(wide.task.initial, left), few) is None
    assert max(each.transitions for each in enumerated) < 500 + 200  # a state has fewer than 200
    assert solution(wide.at(wide.task.initial, 2), few) is not None


def test_growth_does_not_forbid_what_fits(wide: Prepared) -> None:
    whole = within_reach(wide, Limits(10**6, 10**7, 500))
    assert not isinstance(whole, GivenUp)
    assert not isinstance(within_reach(wide, Limits(10**6, 3 * whole.transitions, 500)), GivenUp)
    early = within_reach(wide, Limits(10**6, whole.transitions // 9, 500))
    assert isinstance(early, GivenUp)
    assert early.expected(1) == 184


def test_a_later_state_with_little_left_is_solved(wide: Prepared) -> None:
    """Where two areas are left, all steps that are left are few enough for a glance."""
    few, task = Limits(10**6, 30_000, 2_000), wide.task
    assert solution(wide, few) is None
    clean = [
        variable.symbol == "dirt" and variable.objects not in {("a0",), ("a1",)}
        for variable in task.variables
    ]
    other = {v.symbol: 1 - task.initial[i] for i, v in enumerate(task.variables) if v.symbol == "dirt"}
    state: GroundState = tuple(
        other["dirt"] if done else value for done, value in zip(clean, task.initial, strict=True)
    )
    found = solution(wide.at(state, 7), few)
    assert found is not None
    assert found.values[0, 0] == pytest.approx(_worth(wide.at(state, 7).task))


def _worth(task: Task) -> float:
    return optimum(task)(task.initial, task.horizon)[0]


def test_plans_depend_on_no_other_plan_of_the_episode(wide: Prepared) -> None:
    """Whatever other states have been planned for since the first."""
    planner, asked = PLANNERS["prada+"].having(solve=0.001, runs=1), Options(samples=200, seed=3)
    first = planner(wide, asked)
    later = {left: planner(wide.at(wide.task.initial, left), asked) for left in (5, 3, 1)}
    again = prepare(wide.task)
    assert planner(again, asked).actions == first.actions
    for left in (1, 3, 5):
        plan = planner(again.at(wide.task.initial, left), asked)
        assert (plan.actions, plan.value, plan.measure) == (
            later[left].actions,
            later[left].value,
            later[left].measure,
        )
