"""PRADA's inner loops, compiled: the belief update and the drawing of action sequences (§4.1).

Lang and Toussaint's factored inference: a belief is a product of marginals, one per state variable.
Guaranteed by `lower`: indices are in range, and the rules of one action exclude each other, so the
probability that a rule covers the state is simply that of its condition (docs/planning.md). Nothing is
allocated per sample, and only what an action touched is computed again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from cleancli.compiler.ragged import Bools, Floats, Ints
from cleancli.compiler.tables import Tables
from cleancli.planning.stream import GOLDEN, mixed, split, uniform

NEGLIGIBLE = 1e-9
"""Last steps that add no more than this are dropped from a sequence."""

RULE_THRESHOLD = 0.03
"""A rule less likely than this is taken not to apply, as in the authors' implementation of PRADA."""


class Belief(NamedTuple):
    """A belief over a task's slots, what follows from it, and scratch space (sizes as in `Tables`)."""

    slot: Floats  # (S,) probability of each value
    factor: Floats  # (F,)
    condition: Floats  # (R + C,) probabilities; those of rules are 0 below the threshold
    weight: Floats  # (A,) probability that the action changes something
    kept: Floats  # (V,) scratch: probability that an action leaves the variable alone; 1 between updates
    gained: Floats  # (S,) scratch: probability that an action sets the slot; 0 between updates


@njit(cache=True, nogil=True, forceinline=True)
def _sum(start: Ints, entries: Ints, values: Floats, item: int) -> float:
    total = 0.0
    for i in range(start[item], start[item + 1]):
        total += values[entries[i]]
    return total


@njit(cache=True, nogil=True, forceinline=True)
def _product(start: Ints, entries: Ints, values: Floats, item: int) -> float:
    product = 1.0
    for i in range(start[item], start[item + 1]):
        product *= values[entries[i]]
    return product


@njit(cache=True, nogil=True, forceinline=True)
def _weight(rule_start: Ints, rule_changes: Bools, condition: Floats, action: int) -> float:
    total = 0.0
    for rule in range(rule_start[action], rule_start[action + 1]):
        if rule_changes[rule]:
            total += condition[rule]
    return total


@njit(cache=True, nogil=True)
def initialise(t: Tables, state: Ints, belief: Belief) -> float:
    """Sets the belief to certainty about a state (V,); returns what doing nothing in it is paid."""
    belief.slot[:] = 0.0
    for variable in range(len(state)):
        belief.slot[t.slot_start[variable] + state[variable]] = 1.0
    belief.kept[:] = 1.0
    belief.gained[:] = 0.0
    for f in range(len(belief.factor)):
        belief.factor[f] = _sum(t.factor_slot_start, t.factor_slot, belief.slot, f)
    for c in range(len(belief.condition)):
        # Nothing is cut: in a single state a condition has probability 0 or 1.
        belief.condition[c] = _product(t.condition_factor_start, t.condition_factor, belief.factor, c)
    for action in range(len(belief.weight)):
        belief.weight[action] = _weight(t.rule_start, t.rule_changes, belief.condition, action)
    standing, rules = float(t.constant[0]), len(t.rule_changes)
    for c in range(len(t.state)):
        standing += t.state[c] * belief.condition[rules + c]
    return standing


# The loops below name their arrays first: numba counts references wherever a field is read, which costs ten
# times as much as the arithmetic.


@njit(cache=True, nogil=True, forceinline=True)
def _update_slots(t: Tables, belief: Belief, action: int) -> None:
    """The belief update: each rule, as likely as its condition, sets slots and leaves the rest alone."""
    kept, gained, slot, condition = belief.kept, belief.gained, belief.slot, belief.condition
    set_start, set_variable, set_probability = t.set_start, t.set_variable, t.set_probability
    impact_start, impact_slot, impact_probability = t.impact_start, t.impact_slot, t.impact_probability
    for rule in range(t.rule_start[action], t.rule_start[action + 1]):
        probability = condition[rule]
        if probability > 0.0:
            for i in range(set_start[rule], set_start[rule + 1]):
                kept[set_variable[i]] -= probability * set_probability[i]
            for i in range(impact_start[rule], impact_start[rule + 1]):
                gained[impact_slot[i]] += probability * impact_probability[i]
    touched, slot_start = t.touched_variable, t.slot_start
    for i in range(t.touched_variable_start[action], t.touched_variable_start[action + 1]):
        variable = touched[i]
        for s in range(slot_start[variable], slot_start[variable + 1]):
            slot[s] = slot[s] * kept[variable] + gained[s]
            gained[s] = 0.0
        kept[variable] = 1.0


@njit(cache=True, nogil=True, forceinline=True)
def _update_factors(t: Tables, belief: Belief, action: int) -> None:
    factor, slot, touched = belief.factor, belief.slot, t.touched_factor
    start, entries = t.factor_slot_start, t.factor_slot
    for i in range(t.touched_factor_start[action], t.touched_factor_start[action + 1]):
        factor[touched[i]] = _sum(start, entries, slot, touched[i])


@njit(cache=True, nogil=True, forceinline=True)
def _update_conditions(t: Tables, belief: Belief, action: int) -> tuple[float, float]:
    """Returns what is paid for conditions that end, and the rise of what the state alone is paid."""
    condition, factor, touched = belief.condition, belief.factor, t.touched_condition
    start, entries, rules = t.condition_factor_start, t.condition_factor, len(t.rule_changes)
    decrease, state = t.decrease, t.state
    ended, rise = 0.0, 0.0
    for i in range(t.touched_condition_start[action], t.touched_condition_start[action + 1]):
        c = touched[i]
        product = _product(start, entries, factor, c)
        if c < rules:
            condition[c] = product if product >= RULE_THRESHOLD else 0.0
        else:
            fall = condition[c] - product
            ended += decrease[c - rules] * fall
            rise -= state[c - rules] * fall
            condition[c] = product
    return ended, rise


@njit(cache=True, nogil=True, forceinline=True)
def _update_weights(t: Tables, belief: Belief, action: int) -> None:
    weight, condition, touched = belief.weight, belief.condition, t.touched_action
    rule_start, rule_changes = t.rule_start, t.rule_changes
    for i in range(t.touched_action_start[action], t.touched_action_start[action + 1]):
        weight[touched[i]] = _weight(rule_start, rule_changes, condition, touched[i])


@njit(cache=True, nogil=True, forceinline=True)
def advance(t: Tables, belief: Belief, action: int) -> tuple[float, float]:
    """Updates the belief by an action; returns what it pays itself (eq. 2, less its cost), and the rise of
    what doing nothing is paid from then on."""
    _update_slots(t, belief, action)
    _update_factors(t, belief, action)
    ended, rise = _update_conditions(t, belief, action)
    _update_weights(t, belief, action)
    return ended - t.cost[action], rise


@njit(cache=True, nogil=True)
def rewards(t: Tables, state: Ints, belief: Belief, actions: Ints, result: Floats) -> None:
    """Writes the undiscounted reward of each step from a state (V,); where the actions have ended before the
    result has, nothing is done."""
    standing = initialise(t, state, belief)
    for step in range(len(result)):
        result[step] = 0.0
        if step < len(actions):
            paid, rise = advance(t, belief, actions[step])
            standing += rise
            result[step] = paid
        result[step] += standing


@njit(cache=True, nogil=True, forceinline=True)
def draw(weight: Floats, uniform: float) -> int:
    """An action in proportion to its weight; -1 where none has any."""
    total = 0.0
    for action in range(len(weight)):
        total += weight[action]
    left = uniform * total
    last = -1
    for action in range(len(weight)):
        if weight[action] > 0.0:
            last = action
            left -= weight[action]
            if left < 0.0:
                break
    return last


@njit(cache=True, nogil=True, forceinline=True)
def restore(belief: Belief, start: Belief) -> None:
    """Makes a belief equal to another one of the same task."""
    belief.slot[:] = start.slot
    belief.factor[:] = start.factor
    belief.condition[:] = start.condition
    belief.weight[:] = start.weight


@njit(cache=True, nogil=True)
def search(
    t: Tables,
    initial: Ints,
    start: Belief,
    belief: Belief,
    drawn: Ints,
    best: Ints,
    seed: np.uint64,
    idle: Floats,
    samples: int,
) -> int:
    """Length of the best of `samples` sequences, which is left in `best` (horizon,); 0 if doing nothing is
    as good.

    `idle` (horizon + 1,) is what a reward of 1 in each of so many last steps is worth at their start. From a
    sequence's end on, nothing is done, and the state is paid for what it is; each counts up to where it is
    worth most.

    Sample i depends on the seed and i alone, so more samples never find a worse plan. Of equals the first
    stays.
    """
    horizon, payment, discount = len(drawn), t.payment, t.discount
    initialise(t, initial, belief)
    first = initialise(t, initial, start)
    nothing = first * idle[horizon]
    best_value, best_length = nothing, 0
    for sample in range(samples):
        restore(belief, start)
        stream = mixed(split(seed, np.uint64(sample)))
        standing, value, factor, useful_value, useful_length = first, 0.0, 1.0, nothing, 0
        for step in range(horizon):
            stream += GOLDEN
            action = draw(belief.weight, uniform(stream))
            if action < 0:
                break
            drawn[step] = action
            paid, rise = advance(t, belief, action)
            standing += rise
            value += factor * payment[action] * (paid + standing)
            factor *= discount[action]
            stopped = value + factor * standing * idle[horizon - step - 1]
            if stopped > useful_value + NEGLIGIBLE:
                useful_value, useful_length = stopped, step + 1
        if useful_value > best_value:
            best_value, best_length = useful_value, useful_length
            best[:useful_length] = drawn[:useful_length]
    return best_length
