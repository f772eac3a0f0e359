"""Formulas as PPDDL writes them, with the types, objects and variables that they speak of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cleancli.conversion.export.names import Naming, Predicates
from cleancli.conversion.export.s_expressions import Node
from cleancli.conversion.pddl.formula import Both, Either, Formula, Quantified, negated
from cleancli.language.model import Domain, Equality, Literal, Object, Term, Variable

WORDS = frozenset(
    {
        "and",
        "assign",
        "decrease",
        "define",
        "domain",
        "either",
        "exists",
        "forall",
        "imply",
        "increase",
        "noise",
        "not",
        "number",
        "object",
        "or",
        "problem",
        "probabilistic",
        "reward",
        "scale-down",
        "scale-up",
        "total-cost",
        "total-time",
        "when",
    }
)
"""Words of the language, and `noise`, which is none of .nid names."""

OBJECT = "object"
"""The type above all others."""


def predicates_of(domain: Domain) -> Predicates:
    """What the predicates of a domain are called, whichever file asks first."""
    naming = Naming(WORDS, folded=True)
    for name in (*(each.name for each in domain.symbols), *(each.name for each in domain.derived)):
        naming.of(name)
    predicates = Predicates(naming, lambda symbol, value: f"{symbol}-{value}")
    predicates.claim(domain.symbols)
    return predicates


class FormulaWriter:
    """Writes formulas over predicates that have their names already; types, objects and variables get
    theirs."""

    def __init__(self, domain: Domain) -> None:
        self._domain = domain
        self.types, self.objects, self._variables = (Naming(WORDS, folded=True) for _ in range(3))
        for each in domain.types:
            self.type_of(each.name)
        for constant in domain.constants:
            self.objects.of(constant.name)

    def above(self, parent: str | None) -> str:
        """The type that stands above one whose parent this is."""
        return OBJECT if parent is None else self.type_of(parent)

    def type_of(self, name: str) -> str:
        """The type; one that is called `object`, and is above all others, is PDDL's."""
        roots = [each.name for each in self._domain.types if each.parent is None]
        return OBJECT if name == OBJECT and roots == [OBJECT] else self.types.of(name)

    def typed_objects(self, objects: Iterable[Object]) -> list[str]:
        """A list of objects for each of their types, as declarations have it."""
        found: dict[str, list[str]] = {}
        for thing in objects:
            found.setdefault(self.type_of(thing.type), []).append(self.objects.of(thing.name))
        return [f"{' '.join(names)} - {kind}" for kind, names in found.items()]

    def formula(self, formula: Formula) -> Node:
        """A condition."""
        match formula:
            case Literal(symbol, terms, values):
                atom = (symbol, *map(self.term, terms))
                return atom if True in values else ("not", atom)
            case Equality(left, right, equal):
                same = ("=", self.term(left), self.term(right))
                return same if equal else ("not", same)
            case Both(parts):
                return ("and", *map(self.formula, parts))
            case Either(parts):
                return ("or", *map(self.formula, parts))
            case Quantified(False, _, Either()):
                return ("not", self.formula(negated(formula)))
            case Quantified(exists, variables, part):
                return ("exists" if exists else "forall", self.typed(variables), self.formula(part))

    def typed(self, variables: Sequence[Variable]) -> Node:
        """Variables with their types, as parameters and quantifiers have them."""
        words: list[str] = []
        for place, variable in enumerate(variables):
            words.append(self.term(variable))
            if variable is variables[-1] or variables[place + 1].type != variable.type:
                words += ["-", self.type_of(variable.type)]
        return tuple(words)

    def term(self, term: Term) -> str:
        """A variable or an object."""
        if isinstance(term, Variable):
            return f"?{self._variables.of(term.name)}"
        return self.objects.of(term.name)
