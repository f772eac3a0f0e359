"""Distributions over exact states as arrays, followed through actions whole or by rollouts.

The meaning is that of compiler/semantics.py. Guaranteed by `lower_process`: indices are in range, and at
most one rule of an action covers a state. No code is compiled here, so a few steps cost milliseconds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Ints
from cleancli.compiler.lowering.state_tables import Process
from cleancli.compiler.semantics import SupportTooLargeError
from cleancli.compiler.task import GroundState


class Spread(NamedTuple):
    """States with their weights, which sum to 1; states that were drawn may repeat."""

    states: Ints  # (n, V) value indices
    weights: Floats  # (n,)


def certain(initial: GroundState, copies: int = 1) -> Spread:
    """All weight on one state, in so many equal rows."""
    return Spread(
        np.tile(np.array(initial, dtype=np.int32), (copies, 1)), np.full(copies, 1.0 / max(copies, 1))
    )


def holding(p: Process, states: Ints, condition: int) -> Bools:
    """In which states (n,) a condition (a rule's, or one that is asked) holds."""
    found = np.ones(len(states), dtype=np.bool_)
    for i in range(p.literal_start[condition], p.literal_start[condition + 1]):
        found &= p.allowed[p.literal_row[i] + states[:, p.literal_variable[i]]]
    return found


def covering(p: Process, states: Ints, action: int) -> Ints:
    """The rule of the action that covers each state (n,); -1 where the default rule does."""
    rule = np.full(len(states), -1, dtype=np.int32)
    for r in range(p.rule_start[action], p.rule_start[action + 1]):
        rule[holding(p, states, r)] = r
    return rule


def branched(p: Process, spread: Spread, action: int, limit: int) -> Spread:
    """The exact distribution after an action, each state once.

    Raises `SupportTooLargeError` where it has more than `limit` states.
    """
    states, weights = spread
    rule = covering(p, states, action)
    staying, parts = np.where(rule < 0, weights, 0.0), []
    for r in np.unique(rule[rule >= 0]):
        rows = np.flatnonzero(rule == r)
        for outcome in range(p.outcome_start[r], p.outcome_start[r + 1]):
            share = weights[rows] * p.probability[outcome]
            variables, values = _effects(p, outcome)
            if len(variables) == 0:
                staying[rows] += share
            elif p.probability[outcome] > 0:
                after = states[rows]
                after[:, variables] = values
                parts.append(Spread(after, share))
    stays = np.flatnonzero(staying)
    found = [Spread(states[stays], staying[stays]), *parts]
    merged = _merged(Spread(*map(np.concatenate, zip(*found, strict=True))))
    if len(merged.states) > limit:
        raise SupportTooLargeError(f"more than {limit} states")
    return merged


def drawn(p: Process, spread: Spread, action: int, uniform: Floats) -> Spread:
    """Each state after an outcome of the action, drawn by a number in [0, 1) for each (n,)."""
    states = spread.states.copy()
    rule = covering(p, states, action)
    for r in np.unique(rule[rule >= 0]):
        rows = np.flatnonzero(rule == r)
        first, last = p.outcome_start[r], p.outcome_start[r + 1]
        outcome = first + np.searchsorted(p.cumulated[first:last], uniform[rows], side="right")
        for chosen in np.unique(outcome):
            variables, values = _effects(p, int(chosen))
            states[np.ix_(rows[outcome == chosen], variables)] = values
    return Spread(states, spread.weights)


def paying(p: Process, spread: Spread) -> tuple[float, float]:
    """Expected: what is paid for its decrease (#dirt of eq. 2), and what a step that ends so is paid."""
    rules = len(p.outcome_start) - 1
    chance = np.array([spread.weights @ holding(p, spread.states, rules + c) for c in range(len(p.decrease))])
    if not chance.size:
        return 0.0, float(p.constant[0])
    return float(chance @ p.decrease), float(chance @ p.state + p.constant[0])


def spent(p: Process, spread: Spread, action: int) -> float:
    """Expected: what the reward of a step loses by the action, and by which outcome of it happens."""
    if not p.rule_pays.any():
        return float(p.cost[action])
    rules = len(p.outcome_start) - 1
    chance = np.bincount(covering(p, spread.states, action) + 1, spread.weights, minlength=rules + 1)[1:]
    by_outcome = np.repeat(chance, np.diff(p.outcome_start)) @ (p.probability * p.outcome_cost)
    return float(p.cost[action] + by_outcome)


def ahead(p: Process, spread: Spread) -> float:
    """Expected: what is to be decreased for progress (compiler/semantics.py)."""
    rules = len(p.outcome_start) - 1
    return float(
        sum(
            p.advance[c] * (spread.weights @ holding(p, spread.states, rules + c))
            for c in range(len(p.advance))
            if p.advance[c]
        )
    )


def marginals(p: Process, spread: Spread) -> Floats:
    """The probability of each value of each variable (S,), in the order of `Process.slot_start`."""
    counted = [
        np.bincount(spread.states[:, v], spread.weights, minlength=size) for v, size in enumerate(p.sizes)
    ]
    return np.concatenate([np.zeros(0), *counted])


def _effects(p: Process, outcome: int) -> tuple[Ints, Ints]:
    place = slice(p.effect_start[outcome], p.effect_start[outcome + 1])
    return p.effect_variable[place], p.effect_value[place]


def _merged(spread: Spread) -> Spread:
    """Each state once, with the sum of its weights, in the order of its bytes."""
    states, weights = spread
    if states.shape[1] == 0:
        return Spread(states[:1], np.array([weights.sum()]))
    small = np.ascontiguousarray(states.astype(np.min_scalar_type(int(states.max(initial=0)))))
    keys = small.view(np.dtype((np.void, small.dtype.itemsize * small.shape[1]))).ravel()
    _, first, group = np.unique(keys, return_index=True, return_inverse=True)
    summed: Floats = np.bincount(group.ravel(), weights, minlength=len(first)).astype(np.float64)
    return Spread(states[first], summed)
