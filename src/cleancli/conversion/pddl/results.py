"""What a tree of effects without conditions may come to, and how likely each of that is.

Draws of which no state lets two happen share one draw (`_drawn_apart`); others are multiplied out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from itertools import groupby

from cleancli.conversion.pddl.effect_trees import UNPAID, All, Branch, Chance, Change, Paid, Pay, Tree
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Formula,
    both,
    either,
    quantified,
)

MOST_OUTCOMES = 512
"""Outcomes that one rule may have. Chosen: more than people read, and few enough to plan with."""


MOST_SHARED = 64
"""Draws beside each other of which it is looked up which of them no state lets happen together. Chosen: each
two are compared."""


class TooMany(Exception):
    """An action has more outcomes than `MOST_OUTCOMES`."""


@dataclass(frozen=True, slots=True)
class Result:
    """How likely some changes are, in the order of the text, with what is paid beside them."""

    chance: Fraction
    changes: tuple[Change, ...] = ()
    paid: Paid = UNPAID


Results = tuple[Result, ...]
"""What something may come to, each once."""


MayMeet = Callable[[Formula, Formula], bool]
"""Whether two conditions may hold in one state."""


def results_of(tree: Tree, may_meet: MayMeet | None = None) -> Results:
    """What a tree without conditions but those of its changes may come to, with probabilities that sum to 1.
    `may_meet` tells whether two conditions may hold in one state; None: any two. Raises `TooMany`."""
    match tree:
        case Change():
            return (Result(Fraction(1), (tree,)),)
        case All(parts):
            return reduce(_product, _drawn_apart(parts, may_meet), (Result(Fraction(1)),))
        case Chance(branches):
            rest = 1 - sum((p for p, _ in branches), Fraction(0))
            likely = [
                replace(each, chance=p * each.chance)
                for p, part in branches
                for each in results_of(part, may_meet)
            ]
            return _merged([*likely, *([Result(rest)] if rest else [])])
        case Pay(paid):
            return (Result(Fraction(1), (), paid),)
        case Branch():
            raise AssertionError("conditions are decided before")


def _product(found: Results, others: Results) -> Results:
    """All pairs of results that are drawn independently."""
    if len(found) * len(others) > 64 * MOST_OUTCOMES:
        raise TooMany
    made = _merged([_beside(one, other, one.chance * other.chance) for one in found for other in others])
    if len(made) > MOST_OUTCOMES:
        raise TooMany
    return made


def _beside(one: Result, other: Result, chance: Fraction) -> Result:
    """Both results, which happen together with some probability."""
    return Result(chance, (*one.changes, *other.changes), one.paid + other.paid)


def _drawn_apart(parts: Sequence[Tree], may_meet: MayMeet | None) -> Iterator[Results]:
    """The results of parts that are drawn independently of each other. Parts of which no state lets two
    happen share one draw: of one that happens alone it makes no difference what the others would do."""
    if may_meet is None or len(parts) > MOST_SHARED:
        for is_sure, several in groupby(parts, key=lambda part: isinstance(part, Change)):
            if is_sure:
                yield (Result(Fraction(1), tuple(part for part in several if isinstance(part, Change))),)
            else:
                yield from (results_of(part, may_meet) for part in several)
        return
    groups: list[list[tuple[Formula, Results]]] = []
    for part in parts:
        asked, results = _asked(part), results_of(part, may_meet)
        for group in groups if len(results) > 1 and asked != ALWAYS else ():
            if not any(len(found) == 1 or may_meet(asked, other) for other, found in group):
                group.append((asked, results))
                break
        else:
            groups.append([(asked, results)])
    for group in groups:
        yield _sharing([results for _, results in group])


def _asked(tree: Tree) -> Formula:
    """Where a tree changes or pays anything, whatever chance decides."""
    match tree:
        case Change(variables, guard):
            return quantified(True, variables, guard)
        case All(parts):
            return either(map(_asked, parts))
        case Branch(condition, part):
            return both([condition, _asked(part)])
        case Chance(branches):
            return either(_asked(part) for _, part in branches)
        case Pay(paid):
            return ALWAYS if paid else NEVER


def _sharing(several: Sequence[Results]) -> Results:
    """Results of several draws that one number between 0 and 1 decides: each has its own probabilities. The
    likeliest results come first in each, so that most of them end where those of others do."""
    if len(several) == 1:
        return several[0]
    waiting = [sorted(results, key=lambda each: -each.chance) for results in several]
    found = []
    while waiting[0]:
        chance = min(results[0].chance for results in waiting)
        together = Result(chance)
        for results in waiting:
            together = _beside(together, results[0], chance)
            left = results[0].chance - chance
            results[:1] = [replace(results[0], chance=left)] if left else []
        found.append(together)
    return _merged(found)


def _merged(results: Sequence[Result]) -> Results:
    """Each result once, by what happens."""
    if len(results) == 1:
        return (Result(results[0].chance, tuple(dict.fromkeys(results[0].changes)), results[0].paid),)
    found: dict[tuple[frozenset[Change], Paid], Result] = {}
    for each in results:
        changes = dict.fromkeys(each.changes)
        key = frozenset(changes), each.paid
        before = found.get(key)
        if before is None:
            found[key] = Result(each.chance, tuple(changes), each.paid)
        else:
            found[key] = replace(before, chance=before.chance + each.chance)
    return tuple(found.values())
