"""Rules as narrow as their failures ask for, to plan by where a teacher can be asked.

Where few transitions were changed by a rule, a condition saves less than `learning.structure` has it cost, so
that the rule foretells a little of everything and nothing surely. Plans then try in vain, in one state after
the other, what the shortest condition that tells successes from failures says is of no use there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
from scipy.special import xlogy

from cleancli.array_types import Bools
from cleancli.language.model import Domain, Outcome, OutcomeKind, Rule
from cleancli.learning.exploration.explored import Explored, ExploredAction
from cleancli.learning.exploration.parts import signed
from cleancli.learning.structure.score import PER_LITERAL


def narrowed(found: Explored) -> Domain:
    """The domain that is believed, each of its rules with what its failures ask for besides."""
    rules = {
        rule: _narrowed(found.domain, known, number)
        for known in found.actions.values()
        for number, rule in enumerate(known.rules)
    }
    return replace(found.domain, rules=tuple(rules.get(rule, rule) for rule in found.domain.rules))


def _narrowed(domain: Domain, known: ExploredAction, number: int) -> Rule:
    rule, own = known.rules[number], known.by == number
    held, changed = known.held[own], known.changed[own]
    if changed.all() or not changed.any():
        return rule
    columns = telling(held, changed)
    inside = held[:, columns].all(axis=1)
    share = Fraction(int(changed.sum()), int(inside.sum()))
    condition = (*rule.condition, *(signed(domain, known.parts, column) for column in columns))
    return replace(rule, condition=condition, outcomes=_with_share(rule.outcomes, share))


def telling(held: Bools, changed: Bools) -> list[int]:
    """Parts that held in all transitions that changed something, one after the other the one without which
    most of the rest changed nothing, as long as it raises the score of Pasula, Zettlemoyer and Kaelbling
    (2007, §4), in which a literal costs half a nat. `held`: (n, parts), `changed`: (n,)."""
    successes = int(changed.sum())
    useful = held[changed].all(axis=0)
    failures = held[~changed]
    chosen: list[int] = []
    while len(failures):
        left = np.where(useful, failures.sum(axis=0), len(failures))
        best = int(left.argmin())
        gain = _log_likelihood(successes, left[best]) - _log_likelihood(successes, len(failures))
        if gain <= PER_LITERAL:
            break
        chosen.append(best)
        failures = failures[failures[:, best]]
    return chosen


def _log_likelihood(successes: int, failures: int) -> float:
    """Of so many successes and failures, by their own share."""
    number = successes + failures
    return float(xlogy(successes, successes / number) + xlogy(failures, failures / number))


def _with_share(outcomes: Sequence[Outcome], share: Fraction) -> tuple[Outcome, ...]:
    """The outcomes with such a share of changes among them, which keep their ratios."""
    changes = [each for each in outcomes if each.kind is OutcomeKind.CHANGE]
    total = sum((each.probability for each in changes), start=Fraction(0))
    likely = tuple(replace(each, probability=each.probability / total * share) for each in changes)
    rest = Outcome(1 - share, OutcomeKind.NOTHING)
    return (*likely, rest) if share < 1 else likely
