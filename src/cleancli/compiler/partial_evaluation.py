"""Partial evaluation of conditions: what is left of one, as a formula, once static facts are known.

Guaranteed by the checker: every variable is bound, and definitions of derived predicates are not cyclic.
"""

from __future__ import annotations

from collections.abc import Iterator

from cleancli.compiler.fluents import Binding, Fluent, names_of
from cleancli.compiler.ground_formula import Formula, conjunction, disjunction, negation
from cleancli.compiler.static_join import Part, Universe, step
from cleancli.language.model import (
    Condition,
    DerivedPredicate,
    Equality,
    Literal,
    Quantified,
    Value,
    Variable,
)
from cleancli.language.printing.printer import print_term

STEP_LIMIT = 10_000
"""Steps of the search for the paths of one closure over what changes. Chosen: such a formula has thousands of
cases, and every ground rule would need its own."""


class ClosureTooLargeError(ValueError):
    """A closure over a predicate that rules can change has too many paths to write them out."""

    def __init__(self, derived: str, objects: tuple[str, ...]) -> None:
        super().__init__(f"{derived}({', '.join(objects)})")


class Conditions:
    """Makes formulas of conditions in one universe; remembers those of derived predicates."""

    def __init__(self, universe: Universe) -> None:
        self.universe = universe
        self._derived: dict[tuple[str, tuple[str, ...]], Formula | None] = {}
        self._values = {name: frozenset(symbol.values) for name, symbol in universe.symbols.items()}

    def all_values(self, key: Fluent) -> frozenset[Value]:
        """Every declared value of the key's symbol."""
        return self._values[key[0]]

    def extensions(
        self, variables: tuple[Variable, ...], condition: Condition, binding: Binding
    ) -> Iterator[tuple[Binding, Formula]]:
        """Every extension of `binding` for which the condition may hold, with what is left of it."""
        for extended in self.universe.extensions(variables, condition, binding):
            formula = self.remaining(condition, extended)
            if formula is not None:
                yield extended, formula

    def formula(self, condition: Condition, binding: Binding) -> Formula | None:
        """A condition whose own variables are all bound."""
        return next((formula for _, formula in self.extensions((), condition, binding)), None)

    def remaining(self, condition: Condition, binding: Binding) -> Formula | None:
        """What the changeable parts ask for, where the others hold."""
        required: dict[Fluent, frozenset[Value]] = {}
        parts: list[Formula | None] = []
        for part in condition:
            if self.universe.is_static(part):
                continue
            if isinstance(part, Literal) and part.symbol not in self.universe.derived:
                key = self.universe.key(part.symbol, part.terms, binding)
                required[key] = required.get(key, part.values) & part.values
            else:
                parts.append(self._part(part, binding))
        if not all(required.values()):
            return None
        return conjunction((Formula(required), *parts)) if parts else Formula(required)

    def _part(self, part: Part, binding: Binding) -> Formula | None:
        match part:
            case Quantified(exists, variables, condition):
                found = disjunction(formula for _, formula in self.extensions(variables, condition, binding))
                return found if exists else negation(found, self.all_values)
            case Literal(symbol, terms, values):
                found = self._definition(self.universe.derived[symbol], names_of(terms, binding))
                return found if True in values else negation(found, self.all_values)
            case Equality():
                raise AssertionError("equalities do not change")

    def _definition(self, derived: DerivedPredicate, objects: tuple[str, ...]) -> Formula | None:
        name = (derived.name, objects)
        if name not in self._derived:
            if derived.closure is None:
                binding = dict(zip(derived.parameters, objects, strict=True))
                self._derived[name] = self.formula(derived.condition, binding)
            else:
                self._derived[name] = self._closure(derived, *objects)
        return self._derived[name]

    def _closure(self, derived: DerivedPredicate, start: str, goal: str) -> Formula | None:
        """Some simple path from start to goal holds; a path back to the start is one too."""
        assert derived.closure is not None
        paths: list[Formula] = []
        for steps, path in enumerate(self._paths(derived.closure, start, goal)):
            if steps >= STEP_LIMIT:
                raise ClosureTooLargeError(derived.name, (start, goal))
            if path is not None:
                paths.append(path)
        return disjunction(paths)

    def _paths(self, predicate: str, start: str, goal: str) -> Iterator[Formula | None]:
        """What the simple paths from start to goal ask for, with a None for each step of the search that ends
        none of them."""
        edges: dict[tuple[str, str], Formula | None] = {}
        partial: list[tuple[str, frozenset[str], Formula]] = [(start, frozenset(), Formula())]
        while partial:
            here, visited, so_far = partial.pop()
            for there in self.universe.steps(predicate, here):
                if there in visited:
                    yield None
                    continue
                if (here, there) not in edges:
                    edges[here, there] = self.formula((step(predicate, here, there),), {})
                path = conjunction((so_far, edges[here, there]))
                yield path if there == goal else None
                if path is not None and there not in (start, goal):
                    partial.append((there, visited | {there}, path))


def part_text(part: Part) -> str:
    """A part of a condition in short, to name it in a message."""
    match part:
        case Literal(symbol, terms, values):
            applied = f"{symbol}({', '.join(print_term(term) for term in terms)})"
            return f"not {applied}" if any(value is False for value in values) else applied
        case Equality(left, right, equal):
            return f"{print_term(left)} {'=' if equal else '!='} {print_term(right)}"
        case Quantified(exists, variables, condition):
            names = " ".join(print_term(variable) for variable in variables)
            inner = ", ".join(part_text(literal) for literal in condition)
            return f"{'' if exists else 'not '}exists {names}: {inner}"
