"""What stands in brackets behind a declaration or a number."""

from __future__ import annotations

from cleancli.language.syntax.node import Node
from cleancli.language.syntax.words import Name, Number, Quantity


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


class Attribute(Node):
    """`name`, `name = value` or `name = value [marks]` between brackets."""

    name: Name
    value: Quantity | None
    marks: tuple[QuantityPrior | Seen | Fixed, ...] = ()
