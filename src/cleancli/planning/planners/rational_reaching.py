"""Goals without a horizon in exact arithmetic: policy iteration (Howard 1960) over fractions.

What graphs tell alone, and which states count as one, is as in planning/kernels/goal_policy.py. What a policy
is worth solves a system of linear equations, by taking one state after the other out of it.
"""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from cleancli.array_types import Bools, Floats, Ints
from cleancli.compiler.semantics import covering_rule
from cleancli.compiler.task import GroundState, Reaching, Task
from cleancli.planning import kernels

Chances = Mapping[int, Fraction]
"""Where a choice leads to, and how likely."""


@dataclass(frozen=True, slots=True)
class _Choice:
    """What a choice of a block costs until it has left it, where it leads to then, and its number in the
    graph of states."""

    cost: Fraction
    after: Chances
    origin: int


def solve(task: Task, reaching: Reaching, enumeration: Any, graph: Any, goal: Bools) -> Any:
    """As kernels.goal_policy.solve: the policy, and bounds that are equal, exact but for their rounding to
    floats. `enumeration` and `graph` are those of kernels.state_graph."""
    loops = kernels.goal_policy
    after = _transitions(task, enumeration, graph)
    by_outcome = list(map(reaching.by_outcome, task.rules))
    costs = [
        reaching.costs[action] + by_outcome[rule]
        for action, rule in zip(graph.choice_action.tolist(), graph.choice_rule.tolist(), strict=True)
    ]
    known = kernels.decision_graph.DecisionGraph(
        graph.choice_start,
        graph.edge_start,
        graph.edge_successor,
        graph.edge_probability,
        np.array([float(cost > 0) for cost in costs]),
    )
    told = loops.outlook(known, goal)
    probability = _probabilities(graph, after, goal, told)
    lossless = _lossless(graph, after, probability, told)
    ends, staying = loops.free_components(known, told.back, told.inside, lossless)
    block, blocks = loops.blocks_of(told.inside, ends)
    block[~told.inside] = blocks
    values, leaving = _best(_choices(graph, after, costs, block, blocks, lossless), (Fraction(0),), False)
    exits = np.array([each.origin for each in leaving], dtype=np.int32)
    choice = loops.spread_out(told.back, told.inside, ends, staying, exits)
    return loops.GoalPolicy(_rounded(probability), _rounded([values[b] for b in block]), choice)


def _probabilities(graph: Any, after: Sequence[Chances], goal: Bools, told: Any) -> list[Fraction]:
    """The greatest probability to reach the goal from each state. Behind the blocks stand the goal, and where
    it is out of reach."""
    sure, unknown = goal | told.certain, told.inside & ~told.certain
    block, blocks = kernels.goal_policy.blocks_of(unknown, told.ends)
    block[~unknown] = np.where(sure[~unknown], blocks, blocks + 1)
    free, every = [Fraction(0)] * len(after), np.ones(len(after), dtype=np.bool_)
    values, _ = _best(_choices(graph, after, free, block, blocks, every), (Fraction(1), Fraction(0)), True)
    return [values[b] for b in block]


def _rounded(values: Sequence[Fraction]) -> Floats:
    """Both bounds."""
    return np.array([[float(value) for value in values]] * 2)


def _transitions(task: Task, enumeration: Any, graph: Any) -> list[Chances]:
    """Of each choice where it leads to, and how likely."""
    owner = np.repeat(np.arange(len(graph.states)), np.diff(graph.choice_start)).tolist()
    states = list(map(tuple, graph.states.tolist()))
    found = (
        _successors(task, states[number], action)
        for number, action in zip(owner, graph.choice_action.tolist(), strict=True)
    )
    return [{enumeration.index(state): chance for state, chance in each.items()} for each in found]


def _successors(task: Task, state: GroundState, action: int) -> dict[GroundState, Fraction]:
    """The states that may follow, with their probabilities; none where no rule covers the state."""
    rule = covering_rule(task, state, action)
    found: dict[GroundState, Fraction] = {}
    for outcome in () if rule is None else rule.outcomes:
        if outcome.probability:
            effects = dict(outcome.effects)
            successor = tuple(effects.get(variable, value) for variable, value in enumerate(state))
            found[successor] = found.get(successor, Fraction(0)) + outcome.probability
    return found


def _choices(
    graph: Any,
    after: Sequence[Chances],
    costs: Sequence[Fraction],
    block: Ints,
    blocks: int,
    kept: Bools,
) -> list[list[_Choice]]:
    """The choices of each block that are kept and can leave it, as those of a `Quotient`."""
    found: list[list[_Choice]] = [[] for _ in range(blocks)]
    owner = np.repeat(block, np.diff(graph.choice_start)).tolist()
    of = block.tolist()
    for choice, own in enumerate(owner):
        if own >= blocks or not kept[choice]:
            continue
        leading: dict[int, Fraction] = {}
        for state, chance in after[choice].items():
            leading[of[state]] = leading.get(of[state], Fraction(0)) + chance
        leading.pop(own, None)
        if leaving := sum(leading.values()):
            chances = {b: chance / leaving for b, chance in leading.items()}
            found[own].append(_Choice(costs[choice] / leaving, chances, choice))
    return found


def _lossless(graph: Any, after: Sequence[Chances], probability: Sequence[Fraction], told: Any) -> Bools:
    """Which choices lose no probability."""
    owner = np.repeat(np.arange(len(told.inside)), np.diff(graph.choice_start)).tolist()
    kept: Bools = told.sure.copy()
    for choice, state in enumerate(owner):
        if told.inside[state] and not told.certain[state]:
            worth = sum(chance * probability[s] for s, chance in after[choice].items())
            kept[choice] = worth == probability[state]
    return kept


def _best(
    choices: Sequence[Sequence[_Choice]], fixed: Sequence[Fraction], greatest: bool
) -> tuple[list[Fraction], list[_Choice]]:
    """The best values of all blocks and of the states behind them, which are `fixed`, and the choices that
    have them. Every policy that is met reaches a fixed state for certain."""
    policy, sign = _approaching(choices), -1 if greatest else 1
    while True:
        values = [*_worth(policy, fixed), *fixed]
        improved = [_improved(several, sign, values) for several in choices]
        # Of equals the policy's own choice stays, or it might turn in circles.
        changes = [block for block, (worth, _) in enumerate(improved) if worth < sign * values[block]]
        if not changes:
            return values, policy
        for block in changes:
            policy[block] = improved[block][1]


def _improved(several: Sequence[_Choice], sign: int, values: Sequence[Fraction]) -> tuple[Fraction, _Choice]:
    """The best choice, by what it is worth where others are worth so much."""
    worths = [sign * (each.cost + sum(p * values[b] for b, p in each.after.items())) for each in several]
    best = min(range(len(several)), key=worths.__getitem__)
    return worths[best], several[best]


def _approaching(choices: Sequence[Sequence[_Choice]]) -> list[_Choice]:
    """A policy that reaches a fixed state for certain: each choice leads nearer to one with some chance."""
    chosen: dict[int, _Choice] = {}
    while len(chosen) < len(choices):
        nearer = {
            block: choice
            for block, several in enumerate(choices)
            if block not in chosen
            for choice in reversed(several)
            if any(b >= len(choices) or b in chosen for b in choice.after)
        }
        assert nearer, "from each block a fixed state can be reached"
        chosen |= nearer
    return [chosen[block] for block in range(len(choices))]


def _worth(policy: Sequence[_Choice], fixed: Sequence[Fraction]) -> list[Fraction]:
    """What a policy costs in each block: one block after the other is taken out of the equations, always one
    that the fewest others are tied to, and then they are solved backwards."""
    constant = [each.cost for each in policy]
    rows = [dict(each.after) for each in policy]
    for block, row in enumerate(rows):
        for place, value in enumerate(fixed, len(policy)):
            constant[block] += row.pop(place, Fraction(0)) * value
    before: list[set[int]] = [set() for _ in rows]
    for block, row in enumerate(rows):
        for other in row:
            before[other].add(block)
    waiting = [(len(row) * len(before[block]), block) for block, row in enumerate(rows)]
    heapq.heapify(waiting)
    order: list[int] = []
    gone = set[int]()
    while waiting:
        degree, block = heapq.heappop(waiting)
        if block in gone:
            continue
        if degree < (now := len(rows[block]) * len(before[block])):
            heapq.heappush(waiting, (now, block))
            continue
        gone.add(block)
        order.append(block)
        for other in before[block]:
            _substitute(rows, constant, before, block, other)
        for other in rows[block]:
            before[other].discard(block)
    for block in reversed(order):
        constant[block] += sum(p * constant[other] for other, p in rows[block].items())
    return constant


def _substitute(
    rows: list[dict[int, Fraction]],
    constant: list[Fraction],
    before: Sequence[set[int]],
    block: int,
    other: int,
) -> None:
    """Puts a block's equation into another one's, and solves that for its own block again."""
    share = rows[other].pop(block)
    constant[other] += share * constant[block]
    for after, p in rows[block].items():
        rows[other][after] = rows[other].get(after, Fraction(0)) + share * p
        before[after].add(other)
    if staying := rows[other].pop(other, Fraction(0)):
        before[other].discard(other)
        constant[other] /= 1 - staying
        rows[other] = {after: p / (1 - staying) for after, p in rows[other].items()}
