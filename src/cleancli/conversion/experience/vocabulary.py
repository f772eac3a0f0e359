"""Facts of a .nid domain as atoms of languages that have predicates alone, and back.

A function is a predicate for each of its values, of which one holds; a symmetric predicate holds both ways
round.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from cleancli.compiler.fluents import Fluent, Values
from cleancli.language.model import Domain, Symbol, Value

Atom = tuple[str, tuple[str, ...]]
"""A predicate and the names of its objects."""

Meaning = tuple[Symbol, Value]
"""What a predicate says: that a symbol has a value."""


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What the predicates are called that say the facts of a domain; `meanings` tells what each says."""

    names: Mapping[Meaning, str]
    meanings: Mapping[str, Meaning]

    def atoms(self, values: Values, symbols: Mapping[str, Symbol]) -> list[Atom]:
        """What holds where things have these values, in order."""
        found: set[Atom] = set()
        for (name, objects), value in values.items():
            symbol = symbols[name]
            if value is not False:
                ways = {objects, objects[::-1]} if symbol.symmetric else {objects}
                found.update((self.names[symbol, value], way) for way in ways)
        return sorted(found)


def values_of(facts: Iterable[tuple[Meaning, tuple[str, ...]]]) -> Values:
    """The values of things; raises ValueError where one is given two."""
    found: dict[Fluent, Value] = {}
    for (symbol, value), objects in facts:
        key = symbol.name, symbol.canonical(objects)
        if found.setdefault(key, value) != value:
            shown = f"{symbol.name}({', '.join(objects)})"
            raise ValueError(f"`{shown}` is `{found[key]}` and `{value}` at once")
    return found


def meanings_of(domain: Domain) -> Iterable[Meaning]:
    """All that predicates have to say of a domain, in the order of its declarations."""
    for symbol in domain.symbols:
        for value in (True,) if symbol.is_predicate else symbol.values:
            yield symbol, value
