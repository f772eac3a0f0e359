"""The policy that reaches a goal with the greatest probability, whenever that is, and of those the one of the
least expected cost until then, or until the goal is out of reach.

First what graphs tell alone: where the goal can be reached, the maximal end components, and where it can be
reached for certain (de Alfaro 1997). Then the probabilities elsewhere, in the graph in which each end
component is one state; then the costs among choices that lose no probability, in the graph in which each end
component without costs is one. So bounds meet, and no policy stays for ever where that is free.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Ints
from cleancli.planning.kernels.decision_graph import (
    DecisionGraph,
    Entering,
    end_components,
    entering,
    quotient,
    reaching,
    solving_order,
)
from cleancli.planning.kernels.jit import compiled
from cleancli.planning.kernels.optimistic_iteration import bounds, chosen

ROUNDING = 1e-12
"""Choices whose probabilities differ by this share are as good, beside what the bounds leave open. Chosen:
floats add up to less."""


class GoalPolicy(NamedTuple):
    """For each of N states: bounds of the probability to reach the goal, and of the expected cost until then
    or until it is out of reach; and the choice, -1 where there is nothing to do."""

    probability: Floats  # (2, N) from below and above
    cost: Floats  # (2, N)
    choice: Ints  # (N,)


class Outlook(NamedTuple):
    """What the graph tells alone, whatever the chances are, of its N states and M choices."""

    back: Entering
    inside: Bools  # (N,) where the goal does not hold and can be reached
    ends: Ints  # (N,) the maximal end component inside, -1 where there is none
    staying: Bools  # (M,) which choices stay in one
    certain: Bools  # (N,) inside, and the goal is reached for certain by some policy
    sure: Bools  # (M,) the choices there that keep it so


def outlook(graph: DecisionGraph, goal: Bools, asked: Callable[[], None] = lambda: None) -> Outlook:
    """What the graph tells; `goal` and `asked` as of `solve`."""
    back = entering(graph)
    inside = reaching(back, goal)[0] & ~goal
    ends, staying = end_components(graph, back, inside, np.ones(len(graph.cost), dtype=np.bool_))
    asked()
    certain, sure = _certain(graph, back, goal, inside, ends, staying)
    return Outlook(back, inside, ends, staying, certain, sure)


def solve(
    graph: DecisionGraph, goal: Bools, share: float, asked: Callable[[], None] = lambda: None
) -> GoalPolicy:
    """The policy. `goal` says of each state whether the goal holds; what its choices are plays no part.

    The bounds within a component differ by `share`, see `optimistic_iteration.bounds`; `asked` is too.
    """
    told = outlook(graph, goal, asked)
    inside, certain = told.inside, told.certain
    probability = np.zeros((2, len(goal)))
    probability[:, goal | certain] = 1.0
    unknown = inside & ~certain
    lossless = told.sure
    if unknown.any():
        _probabilities(graph, unknown, told.ends, probability, share, asked)
        left_open = (probability[1] - probability[0])[unknown] / probability[0, unknown]
        lossless = np.zeros_like(told.sure)
        share_open = 2 * left_open.max() + ROUNDING
        _lossless(graph, inside, certain, told.sure, probability[0], share_open, lossless)
    cost = np.zeros((2, len(goal)))
    choice = _costs(graph, told.back, inside, lossless, cost, share, asked)
    return GoalPolicy(probability, cost, choice)


def load() -> None:
    """Makes numba load or compile what `solve` runs: one state that is left at a chance of a half, where it
    is chance alone that decides, one that is left for free, and what is fixed."""
    graph = DecisionGraph(
        np.array([0, 1, 2, 2, 2], dtype=np.int32),
        np.array([0, 2, 4], dtype=np.int32),
        np.array([1, 2, 0, 3], dtype=np.int32),
        np.full(4, 0.5),
        np.array([0.0, 1.0]),
    )
    solve(graph, np.array([False, False, True, False]), 1e-3)


def _certain(
    graph: DecisionGraph, back: Entering, goal: Bools, inside: Bools, ends: Ints, staying: Bools
) -> tuple[Bools, Bools]:
    """From where the goal can be reached for certain, and the choices there that keep it so.

    Who leaves each end component by choices that never lead out of these states reaches it at last.
    """
    block, blocks = blocks_of(inside, ends)
    certain = inside.copy()
    keeps = np.zeros(len(graph.cost), dtype=np.bool_)
    left = np.zeros(blocks, dtype=np.int32)
    queue = np.empty(len(inside), dtype=np.int32)
    members = np.argsort(block[inside], kind="stable").astype(np.int32)
    states = np.flatnonzero(inside).astype(np.int32)[members]
    start = np.zeros(blocks + 1, dtype=np.int32)
    start[1:] = np.cumsum(np.bincount(block[inside], minlength=blocks))
    _keep(graph, back, certain | goal, certain, block, staying, states, start, keeps, left, queue)
    return certain, keeps


@compiled
def _keep(
    g: DecisionGraph,
    back: Entering,
    within: Bools,
    certain: Bools,
    block: Ints,
    staying: Bools,
    states: Ints,
    start: Ints,
    keeps: Bools,
    left: Ints,
    queue: Ints,
) -> None:
    """Takes blocks out of `certain` and `within` that all choices may leave for elsewhere, again and again.
    `left` counts the choices of each block that leave it, and only for states within."""
    choice_start, edge_start, successor = g.choice_start, g.edge_start, g.successor
    for s in range(len(certain)):
        if certain[s]:
            for c in range(choice_start[s], choice_start[s + 1]):
                keeps[c] = True
                for e in range(edge_start[c], edge_start[c + 1]):
                    keeps[c] = keeps[c] and within[successor[e]]
                left[block[s]] += keeps[c] and not staying[c]
    last, first = 0, 0
    for b in range(len(left)):
        if left[b] == 0:
            for m in range(start[b], start[b + 1]):
                queue[last] = states[m]
                last += 1
    while first < last:
        lost = queue[first]
        certain[lost], within[lost], first = False, False, first + 1
        for c in range(choice_start[lost], choice_start[lost + 1]):
            keeps[c] = False
        for i in range(back.start[lost], back.start[lost + 1]):
            c = back.choice[i]
            b = block[back.state[c]]
            if keeps[c] and left[b] > 0:
                keeps[c] = False
                left[b] -= not staying[c]
                if left[b] == 0:
                    for m in range(start[b], start[b + 1]):
                        queue[last] = states[m]
                        last += 1


def _probabilities(
    graph: DecisionGraph,
    unknown: Bools,
    ends: Ints,
    probability: Floats,
    share: float,
    asked: Callable[[], None],
) -> None:
    """Fills in the bounds where only chance decides. Behind the blocks stand the goal, and where it is out
    of reach."""
    block, blocks = blocks_of(unknown, ends)
    block[~unknown] = np.where(probability[0, ~unknown] == 1.0, blocks, blocks + 1)
    small = quotient(graph, block, blocks, np.ones(len(graph.cost), dtype=np.bool_), 2).graph
    order = solving_order(small, 2)
    free = small._replace(cost=np.zeros(len(small.cost)))
    found = bounds(free, order, np.array([1.0, 0.0]), True, share, 1e-300, asked)
    probability[:, unknown] = np.minimum(np.array(found)[:, block[unknown]], 1.0)


@compiled
def _lossless(
    g: DecisionGraph,
    inside: Bools,
    certain: Bools,
    sure: Bools,
    probability: Floats,
    share: float,
    lossless: Bools,
) -> None:
    """Which choices lose no probability, but for a `share` of it."""
    choice_start, edge_start, successor, chance = g.choice_start, g.edge_start, g.successor, g.probability
    for s in range(len(inside)):
        if not inside[s]:
            continue
        for c in range(choice_start[s], choice_start[s + 1]):
            if certain[s]:
                lossless[c] = sure[c]
            else:
                total = 0.0
                for e in range(edge_start[c], edge_start[c + 1]):
                    total += chance[e] * probability[successor[e]]
                lossless[c] = total >= probability[s] * (1.0 - share)


def _costs(
    graph: DecisionGraph,
    back: Entering,
    inside: Bools,
    lossless: Bools,
    cost: Floats,
    share: float,
    asked: Callable[[], None],
) -> Ints:
    """Fills in the bounds of the costs; returns the choices."""
    ends, staying = free_components(graph, back, inside, lossless)
    asked()
    block, blocks = blocks_of(inside, ends)
    block[~inside] = blocks
    small = quotient(graph, block, blocks, lossless, 1)
    order = solving_order(small.graph, 1)
    found = bounds(small.graph, order, np.zeros(1), False, share, 1.0, asked)
    cost[:, inside] = np.array(found)[:, block[inside]]
    leaving = np.empty(blocks, dtype=np.int32)
    chosen(small.graph, found[1], False, leaving)
    assert (leaving >= 0).all()
    return spread_out(back, inside, ends, staying, small.origin[leaving])


def free_components(graph: DecisionGraph, back: Entering, inside: Bools, kept: Bools) -> tuple[Ints, Bools]:
    """The maximal end components by choices that are `kept` and cost nothing, as of `end_components`."""
    if not (graph.cost[kept] == 0.0).any():
        return np.full(len(inside), -1, dtype=np.int32), np.zeros(len(kept), dtype=np.bool_)
    return end_components(graph, back, inside, kept & (graph.cost == 0.0))


def spread_out(back: Entering, inside: Bools, ends: Ints, staying: Bools, leaving: Ints) -> Ints:
    """The choice in each state, given by which choice each block is left: there the others go to."""
    choice = np.full(len(inside), -1, dtype=np.int32)
    exits = back.state[leaving]
    choice[exits] = leaving
    queue = np.empty(len(inside), dtype=np.int32)
    queue[: len(exits)] = exits
    _approach(back, ends, staying, choice, queue, len(exits))
    return choice


@compiled
def _approach(back: Entering, ends: Ints, staying: Bools, choice: Ints, queue: Ints, last: int) -> None:
    start, before, state = back.start, back.choice, back.state
    first = 0
    while first < last:
        s = queue[first]
        first += 1
        for i in range(start[s], start[s + 1]):
            c = before[i]
            if staying[c] and choice[state[c]] < 0 and ends[state[c]] == ends[s]:
                choice[state[c]] = c
                queue[last] = state[c]
                last += 1


def blocks_of(part: Bools, ends: Ints) -> tuple[Ints, int]:
    """A number for each end component and for each other state of the part, in no order; how many."""
    occurring = np.bincount(ends[part & (ends >= 0)]) > 0
    number = np.cumsum(occurring, dtype=np.int32) - 1
    block = np.zeros(len(part), dtype=np.int32)
    block[part] = number[ends[part]] if len(number) else 0
    single = part & (ends < 0)
    first, singles = int(occurring.sum()), int(single.sum())
    block[single] = np.arange(first, first + singles)
    return block, first + singles
