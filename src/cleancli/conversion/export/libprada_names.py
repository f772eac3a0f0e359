"""What libPRADA's files call the things of a .nid domain and a problem."""

from __future__ import annotations

from collections.abc import Sequence

from cleancli.conversion.export.names import Naming, Predicates
from cleancli.language.model import Domain, Object, Problem

SAME = "same"
"""The predicate that holds of each object and itself."""


class LibpradaNames:
    """Names for all files of a domain and a problem; `experienced` are the objects of experience that goes
    with them, if any does.

    `numbers` has those of objects, `given` the other names by kinds. `typed`: whether types are predicates.
    Facts alone tell which objects there are, so that a single type is one too where an object has no others,
    and with experience.
    """

    def __init__(self, domain: Domain, problem: Problem, experienced: Sequence[Object] | None = None) -> None:
        self._naming = Naming(["default", "noise", SAME], folded=False)
        self.given: dict[tuple[str, str], str] = {}
        self.predicates = Predicates(Naming((), folded=False), lambda symbol, value: f"{symbol}_{value}")
        self.predicates.claim(domain.symbols)
        things = dict.fromkeys(each.name for each in (*domain.constants, *problem.objects))
        others = dict.fromkeys(each.name for each in experienced or ())
        self.numbers = _numbers([*(things | others)])
        told = {name for fact in problem.state for name in fact.objects}
        self.typed = len(domain.types) > 1 or experienced is not None or not things.keys() <= told
        self._claim(domain)

    def _claim(self, domain: Domain) -> None:
        """Give names in one order, whichever file asks first."""
        for action in domain.actions:
            self.of(action.name, "action")
        for kind in domain.types if self.typed else ():
            self.of(kind.name, "type")
        for symbol in domain.symbols:
            for value in (None,) if symbol.is_predicate else symbol.values:
                self.of(self.predicates.of(symbol.name, value))
        for name in (*(each.name for each in domain.derived), *(each.name for each in domain.counts)):
            self.of(name)

    def of(self, name: str, kind: str = "symbol") -> str:
        """What a symbol is called: libPRADA's begin with a small letter."""
        if (kind, name) not in self.given:
            self.given[kind, name] = self._naming.fresh(name[:1].lower() + name[1:])
        return self.given[kind, name]


def _numbers(names: Sequence[str]) -> dict[str, str]:
    """Objects as numbers, which libPRADA's are: `o10` is 10, others begin with 10."""
    taken = {name[1:] for name in names if name[0] == "o" and name[1:].isdecimal()}
    found: dict[str, str] = {}
    number = 10
    for name in names:
        if name[1:] in taken and name[0] == "o":
            found[name] = name[1:]
            continue
        while str(number) in taken:
            number += 1
        found[name] = str(number)
        number += 1
    return found
