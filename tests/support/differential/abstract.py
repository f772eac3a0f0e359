"""What a domain and a problem say, as plain data of the differential test's own.

Nothing here comes from the product: `drawing.py` makes these objects, `writing.py` prints them as .nid
text for the product, and `interpreter.py` says what they mean (docs/language.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

Value = bool | int | str
Key = tuple[str, tuple[str, ...]]
"""A symbol and the objects that it is said of."""


@dataclass(frozen=True, slots=True)
class Variable:
    name: str
    kind: str


@dataclass(frozen=True, slots=True)
class Symbol:
    """A predicate (`values` is empty) or a function with its values in rising order."""

    name: str
    kinds: tuple[str, ...]
    values: tuple[int | str, ...] = ()
    symmetric: bool = False
    static: bool = False


@dataclass(frozen=True, slots=True)
class Truth:
    """p(...) or not p(...), of a declared or a derived predicate."""

    symbol: str
    terms: tuple[str, ...]
    holds: bool = True


@dataclass(frozen=True, slots=True)
class Comparison:
    symbol: str
    terms: tuple[str, ...]
    relation: str
    value: int | str


@dataclass(frozen=True, slots=True)
class Equality:
    left: str
    right: str
    same: bool = True


Literal = Truth | Comparison | Equality


@dataclass(frozen=True, slots=True)
class AnyOf:
    literals: tuple[Literal, ...]


@dataclass(frozen=True, slots=True)
class Exists:
    variables: tuple[Variable, ...]
    body: tuple[Literal, ...]
    holds: bool = True


@dataclass(frozen=True, slots=True)
class Every:
    variables: tuple[Variable, ...]
    guard: tuple[Literal, ...]
    then: Literal


Part = Literal | AnyOf | Exists | Every


@dataclass(frozen=True, slots=True)
class Definition:
    """A derived predicate that holds where its condition does."""

    name: str
    parameters: tuple[Variable, ...]
    condition: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Closure:
    name: str
    parameters: tuple[Variable, Variable]
    of: str


@dataclass(frozen=True, slots=True)
class Count:
    name: str
    variables: tuple[Variable, ...]
    condition: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class SetTruth:
    symbol: str
    terms: tuple[str, ...]
    holds: bool


@dataclass(frozen=True, slots=True)
class SetValue:
    symbol: str
    terms: tuple[str, ...]
    value: int | str


@dataclass(frozen=True, slots=True)
class Shift:
    symbol: str
    terms: tuple[str, ...]
    amount: int


Setting = SetTruth | SetValue | Shift


@dataclass(frozen=True, slots=True)
class ForEach:
    variables: tuple[Variable, ...]
    guard: tuple[Literal, ...]
    settings: tuple[Setting, ...]


@dataclass(frozen=True, slots=True)
class Priced:
    """`weight`, which may be below 0 where an outcome pays, times the value of a static function."""

    weight: Fraction
    symbol: str
    terms: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Price:
    """A number and what functions come to, in any order, one perhaps several times."""

    number: Fraction = Fraction(0)
    parts: tuple[Priced, ...] = ()


FREE = Price()


@dataclass(frozen=True, slots=True)
class Outcome:
    """`said` is how the probability is written: a number, `rest`, or the name of a shared parameter."""

    probability: Fraction
    said: str
    marks: str
    effects: tuple[Setting | ForEach, ...]
    idle: str = ""
    """`nothing` or `noise`, where there are no effects and nothing is paid."""
    reward: Price = FREE
    cost: Price = FREE
    """What it pays, and what it adds to what its action costs."""


@dataclass(frozen=True, slots=True)
class Reference:
    variables: tuple[Variable, ...]
    body: tuple[Literal, ...]


@dataclass(frozen=True, slots=True)
class Rule:
    """`parameters` are the action's, by the rule's own names."""

    name: str
    action: str
    parameters: tuple[Variable, ...]
    condition: tuple[Part, ...]
    references: tuple[Reference, ...]
    outcomes: tuple[Outcome, ...]
    fixed: bool = False


@dataclass(frozen=True, slots=True)
class Action:
    name: str
    parameters: tuple[Variable, ...]
    duration: str | None
    """With its unit, as it is written."""
    cost: Price | None


@dataclass(frozen=True, slots=True)
class Payment:
    """`kind` is decrease, count, goal, cost or duration."""

    weight: Fraction
    kind: str
    count: str = ""


@dataclass(frozen=True, slots=True)
class Domain:
    name: str
    kinds: tuple[tuple[str, str | None], ...]
    """Each type with the one above it."""
    constants: tuple[Variable, ...]
    symbols: tuple[Symbol, ...]
    derived: tuple[Definition | Closure, ...]
    counts: tuple[Count, ...]
    shared: tuple[tuple[str, str, str], ...]
    """Name, number and marks."""
    actions: tuple[Action, ...]
    rules: tuple[Rule, ...]
    default: str | None
    reward: tuple[Payment, ...]
    included: int = 0
    """How many of the rules stand in an included file, with all declarations."""


@dataclass(frozen=True, slots=True)
class Problem:
    name: str
    objects: tuple[Variable, ...]
    facts: tuple[tuple[Key, Value], ...]
    """Every function's value, and the predicates that are true; in any order."""
    goal: tuple[Part, ...]
    horizon: tuple[int | None, str | None] | None
    """A number, a count, or their sum; None where it is left out."""
    discount: str | None
