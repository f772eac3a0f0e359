"""Simulated annealing over action sequences, valued by 64 rollouts a machine word (compiled).

Runs are bits: for each value of each variable a word says in which of 64 runs the variable has it. A rule's
condition is then a few operations on words, for 64 runs at once, and so is what an outcome sets. What is
drawn belongs to a run, a rule and how often its action stands before in the sequence; so sequences meet the
same random numbers wherever they do the same, and the difference of their values is hardly noise. A
sequence is changed in one place at a time, and only what follows that place is run again.
Guaranteed by `lower` and `lower_process`: indices are in range, at most one rule of an action covers a state.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cleancli.array_types import Floats, Ints, Longs, Words
from cleancli.compiler.lowering.state_tables import Process
from cleancli.planning.kernels.jit import better, compiled, inlined, inner, standing_earliness
from cleancli.planning.kernels.rng import GOLDEN, mixed, uniform
from cleancli.planning.preference import AS_GOOD

TRIES = 100
"""Actions looked at until one is found that can change a run."""

DIGITS = 24
"""Binary digits of a probability that draws keep: an error of 6e-8 at most."""

INSERT, REPLACE, DELETE, MOVE = 0, 1, 2, 3

NONE, ALL = np.uint64(0), np.uint64(0xFFFFFFFFFFFFFFFF)


class Runs(NamedTuple):
    """64 W runs of a sequence of up to H actions, before each step and after the last, over S slots.

    Each row exists twice, for what is and for what is tried; `row` says which of them is.
    """

    word: Words  # (2, H + 1, S, W) in which runs each slot holds
    standing: Floats  # (2, H + 1) what doing nothing is paid there, in the mean
    total: Floats  # (2, H + 1) mean value of the steps before
    early: Floats  # (2, H + 1) mean earliness of the steps before (planning/preference.py)
    factor: Floats  # (2, H + 1) discount of the steps from there on
    row: Ints  # (H + 1,)


class CommonRandomNumbers(NamedTuple):
    """Outcomes that were drawn, kept as long as no others need the place (E, a power of 2)."""

    key: Longs  # (E,) of which rule and use of its action; -1 where nothing is kept
    word: Words  # (E, M, W) in which runs each of up to M outcomes comes


class Scratch(NamedTuple):
    """Space for sequences of up to H actions."""

    current: Ints  # (H + 1,)
    trial: Ints  # (H + 1,)


@inlined
def _ones(word: np.uint64) -> int:
    """How many bits are set."""
    word = word - ((word >> np.uint64(1)) & np.uint64(0x5555555555555555))
    pairs = word & np.uint64(0x3333333333333333)
    word = pairs + ((word >> np.uint64(2)) & np.uint64(0x3333333333333333))
    word = (word + (word >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return int((word * np.uint64(0x0101010101010101)) >> np.uint64(56))


@inlined
def _held(p: Process, word: Words, row: int, place: int, condition: int, w: int) -> np.uint64:
    """In which of 64 runs a condition holds."""
    held = ALL
    for literal in range(p.literal_start[condition], p.literal_start[condition + 1]):
        either = NONE
        for i in range(p.literal_slot_start[literal], p.literal_slot_start[literal + 1]):
            either |= word[row, place, p.literal_slot[i], w]
        held &= either
    return held


@inner
def _drawn(probability: float, stream: np.uint64) -> np.uint64:
    """A word whose bits are each set with the probability: its binary digits, from the last on, say whether
    a random word is joined by `or` or by `and`."""
    digits = int(probability * (1 << DIGITS) + 0.5)
    if digits >= 1 << DIGITS:
        return ALL
    word = NONE
    for place in range(DIGITS):
        stream += GOLDEN
        if (digits >> place) % 2:
            word |= mixed(stream)
        elif word != NONE:
            word &= mixed(stream)
    return word


@inner
def _outcomes(p: Process, common: CommonRandomNumbers, rule: int, use: int, seed: np.uint64) -> int:
    """Where in `common` it stands in which runs each outcome of a rule comes, at this use of its action."""
    key = rule * 4096 + use
    entry = int(mixed(np.uint64(key)) % np.uint64(len(common.key)))
    if common.key[entry] == key:
        return entry
    common.key[entry] = key
    first, last = p.outcome_start[rule], p.outcome_start[rule + 1] - 1
    for w in range(common.word.shape[2]):
        left, rest = ALL, 1.0
        for outcome in range(first, last):
            stream = (
                mixed(seed + np.uint64(key) * GOLDEN) + np.uint64(w * 1024 + (outcome - first) * 32) * GOLDEN
            )
            share = p.probability[outcome] / rest if rest > p.probability[outcome] else 1.0
            comes = left & _drawn(share, stream)
            common.word[entry, outcome - first, w] = comes
            left &= ~comes
            rest -= p.probability[outcome]
        common.word[entry, last - first, w] = left
    return entry


@inner
def _paid(p: Process, runs: Runs, row: int, place: int, action: int) -> tuple[float, float, float]:
    """What all runs are paid for its decrease and for their states, and whose decrease is progress, as far as
    the action can change it."""
    rules, decreasing, standing, ahead = len(p.rule_useful), 0.0, 0.0, 0.0
    for i in range(p.touched_reward_start[action], p.touched_reward_start[action + 1]):
        c, number = p.touched_reward[i], 0
        for w in range(runs.word.shape[3]):
            number += _ones(_held(p, runs.word, row, place, rules + c, w))
        decreasing += p.decrease[c] * number
        standing += p.state[c] * number
        ahead += p.advance[c] * number
    return decreasing, standing, ahead


@inner
def _set(p: Process, word: Words, row: int, place: int, outcome: int, w: int, runs: np.uint64) -> None:
    """Changes what holds in some of 64 runs as an outcome says."""
    for i in range(p.effect_start[outcome], p.effect_start[outcome + 1]):
        variable = p.effect_variable[i]
        first = p.slot_start[variable]
        for slot in range(first, p.slot_start[variable + 1]):
            word[row, place, slot, w] &= ~runs
        word[row, place, first + p.effect_value[i], w] |= runs


@inner
def _act(
    p: Process,
    runs: Runs,
    common: CommonRandomNumbers,
    source: int,
    target: int,
    place: int,
    action: int,
    use: int,
    seed: np.uint64,
) -> tuple[bool, float]:
    """Draws what the action does in each run; whether it changes one, or is a choice in one that waits, and
    what the outcomes cost in all runs."""
    word, useful, spent = runs.word, False, 0.0
    for rule in range(p.rule_start[action], p.rule_start[action + 1]):
        if not (p.rule_useful[rule] or p.rule_pays[rule]):
            continue
        for w in range(word.shape[3]):
            held = _held(p, word, source, place, rule, w)
            if held == NONE:
                continue
            useful |= p.waiting[0]
            entry = _outcomes(p, common, rule, use, seed)
            first = p.outcome_start[rule]
            for outcome in range(first, p.outcome_start[rule + 1]):
                comes = held & common.word[entry, outcome - first, w]
                if p.outcome_cost[outcome] != 0.0:
                    spent += p.outcome_cost[outcome] * _ones(comes)
                if comes != NONE and p.effect_start[outcome] < p.effect_start[outcome + 1]:
                    _set(p, word, target, place + 1, outcome, w, comes)
                    useful = True
    return useful, spent


@inner
def _run(
    p: Process,
    runs: Runs,
    common: CommonRandomNumbers,
    actions: Ints,
    length: int,
    start: int,
    trial: int,
    seed: np.uint64,
) -> int:
    """Runs the actions from place `start` on; returns the first of them that was of no use in any run, or -1.

    With `trial` 1 the rows of what is stay as they are, with 0 they are overwritten.
    """
    word, row, useless = runs.word, runs.row, -1
    slots, words, horizon = word.shape[2], word.shape[3], word.shape[1] - 1
    for place in range(start, length):
        action = actions[place]
        source = row[place] if place == start else (row[place] + trial) % 2
        target = (row[place + 1] + trial) % 2
        for slot in range(slots):
            for w in range(words):
                word[target, place + 1, slot, w] = word[source, place, slot, w]
        use = 0
        for earlier in range(place):
            use += actions[earlier] == action
        useful, spent = _act(p, runs, common, source, target, place, action, use, seed)
        gain, progress = -p.cost[action] - spent / (64 * words), 0.0
        standing = runs.standing[source, place]
        if useful:
            before, stood, ahead = _paid(p, runs, source, place, action)
            after, stands, still = _paid(p, runs, target, place + 1, action)
            gain += (before - after) / (64 * words)
            progress = (ahead - still) / (64 * words)
            standing += (stands - stood) / (64 * words)
        elif useless < 0:
            useless = place
        factor = runs.factor[source, place]
        runs.standing[target, place + 1] = standing
        runs.total[target, place + 1] = runs.total[source, place] + factor * p.payment[action] * (
            gain + standing
        )
        runs.early[target, place + 1] = runs.early[source, place] + (horizon - place) * (progress + standing)
        runs.factor[target, place + 1] = factor * p.discount[action]
    return useless


@inner
def _worth(runs: Runs, length: int, row: int, idle: Floats) -> float:
    """The mean value of the runs of a sequence whose last states stand in a row; `idle` as in states.py."""
    rest = runs.word.shape[1] - 1 - length
    worth: float = (
        runs.total[row, length] + runs.factor[row, length] * runs.standing[row, length] * idle[rest]
    )
    return worth


@inner
def _earliness(runs: Runs, length: int, row: int) -> float:
    """The mean earliness of the runs of a sequence whose last states stand in a row."""
    rest = runs.word.shape[1] - 1 - length
    earliness: float = runs.early[row, length] + runs.standing[row, length] * standing_earliness(rest)
    return earliness


@inner
def _proposed(p: Process, runs: Runs, place: int, stream: np.uint64) -> int:
    """An action that is a choice in one of the runs before a place; -1 if none is met."""
    row, actions, words = runs.row[place], len(p.rule_start) - 1, runs.word.shape[3]
    for _ in range(TRIES):
        stream += GOLDEN
        bits = mixed(stream)
        action = int((bits >> np.uint64(32)) % np.uint64(actions))
        run, w = bits & np.uint64(63), int((bits >> np.uint64(6)) % np.uint64(words))
        for rule in range(p.rule_start[action], p.rule_start[action + 1]):
            if p.rule_useful[rule] and (_held(p, runs.word, row, place, rule, w) >> run) & np.uint64(1):
                return action
    return -1


@inner
def _copy(source: Ints, start: int, end: int, target: Ints, place: int) -> None:
    for i in range(start, end):
        target[place + i - start] = source[i]


@inner
def _change(p: Process, runs: Runs, s: Scratch, length: int, stream: np.uint64) -> tuple[int, int]:
    """Writes a changed sequence to `trial`; its length, and the first place that differs (-1: no change)."""
    current, trial, horizon = s.current, s.trial, runs.word.shape[1] - 1
    kind, place = int(uniform(stream) * 4), int(uniform(stream + np.uint64(1)) * (length + 1))
    _copy(current, 0, length, trial, 0)
    if kind == INSERT and length < horizon:
        trial[place] = _proposed(p, runs, place, stream)
        _copy(current, place, length, trial, place + 1)
        return length + 1, place if trial[place] >= 0 else -1
    if place == length:
        return length, -1
    if kind == REPLACE:
        trial[place] = _proposed(p, runs, place, stream)
        return length, place if trial[place] >= 0 and trial[place] != current[place] else -1
    if kind == DELETE:
        _copy(current, place + 1, length, trial, place)
        return length - 1, place
    other = int(uniform(stream + np.uint64(2)) * length)
    if kind == MOVE and other != place:
        if other < place:
            _copy(current, other, place, trial, other + 1)
        else:
            _copy(current, place + 1, other + 1, trial, place)
        trial[other] = current[place]
        return length, min(place, other)
    return length, -1


@compiled
def begin(p: Process, runs: Runs, common: CommonRandomNumbers, state: Ints) -> None:
    """Puts all runs into a state, and forgets what was drawn."""
    rules, words = len(p.rule_useful), runs.word.shape[3]
    for variable in range(len(state)):
        for slot in range(p.slot_start[variable], p.slot_start[variable + 1]):
            for w in range(words):
                runs.word[0, 0, slot, w] = ALL if slot - p.slot_start[variable] == state[variable] else NONE
    standing = p.constant[0]
    for c in range(len(p.state)):
        if _held(p, runs.word, 0, 0, rules + c, 0) == ALL:
            standing += p.state[c]
    runs.standing[0, 0], runs.total[0, 0], runs.factor[0, 0], runs.early[0, 0] = standing, 0.0, 1.0, 0.0
    for place in range(len(runs.row)):
        runs.row[place] = 0
    for entry in range(len(common.key)):
        common.key[entry] = -1


@compiled
def worth(
    p: Process, runs: Runs, common: CommonRandomNumbers, actions: Ints, idle: Floats, seed: np.uint64
) -> tuple[float, float]:
    """Mean discounted reward of a sequence over the runs of a seed, from the state in which they begin, and
    its earliness."""
    _run(p, runs, common, actions, len(actions), 0, 0, seed)
    return _worth(runs, len(actions), 0, idle), _earliness(runs, len(actions), 0)


@compiled
def anneal(
    p: Process,
    runs: Runs,
    common: CommonRandomNumbers,
    s: Scratch,
    length: int,
    best: Ints,
    idle: Floats,
    moves: int,
    heat: float,
    seed: np.uint64,
) -> int:
    """Tries `moves` changes of `s.current`, and leaves the best sequence met in `best`; returns its length.

    A loss is accepted with probability exp(loss / warmth); the warmth falls to 0 from `heat` times what an
    action of the best sequence adds to doing nothing. Of equals the later are accepted too, but not in the
    last quarter: many a gain is reached by way of an equal. The runs have begun.
    """
    nothing = _worth(runs, 0, 0, idle)
    _run(p, runs, common, s.current, length, 0, 0, seed)
    value, early = _worth(runs, length, 0, idle), _earliness(runs, length, 0)
    _copy(s.current, 0, length, best, 0)
    best_length, best_value, best_early = length, value, early
    stream = mixed(seed + GOLDEN)
    for move in range(moves):
        stream = mixed(stream + GOLDEN)
        new, start = _change(p, runs, s, length, stream)
        if start < 0:
            continue
        useless = _run(p, runs, common, s.trial, new, start, 1, seed)
        row = (runs.row[new] + 1) % 2 if new > start else runs.row[new]
        tried, soon = _worth(runs, new, row, idle), _earliness(runs, new, row)
        warmth = heat * (best_value - nothing) / max(best_length, 1) * (1.0 - move / moves)
        if tried - value < warmth * np.log(1.0 - uniform(stream + np.uint64(3))):
            continue
        if 4 * move >= 3 * moves and abs(tried - value) <= AS_GOOD and soon < early - AS_GOOD:
            continue
        for place in range(start + 1, new + 1):
            runs.row[place] = 1 - runs.row[place]
        _copy(s.trial, 0, new, s.current, 0)
        length, value, early = new, tried, soon
        if useless >= 0:
            _copy(s.trial, useless + 1, length, s.current, useless)
            length -= 1
            _run(p, runs, common, s.current, length, useless, 0, seed)
            value = _worth(runs, length, runs.row[length], idle)
            early = _earliness(runs, length, runs.row[length])
        shorter = length < best_length and not better(best_value, best_early, value, early)
        if shorter or better(value, early, best_value, best_early):
            best_length, best_value, best_early = length, value, early
            _copy(s.current, 0, length, best, 0)
    return best_length
