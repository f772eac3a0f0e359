"""The compiled kernel for callers: checks the arrays that go in, gives it the memory that it works in, and
divides its work among threads."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from cleancli.array_types import Floats, Indices, Ints
from cleancli.compiler.lowering.belief_tables import Tables
from cleancli.compiler.semantics import idle_worth
from cleancli.compiler.task import GroundState
from cleancli.planning.kernels import belief as kernel
from cleancli.planning.preference import preferred

PORTION = 1000
"""The fewest samples that are worth a thread, and how many it draws between looks at the clock. Chosen:
milliseconds for ten areas."""

ROUNDING = 1e-9
"""What bounds are raised by, so that sums in another order stay below them."""


def best_sequence(
    tables: Tables,
    state: GroundState,
    horizon: int,
    discount: float,
    samples: int,
    seed: int,
    *,
    threshold: float,
    threads: int = 1,
    deadline: float | None = None,
) -> tuple[Ints, int]:
    """Action indices (at most `horizon`) of the best of `samples` sequences drawn from a state (§4.1), and
    how many were drawn; fewer only if `time.perf_counter()` has passed `deadline`."""
    check(tables)
    horizon = max(horizon, 0)
    run = partial(
        _best_of,
        tables,
        _state(tables, state),
        threshold,
        np.uint64(seed % 2**64),
        idle_worth(discount, horizon),
        ceiling(tables, discount, horizon),
    )
    best, value, early, drawn = np.zeros(0, dtype=np.int32), -np.inf, -np.inf, 0
    size = PORTION if deadline is not None else max(-(-samples // threads), PORTION)
    firsts = range(0, samples, size)
    with ThreadPoolExecutor(threads) as pool:
        for i in range(0, len(firsts), threads):
            portions = [
                (first, min(first + size, samples), value, early) for first in firsts[i : i + threads]
            ]
            for worth, soon, found in (map if len(portions) == 1 else pool.map)(run, portions):
                if preferred(worth, soon, value, early):
                    best, value, early = found, worth, soon
            drawn = portions[-1][1]
            if deadline is not None and time.perf_counter() > deadline:
                break
    return best, drawn


def _best_of(
    tables: Tables,
    state: Ints,
    threshold: float,
    seed: np.uint64,
    idle: Floats,
    most: Floats,
    portion: tuple[int, int, float, float],
) -> tuple[float, float, Ints]:
    """The best of some samples (first, last + 1) if it is preferred to a value and its earliness, and these
    of it."""
    drawn, best = np.zeros((2, len(idle) - 1), dtype=np.int32)
    start, belief = new_belief(tables, threshold), new_belief(tables, threshold)
    worth, early, length = kernel.search(
        tables, state, start, belief, drawn, best, seed, idle, most, *portion
    )
    return worth, early, best[:length]


def ceiling(t: Tables, discount: float, steps: int) -> Floats:
    """What so many steps can pay at most, at their start (steps + 1,)."""
    standing = float(t.constant[0]) + float(np.maximum(t.state, 0).sum())
    step = max(standing, float(np.max(t.payment * (t.most + standing), initial=0.0)), 0.0)
    return step * idle_worth(float(np.max(t.discount, initial=discount)), steps) * (1 + ROUNDING) + ROUNDING


def step_rewards(
    tables: Tables, state: GroundState, sequences: Sequence[Ints], steps: int, *, threshold: float
) -> tuple[Floats, Floats]:
    """Undiscounted expected reward of each of `steps` steps of each sequence of action indices from a state,
    and its progress (compiler/semantics.py) (sequences, steps).

    Nothing is done in the steps after a sequence's last action.
    """
    check(tables)
    first, belief = _state(tables, state), new_belief(tables, threshold)
    result, progress = np.zeros((2, len(sequences), steps))
    for row, actions in enumerate(sequences):
        assert actions.ndim == 1
        assert actions.size <= steps
        assert actions.size == 0 or (actions.min() >= 0 and actions.max() < len(tables.cost))
        kernel.rewards(tables, first, belief, actions.astype(np.int64), result[row], progress[row])
    return result, progress


def beliefs(tables: Tables, state: GroundState, actions: Sequence[int], *, threshold: float) -> Floats:
    """The probability of each value of each variable (actions + 1, S): in a state, and after each action."""
    check(tables)
    assert all(0 <= action < len(tables.cost) for action in actions)
    belief = new_belief(tables, threshold)
    kernel.initialise(tables, _state(tables, state), belief)
    slots = len(belief.change)
    result = [belief.number[:slots].copy()]
    for action in actions:
        kernel.advance(tables, belief, action)
        result.append(belief.number[:slots].copy())
    return np.array(result)


def new_belief(t: Tables, threshold: float) -> kernel.Belief:
    """Memory for a belief of a task, for `initialise` to fill in."""
    slots, sums, rules, actions = int(t.slot_start[-1]), len(t.sum_start) - 1, len(t.useful), len(t.cost)
    sizes = (slots + sums + 1, len(t.state), actions, rules, rules, slots)
    number, reward, weight, cover, others, change = map(np.zeros, sizes)
    return kernel.Belief(number, reward, weight, cover, others, change, np.array([threshold]))


def _state(t: Tables, assignment: GroundState) -> Ints:
    state = np.asarray(assignment, dtype=np.int32)
    assert state.shape == (len(t.slot_start) - 1,)
    assert ((state >= 0) & (state < np.diff(t.slot_start))).all()
    return state


def check(t: Tables) -> None:
    """Compiled code checks no index: a table that doesn't fit would read and write other memory."""
    variables, slots, sums = len(t.slot_start) - 1, int(t.slot_start[-1]), len(t.sum_start) - 1
    actions, rules, rewards = len(t.rule_start) - 1, len(t.useful), len(t.state)
    numbers = slots + sums + 1
    _check_lists(t.slot_start, np.arange(slots, dtype=np.uint32), variables, slots)
    _check_lists(t.sum_start, t.sum_slot, sums, slots)
    _check_lists(t.guard_start, t.guard, actions, numbers)
    _check_lists(t.condition_start, t.condition, rules + rewards, numbers)
    _check_lists(t.rule_start, np.arange(rules, dtype=np.uint32), actions, rules)
    _check_lists(t.shift_start, t.shift_slot, rules, slots, t.shift)
    _check_lists(t.loss_start, t.loss_slot, rules, slots, t.loss)
    _check_lists(t.loss_start, t.loss_given, rules, numbers)
    _check_lists(t.touched_slot_start, t.touched_slot, actions, slots)
    _check_lists(t.touched_sum_start, t.touched_sum, actions, sums)
    _check_lists(t.touched_reward_start, t.touched_reward, actions, rewards)
    per_action, per_reward = (t.cost, t.payment, t.discount, t.most), (t.decrease, t.state, t.advance)
    assert all(array.dtype == np.float64 for array in (*per_action, *per_reward, t.constant))
    assert all(array.shape == (actions,) for array in per_action)
    assert t.rule_cost.dtype == np.float64
    assert t.rule_cost.shape == (rules,)
    assert all(array.shape == (rewards,) for array in per_reward)
    assert t.useful.dtype == t.independent.dtype == np.bool_
    assert (t.useful.shape, t.independent.shape, t.constant.shape) == ((rules,), (1,), (1,))


def _check_lists(
    start: Indices, entries: Indices, lists: int, bound: int, along: Floats | None = None
) -> None:
    """`lists` ragged lists of indices below `bound`, with a number along each entry where there are any."""
    assert start.dtype == entries.dtype == np.uint32
    assert start.shape == (lists + 1,)
    assert (start[0], start[-1]) == (0, len(entries))
    assert (start[1:] >= start[:-1]).all()
    assert len(entries) == 0 or entries.max() < bound
    assert along is None or (along.dtype == np.float64 and along.shape == entries.shape)
