"""The compiled kernel for callers: checks the arrays that go in, and gives it the memory that it works in."""

from __future__ import annotations

import numpy as np

from cleancli.compiler.tables import Floats, Ints, Tables
from cleancli.planning import kernel


def best_sequence(tables: Tables, horizon: int, discount: float, samples: int, seed: int) -> Ints:
    """Action indices (at most `horizon`) of the best of `samples` drawn sequences (§4.1)."""
    _check(tables)
    worth = np.cumsum(discount ** np.arange(max(horizon, 0))[::-1])[::-1].copy()
    drawn, best = np.zeros((2, max(horizon, 0)), dtype=np.int32)
    start, belief = _belief(tables), _belief(tables)
    stream = np.uint64(seed % 2**64)
    length: int = kernel.search(tables, start, belief, drawn, best, stream, discount, worth, samples)
    return best[:length]


def step_rewards(tables: Tables, actions: Ints, steps: int) -> Floats:
    """Undiscounted expected reward of each of `steps` steps (steps,), at least those of the actions.

    Nothing is done in the steps after the last action.
    """
    _check(tables)
    assert actions.ndim == 1
    assert actions.dtype == np.int32
    assert actions.size == 0 or (actions.min() >= 0 and actions.max() < len(tables.rule_start) - 1)
    assert steps >= actions.size
    result = np.zeros(steps)
    kernel.rewards(tables, _belief(tables), actions, result)
    return result


def _belief(t: Tables) -> kernel.Belief:
    variables, slots = len(t.slot_start) - 1, len(t.initial)
    factors, conditions = len(t.factor_slot_start) - 1, len(t.condition_factor_start) - 1
    actions = len(t.rule_start) - 1
    return kernel.Belief(*(np.zeros(n) for n in (slots, factors, conditions, actions, variables, slots)))


def _check(t: Tables) -> None:
    """Compiled code checks no index: a table that doesn't fit would read and write other memory."""
    slots, factors = len(t.initial), len(t.factor_slot_start) - 1
    conditions, rules = len(t.condition_factor_start) - 1, len(t.rule_changes)
    variables, actions = len(t.slot_start) - 1, len(t.rule_start) - 1
    assert t.slot_start[-1] == slots
    assert t.rule_start[-1] == rules
    assert t.rule_changes.dtype == np.bool_
    _check_lists(t.factor_slot_start, t.factor_slot, factors, slots)
    _check_lists(t.condition_factor_start, t.condition_factor, conditions, factors)
    _check_lists(t.set_start, t.set_variable, rules, variables, t.set_probability)
    _check_lists(t.impact_start, t.impact_slot, rules, slots, t.impact_probability)
    _check_lists(t.touched_variable_start, t.touched_variable, actions, variables)
    _check_lists(t.touched_factor_start, t.touched_factor, actions, factors)
    _check_lists(t.touched_condition_start, t.touched_condition, actions, conditions)
    _check_lists(t.touched_action_start, t.touched_action, actions, actions)
    for numbers, size in ((t.cost, actions), (t.decrease, conditions - rules), (t.state, conditions - rules)):
        assert numbers.dtype == np.float64
        assert numbers.shape == (size,)
    assert t.standing.dtype == np.float64
    assert t.standing.shape == (1,)


def _check_lists(start: Ints, entries: Ints, lists: int, bound: int, along: Floats | None = None) -> None:
    """`lists` ragged lists of indices below `bound`, with a number along each entry where there are any."""
    assert start.dtype == entries.dtype == np.int32
    assert start.shape == (lists + 1,)
    assert (start[0], start[-1]) == (0, len(entries))
    assert (np.diff(start) >= 0).all()
    assert len(entries) == 0 or (entries.min() >= 0 and entries.max() < bound)
    assert along is None or (along.dtype == np.float64 and along.shape == entries.shape)
