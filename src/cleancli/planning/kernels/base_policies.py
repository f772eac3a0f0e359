"""Base policies (Bertsekas's word in rollout algorithms), compiled: what a state is worth by ways to go on
that cost no search.

All but one read a sequence of actions that is good from the initial state on. The tail carries out what is
left of it, whatever happens. The list does the first of its actions that may change the state, again and
again. The retried sequence stays at an action until it has changed something, and leaves out those that can
change nothing. The greedy policy needs no sequence: it does what the next step alone pays most for.

The meaning of actions and rewards is that of compiler/semantics.py.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cleancli.array_types import Floats, Ints
from cleancli.compiler.lowering.state_tables import Process
from cleancli.planning.kernels.jit import compiled, inner, standing_earliness
from cleancli.planning.kernels.relaxed import Relaxed
from cleancli.planning.kernels.rng import GOLDEN, split, uniform
from cleancli.planning.kernels.transitions import (
    apply,
    carry_out,
    choosable,
    covering,
    draw,
    rewarded,
    touched,
)
from cleancli.planning.preference import AS_GOOD

STOP, GREEDY, TAIL, LIST, RETRIED = -1, 0, 1, 2, 3
"""What can be done from a state on."""

FIRST_ROLLOUT, LAST_ROLLOUT = TAIL, RETRIED
"""Those that are valued by rollouts."""


class Bases(NamedTuple):
    """A sequence of n actions, and what all base policies share."""

    sequence: Ints  # (n,)
    priority: Ints  # (m,) its actions, each once, in their order
    idle: Floats  # (H + 1,) what a reward of 1 in each of so many last steps is worth at their start
    scratch: Ints  # (2, V) states that are worked on
    relaxed: Relaxed  # to tell how far a goal is


@inner
def one_step(
    p: Process, b: Bases, state: Ints, action: int, rule: int, left: int, standing: float
) -> tuple[float, float]:
    """What it is worth to do one action and then stop, and its earliness; a rule of the action covers the
    state, `standing` is paid for it. Works in the first row of the scratch."""
    after, value, early = b.scratch[0], 0.0, 0.0
    idle = p.payment[action] + p.discount[action] * b.idle[left - 1]
    before, stood, ahead = touched(p, state, action)
    for outcome in range(p.outcome_start[rule], p.outcome_start[rule + 1]):
        if p.probability[outcome] == 0.0:
            continue
        decreasing, now, still = before, stood, ahead
        if p.effect_start[outcome] < p.effect_start[outcome + 1]:
            for v in range(len(state)):
                after[v] = state[v]
            apply(p, after, outcome)
            decreasing, now, still = touched(p, after, action)
        now += standing - stood
        paid = before - decreasing - p.outcome_cost[outcome]
        value += p.probability[outcome] * (p.payment[action] * paid + idle * now)
        early += p.probability[outcome] * (left * (ahead - still + now) + standing_earliness(left - 1) * now)
    return value - p.payment[action] * p.cost[action], early


@inner
def _greedy(p: Process, b: Bases, state: Ints, left: int, standing: float) -> int:
    """The action that is worth most if nothing comes after it; -1 where stopping is worth as much."""
    best, most = -1, standing * b.idle[left] + AS_GOOD
    for action in range(len(p.cost)):
        rule = choosable(p, state, action)
        if rule >= 0:
            value, _ = one_step(p, b, state, action, rule, left, standing)
            if value > most:
                best, most = action, value
    return best


@inner
def next_place(p: Process, b: Bases, state: Ints, place: int) -> int:
    """Where the retried sequence goes on: at the first action from a place on that may change the state."""
    while place < len(b.sequence) and choosable(p, state, b.sequence[place]) < 0:
        place += 1
    return place


@inner
def chosen(p: Process, b: Bases, state: Ints, base: int, place: int, left: int, standing: float) -> int:
    """What a base policy does in a state; -1 to stop. `place` is how far in its sequence it is."""
    if base == GREEDY:
        return _greedy(p, b, state, left, standing)
    if base == LIST:
        for i in range(len(b.priority)):
            if choosable(p, state, b.priority[i]) >= 0:
                return int(b.priority[i])
        return -1
    if base == STOP or place >= len(b.sequence):
        return -1
    return int(b.sequence[place])


@inner
def rollout(
    p: Process, b: Bases, state: Ints, base: int, place: int, left: int, standing: float, stream: np.uint64
) -> tuple[float, float]:
    """Discounted reward of a base policy in a run, and its earliness; changes the state."""
    value, early, factor = 0.0, 0.0, 1.0
    while left > 0:
        if base == RETRIED:
            place = next_place(p, b, state, place)
        action = chosen(p, b, state, base, place, left, standing)
        if action < 0:
            break
        stream += GOLDEN
        rule = covering(p, state, action)
        outcome = -1 if rule < 0 else draw(p, rule, uniform(stream))
        changed = outcome >= 0 and p.effect_start[outcome] < p.effect_start[outcome + 1]
        if base == TAIL or changed:
            place += 1
        paid, rise, progress = carry_out(p, state, action, outcome)
        standing += rise
        value += factor * p.payment[action] * (paid + standing)
        early += left * (progress + standing)
        factor *= p.discount[action]
        left -= 1
    rest = standing * b.idle[left]
    return value + factor * rest, early + standing * standing_earliness(left)


@inner
def mean_rollout(
    p: Process, b: Bases, state: Ints, base: int, place: int, left: int, runs: int, seed: np.uint64
) -> tuple[float, float]:
    """Means of `rollout` over runs of a seed, of which run i depends on the seed and i alone. Works in the
    scratch."""
    value, early, standing, run = 0.0, 0.0, rewarded(p, state)[1], b.scratch[1]
    for i in range(runs):
        for v in range(len(state)):
            run[v] = state[v]
        paid, soon = rollout(p, b, run, base, place, left, standing, split(seed, np.uint64(i)))
        value += paid
        early += soon
    return value / runs, early / runs


@compiled
def next_choice(p: Process, b: Bases, state: Ints, base: int, place: int, left: int) -> tuple[int, int]:
    """Where in its sequence a base policy goes on in a state, and what it does; -1 to stop."""
    if base == RETRIED:
        place = next_place(p, b, state, place)
    return place, chosen(p, b, state, base, place, left, rewarded(p, state)[1])
