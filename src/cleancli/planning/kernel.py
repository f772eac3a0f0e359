"""PRADA's inner loops, compiled: the belief update and the drawing of action sequences (§4.1).

Lang and Toussaint's factored inference: a belief is a product of marginals, one per state variable. Guaranteed by
`lower`: indices are in range, and the rules of one action exclude each other, so the probability that a rule covers
the state is simply that of its condition (docs/planning.md). Nothing is allocated per sample, and only what an action
touched is computed again.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from cleancli.compiler.tables import Floats, Ints, Tables

RULE_THRESHOLD = 0.03
"""A rule less likely than this is taken not to apply, as in the authors' implementation of PRADA."""


class Belief(NamedTuple):
    """A belief over a task's slots, everything that follows from it, and scratch space (sizes as in `Tables`)."""

    slot: Floats  # (S,) probability of each value
    factor: Floats  # (F,)
    condition: Floats  # (R + C,) probabilities; those of rules are 0 below the threshold
    weight: Floats  # (A,) probability that the action changes something
    kept: Floats  # (V,) scratch: probability that an action leaves the variable alone; 1 between updates
    gained: Floats  # (S,) scratch: probability that an action sets the slot; 0 between updates


@njit(cache=True, nogil=True)
def _factor(t: Tables, belief: Belief, f: int) -> None:
    total = 0.0
    for i in range(t.factor_slot_start[f], t.factor_slot_start[f + 1]):
        total += belief.slot[t.factor_slot[i]]
    belief.factor[f] = total


@njit(cache=True, nogil=True)
def _condition(t: Tables, belief: Belief, c: int) -> float:
    """Computes a condition's probability again and returns its rise."""
    product = 1.0
    for i in range(t.condition_factor_start[c], t.condition_factor_start[c + 1]):
        product *= belief.factor[t.condition_factor[i]]
    if product < RULE_THRESHOLD and c < len(t.rule_changes):
        product = 0.0
    rise = product - belief.condition[c]
    belief.condition[c] = product
    return rise


@njit(cache=True, nogil=True)
def _weight(t: Tables, belief: Belief, action: int) -> None:
    total = 0.0
    for rule in range(t.rule_start[action], t.rule_start[action + 1]):
        if t.rule_changes[rule]:
            total += belief.condition[rule]
    belief.weight[action] = total


@njit(cache=True, nogil=True)
def initialise(t: Tables, belief: Belief) -> None:
    """Sets the belief to certainty about the initial state."""
    belief.slot[:] = t.initial
    belief.kept[:] = 1.0
    belief.gained[:] = 0.0
    for f in range(len(belief.factor)):
        _factor(t, belief, f)
    for c in range(len(belief.condition)):
        _condition(t, belief, c)
    for action in range(len(belief.weight)):
        _weight(t, belief, action)


@njit(cache=True, nogil=True)
def _update_slots(t: Tables, belief: Belief, action: int) -> None:
    """The belief update: each rule, as likely as its condition, sets slots and leaves the rest alone."""
    for rule in range(t.rule_start[action], t.rule_start[action + 1]):
        probability = belief.condition[rule]
        if probability > 0.0:
            for i in range(t.set_start[rule], t.set_start[rule + 1]):
                belief.kept[t.set_variable[i]] -= probability * t.set_probability[i]
            for i in range(t.impact_start[rule], t.impact_start[rule + 1]):
                belief.gained[t.impact_slot[i]] += probability * t.impact_probability[i]
    for i in range(t.touched_variable_start[action], t.touched_variable_start[action + 1]):
        variable = t.touched_variable[i]
        for slot in range(t.slot_start[variable], t.slot_start[variable + 1]):
            belief.slot[slot] = belief.slot[slot] * belief.kept[variable] + belief.gained[slot]
            belief.gained[slot] = 0.0
        belief.kept[variable] = 1.0


@njit(cache=True, nogil=True)
def advance(t: Tables, belief: Belief, action: int) -> float:
    """Updates the belief by an action and returns its reward: the decrease of the expected count (eq. 2)."""
    _update_slots(t, belief, action)
    for i in range(t.touched_factor_start[action], t.touched_factor_start[action + 1]):
        _factor(t, belief, t.touched_factor[i])
    reward = 0.0
    for i in range(t.touched_condition_start[action], t.touched_condition_start[action + 1]):
        rise = _condition(t, belief, t.touched_condition[i])
        if t.touched_condition[i] >= len(t.rule_changes):
            reward -= rise
    for i in range(t.touched_action_start[action], t.touched_action_start[action + 1]):
        _weight(t, belief, t.touched_action[i])
    return reward


@njit(cache=True, nogil=True)
def rewards(t: Tables, belief: Belief, actions: Ints, result: Floats) -> None:
    """Writes the undiscounted reward of each step of a sequence that starts in the initial state."""
    initialise(t, belief)
    for step in range(len(actions)):
        result[step] = advance(t, belief, actions[step])


@njit(cache=True, nogil=True)
def _mixed(state: np.uint64) -> np.uint64:
    """The output function of splitmix64 (Steele, Lea and Flood, OOPSLA 2014)."""
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return state ^ (state >> np.uint64(31))


@njit(cache=True, nogil=True)
def _uniform(bits: np.uint64) -> float:
    """The 53 upper bits as a number in [0, 1)."""
    return float(bits >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@njit(cache=True, nogil=True)
def _draw(weight: Floats, uniform: float) -> int:
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


@njit(cache=True, nogil=True)
def _restore(belief: Belief, start: Belief) -> None:
    belief.slot[:] = start.slot
    belief.factor[:] = start.factor
    belief.condition[:] = start.condition
    belief.weight[:] = start.weight


@njit(cache=True, nogil=True)
def search(
    t: Tables, start: Belief, belief: Belief, drawn: Ints, best: Ints, seed: np.uint64, discount: float, samples: int
) -> int:
    """Length of the best of `samples` sequences, which is left in `best` (horizon,); 0 where none has a value.

    Sample i depends on the seed and i alone, so more samples never find a worse plan. Of equals the first stays.
    """
    golden = np.uint64(0x9E3779B97F4A7C15)
    best_value, best_length = 0.0, 0
    initialise(t, start)
    initialise(t, belief)
    for sample in range(samples):
        _restore(belief, start)
        state = _mixed(_mixed(seed) + np.uint64(sample) * golden)
        value, factor, length = 0.0, 1.0, 0
        while length < len(drawn):
            state += golden
            action = _draw(belief.weight, _uniform(_mixed(state)))
            if action < 0:
                break
            drawn[length] = action
            value += factor * advance(t, belief, action)
            factor *= discount
            length += 1
        if value > best_value:
            best_value, best_length = value, length
            best[:length] = drawn[:length]
    return best_length
