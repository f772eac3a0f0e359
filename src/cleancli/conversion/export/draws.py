"""One draw of many results as several draws, each by itself, of few.

A rule has one draw, whose outcomes are all ways in which independent things can turn out; languages in which
these can be drawn side by side say them shorter.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from math import prod
from typing import TypeVar

_Part = TypeVar("_Part", bound=Hashable)

MOST_PARTS = 100
"""Parts of a draw that are compared by twos. Chosen."""

Draw = Mapping[frozenset[_Part], Fraction]
"""Sets of parts that happen together, and how likely each is."""


def draws_of(
    outcomes: Iterable[tuple[Fraction, Iterable[_Part]]],
) -> tuple[tuple[tuple[Fraction, tuple[_Part, ...]], ...], ...]:
    """The independent draws that outcomes come to: the results of each, with their probabilities and their
    parts in order."""
    results: dict[frozenset[_Part], Fraction] = {}
    order: dict[_Part, None] = {}
    for chance, happening in outcomes:
        parts = dict.fromkeys(happening)
        order |= parts
        results[frozenset(parts)] = results.get(frozenset(parts), Fraction(0)) + chance
    return tuple(
        tuple((chance, tuple(part for part in order if part in result)) for result, chance in draw.items())
        for draw in independent(results, [*order])
    )


def independent(draw: Draw[_Part], parts: Sequence[_Part]) -> tuple[Draw[_Part], ...]:
    """Draws that are independent of one another, and together the one that is given: each of its results is
    a union of theirs. The one itself where it has no such form. `parts` are all there are, in order."""
    if len(parts) > MOST_PARTS:
        return (draw,)
    groups = _groups(draw, parts)
    found = [_marginal(draw, group) for group in groups]
    if len(found) < 2 or prod(map(len, found)) != len(draw):
        return (draw,)
    for result, chance in draw.items():
        if chance != prod(one[result & group] for one, group in zip(found, groups, strict=True)):
            return (draw,)
    return tuple(found)


def _groups(draw: Draw[_Part], parts: Sequence[_Part]) -> list[frozenset[_Part]]:
    """The parts, those together that depend on each other by twos."""
    chances = {part: _chance(draw, {part}) for part in parts}
    group = {part: {part} for part in parts}
    for one, other in combinations(parts, 2):
        if group[one] is not group[other] and _chance(draw, {one, other}) != chances[one] * chances[other]:
            group[one] |= group[other]
            for part in group[other]:
                group[part] = group[one]
    return list(dict.fromkeys(frozenset(group[part]) for part in parts))


def _chance(draw: Draw[_Part], parts: set[_Part]) -> Fraction:
    return sum((chance for result, chance in draw.items() if parts <= result), Fraction(0))


def _marginal(draw: Draw[_Part], group: frozenset[_Part]) -> Draw[_Part]:
    found: dict[frozenset[_Part], Fraction] = {}
    for result, chance in draw.items():
        found[result & group] = found.get(result & group, Fraction(0)) + chance
    return found
