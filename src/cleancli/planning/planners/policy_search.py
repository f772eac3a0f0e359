"""Search in policies, which starts from the best sequence that is known."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cleancli.compiler.lowering.state_tables import lower_process
from cleancli.compiler.task import Task
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.planners import beam, goal_beam
from cleancli.planning.policy import Course, Policy
from cleancli.planning.reductions.determinization import by_chance

EXPLORATION = 10.0
"""The weight of the upper bounds (planning/kernels/policy_tree.py). Chosen by benchmarks/regret.py."""

START_RUNS = 256
"""Runs that value a sequence as a base policy, to choose the one to start from. Chosen."""

FRESH_RUNS = 1024
"""Runs that value the policy that was found. Chosen."""

HOPE = 1.0
"""What a new node is worth where a goal is hoped for falls by this power of e where the relaxed plan takes
all steps that are left. Chosen by benchmarks/goals.py, as HOPEFUL_EXPLORATION and WIDTH are."""

HOPEFUL_EXPLORATION = 0.3
"""The weight of the upper bounds there, where values are not drawn."""

WIDTH = 8
"""States that are followed along relaxed plans in each step."""

ROUND = 20
"""Descents between two looks at the clock. Chosen: some milliseconds where states are large."""

BEAM_WORK, NARROW, WIDE = 2_000_000, 50, 2_000
"""Where outcomes are actions, so many states are followed in each step that steps, states and actions
multiply to BEAM_WORK, within these bounds. Chosen."""

Actions = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Grown:
    """A policy and its likeliest course, what it is worth over fresh runs with its earliness, and how many
    descents found it."""

    policy: Policy
    course: Course
    value: float
    earliness: float
    descents: int


@dataclass(frozen=True, slots=True)
class Effort:
    """So many descents, or as many as there is time for until the deadline; the seed of what is drawn."""

    descents: int
    deadline: float | None
    seed: int


def search(prepared: Prepared, starts: Sequence[Actions], runs: int, effort: Effort) -> Grown:
    """The policy that a search finds from the best of the sequences; its value is that of fresh runs."""
    seed = effort.seed
    tree = kernels.tree_search.Search(
        prepared, best_start(prepared, starts, seed), runs=runs, exploration=EXPLORATION, seed=seed
    )
    _grow(tree, effort)
    return Grown(tree.policy(), tree.course(), *tree.mean(FRESH_RUNS, seed + 1), tree.played)


def hopeful(prepared: Prepared, way: Actions, effort: Effort) -> Grown:
    """The policy that a search finds where nothing is paid but for a goal, and a new node is worth what that
    pays, less by how far it is. The way is what is tried first. Its value is a guess."""
    tree = kernels.tree_search.Search(
        prepared, way, exploration=HOPEFUL_EXPLORATION, seed=effort.seed, hope=HOPE
    )
    _grow(tree, effort)
    return Grown(tree.policy(), tree.course(), tree.value, 0.0, tree.played)


def _grow(tree: Any, effort: Effort) -> None:
    """Puts so much effort into a tree."""
    descents, deadline = effort.descents, effort.deadline
    while tree.played < descents and not tree.solved and (deadline is None or time.perf_counter() < deadline):
        tree.run(min(ROUND, descents - tree.played))


def goal_alone(task: Task) -> bool:
    """Whether nothing is paid but for a goal."""
    earning = any(outcome.cost < 0 for rule in task.rules for outcome in rule.outcomes)
    return bool(task.goal) and not earning and all(each.condition in task.goal for each in task.rewards)


def prize(task: Task) -> float:
    """What reaching the goal pays."""
    return max((-float(reward.decrease) for reward in task.rewards), default=0.0)


def way_to_goal(prepared: Prepared) -> Actions:
    """A sequence that may lead to the goal; none where none was found."""
    task = prepared.task
    return goal_beam.sequence(prepared.process, task.initial, task.horizon, WIDTH)


def carried_out(prepared: Prepared, sequence: Actions, seed: int) -> tuple[float, float]:
    """What a sequence is worth, whatever happens, and its earliness, over the runs that value the policy."""
    return kernels.tree_search.base_mean(prepared, sequence, kernels.base_policies.TAIL, FRESH_RUNS, seed + 1)


def best_start(prepared: Prepared, starts: Sequence[Actions], seed: int) -> Actions:
    """The sequence that is worth most as a base policy, of equals the first."""
    if len(starts) == 1:
        return starts[0]
    loops = kernels.base_policies
    worth = [
        max(
            kernels.tree_search.base_mean(prepared, each, base, START_RUNS, seed)
            for base in range(loops.FIRST_ROLLOUT, loops.LAST_ROLLOUT + 1)
        )
        for each in starts
    ]
    return starts[worth.index(max(worth))]


def hoped_for(prepared: Prepared) -> Actions:
    """The best sequence where each outcome counts by its chance (reductions/determinization.py)."""
    task = prepared.task
    process, origins = _hopeful(prepared)
    steps = max(task.horizon, 0)
    width = min(max(BEAM_WORK // max(steps * len(origins), 1), NARROW), WIDE)
    sequence = beam.best_sequence(process, task.initial, task.discount, steps=steps, width=width)
    return tuple(origins[action] for action in sequence)


def _hopeful(prepared: Prepared) -> tuple[Any, tuple[int, ...]]:
    """The process in which outcomes are actions, and what these stand for; made once for all states."""
    if "by chance" not in prepared.solutions:
        task, origins = by_chance(prepared.task)
        prepared.solutions["by chance"] = lower_process(task), origins
    made: tuple[Any, tuple[int, ...]] = prepared.solutions["by chance"]
    return made


def load(prepared: Prepared) -> None:
    """Makes numba load or compile what will run."""
    first = prepared.at(prepared.task.initial, 1)
    tree = kernels.tree_search.Search(first, [0] if first.task.actions else [], runs=1, exploration=0, seed=0)
    tree.run(1)
    tree.course()
    tree.sampled(1, 0)
    best_start(first, [(), ()], 0)
    if goal_alone(first.task):
        way_to_goal(first)
