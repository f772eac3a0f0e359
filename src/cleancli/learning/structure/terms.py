"""The terms that effects and conditions are told of: arguments, constants, and what references name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Bools, Longs
from cleancli.language.model import Assign, Equality, ForAll, Literal, Reference, Shift, Term, Variable
from cleancli.learning.structure.arrays import UNDEFINED, ActionArrays, Index, index_of

Effect = Assign | Shift | ForAll
Parts = tuple[Literal | Equality, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Named:
    """The terms that effects may be told of: `columns` are their places in each of the `size` transitions, or
    UNDEFINED where a reference names nothing."""

    size: int
    columns: Mapping[Term, Longs]
    references: tuple[Reference, ...] = ()
    foralls: tuple[ForAll, ...] = ()


def needed_by(known: Named, reference: Reference) -> tuple[Reference, ...]:
    """A reference after those that its condition uses, and that these use."""
    used = {term for part in reference.condition for term in terms_of(part)}
    before = [each for each in known.references if each != reference and used & set(each.variables)]
    found = dict.fromkeys(more for each in before for more in needed_by(known, each))
    return (*found, reference)


def terms_of(part: Literal | Equality) -> tuple[Term, ...]:
    """The terms of a part of a condition."""
    return part.terms if isinstance(part, Literal) else (part.left, part.right)


def used(known: Named, outcomes: Sequence[frozenset[Effect]]) -> tuple[Reference, ...]:
    """The references that outcomes use, and those that these rest on."""
    terms = {term for outcome in outcomes for effect in outcome for term in effect_terms(effect)}
    used = {r for each in known.references if terms & set(each.variables) for r in needed_by(known, each)}
    return tuple(each for each in known.references if each in used)


def effect_terms(effect: Effect) -> Iterator[Term]:
    """The terms of an effect, and of the guard of a `forall`."""
    if isinstance(effect, ForAll):
        for part in effect.condition:
            yield from terms_of(part)
        for each in effect.effects:
            yield from each.terms
    else:
        yield from effect.terms


def named(action: ActionArrays, parameters: Sequence[Variable]) -> Named:
    """The action's arguments and the domain's constants."""
    columns: dict[Term, Longs] = dict(zip(parameters, action.columns, strict=True))
    return Named(action.arrays.size, {**columns, **index_of(action.arrays, {})})


def defined(literal: Literal, known: Named) -> Bools:
    """Where all terms of a literal name something, (n,)."""
    columns = [known.columns[term] for term in literal.terms if term in known.columns]
    found: Bools = np.ones(known.size, dtype=bool)
    for column in columns:
        found = found & (column != UNDEFINED)
    return found


def index_of_terms(known: Named) -> Index:
    return {term: np.maximum(column, 0) for term, column in known.columns.items()}
