"""Optimistic value iteration (Hartmanns and Kaminski 2020), component by component, those first that others
lead to (Dai et al. 2011): values with bounds.

Guaranteed by whoever calls: the graph has no end components but its fixed states, so that the values are the
only solution of their equations; costs and fixed values are 0 or more.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cleancli.array_types import Floats, Ints, Longs
from cleancli.planning.kernels.decision_graph import Components, DecisionGraph, renumbered
from cleancli.planning.kernels.jit import compiled, inlined

WORK = 200_000_000
"""Transitions that are looked at before Python is asked again: about half a second. Chosen."""

UNIT = 2.0**-53
"""How much one operation of floats may be wrong, as a share of what comes out (IEEE 754)."""

MADE = 16
"""Operations that a choice's cost and probabilities were made by, beside three for each transition: a product
and two sums, one of them over what leaves a block. Chosen: few rules have so many outcomes of one effect."""

STILL = 8 * UNIT
"""The share by which a value still rises where floats tell no more: then guesses grow. Chosen."""

FIRST_SWEEPS = 16
"""A guess is first tried in so many sweeps, and in more where the bound from below needed more. Chosen."""


def bounds(
    graph: DecisionGraph,
    order: Components,
    fixed: Floats,
    greatest: bool,
    share: float,
    least: float,
    asked: Callable[[], None],
) -> tuple[Floats, Floats]:
    """Bounds from below and above of the least expected cost that is paid until a fixed state is reached, and
    of that state's value; or of the greatest. `fixed` are the values of the last states.

    Within each component the bounds differ by `share` of the value, or of `least` where that is less, if
    floats can tell; that adds up over components that lead to each other. What is `asked` may stop it, by an
    exception.
    """
    ordered, number = renumbered(graph, order.states), len(graph.choice_start) - 1
    lower = np.zeros(number)
    lower[number - len(fixed) :] = fixed
    upper, at = lower.copy(), np.zeros(1, dtype=np.int64)
    sign = -1.0 if greatest else 1.0
    while at[0] < order.number:
        _solve(ordered, order.start, lower, upper, sign, share, least, WORK, at)
        asked()
    found = np.stack((lower, upper))
    found[:, order.states] = found[:, : len(order.states)].copy()
    return found[0], found[1]


@inlined
def _best(
    choice_start: Ints,
    edge_start: Ints,
    successor: Ints,
    probability: Floats,
    cost: Floats,
    values: Floats,
    sign: float,
    s: int,
    side: float,
) -> tuple[float, int]:
    """The best value of a choice in a state, and the first choice that has it.

    On the `side` -1 it is less by all that floats may have lost in it, and on 1 more; 0 leaves it as it is.
    Nothing that is added up is negative, so what is lost is a share of the sum: `UNIT` for each product, sum
    and quotient that it was made of (Higham 2002, section 3.1).
    """
    best, chosen = np.inf, -1
    for c in range(choice_start[s], choice_start[s + 1]):
        total = cost[c]
        for e in range(edge_start[c], edge_start[c + 1]):
            total += probability[e] * values[successor[e]]
        total *= 1.0 + side * UNIT * (3 * (edge_start[c + 1] - edge_start[c]) + MADE)
        if sign * total < best:
            best, chosen = sign * total, c
    return sign * best, chosen


@compiled
def chosen(g: DecisionGraph, values: Floats, greatest: bool, choice: Ints) -> None:
    """The choice in each state that is best by these values, of equals the first; -1 without one."""
    a, b, successor, probability, cost = g.choice_start, g.edge_start, g.successor, g.probability, g.cost
    for s in range(len(choice)):
        choice[s] = _best(a, b, successor, probability, cost, values, -1.0 if greatest else 1.0, s, 0.0)[1]


@compiled
def _sweep(g: DecisionGraph, first: int, last: int, lower: Floats, sign: float, least: float) -> float:
    """Raises the lower bounds once, each by those before it; the greatest rise, as a share of the value."""
    a, b, successor, probability, cost = g.choice_start, g.edge_start, g.successor, g.probability, g.cost
    most = 0.0
    for s in range(first, last):
        value = _best(a, b, successor, probability, cost, lower, sign, s, -1.0)[0]
        if value > lower[s]:
            most = max(most, (value - lower[s]) / max(value, least))
            lower[s] = value
    return most


@compiled
def _holds(g: DecisionGraph, first: int, last: int, upper: Floats, sign: float, sweeps: int) -> bool:
    """Whether a guess turns out to be an upper bound: in one sweep no state would have more. It is lowered on
    the way."""
    a, b, successor, probability, cost = g.choice_start, g.edge_start, g.successor, g.probability, g.cost
    for _ in range(sweeps):
        grown = False
        for s in range(first, last):
            value = _best(a, b, successor, probability, cost, upper, sign, s, 1.0)[0]
            if value > upper[s]:
                grown = True
            else:
                upper[s] = value
        if not grown:
            return True
    return False


@compiled
def _gap(g: DecisionGraph, first: int, last: int, lower: Floats, upper: Floats) -> tuple[float, int]:
    """How far apart the bounds are at most where the component leads to, and its transitions."""
    gap, begin, end = 0.0, g.edge_start[g.choice_start[first]], g.edge_start[g.choice_start[last]]
    for e in range(begin, end):
        after = g.successor[e]
        if not first <= after < last:
            gap = max(gap, upper[after] - lower[after])
    return gap, end - begin


@compiled
def _solve(
    g: DecisionGraph,
    start: Ints,
    lower: Floats,
    upper: Floats,
    sign: float,
    share: float,
    least: float,
    work: int,
    at: Longs,
) -> None:
    """Solves components from `at` on, which it moves on, until there are none or enough has been done; the
    states of a component lie together, `start` says from where."""
    a, b, successor, probability, cost = g.choice_start, g.edge_start, g.successor, g.probability, g.cost
    while at[0] < len(start) - 1 and work > 0:
        first, last = start[at[0]], start[at[0] + 1]
        if last - first == 1:
            s = first
            lower[s] = _best(a, b, successor, probability, cost, lower, sign, s, -1.0)[0]
            upper[s] = _best(a, b, successor, probability, cost, upper, sign, s, 1.0)[0]
            at[0] += 1
            work -= a[s + 1] - a[s] + 1
            continue
        gap, edges = _gap(g, first, last, lower, upper)
        within, guess, solved = share / 8.0, share, False
        while not solved and work > 0:
            sweeps, rise = FIRST_SWEEPS, np.inf
            while rise > within and work > 0:
                rise = _sweep(g, first, last, lower, sign, least)
                sweeps += 1
                work -= edges
            if rise > within:
                break
            for s in range(first, last):
                upper[s] = lower[s] + gap + guess * max(lower[s], least)
            solved = _holds(g, first, last, upper, sign, sweeps)
            work -= edges * sweeps
            if rise <= STILL:
                guess *= 4.0
            within /= 8.0
        at[0] += solved
