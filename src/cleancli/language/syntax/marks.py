"""What stands in brackets behind a declaration or a number."""

from __future__ import annotations

from cleancli.language.syntax.node import Node
from cleancli.language.syntax.words import Application, Name, Number, Quantity


class Prior(Node):
    """`prior p`, of a probability."""

    probability: Number


class QuantityPrior(Node):
    """`prior q`, of a quantity."""

    quantity: Quantity


class Seen(Node):
    """`seen n`; `n` may have a point."""

    count: Number


class Fixed(Node):
    """The mark `fixed`."""


class Priced(Node):
    """`weight * f(...)`; without a weight the value of the function as it is."""

    weight: Number | None
    application: Application


class Price(Node):
    """`amount + weight * f(...) + ...`; a fraction is an amount alone."""

    amount: Number | None
    parts: tuple[Priced, ...]


class Attribute(Node):
    """`name`, `name = value` or `name = value [marks]` between brackets."""

    name: Name
    value: Quantity | Price | None
    marks: tuple[QuantityPrior | Seen | Fixed, ...] = ()
