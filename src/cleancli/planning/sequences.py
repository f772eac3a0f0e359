"""Annealing over action sequences, each valued by the same drawn runs of the process (compiled).

A sequence is changed in one place at a time, and only what follows that place is run again: the states of all
runs before each step are kept. A draw belongs to a run, an action and how often the action stands before it
in the sequence, so sequences meet the same luck wherever they do the same, and their difference is no noise.
Guaranteed by `lower_process`: indices are in range, and at most one rule of an action covers a state.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from cleancli.compiler.process import Process
from cleancli.compiler.ragged import Floats, Ints
from cleancli.planning import states
from cleancli.planning.stream import GOLDEN, mixed, uniform

TRIES = 100
"""Actions looked at until one is found that can change a run."""

INSERT, REPLACE, DELETE, MOVE = 0, 1, 2, 3


class Runs(NamedTuple):
    """N runs of a sequence of up to H actions over V variables, before each step and after the last.

    Each row exists twice, for what is and for what is tried; `row` says which is which.
    """

    state: NDArray[np.int32]  # (2, H + 1, N, V)
    standing: Floats  # (2, H + 1, N) what doing nothing is paid there
    total: Floats  # (2, H + 1) mean value of the steps before
    factor: Floats  # (2, H + 1) discount of the steps from there on
    row: Ints  # (H + 1,)


class Sequence(NamedTuple):
    """Scratch space for sequences of up to H actions."""

    current: Ints  # (H + 1,)
    trial: Ints  # (H + 1,)


@njit(cache=True, nogil=True)
def _run(p: Process, runs: Runs, actions: Ints, length: int, start: int, trial: int, seed: np.uint64) -> int:
    """Runs the actions from place `start` on; returns the first of them that changed no run, or -1.

    With `trial` 1 the rows of what is stay as they are, with 0 they are overwritten.
    """
    state, standing, row, idle = runs.state, runs.standing, runs.row, -1
    number = state.shape[2]
    for place in range(start, length):
        action = actions[place]
        source = row[place] if place == start else (row[place] + trial) % 2
        target = (row[place + 1] + trial) % 2
        earlier = 0
        for j in range(place):
            earlier += actions[j] == action
        stream = mixed(seed + np.uint64(action * 4096 + earlier) * GOLDEN)
        before, after = state[source, place], state[target, place + 1]
        paid, changed = 0.0, False
        for i in range(number):
            after[i] = before[i]
            stream += GOLDEN
            rule = states.covering(p, after[i], action)
            gain, rise = -p.cost[action], 0.0
            if rule >= 0:
                outcome = states.draw(p, rule, uniform(stream))
                if p.effect_start[outcome] < p.effect_start[outcome + 1]:
                    gain, rise = states.follow(p, after[i], action, outcome)
                    changed = True
            now = standing[source, place, i] + rise
            standing[target, place + 1, i] = now
            paid += gain + now
        if not changed and idle < 0:
            idle = place
        factor = runs.factor[source, place]
        runs.total[target, place + 1] = runs.total[source, place] + factor * p.payment[action] * paid / number
        runs.factor[target, place + 1] = factor * p.discount[action]
    return idle


@njit(cache=True, nogil=True)
def _worth(runs: Runs, length: int, row: int, idle: Floats) -> float:
    """The mean value of the runs of a sequence whose last states stand in a row; `idle` as in states.py."""
    number, rest = runs.state.shape[2], runs.state.shape[1] - 1 - length
    standing = 0.0
    for i in range(number):
        standing += runs.standing[row, length, i]
    return float(runs.total[row, length] + runs.factor[row, length] * standing / number * idle[rest])


@njit(cache=True, nogil=True)
def _proposed(p: Process, runs: Runs, place: int, stream: np.uint64) -> int:
    """An action that can change one of the runs before a place, each as likely as it can; -1 if none is met."""
    before, actions = runs.state[runs.row[place], place], len(p.rule_start) - 1
    for _ in range(TRIES):
        stream += GOLDEN
        bits = mixed(stream)
        action = int(np.uint64(bits >> np.uint64(32)) % np.uint64(actions))
        run = int(np.uint64(bits & np.uint64(0xFFFFFFFF)) % np.uint64(before.shape[0]))
        rule = states.covering(p, before[run], action)
        if rule >= 0 and p.rule_changes[rule]:
            return action
    return -1


@njit(cache=True, nogil=True)
def _change(p: Process, runs: Runs, s: Sequence, length: int, stream: np.uint64) -> tuple[int, int]:
    """Writes a changed sequence to `trial`; its length, and the first place that differs (-1: no change)."""
    current, trial, horizon = s.current, s.trial, runs.state.shape[1] - 1
    kind, place = int(uniform(stream) * 4), int(uniform(stream + np.uint64(1)) * (length + 1))
    trial[:length] = current[:length]
    if kind == INSERT and length < horizon:
        trial[place] = _proposed(p, runs, place, stream)
        trial[place + 1 : length + 1] = current[place:length]
        return length + 1, place if trial[place] >= 0 else -1
    if place == length:
        return length, -1
    if kind == REPLACE:
        trial[place] = _proposed(p, runs, place, stream)
        return length, place if trial[place] >= 0 and trial[place] != current[place] else -1
    if kind == DELETE:
        trial[place : length - 1] = current[place + 1 : length]
        return length - 1, place
    other = int(uniform(stream + np.uint64(2)) * length)
    if kind == MOVE and other != place:
        if other < place:
            trial[other + 1 : place + 1] = current[other:place]
        else:
            trial[place:other] = current[place + 1 : other + 1]
        trial[other] = current[place]
        return length, min(place, other)
    return length, -1


@njit(cache=True, nogil=True)
def anneal(
    p: Process,
    runs: Runs,
    s: Sequence,
    length: int,
    best: Ints,
    idle: Floats,
    moves: int,
    heat: float,
    seed: np.uint64,
) -> tuple[int, float]:
    """Tries `moves` changes of `s.current`, and leaves the best sequence met in `best` (H,).

    Returns its length and mean value over the runs. A loss is accepted with probability exp(loss / heat); the
    heat falls to 0. The rows of place 0 hold the initial state.
    """
    _run(p, runs, s.current, length, 0, 0, seed)
    value = _worth(runs, length, runs.row[length], idle)
    best[:length] = s.current[:length]
    best_length, best_value = length, value
    stream = mixed(seed + GOLDEN)
    for move in range(moves):
        stream = mixed(stream + GOLDEN)
        new, start = _change(p, runs, s, length, stream)
        if start < 0:
            continue
        useless = _run(p, runs, s.trial, new, start, 1, seed)
        row = (runs.row[new] + 1) % 2 if new > start else runs.row[new]
        tried = _worth(runs, new, row, idle)
        warmth = heat * (1.0 - move / moves)
        if tried < value and uniform(stream + np.uint64(3)) >= np.exp((tried - value) / max(warmth, 1e-300)):
            continue
        for place in range(start + 1, new + 1):
            runs.row[place] = 1 - runs.row[place]
        s.current[:new] = s.trial[:new]
        length, value = new, tried
        if useless >= 0:
            s.current[useless : length - 1] = s.trial[useless + 1 : length]
            length -= 1
            _run(p, runs, s.current, length, useless, 0, seed)
            value = _worth(runs, length, runs.row[length], idle)
        if value > best_value:
            best_length, best_value = length, value
            best[:length] = s.current[:length]
    return best_length, best_value
