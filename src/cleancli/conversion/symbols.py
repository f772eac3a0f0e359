"""Symbols, literals and facts in the words of the language.

Guaranteed by `check`: atoms fit their declarations.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from itertools import product

from cleancli.conversion.check import rule_atoms
from cleancli.conversion.names import OBJECT, Names
from cleancli.conversion.records import Atom, Declaration, Kind, Library
from cleancli.language.model import Fact, Literal, Object, Symbol, Term, Value, Variable

_COMPARE: Mapping[str, Callable[[int, int], bool]] = {
    "=": operator.eq, "!=": operator.ne,
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
}  # fmt: skip

Asked = tuple[str, tuple[Term, ...]]
"""A symbol and the terms that a literal asks it of."""


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """The symbols that rules and counts mention, and how to say libPRADA's literals with them."""

    names: Names
    symbols: Mapping[str, Symbol]

    def literal(self, atom: Atom, variables: Mapping[str, Variable]) -> Literal:
        """A literal; its `values` may be none or all."""
        function = self.names.functions.get(atom.symbol)
        symbol = self.symbols[self.names.symbols[atom.symbol] if function is None else function.name]
        terms = tuple(self.term(term, variables) for term in atom.terms)
        if function is not None:
            own = frozenset({function.value_of[atom.symbol]})
            values = own if atom.value else frozenset(symbol.values) - own
        elif isinstance(atom.value, bool):
            values = frozenset({atom.value})
        else:
            fits = _COMPARE[atom.relation]
            values = frozenset(v for v in symbol.values if fits(int(v), atom.value))
        return Literal(symbol.name, terms, values)

    def has(self, atom: Atom) -> bool:
        """Whether the symbol of a literal is one that rules or counts mention."""
        function = self.names.functions.get(atom.symbol)
        return (self.names.symbols[atom.symbol] if function is None else function.name) in self.symbols

    def conjunction(
        self, atoms: Iterable[Atom], variables: Mapping[str, Variable]
    ) -> tuple[Literal, ...] | None:
        """The literals, one for each fact they ask for, without those that any value fits; None where they
        contradict each other."""
        values: dict[Asked, frozenset[Value]] = {}
        for atom in atoms:
            literal = self.literal(atom, variables)
            key = literal.symbol, literal.terms
            values[key] = values.get(key, literal.values) & literal.values
        if not all(values.values()):
            return None
        return tuple(
            Literal(*key, allowed)
            for key, allowed in values.items()
            if len(allowed) < len(self.symbols[key[0]].values)
        )

    def term(self, term: str, variables: Mapping[str, Variable]) -> Term:
        """A variable of the rule, or an object."""
        return variables.get(term) or Object(self.names.objects[term], OBJECT)


def vocabulary(library: Library, names: Names) -> Vocabulary:
    """What rules and counts mention; a symbol that only facts mention changes nothing and is left out."""
    counted = [atom for symbol in library.symbols for atom in symbol.condition]
    mentioned = {atom.symbol for atom in (*rule_atoms(library), *counted)}
    declared = [s for s in library.symbols if s.kind is Kind.PRIMITIVE and s.name in mentioned]
    symbols = [_symbol(symbol, library, names) for symbol in declared]
    return Vocabulary(names, {symbol.name: symbol for symbol in symbols})


def _symbol(declared: Declaration, library: Library, names: Names) -> Symbol:
    """A predicate or function, or the function that a group becomes of which a predicate is a member."""
    function = names.functions.get(declared.name)
    if function is not None:
        return Symbol(function.name, parameters(declared.arity), function.values)
    values = (False, True) if declared.is_binary else _range(library, declared.name)
    return Symbol(names.symbols[declared.name], parameters(declared.arity), values)


def parameters(number: int) -> tuple[Variable, ...]:
    """`?x ?y ?z`, or `?x1 ?x2 ...` where these do not do."""
    names = "xyz"[:number] if number <= 3 else [f"x{place}" for place in range(1, number + 1)]
    return tuple(Variable(name, OBJECT) for name in names)


def facts(library: Library, words: Vocabulary, objects: Collection[str]) -> frozenset[Fact]:
    """The state; where no member of a group holds, its function has the first value."""
    chosen = [symbol for symbol in words.symbols.values() if isinstance(symbol.values[0], str)]
    found: dict[tuple[str, tuple[str, ...]], Value] = {
        (symbol.name, terms): symbol.values[0]
        for symbol in chosen
        for terms in product(objects, repeat=len(symbol.parameters))
    }
    stated = (_fact(atom, words) for atom in library.facts)
    found |= {(fact.symbol, fact.objects): fact.value for fact in stated if fact is not None}
    return frozenset(Fact(name, terms, value) for (name, terms), value in found.items())


def _fact(atom: Atom, words: Vocabulary) -> Fact | None:
    """What a literal of the state says; None for what is false, and of a symbol that is left out."""
    function = words.names.functions.get(atom.symbol)
    name = words.names.symbols[atom.symbol] if function is None else function.name
    if name not in words.symbols or atom.value is False:
        return None
    value = atom.value if function is None else function.value_of[atom.symbol]
    return Fact(name, tuple(words.names.objects[term] for term in atom.terms), value)


def _range(library: Library, name: str) -> tuple[Value, ...]:
    """All integers from the lowest to the highest that the files mention; two at least."""
    atoms = [atom for atom in (*rule_atoms(library), *library.facts) if atom.symbol == name]
    numbers = [int(atom.value) for atom in atoms]
    low, high = min(numbers, default=0), max(numbers, default=0)
    return tuple(range(low, max(high, low + 1) + 1))
