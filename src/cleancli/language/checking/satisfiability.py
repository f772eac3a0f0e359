"""Whether formulas can hold together in some state of some problem, by search; exact within a stated effort.

A formula of `formula` asks for finitely many objects to exist and says the rest about every object. If it
holds in any state, it also holds among the constants and those objects alone, because what is said of every
object stays true of fewer (the finite models of the Bernays-Schönfinkel class). So the search is over the
ways in which these objects may be the same, and over the values of their finitely many facts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from cleancli.language.checking.declarations import Declarations
from cleancli.language.checking.first_order import Both, Either, Every, Formula, Reading
from cleancli.language.checking.literals import Witness, canonical
from cleancli.language.model import Equality, Literal, Object, Term, Value, Variable

_EFFORT = 20_000
"""Parts of formulas looked at before the search gives up: about 0.1 s."""

_MOST_OBJECTS = 40

_Binding = Mapping[Term, Term | None]
_Facts = dict[tuple[str, tuple[Term, ...]], frozenset[Value]]


class TooHard(Exception):
    """The search has looked at so much that it gave up."""


@dataclass(slots=True)
class _Effort:
    left: int = _EFFORT

    def spend(self) -> None:
        self.left -= 1
        if self.left < 0:
            raise TooHard


def satisfy(formulas: Sequence[Formula], reading: Reading, declared: Declarations) -> Witness | None:
    """A state in which all formulas hold, None if there is none; raises TooHard."""
    if len(reading.variables) > _MOST_OBJECTS:
        raise TooHard
    effort = _Effort()
    top = [f for f in _flat(formulas) if isinstance(f, Equality)]
    several = bool(reading.optional) or any(_compares(f) for f in formulas if not isinstance(f, Equality))
    for binding in _Identification(reading, top, declared, effort).bindings():
        search = _Search(binding, declared, effort)
        facts = search.hold([(formula, binding) for formula in formulas], {})
        if facts is not None:
            return _witness(binding, facts)
        if not several:
            return None
    return None


def _flat(formulas: Sequence[Formula]) -> Iterator[Formula]:
    for formula in formulas:
        if isinstance(formula, Both):
            yield from _flat(formula.parts)
        else:
            yield formula


def _compares(formula: Formula) -> bool:
    """Whether it can matter which objects are the same, beyond what must hold anyway."""
    match formula:
        case Both(parts):
            return any(_compares(p) for p in parts if not isinstance(p, Equality))
        case Either(parts):
            return any(isinstance(p, Equality) or _compares(p) or _has_equality(p) for p in parts)
        case Every(_, body):
            return _has_equality(body)
    return False


def _has_equality(formula: Formula) -> bool:
    match formula:
        case Equality():
            return True
        case Both(parts) | Either(parts):
            return any(map(_has_equality, parts))
        case Every(_, body):
            return _has_equality(body)
    return False


@dataclass(frozen=True, slots=True)
class _Identification:
    """A search over the ways in which variables can be the same objects.

    An object is the constant or the first variable that stands for it; None stands for an object that is not
    needed.
    """

    reading: Reading
    equalities: Sequence[Equality]
    declared: Declarations
    effort: _Effort

    def bindings(self) -> Iterator[_Binding]:
        """Every way that agrees with the equalities, those with the most objects first."""
        return self._extended({c: c for c in self.declared.constants.values()}, self.reading.variables)

    def _extended(self, binding: _Binding, free: Sequence[Variable]) -> Iterator[_Binding]:
        """Every way to bind the free variables, too."""
        self.effort.spend()
        if not free:
            yield binding
            return
        variable, rest = free[0], free[1:]
        for option in self._options(variable, binding):
            extended = {**binding, variable: option}
            if self._agrees(variable, extended):
                yield from self._extended(extended, rest)

    def _options(self, variable: Variable, binding: _Binding) -> Iterator[Term | None]:
        """What a variable can stand for: an object of its own, one that others stand for, perhaps none."""
        yield variable
        for chosen in dict.fromkeys(stands for stands in binding.values() if stands is not None):
            if self._fits(variable, chosen, binding):
                yield chosen
        if variable in self.reading.optional:
            yield None

    def _fits(self, variable: Variable, chosen: Term, binding: _Binding) -> bool:
        """Whether an object can have the type of a variable as well as those of all that stand for it."""
        same = [term for term, stands in binding.items() if stands == chosen]
        if any(self.declared.meet(variable.type, term.type) is None for term in same):
            return False
        return not isinstance(chosen, Object) or self.declared.is_a(chosen.type, variable.type)

    def _agrees(self, term: Term, binding: _Binding) -> bool:
        """Whether the equalities about a term hold, as far as their terms are bound."""
        about = [e for e in self.equalities if term in (e.left, e.right)]
        bound = [e for e in about if {e.left, e.right} <= binding.keys()]
        return all((binding[e.left] == binding[e.right]) == e.equal for e in bound)


@dataclass(frozen=True, slots=True)
class _Search:
    """A tableau over the facts of fixed objects."""

    objects: _Binding
    declared: Declarations
    effort: _Effort

    def hold(self, todo: list[tuple[Formula, _Binding]], facts: _Facts) -> _Facts | None:
        """The values that facts may have where all of `todo` hold, None if they cannot."""
        facts, todo = dict(facts), list(todo)
        choices: list[tuple[Either, _Binding]] = []
        while todo:
            formula, binding = todo.pop(0)
            self.effort.spend()
            match formula:
                case Both(parts):
                    todo += [(part, binding) for part in parts]
                case Every(variables, body):
                    todo += [(body, inner) for inner in self._instances(variables, binding)]
                case Either():
                    choices.append((formula, binding))
                case _:
                    if not self._take(formula, binding, facts):
                        return None
        return self._choose(choices, facts)

    def _choose(self, choices: list[tuple[Either, _Binding]], facts: _Facts) -> _Facts | None:
        """Settle the choices that the facts decide; of the others, try the narrowest in every way."""
        open_choices = []
        for formula, binding in choices:
            self.effort.spend()
            states = [(self._state(part, binding, facts), part) for part in formula.parts]
            if not any(state is True for state, _ in states):
                open_choices.append(([part for state, part in states if state is None], binding))
        if not open_choices:
            return facts
        at = min(range(len(open_choices)), key=lambda index: len(open_choices[index][0]))
        parts, binding = open_choices.pop(at)
        rest: list[tuple[Formula, _Binding]] = [(Either(tuple(p)), b) for p, b in open_choices]
        for part in parts:
            found = self.hold([(part, binding), *rest], facts)
            if found is not None:
                return found
        return None

    def _state(self, formula: Formula, binding: _Binding, facts: _Facts) -> bool | None:
        """Whether a literal or equality holds or fails already."""
        match formula:
            case Equality(left, right, equal):
                one, other = binding.get(left), binding.get(right)
                return None not in (one, other) and (one == other) == equal
            case Literal(symbol, _, values):
                key = self._key(formula, binding)
                if key is None:
                    return False
                now = facts.get(key, frozenset(self.declared.symbols[symbol].values))
                return True if now <= values else (None if now & values else False)
        return None

    def _take(self, formula: Literal | Equality, binding: _Binding, facts: _Facts) -> bool:
        state = self._state(formula, binding, facts)
        if isinstance(formula, Literal) and state is not False:
            key = self._key(formula, binding)
            assert key is not None
            all_values = frozenset(self.declared.symbols[formula.symbol].values)
            facts[key] = facts.get(key, all_values) & formula.values
        return state is not False

    def _key(self, literal: Literal, binding: _Binding) -> tuple[str, tuple[Term, ...]] | None:
        terms = tuple(t for term in literal.terms if (t := binding.get(term)) is not None)
        if len(terms) < len(literal.terms):
            return None
        return literal.symbol, canonical(self.declared.symbols[literal.symbol], terms)

    def _instances(self, variables: tuple[Variable, ...], binding: _Binding) -> Iterator[_Binding]:
        there = {stands for stands in self.objects.values() if stands is not None}
        candidates = [
            sorted((o for o in there if self._belongs(o, variable)), key=lambda o: o.name)
            for variable in variables
        ]
        for chosen in product(*candidates):
            yield {**binding, **dict(zip(variables, chosen, strict=True))}

    def _belongs(self, chosen: Term, variable: Variable) -> bool:
        """Whether an object is of a type: it is of the lowest of those of all that stand for it."""
        same = [term for term, stands in self.objects.items() if stands == chosen]
        return any(self.declared.is_a(term.type, variable.type) for term in same)


def _witness(binding: _Binding, facts: _Facts) -> Witness:
    equal = tuple((term, stands) for term, stands in binding.items() if stands is not None and stands != term)
    return Witness(equal, tuple(Literal(symbol, terms, values) for (symbol, terms), values in facts.items()))
