"""What came of comparing one drawn domain and problem."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction

from scipy.special import chdtrc

from support.differential.interpreter import Meaning, State
from support.differential.product import near


@dataclass(slots=True)
class Comparison:
    """What came of one seed. `chi` sums squared deviations of drawn frequencies over `freedom` degrees."""

    seed: int
    refused: tuple[str, ...] = ()
    differences: list[str] = field(default_factory=list)
    compared: Counter[str] = field(default_factory=Counter)
    chi: float = 0.0
    freedom: int = 0

    def same(self, what: str, expected: object, actual: object, place: str = "") -> bool:
        self.compared[what] += 1
        if isinstance(expected, float | Fraction) and isinstance(actual, int | float | Fraction):
            equal = near(expected, actual)
        else:
            equal = expected == actual
        if not equal:
            self.differ(what, f"{place}: expected {expected}, got {actual}")
        return equal

    def differ(self, what: str, text: str) -> None:
        self.differences.append(f"{what}: {text}")


def shown(meaning: Meaning, state: State) -> str:
    facts = [
        f"{symbol}({', '.join(objects)})" + ("" if value is True else f" = {value}")
        for (symbol, objects), value in zip(meaning.keys, state, strict=True)
        if value is not False
    ]
    return "{" + ", ".join(facts) + "}"


def unlikely(compared: Iterable[Comparison]) -> float:
    """How probable it is that drawn frequencies are together as far from the declared ones, or farther."""
    found = tuple(compared)
    return float(chdtrc(max(sum(each.freedom for each in found), 1), sum(each.chi for each in found)))
