"""What prices come to for objects of a problem, by the values that functions have in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from cleancli.compiler.fluents import Binding, Values
from cleancli.language.model import Outcome, Price, Variable


def comes_to(price: Price, binding: Binding, values: Values) -> Fraction:
    """The whole price, where all its variables are bound."""
    return price.number + by_functions(price, binding, values)


def by_functions(price: Price, binding: Binding, values: Values) -> Fraction:
    """What functions say of a price, without its number."""
    total = Fraction(0)
    for part in price.parts:
        names = tuple(binding[term] if isinstance(term, Variable) else term.name for term in part.terms)
        value = values[part.symbol, names]
        assert isinstance(value, int), "the checker lets only integers count"
        total += part.weight * value
    return total


@dataclass(frozen=True, slots=True)
class Prices:
    """What outcomes pay in a problem: the values that hold in it at first, and how many times a cost counts
    in the reward."""

    values: Values
    cost_weight: Fraction

    def paid(self, outcome: Outcome, binding: Binding) -> tuple[Fraction, Fraction]:
        """What the reward of a step loses by an outcome, and what it adds to the cost of its action."""
        cost = comes_to(outcome.cost, binding, self.values)
        return -comes_to(outcome.reward, binding, self.values) - self.cost_weight * cost, cost


def most(price: Price, ends: Mapping[str, tuple[int, int]]) -> Fraction:
    """What a price comes to at most, where `ends` has the least and the greatest value of each function."""
    total = price.number
    for part in price.parts:
        low, high = ends[part.symbol]
        total += part.weight * (high if part.weight > 0 else low)
    return total
