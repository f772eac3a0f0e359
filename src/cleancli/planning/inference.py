"""The compiled kernel for callers: checks the arrays that go in, and gives it the memory that it works in."""

from __future__ import annotations

import numpy as np

from cleancli.compiler.ragged import Floats, Ints
from cleancli.compiler.tables import Tables
from cleancli.compiler.task import Assignment
from cleancli.planning import kernel


def best_sequence(
    tables: Tables, state: Assignment, horizon: int, discount: float, samples: int, seed: int
) -> Ints:
    """Action indices (at most `horizon`) of the best of `samples` sequences drawn from a state (§4.1)."""
    _check(tables)
    idle = np.concatenate([[0.0], np.cumsum(discount ** np.arange(max(horizon, 0)))])
    drawn, best = np.zeros((2, max(horizon, 0)), dtype=np.int32)
    start, belief = _belief(tables), _belief(tables)
    stream = np.uint64(seed % 2**64)
    length: int = kernel.search(
        tables, _state(tables, state), start, belief, drawn, best, stream, idle, samples
    )
    return best[:length]


def step_rewards(tables: Tables, state: Assignment, actions: Ints, steps: int) -> Floats:
    """Undiscounted expected reward of each of `steps` steps (steps,) from a state, at least those of the
    actions.

    Nothing is done in the steps after the last action.
    """
    _check(tables)
    assert actions.ndim == 1
    assert actions.dtype == np.int32
    assert actions.size == 0 or (actions.min() >= 0 and actions.max() < len(tables.rule_start) - 1)
    assert steps >= actions.size
    result = np.zeros(steps)
    kernel.rewards(tables, _state(tables, state), _belief(tables), actions, result)
    return result


def _state(t: Tables, assignment: Assignment) -> Ints:
    state = np.asarray(assignment, dtype=np.int32)
    assert state.shape == (len(t.slot_start) - 1,)
    assert ((state >= 0) & (state < np.diff(t.slot_start))).all()
    return state


def _belief(t: Tables) -> kernel.Belief:
    variables, slots = len(t.slot_start) - 1, int(t.slot_start[-1])
    factors, conditions = len(t.factor_slot_start) - 1, len(t.condition_factor_start) - 1
    actions = len(t.rule_start) - 1
    return kernel.Belief(*(np.zeros(n) for n in (slots, factors, conditions, actions, variables, slots)))


def _check(t: Tables) -> None:
    """Compiled code checks no index: a table that doesn't fit would read and write other memory."""
    slots, factors = int(t.slot_start[-1]), len(t.factor_slot_start) - 1
    conditions, rules = len(t.condition_factor_start) - 1, len(t.rule_changes)
    variables, actions = len(t.slot_start) - 1, len(t.rule_start) - 1
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
    per_action = ((t.cost, actions), (t.payment, actions), (t.discount, actions))
    for numbers, size in (
        *per_action,
        (t.constant, 1),
        (t.decrease, conditions - rules),
        (t.state, conditions - rules),
    ):
        assert numbers.dtype == np.float64
        assert numbers.shape == (size,)


def _check_lists(start: Ints, entries: Ints, lists: int, bound: int, along: Floats | None = None) -> None:
    """`lists` ragged lists of indices below `bound`, with a number along each entry where there are any."""
    assert start.dtype == entries.dtype == np.int32
    assert start.shape == (lists + 1,)
    assert (start[0], start[-1]) == (0, len(entries))
    assert (np.diff(start) >= 0).all()
    assert len(entries) == 0 or (entries.min() >= 0 and entries.max() < bound)
    assert along is None or (along.dtype == np.float64 and along.shape == entries.shape)
