"""Prices by functions for a random domain: what its actions cost on their objects, and what outcomes pay.

They have draws of their own, so that all else of a domain is the same with them and without.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING

from support.differential.abstract import FREE, Action, Outcome, Price, Priced, Rule, Symbol, Variable

if TYPE_CHECKING:
    from support.differential.drawing import Drawer

PRICED = 0.4
"""The share of domains with such prices, where anything can be priced."""
WEIGHTS = ("1", "1", "1", "2", "0.5", "1/3", "2.25")


@dataclass(frozen=True, slots=True)
class PriceDrawer:
    """`symbols` are those that a price may be counted with; none in a domain without such prices."""

    drawer: Drawer
    random: Random
    symbols: tuple[Symbol, ...] = ()

    def functions(self) -> tuple[Symbol, ...]:
        """Functions that nothing else in the domain speaks of."""
        kinds = [name for name, _ in self.drawer.kinds]
        made = []
        for index in range(self.random.choice((1, 2))):
            of = tuple(self.random.choice(kinds) for _ in range(self.random.choice((0, 1, 1, 1, 2))))
            low = self.random.choice((0, 0, 1))
            values = tuple(range(low, low + self.random.randint(2, 6)))
            made.append(Symbol(f"g{index}", of, values, static=True))
        return tuple(made)

    def often(self, share: float) -> bool:
        return self.random.random() < share

    def parts(self, variables: tuple[Variable, ...], least: int) -> tuple[Priced, ...]:
        """One part or several, as far as there is anything of the types."""
        drawn = []
        for _ in range(self.random.choice((1, 1, 2, 3))):
            symbol = self.random.choice(self.symbols)
            things = (*variables, *self.drawer.constants)
            pools = [[v.name for v in things if self.drawer.below(v.kind, kind)] for kind in symbol.kinds]
            if all(pools):
                terms = tuple(self.random.choice(pool) for pool in pools)
                weight = Fraction(self.random.choice(WEIGHTS)) * self.random.choice((1, 1, least))
                drawn.append(Priced(weight, symbol.name, terms))
        return tuple(drawn)

    def action(self, action: Action) -> Action:
        """The action, which may cost more on some objects than on others; a function may count 0 times."""
        parts = self.parts(action.parameters, 0) if self.symbols and self.often(0.5) else ()
        return replace(action, cost=more(action.cost or FREE, parts)) if parts else action

    def rule(self, rule: Rule) -> Rule:
        """The rule, of which some outcomes may pay by functions."""
        if not self.symbols or not self.often(0.4):
            return rule
        scope = (*rule.parameters, *(each for reference in rule.references for each in reference.variables))
        return replace(rule, outcomes=tuple(self.outcome(each, scope) for each in rule.outcomes))

    def outcome(self, outcome: Outcome, scope: tuple[Variable, ...]) -> Outcome:
        earned = self.parts(scope, -1) if outcome.idle != "noise" and self.often(0.6) else ()
        spent = self.parts(scope, 1) if outcome.idle != "noise" and self.often(0.3) else ()
        if not earned and not spent:
            return outcome
        reward, cost = more(outcome.reward, earned), more(outcome.cost, spent)
        if earned and comes_to_nothing(reward):
            return outcome
        return replace(outcome, idle="", reward=reward, cost=cost)


def more(price: Price, parts: tuple[Priced, ...]) -> Price:
    return replace(price, parts=(*price.parts, *parts))


def comes_to_nothing(price: Price) -> bool:
    """Whether all that is added is taken away again, which no outcome may say."""
    sums = {(part.symbol, part.terms): Fraction(0) for part in price.parts}
    for part in price.parts:
        sums[part.symbol, part.terms] += part.weight
    return not price.number and not any(sums.values())


def price_drawer(drawer: Drawer, random: Random) -> tuple[PriceDrawer, tuple[Symbol, ...]]:
    """Who draws the prices of a domain, and the functions that the domain has for them alone."""
    if random.random() >= PRICED:
        return PriceDrawer(drawer, random), ()
    own = PriceDrawer(drawer, random).functions()
    fitting = [
        each
        for each in drawer.symbols
        if each.static and each.values and isinstance(low := each.values[0], int) and low >= 0
    ]
    return PriceDrawer(drawer, random, (*own, *fitting)), own
