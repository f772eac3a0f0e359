"""How well rules explain transitions, and how much they say: what rules are compared by.

The score is that of Pasula, Zettlemoyer and Kaelbling (2007, §4): the log-likelihood of the transitions less
half a nat for each literal. Noise makes a transition with the probability of its results that learning takes
(`RESULTS_OF_NOISE`), for each fact that changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cleancli.array_types import Bools, Floats, Longs
from cleancli.language.model import (
    Assign,
    Condition,
    Domain,
    ForAll,
    Outcome,
    OutcomeKind,
    Quantified,
    Rule,
    Shift,
    Term,
)
from cleancli.learning.edits import is_written
from cleancli.learning.explained import RESULTS_OF_NOISE
from cleancli.learning.structure.arrays import UNDEFINED, ActionArrays, Arrays, holds, index_of, ranging
from cleancli.learning.structure.mixture import fitted
from cleancli.learning.structure.sets import fits
from cleancli.learning.structure.terms import Effect, Named, named

PER_LITERAL = 0.5
"""The paper's α, in nats."""
IMPOSSIBLE = 1e-3
"""How likely it is taken to be that anything happens that rules do not allow; chosen."""


@dataclass(frozen=True, slots=True)
class Score:
    """Of transitions by rules: how many there are, the logarithm of their likelihood, the literals of the
    rules, the total variation between what they foretell and what happened, in the mean, and in how many
    something happened that they do not foretell."""

    transitions: int = 0
    log_likelihood: float = 0.0
    literals: int = 0
    variation: float = 0.0
    unforetold: int = 0

    @property
    def score(self) -> float:
        """In nats; more is better."""
        return self.log_likelihood - PER_LITERAL * self.literals


def together(scores: Sequence[Score]) -> Score:
    """The score of all transitions by all rules."""
    number = sum(each.transitions for each in scores)
    off = sum(each.variation * each.transitions for each in scores)
    return Score(
        number,
        sum(each.log_likelihood for each in scores),
        sum(each.literals for each in scores),
        off / number if number else 0.0,
        sum(each.unforetold for each in scores),
    )


def scored(domain: Domain, action: str, given: ActionArrays, refitted: bool = False) -> Score:
    """The score of an action's transitions by the domain's rules for it; where `refitted`, with those
    probabilities of its outcomes that make the transitions likeliest, and with such a default rule where the
    domain has none."""
    explained, foretold = _foretold(domain, action, given, refitted)
    literals = sum(literals_of(rule) for rule in domain.rules if rule.action == action)
    impossible = np.log(IMPOSSIBLE) - np.log(RESULTS_OF_NOISE) * np.maximum(given.arrays.changed, 1)
    logs = np.log(explained, out=impossible, where=explained > 0)
    off = float((1 - foretold).mean()) if len(foretold) else 0.0
    return Score(len(logs), float(logs.sum()), literals, off, int((foretold == 0).sum()))


def literals_of(rule: Rule) -> int:
    """How many literals a rule has: in its condition, its references and its effects."""
    effects = [effect for outcome in rule.outcomes for effect in outcome.effects]
    inner = [len(each.condition) + len(each.effects) if isinstance(each, ForAll) else 1 for each in effects]
    return _literals(rule.condition) + sum(_literals(each.condition) for each in rule.references) + sum(inner)


def _literals(condition: Condition) -> int:
    return sum(len(part.condition) if isinstance(part, Quantified) else 1 for part in condition)


def _by_noise(arrays: Arrays) -> Floats:
    """How likely noise makes each transition (n,)."""
    found: Floats = (1 / RESULTS_OF_NOISE) ** np.maximum(arrays.changed, 1.0)
    return found


def _foretold(domain: Domain, action: str, given: ActionArrays, refitted: bool) -> tuple[Floats, Floats]:
    """How likely rules make each transition, (n,), and how likely they foretell the state after: as planners
    read it, by whom noise is taken to change nothing."""
    arrays, noise = given.arrays, _by_noise(given.arrays)
    still = arrays.changed == 0
    explained, foretold = np.zeros(arrays.size), still.astype(float)
    left: Bools = np.ones(arrays.size, dtype=bool)
    for rule in domain.rules:
        if rule.action == action:
            known, covered = bound(rule, given)
            may, stated = _of_outcomes(rule, arrays, known)
            made = np.column_stack([may, noise])[covered]
            if refitted and len(made):
                start = (stated > 0) / (stated > 0).sum()
                stated = fitted(np.ones((1, len(made))), made, start)[0]
            explained[covered] = made @ stated
            foretold[covered] = (may @ stated[:-1] + stated[-1] * still)[covered]
            left &= ~covered
    odd = _odd(domain, still[left], refitted)
    explained[left] = np.where(still, 1 - odd, 0.0)[left] + odd * noise[left]
    return explained, foretold


def _odd(domain: Domain, still: Bools, refitted: bool) -> float:
    """How likely it is that noise happens where no rule covers an action; in such transitions nothing has
    changed where `still`. Where `refitted` it is their share, if the domain has no default rule to say it."""
    if refitted and not any(map(is_written, domain.default)):
        return float(1 - still.mean()) if len(still) else 0.0
    return float(sum(each.probability for each in domain.default if each.kind is OutcomeKind.NOISE))


def bound(rule: Rule, given: ActionArrays) -> tuple[Named, Bools]:
    """What a rule's variables stand for in each transition, and which of them it covers."""
    known = named(given, rule.variables)
    arrays = given.arrays
    covered = np.broadcast_to(holds(arrays, rule.condition, index_of(arrays, known.columns)), (arrays.size,))
    for reference in rule.references:
        index = {term: np.maximum(column, 0) for term, column in known.columns.items()}
        ranged, typed = ranging(arrays, index, reference.variables)
        found = np.broadcast_to(
            typed & holds(arrays, reference.condition, ranged),
            (arrays.size, *(arrays.places,) * len(reference.variables)),
        ).reshape(arrays.size, -1)
        unique = found.sum(axis=1) == 1
        covered = covered & unique
        places = np.unravel_index(found.argmax(axis=1), (arrays.places,) * len(reference.variables))
        columns: dict[Term, Longs] = {
            variable: np.where(unique, place, UNDEFINED)
            for variable, place in zip(reference.variables, places, strict=True)
        }
        known = replace(known, columns={**known.columns, **columns})
    return known, covered


def _of_outcomes(rule: Rule, arrays: Arrays, known: Named) -> tuple[Bools, Floats]:
    """Which outcomes of a rule may have made which transitions, those of noise left out, and how likely they
    are, noise at the end."""
    plain = [each for each in rule.outcomes if each.kind is not OutcomeKind.NOISE]
    may = fits(arrays, known, [frozenset(_single(each)) for each in plain])
    odd = sum(float(each.probability) for each in rule.outcomes if each.kind is OutcomeKind.NOISE)
    return may, np.array([*(float(each.probability) for each in plain), odd])


def _single(outcome: Outcome) -> list[Effect]:
    """The effects of an outcome, each `forall` with one effect."""
    found: list[Effect] = []
    for effect in outcome.effects:
        if isinstance(effect, ForAll):
            inner: tuple[Assign | Shift, ...] = effect.effects
            found += [replace(effect, effects=(each,)) for each in inner]
        else:
            found.append(effect)
    return found
