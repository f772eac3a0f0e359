"""Outcomes of a random rule: their probabilities, how these are written, and what they set."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from support.differential.abstract import (
    ForEach,
    Outcome,
    Price,
    Setting,
    SetTruth,
    SetValue,
    Shift,
    Symbol,
    Variable,
)
from support.differential.writing import number

if TYPE_CHECKING:
    from support.differential.drawing import Drawer

MARKS = ("", "", "", "", "prior 0.3, seen 4.25", "seen 2", "fixed", "prior 1/7")
REST_MARKS = ("", "", "seen 3.5", "fixed")
Said = tuple[Fraction, str, str]
"""A probability, how it is written, and the marks beside it."""


@dataclass(slots=True)
class OutcomeDrawer:
    drawer: Drawer
    scope: tuple[Variable, ...]
    shared: tuple[tuple[str, str, str], ...]

    def outcomes(self) -> tuple[Outcome, ...]:
        drawn: list[Outcome] = []
        idle = self.drawer.random.sample(("nothing", "noise"), 2)
        pays = self.drawer.often(0.15)
        for probability, said, marks in self.chances():
            effects = self.effects() if not idle or self.drawer.often(0.8) else ()
            paid = self.payments() if pays else ()
            if any(each.number for each in paid) and all(
                (effects, *paid) != (o.effects, o.reward, o.cost) for o in drawn
            ):
                drawn.append(Outcome(probability, said, marks, effects, "", *paid))
                continue
            if any(effects == other.effects and effects for other in drawn):
                effects = ()
            if not effects and not idle:
                return self.idle(Fraction(1))
            drawn.append(Outcome(probability, said, marks, effects, "" if effects else idle.pop()))
        return tuple(drawn)

    def payments(self) -> tuple[Price, Price]:
        """What an outcome pays, and what it costs more, both in numbers."""
        amounts = (Fraction(0), Fraction(1, 3), Fraction(5, 2), Fraction(3))
        reward = self.drawer.random.choice(amounts) * self.drawer.random.choice((1, 1, -1))
        cost = self.drawer.random.choice(amounts) if self.drawer.often(0.4) else Fraction(0)
        return Price(reward), Price(cost)

    def idle(self, probability: Fraction) -> tuple[Outcome, ...]:
        if self.drawer.often(0.7):
            return (Outcome(probability, "1", "", (), self.drawer.random.choice(("nothing", "noise"))),)
        return (
            Outcome(Fraction(7, 10), "0.7", "", (), "nothing"),
            Outcome(Fraction(3, 10), "rest", "", (), "noise"),
        )

    # ---- probabilities

    def chances(self) -> list[Said]:
        random = self.drawer.random
        count = random.choice((1, 2, 2, 2, 3, 3, 4))
        said: list[Said] = []
        left = Fraction(1)
        if count > 1 and self.shared and self.drawer.often(0.4):
            name, text, _ = random.choice(self.shared)
            said.append((Fraction(text), name, ""))
            left -= Fraction(text)
        if count > 1 and self.drawer.often(0.15):
            said.append((Fraction(0), "0", ""))
        others = max(count - len(said), 1)
        weights = [random.randint(1, 5) for _ in range(others)]
        parts = [left * weight / sum(weights) for weight in weights]
        if self.drawer.often(0.6):
            parts = [Fraction(round(part * 100), 100) for part in parts]
            parts[-1] = left - sum(parts[:-1])
        said += [(part, number(part, random), random.choice(MARKS)) for part in parts]
        if self.drawer.often(0.3):
            said[-1] = (parts[-1], "rest", random.choice(REST_MARKS))
        random.shuffle(said)
        return said

    # ---- effects

    def effects(self) -> tuple[Setting | ForEach, ...]:
        """Mostly of different symbols, so that few outcomes set one fact twice; shifts of one may add up."""
        drawn: list[Setting | ForEach] = []
        used: set[str] = set()
        for _ in range(self.drawer.random.choice((1, 1, 2, 2, 3))):
            if self.drawer.often(0.25):
                each = self.for_each(used)
                drawn += [] if each is None else [each]
            else:
                setting = self.setting(self.scope, used)
                drawn += [] if setting is None else [setting]
        unique: list[Setting | ForEach] = []
        for effect in drawn:
            if all(not same_fact(effect, other) for other in unique):
                unique.append(effect)
        return tuple(unique)

    def for_each(self, used: set[str]) -> ForEach | None:
        drawer = self.drawer
        variables = drawer.fresh(drawer.random.choice((0, 1, 1, 2, 1, 1)))
        scope = (*self.scope, *variables)
        guard = drawer.body(scope, variables, drawer.random.choice((0, 1, 1, 2) if variables else (1, 1, 2)))
        if not variables and not guard:
            return None
        settings = [self.setting(scope, used, variables) for _ in range(drawer.random.choice((1, 1, 2)))]
        found = tuple(dict.fromkeys(setting for setting in settings if setting is not None))
        if len(found) == 2 and same_fact(*found):
            found = found[:1]
        return ForEach(variables, guard, found) if found else None

    def setting(
        self, scope: tuple[Variable, ...], used: set[str], wanted: tuple[Variable, ...] = ()
    ) -> Setting | None:
        drawer = self.drawer
        for _ in range(6):
            symbol = drawer.random.choice(drawer.symbols)
            terms = drawer.terms(symbol.kinds, scope, wanted)
            if symbol.static or terms is None:
                continue
            if symbol.name in used and not drawer.often(0.5 if self.shifts(symbol) else 0.15):
                continue
            used.add(symbol.name)
            return self.of(symbol, terms)
        return None

    def shifts(self, symbol: Symbol) -> bool:
        return bool(symbol.values) and isinstance(symbol.values[0], int)

    def of(self, symbol: Symbol, terms: tuple[str, ...]) -> Setting:
        random = self.drawer.random
        if not symbol.values:
            return SetTruth(symbol.name, terms, random.random() < 0.5)
        if self.shifts(symbol) and random.random() < 0.85:
            return Shift(symbol.name, terms, random.choice((1, 1, 2, 3)) * random.choice((1, -1)))
        return SetValue(symbol.name, terms, random.choice(symbol.values))


def same_fact(one: Setting | ForEach, other: Setting | ForEach) -> bool:
    """Whether two effects are written about the same fact (E308), shifts aside."""
    for each, beside in ((one, other), (other, one)):
        if isinstance(each, ForEach):
            return not each.variables and any(same_fact(setting, beside) for setting in each.settings)
    assert not isinstance(one, ForEach)
    assert not isinstance(other, ForEach)
    if isinstance(one, Shift) and isinstance(other, Shift):
        return False
    return one.symbol == other.symbol and sorted(one.terms) == sorted(other.terms)
