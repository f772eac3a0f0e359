"""Conditions of first-order logic over the symbols of a .nid file, in which only literals are negated.

Every function that makes a formula leaves out what says nothing: parts that always hold or never do.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from cleancli.language.model import Equality, Literal, Object, Term, Variable

_VALUES = {truth: frozenset({truth}) for truth in (False, True)}


@dataclass(frozen=True, slots=True)
class Both:
    """All parts hold; none is always true."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Either:
    """One part holds at least; none is never true."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Quantified:
    """Some binding of the variables satisfies `part` (`exists`), or each does."""

    exists: bool
    variables: tuple[Variable, ...]
    part: Formula


Formula = Literal | Equality | Both | Either | Quantified

MayBeOne = Callable[[Term, Term], bool]
"""Whether the types of two terms allow that they are one object."""

ALWAYS = Both(())
NEVER = Either(())


def literal(symbol: str, terms: tuple[Term, ...], value: bool = True) -> Literal:
    """That a predicate is true or false of terms."""
    return Literal(symbol, terms, _VALUES[value])


def equality(left: Term, right: Term, may_be_one: MayBeOne) -> Formula:
    """That two terms are one object."""
    if left == right:
        return ALWAYS
    if isinstance(left, Object) and isinstance(right, Object):
        return NEVER
    return Equality(left, right, True) if may_be_one(left, right) else NEVER


def negated(formula: Formula) -> Formula:
    """The opposite."""
    match formula:
        case Literal():
            return Literal(formula.symbol, formula.terms, _VALUES[False in formula.values])
        case Equality():
            return Equality(formula.left, formula.right, not formula.equal)
        case Both(parts):
            return either(map(negated, parts))
        case Either(parts):
            return both(map(negated, parts))
        case Quantified():
            return Quantified(not formula.exists, formula.variables, negated(formula.part))


def both(parts: Iterable[Formula]) -> Formula:
    """The conjunction."""
    saying = [part for part in parts if not (isinstance(part, Both) and not part.parts)]
    if len(saying) < 2:
        return saying[0] if saying else ALWAYS
    found = dict.fromkeys(_flat(saying, Both))
    if len(found) == 1:
        return next(iter(found))
    return NEVER if NEVER in found or _has_opposites(found) else Both(tuple(found))


def either(parts: Iterable[Formula]) -> Formula:
    """The disjunction."""
    saying = [part for part in parts if not (isinstance(part, Either) and not part.parts)]
    if len(saying) < 2:
        return saying[0] if saying else NEVER
    found = dict.fromkeys(_flat(saying, Either))
    if len(found) == 1:
        return next(iter(found))
    return ALWAYS if ALWAYS in found or _has_opposites(found) else Either(tuple(found))


def _has_opposites(parts: Collection[Formula]) -> bool:
    """Whether a literal or an equality is among some parts, and its opposite too."""
    negative = (
        part
        for part in parts
        if (isinstance(part, Literal) and False in part.values)
        or (isinstance(part, Equality) and not part.equal)
    )
    return any(negated(part) in parts for part in negative)


def quantified(exists: bool, variables: Iterable[Variable], part: Formula) -> Formula:
    """The quantified formula; a variable that `part` does not mention is left out, as if there were an object
    of its type. Parts that mention none of the variables stand outside of the quantifier."""
    variables = tuple(variables)
    if not variables:
        return part
    free = free_variables(part)
    bound = tuple([variable for variable in variables if variable in free])
    if not bound:
        return part
    if exists and isinstance(part, Both):
        outer = [each for each in part.parts if free_variables(each).keys().isdisjoint(bound)]
        inner = both(each for each in part.parts if each not in outer)
        return both([*outer, Quantified(True, bound, inner)])
    if not exists and isinstance(part, Either):
        outer = [each for each in part.parts if free_variables(each).keys().isdisjoint(bound)]
        inner = either(each for each in part.parts if each not in outer)
        return either([*outer, Quantified(False, bound, inner)])
    return Quantified(exists, bound, part)


def _flat(parts: Iterable[Formula], kind: type[Both] | type[Either]) -> Iterator[Formula]:
    for part in parts:
        if isinstance(part, kind):
            yield from part.parts
        else:
            yield part


def is_basic(formula: Formula) -> bool:
    """Whether it is a literal or an equality."""
    return isinstance(formula, Literal | Equality)


def free_variables(formula: Formula) -> dict[Variable, None]:
    """The variables that no quantifier of the formula binds, in the order of the text."""
    match formula:
        case Literal():
            return {term: None for term in formula.terms if isinstance(term, Variable)}
        case Equality():
            return {t: None for t in (formula.left, formula.right) if isinstance(t, Variable)}
        case Both(parts) | Either(parts):
            return {variable: None for part in parts for variable in free_variables(part)}
        case Quantified():
            inner = free_variables(formula.part)
            return {v: None for v in inner if v not in formula.variables}


def substituted(formula: Formula, terms: Mapping[Term, Term], may_be_one: MayBeOne) -> Formula:
    """The formula with other terms for some; bound variables that these would meet get other names."""
    if not terms:
        return formula
    match formula:
        case Literal():
            changed = tuple([terms.get(term, term) for term in formula.terms])
            return Literal(formula.symbol, changed, formula.values)
        case Equality():
            left, right = (terms.get(term, term) for term in (formula.left, formula.right))
            same = equality(left, right, may_be_one)
            return same if formula.equal else negated(same)
        case Both(parts):
            return both(substituted(part, terms, may_be_one) for part in parts)
        case Either(parts):
            return either(substituted(part, terms, may_be_one) for part in parts)
        case Quantified():
            met = set(terms.values())
            names: dict[Term, Term] = {}
            for variable in formula.variables:
                names[variable] = apart(variable, met)
                met.add(names[variable])
            bound = tuple(v for v in names.values() if isinstance(v, Variable))
            inner = substituted(formula.part, {**terms, **names}, may_be_one)
            return quantified(formula.exists, bound, inner)


def apart(variable: Variable, met: Iterable[Term]) -> Variable:
    """The variable, under another name where one of these has its name."""
    return named_apart(variable, {term.name for term in met})


def named_apart(variable: Variable, names: Collection[str]) -> Variable:
    """The variable, under another name where its own is among these."""
    name, number = variable.name, 2
    while name in names:
        name, number = f"{variable.name}_{number}", number + 1
    return variable if name == variable.name else replace(variable, name=name)


class Known:
    """Formulas that hold somewhere. They are looked through when that is first asked for, and once."""

    def __init__(self, formulas: Iterable[Formula]) -> None:
        self.formulas = tuple(formulas)
        self._parts: frozenset[Formula] | None = None

    def left_of(self, formula: Formula) -> Formula:
        """What is left of a formula where they hold."""
        if formula in (ALWAYS, NEVER):
            return formula
        if self._parts is None:
            self._parts = frozenset(_flat(self.formulas, Both))
        return _left_of(formula, self._parts)


def assuming(formula: Formula, known: Iterable[Formula]) -> Formula:
    """What is left of a formula where others hold, of which no more is asked."""
    return Known(known).left_of(formula)


def _left_of(formula: Formula, known: frozenset[Formula]) -> Formula:
    if formula in known:
        return ALWAYS
    if negated(formula) in known:
        return NEVER
    match formula:
        case Both(parts):
            return both([_left_of(part, known) for part in parts])
        case Either(parts):
            return either([_left_of(part, known) for part in parts])
    return formula
