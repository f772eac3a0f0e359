"""What may matter to what an action does: parts of conditions, and where they hold.

They are what `learning.structure` may ask for, less conjunctions about objects that nothing names.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from cleancli.array_types import Bools
from cleancli.language.model import Action, Domain, Equality, Literal, Quantified, Term, Variable
from cleancli.learning.structure.arrays import ActionArrays, holds, index_of
from cleancli.learning.structure.effects import changes_of, with_references
from cleancli.learning.structure.literals import equalities, literals, negated, symbols
from cleancli.learning.structure.terms import Named, named, needed_by

Part = Literal | Equality | Quantified

_OTHER = "other!"
"""An object that nothing names; no text can declare it."""


def parts_of(domain: Domain, action: Action, given: ActionArrays) -> tuple[Part, ...]:
    """What may matter to an action: of its arguments and constants, of what the references name that its
    transitions need, and whether there is any object of which one literal holds."""
    known = with_references(given, named(given, action.parameters), changes_of(given.arrays))
    terms: tuple[Term, ...] = (*action.parameters, *domain.constants)
    return (
        *literals(domain, terms),
        *equalities(domain, terms),
        *_of_references(domain, terms, known),
        *_of_others(domain, terms),
    )


def _of_references(domain: Domain, terms: Sequence[Term], known: Named) -> Iterator[Quantified]:
    for reference in known.references:
        before = needed_by(known, reference)
        variables = tuple(variable for each in before for variable in each.variables)
        definition = tuple(part for each in before for part in each.condition)
        (variable,) = reference.variables
        yield Quantified(True, variables, definition)
        everything = (*terms, *variables)
        further: Iterable[Literal | Equality] = (
            *literals(domain, everything, variable),
            *equalities(domain, everything, variable),
        )
        for part in further:
            if part not in definition:
                yield Quantified(True, variables, (*definition, part))


def _of_others(domain: Domain, terms: Sequence[Term]) -> Iterator[Quantified]:
    types = dict.fromkeys(p.type for symbol in symbols(domain) for p in symbol.parameters)
    for type_name in types:
        other = Variable(_OTHER, type_name)
        for literal in literals(domain, (*terms, other), other):
            yield Quantified(True, (other,), (literal,))


def held(action: Action, given: ActionArrays, parts: Sequence[Part]) -> Bools:
    """Which parts hold in which transitions, and then which do not (n, 2 * parts)."""
    arrays = given.arrays
    index = index_of(arrays, dict(zip(action.parameters, given.columns, strict=True)))
    columns = [np.broadcast_to(holds(arrays, (part,), index), (arrays.size,)) for part in parts]
    true = np.column_stack(columns) if columns else np.zeros((arrays.size, 0), dtype=bool)
    return np.concatenate([true, ~true], axis=1)


def signed(domain: Domain, parts: Sequence[Part], column: int) -> Part:
    """What a column of `held` tells of: a part, or its opposite."""
    part = parts[column % len(parts)]
    if column < len(parts):
        return part
    match part:
        case Literal():
            return negated(domain, part)
        case Equality():
            return replace(part, equal=not part.equal)
        case Quantified():
            return replace(part, exists=not part.exists)
