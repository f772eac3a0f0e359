"""PRADA's inner loops, compiled: the belief update and the drawing of action sequences (§4.1).

Lang and Toussaint's factored inference: a belief is a product of marginals, one per state variable; `Tables`
says how it is stored. Nothing is allocated per sample, and little is computed: an update does what the drawn
action changes, and only actions that are proposed are weighed. Guaranteed by `lower`: indices are in range.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cleancli.array_types import Floats, Indices, Ints, Longs
from cleancli.compiler.lowering.belief_tables import Tables
from cleancli.planning.kernels.jit import better, compiled, inlined, standing_earliness
from cleancli.planning.kernels.rng import GOLDEN, mixed, split, uniform

HALF = np.uint64(32)
LOWER_HALF = np.uint64(2**32 - 1)
UNIT = 2.0**-32


class Belief(NamedTuple):
    """A belief over a task's slots, how it is updated, and scratch space (sizes as in `Tables`)."""

    number: Floats  # (N,) probability of each value, then sums of them, then 1
    reward: Floats  # (C,) probability of each reward condition
    weight: Floats  # (A,) probability that a useful rule covers, after `initialise` and `advance`
    cover: Floats  # (R,) scratch: probability that each rule of the action last weighed applies
    others: Floats  # (R,) scratch of the same
    change: Floats  # (S,) scratch: what an update adds to each slot; 0 between updates
    threshold: Floats  # (1,) a rule less likely than this is taken not to apply


@inlined
def _product(start: Indices, entries: Indices, number: Floats, item: int) -> float:
    product = 1.0
    for i in range(start[item], start[item + 1]):
        product *= number[entries[i]]
    return product


@inlined
def _sum(start: Indices, entries: Indices, number: Floats, item: int) -> float:
    total = 0.0
    for i in range(start[item], start[item + 1]):
        total += number[entries[i]]
    return total


@inlined
def _alone(cover: Floats, others: Floats, first: int, last: int, threshold: float) -> None:
    """Of independent rules: the probability that each applies and no other does, cut as that of each was."""
    none = 1.0
    for rule in range(first, last):
        others[rule] = none
        none *= 1.0 - cover[rule]
    none = 1.0
    for rule in range(last - 1, first - 1, -1):
        product = cover[rule] * others[rule] * none
        none *= 1.0 - cover[rule]
        cover[rule] = product if product >= threshold else 0.0


@inlined
def _weigh(t: Tables, belief: Belief, action: int, least: float) -> float:
    """The probability that a useful rule of the action covers, leaving in `cover` that of each of its rules;
    or 0 as soon as it is known to be at most `least`."""
    number, cover, condition_start, condition = belief.number, belief.cover, t.condition_start, t.condition
    useful, threshold = t.useful, belief.threshold[0]
    guard = _product(t.guard_start, t.guard, number, action)
    if guard <= least:
        return 0.0
    first, last = t.rule_start[action], t.rule_start[action + 1]
    for rule in range(first, last):
        product = guard * _product(condition_start, condition, number, rule)
        cover[rule] = product if product >= threshold else 0.0
    if t.independent[0]:
        _alone(cover, belief.others, first, last, threshold)
    weight = 0.0
    for rule in range(first, last):
        if useful[rule]:
            weight += cover[rule]
    return weight


@compiled
def _weigh_all(t: Tables, belief: Belief) -> None:
    weight = belief.weight
    for action in range(len(weight)):
        weight[action] = _weigh(t, belief, action, 0.0)


@inlined
def _update_numbers(t: Tables, belief: Belief, action: int) -> float:
    """Each rule, as likely as `cover` says, sets slots and leaves the rest alone; returns what their outcomes
    cost on average."""
    number, cover, change = belief.number, belief.cover, belief.change
    shift_start, shift_slot, shift = t.shift_start, t.shift_slot, t.shift
    loss_start, loss_slot, loss_given, loss = t.loss_start, t.loss_slot, t.loss_given, t.loss
    rule_cost, spent = t.rule_cost, 0.0
    for rule in range(t.rule_start[action], t.rule_start[action + 1]):
        p = cover[rule]
        if p > 0.0:
            spent += p * rule_cost[rule]
            for i in range(shift_start[rule], shift_start[rule + 1]):
                change[shift_slot[i]] += p * shift[i]
            for i in range(loss_start[rule], loss_start[rule + 1]):
                change[loss_slot[i]] -= p * loss[i] * (number[loss_slot[i]] / number[loss_given[i]])
    slots, sums = t.touched_slot, t.touched_sum
    for i in range(t.touched_slot_start[action], t.touched_slot_start[action + 1]):
        slot = slots[i]
        number[slot] = max(number[slot] + change[slot], 0.0)
        change[slot] = 0.0
    sum_start, sum_slot, first_sum = t.sum_start, t.sum_slot, len(change)
    for i in range(t.touched_sum_start[action], t.touched_sum_start[action + 1]):
        number[first_sum + sums[i]] = _sum(sum_start, sum_slot, number, sums[i])
    return spent


@inlined
def _update_rewards(t: Tables, belief: Belief, action: int) -> tuple[float, float, float]:
    """Returns what is paid for conditions that end, the rise of what the state alone is paid, and how much of
    the step's progress the ends are."""
    number, reward, touched, rules = belief.number, belief.reward, t.touched_reward, len(t.useful)
    start, entries, decrease, state, advance = t.condition_start, t.condition, t.decrease, t.state, t.advance
    ended, rise, advanced = 0.0, 0.0, 0.0
    for i in range(t.touched_reward_start[action], t.touched_reward_start[action + 1]):
        c = touched[i]
        product = _product(start, entries, number, rules + c)
        fall = reward[c] - product
        ended += decrease[c] * fall
        rise -= state[c] * fall
        advanced += advance[c] * fall
        reward[c] = product
    return ended, rise, advanced


@inlined
def _apply(t: Tables, belief: Belief, action: int) -> tuple[float, float, float]:
    """`follow` for the action that was weighed last, and how much of the step's progress ends are."""
    spent = _update_numbers(t, belief, action)
    ended, rise, advanced = _update_rewards(t, belief, action)
    return ended - t.cost[action] - spent, rise, advanced


@compiled
def follow(t: Tables, belief: Belief, action: int) -> tuple[float, float]:
    """Updates the belief by an action, but no weights; returns what it pays itself (eq. 2, less its costs),
    and the rise of what doing nothing is paid from then on."""
    _weigh(t, belief, action, -1.0)
    paid, rise, _ = _apply(t, belief, action)
    return paid, rise


@compiled
def advance(t: Tables, belief: Belief, action: int) -> tuple[float, float]:
    """`follow`, and weighs all actions."""
    paid, rise = follow(t, belief, action)
    _weigh_all(t, belief)
    return paid, rise


@inlined
def _copy(source: Floats, target: Floats) -> None:
    for i in range(len(target)):  # an assignment of slices would look for overlaps first
        target[i] = source[i]


@compiled
def _settle(t: Tables, state: Ints, belief: Belief) -> float:
    """`initialise` without weighing."""
    number, reward, slots = belief.number, belief.reward, len(belief.change)
    number[:] = 0.0
    belief.change[:] = 0.0
    for variable in range(len(state)):
        number[t.slot_start[variable] + state[variable]] = 1.0
    for i in range(len(t.sum_start) - 1):
        number[slots + i] = _sum(t.sum_start, t.sum_slot, number, i)
    number[-1] = 1.0
    standing = float(t.constant[0])
    for c in range(len(reward)):
        reward[c] = _product(t.condition_start, t.condition, number, len(t.useful) + c)
        standing += t.state[c] * reward[c]
    return standing


@compiled
def initialise(t: Tables, state: Ints, belief: Belief) -> float:
    """Sets the belief to certainty about a state (V,); returns what doing nothing in it is paid."""
    standing = _settle(t, state, belief)
    _weigh_all(t, belief)
    return standing


@compiled
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


@inlined
def choose(t: Tables, belief: Belief, stream: np.uint64) -> tuple[int, np.uint64]:
    """An action in proportion to what it weighs now, and the stream after it; -1 where none has weight.

    One is proposed, each as likely, and accepted with its weight as the probability, until it is cheaper to
    weigh them all. A number gives a half of its bits to either choice.
    """
    actions = len(belief.weight)
    for _ in range(actions):
        stream += GOLDEN
        bits = mixed(stream)
        action = int(float(bits >> HALF) * UNIT * actions)
        least = float(bits & LOWER_HALF) * UNIT
        if _weigh(t, belief, action, least) > least:
            return action, stream
    _weigh_all(t, belief)
    stream += GOLDEN
    action = draw(belief.weight, uniform(stream))
    if action >= 0:
        _weigh(t, belief, action, 0.0)
    return action, stream


@compiled
def rewards(t: Tables, state: Ints, belief: Belief, actions: Longs, result: Floats, progress: Floats) -> None:
    """Writes the undiscounted reward of each step from a state (V,), and its progress; where the actions have
    ended before the result has, nothing is done."""
    standing = _settle(t, state, belief)
    for step in range(len(result)):
        paid, advanced = 0.0, 0.0
        if step < len(actions):
            _weigh(t, belief, actions[step], -1.0)
            paid, rise, advanced = _apply(t, belief, actions[step])
            standing += rise
        result[step], progress[step] = paid + standing, advanced + standing


@compiled
def search(
    t: Tables,
    initial: Ints,
    start: Belief,
    belief: Belief,
    drawn: Ints,
    best: Ints,
    seed: np.uint64,
    idle: Floats,
    ceiling: Floats,
    first: int,
    last: int,
    least: float,
    latest: float,
) -> tuple[float, float, int]:
    """Value, earliness (planning/preference.py) and length of the best of sequences `first` to `last` - 1,
    which is left in `best` (horizon,); `least`, `latest` and 0 where none is better.

    `idle` (horizon + 1,) is what a reward of 1 in each of so many last steps is worth at their start,
    `ceiling` (horizon + 1,) what they can pay at most. From a sequence's end on, nothing is done, and the
    state is paid for what it is; each counts up to where it is worth most, but as a whole where rules are
    independent. A sequence that can no longer be the best is given up.

    Sequence i depends on the seed and i alone, so more of them never find a worse plan. Of equals the first
    stays.
    """
    horizon, payment, discount, whole = len(drawn), t.payment, t.discount, t.independent[0]
    standing_first = _settle(t, initial, belief)
    _settle(t, initial, start)
    nothing, nothing_early = standing_first * idle[horizon], standing_first * standing_earliness(horizon)
    best_value, best_early, best_length = least, latest, 0
    for sample in range(first, last):
        _copy(start.number, belief.number)
        _copy(start.reward, belief.reward)
        stream = mixed(split(seed, np.uint64(sample)))
        standing, value, factor, length, early = standing_first, 0.0, 1.0, 0, 0.0
        stopped, stopped_early = nothing, nothing_early
        useful_value, useful_early, useful_length = nothing, nothing_early, 0
        while length < horizon:
            if value + factor * ceiling[horizon - length] <= max(best_value, useful_value):
                break
            action, stream = choose(t, belief, stream)
            if action < 0:
                break
            drawn[length] = action
            length += 1
            paid, rise, advanced = _apply(t, belief, action)
            standing += rise
            value += factor * payment[action] * (paid + standing)
            factor *= discount[action]
            rest = horizon - length
            early += (rest + 1) * (advanced + standing)
            stopped = value + factor * standing * idle[rest]
            stopped_early = early + standing * standing_earliness(rest)
            if not whole and better(stopped, stopped_early, useful_value, useful_early):
                useful_value, useful_early, useful_length = stopped, stopped_early, length
        if whole:
            useful_value, useful_early, useful_length = stopped, stopped_early, length
        if better(useful_value, useful_early, best_value, best_early):
            best_value, best_early, best_length = useful_value, useful_early, useful_length
            for step in range(useful_length):
                best[step] = drawn[step]
    return best_value, best_early, best_length
