"""Which outcomes an action has, and which of them a set of its transitions.

An outcome is worth its place where it shortens a description in two parts (Rissanen 1978): the transitions,
which take the negative logarithm of their likelihood, and what is said of them. Over all n transitions of an
action each probability takes half a logarithm of n, and an outcome, for its effects and itself, the logarithm
of how many effects there are. A transition that only noise makes is told fact by fact.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Bools, Floats, Longs
from cleancli.learning.explained import RESULTS_OF_NOISE
from cleancli.learning.structure.arrays import Arrays
from cleancli.learning.structure.effects import raw_outcomes
from cleancli.learning.structure.mixture import FEW_ROUNDS, SOME_ROUNDS, fitted, log_likelihoods
from cleancli.learning.structure.sets import UNFIT, Change, Outcome, mismatches
from cleancli.learning.structure.terms import Named

MOST_OUTCOMES = 30
"""Different results of an action that are looked at, the most frequent ones; chosen."""
MOST_EFFECTS = 50
"""Effects of a result above which it is no outcome: to say that many costs more than noise does which tells
of what happened once fact by fact. Chosen."""
FLICKER = 0.002
"""The share of facts that no outcome explains from which on these are taken to flicker, each by itself, and
not for noise; chosen."""
MOST_FLICKER = 0.5
"""The chance that a fact is seen wrongly by which seeing it says nothing; no more is believed."""
MOST_WRONG = 4
"""Facts about which an outcome is wrong beside the best one, above which it counts as so much; chosen."""
MOST_JOINED = 8
"""Of these the ones that are tried in pairs, as one result that in some states looks like either; chosen."""


@dataclass(frozen=True, slots=True, eq=False)
class Possible:
    """The outcomes of an action, and noise as the last: how likely each makes a transition of each pattern
    (patterns, outcomes + 1), and the pattern of each transition (n,)."""

    outcomes: tuple[Outcome, ...]
    likelihoods: Floats
    pattern: Longs

    def counts(self, rows: Longs | Bools) -> Floats:
        """How many transitions of these rows have each pattern."""
        return np.bincount(self.pattern[rows], minlength=len(self.likelihoods)).astype(float)

    def only(self, kept: Sequence[int]) -> Possible:
        """With these outcomes alone, and noise."""
        chosen = tuple(self.outcomes[each] for each in kept)
        return _possible(chosen, self.likelihoods[:, [*kept, -1]], self.pattern)


def possible(arrays: Arrays, known: Named, changes: Sequence[Change]) -> Possible:
    """All outcomes that may have made a transition of an action."""
    raw = raw_outcomes(arrays, known, changes)
    raw.setdefault(frozenset(), 0)
    short = [each for each in raw if len(each) <= MOST_EFFECTS]
    listed = sorted(short, key=lambda each: (-raw[each], len(each), sorted(map(str, each))))[:MOST_OUTCOMES]
    joined = [one | other for one, other in itertools.combinations(listed[:MOST_JOINED], 2)]
    listed += [each for each in dict.fromkeys(joined) if each not in raw]
    wrong = mismatches(arrays, known, listed)
    noise = (1 / RESULTS_OF_NOISE) ** np.maximum(arrays.changed, 1.0)
    least = wrong.min(axis=1)
    flicker = min(float(least.sum()) / max(arrays.facts, 1), MOST_FLICKER)
    if flicker < FLICKER:
        likelihoods = np.column_stack([wrong == 0, noise])
    else:
        odds = flicker / (1 - flicker)
        beside = np.minimum(wrong - least[:, None], MOST_WRONG)
        exact = np.where(wrong == UNFIT, 0.0, odds**beside)
        likelihoods = np.column_stack([exact, np.zeros(arrays.size)])
    useful = [number for number in range(len(listed)) if (wrong[:, number] == least).any()]
    listed = [listed[number] for number in useful]
    return _possible(tuple(listed), likelihoods[:, [*useful, -1]], np.arange(arrays.size))


def needed(found: Possible) -> Possible:
    """The outcomes that are worth their description over all transitions of an action."""
    listed, number = found.outcomes, len(found.pattern)
    effects = {effect for outcome in listed for effect in outcome}
    of_effects = np.log(len(effects) + 1)
    costs = np.array([of_effects * (1 + len(outcome)) for outcome in listed]) + 0.5 * np.log(number)
    return found.only(chosen(found, found.counts(np.arange(number)), costs)[0])


def by_default(possible: Possible, rows: Longs | Bools) -> float:
    """How likely the default rule makes transitions, as a logarithm: nothing happens, or noise."""
    kinds = [place for place, each in enumerate(possible.outcomes) if not each]
    likelihoods = possible.likelihoods[:, [*kinds, -1]]
    counts = possible.counts(rows)[None]
    start = np.full(likelihoods.shape[1], 1 / likelihoods.shape[1])
    return float(log_likelihoods(counts, likelihoods, fitted(counts, likelihoods, start, FEW_ROUNDS))[0])


def _possible(outcomes: tuple[Outcome, ...], likelihoods: Floats, pattern: Longs) -> Possible:
    """With patterns that differ."""
    unique, inverse = np.unique(likelihoods, axis=0, return_inverse=True)
    return Possible(outcomes, unique, inverse.reshape(-1)[pattern])


def chosen(possible: Possible, counts: Floats, costs: Floats) -> tuple[list[int], Floats]:
    """The outcomes that are worth what they cost in a set of transitions, and their probabilities, with that
    of noise at the end.

    One after the other is left out, as long as that makes the description shorter. `counts` are those of the
    patterns, `costs` in nats those of the outcomes.
    """
    number = len(possible.outcomes)
    kept = np.ones(number + 1, dtype=bool)
    start = np.full(number + 1, 1 / (number + 1))
    has_some = counts > 0
    seen, likely = counts[has_some], possible.likelihoods[has_some]
    beliefs = fitted(seen[None], likely, start, SOME_ROUNDS)[0]
    while kept[:number].any():
        likelihood = log_likelihoods(seen[None], likely, beliefs)
        listed = np.flatnonzero(kept[:number])
        starts = np.tile(np.where(kept, np.maximum(beliefs, 1e-6), 0), (len(listed), 1))
        starts[np.arange(len(listed)), listed] = 0
        starts /= starts.sum(axis=1, keepdims=True)
        sets = np.tile(seen, (len(listed), 1))
        tried = fitted(sets, likely, starts, FEW_ROUNDS)
        gains = log_likelihoods(sets, likely, tried) - likelihood + costs[listed]
        best = int(gains.argmax())
        if gains[best] < 0:
            break
        kept[listed[best]] = False
        beliefs = fitted(seen[None], likely, tried[best], SOME_ROUNDS)[0]
    beliefs = fitted(seen[None], likely, beliefs)[0]
    if not beliefs.any():  # even noise is less likely than a float can tell, where very much changed at once
        beliefs[-1] = 1
    return list(map(int, np.flatnonzero(kept[:number]))), beliefs[[*kept[:number], True]]
