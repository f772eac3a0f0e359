"""The numeric functions of PDDL that say what is paid for objects.

An effect of PDDL rises by a number or by a function, not by a function with a weight: so a function of a .nid
domain becomes one of PDDL for each weight that it counts with, whose values are as much.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from cleancli.conversion.export.names import Naming
from cleancli.language.model import Domain, PricePart, Problem


class CostFunctions:
    """Names the functions of one domain that costs are counted with, as they are asked for."""

    def __init__(self, domain: Domain, naming: Naming) -> None:
        self._symbols = {symbol.name: symbol for symbol in domain.symbols}
        self._naming = naming
        self._names: dict[tuple[str, Fraction], str] = {}

    @property
    def symbols(self) -> frozenset[str]:
        """The functions of the .nid domain that are counted with."""
        return frozenset(symbol for symbol, _ in self._names)

    def of(self, part: PricePart, weight: Fraction) -> str:
        """The function whose values are so many times those of the part's, which is called as that is where
        they are the same."""
        key = part.symbol, weight
        if key not in self._names:
            plain = weight == 1
            name = self._naming.of(part.symbol) if plain else self._naming.fresh(f"{part.symbol}-cost")
            self._names[key] = name
        return self._names[key]

    def declared(self) -> Iterator[tuple[str, str]]:
        """The names of the functions, each with that of the .nid function which it comes of."""
        for (symbol, _), name in self._names.items():
            yield name, symbol

    def values(self, problem: Problem) -> Iterator[tuple[str, Sequence[str], Fraction]]:
        """What each function is of which objects of a problem, in order."""
        facts = sorted(problem.state, key=lambda fact: fact.objects)
        for (symbol, weight), name in self._names.items():
            for fact in facts:
                if fact.symbol == symbol:
                    assert isinstance(fact.value, int), "the checker lets only integers count"
                    yield name, fact.objects, weight * fact.value
