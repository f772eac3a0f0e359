"""Names, numbers and what is made of them everywhere."""

from __future__ import annotations

from fractions import Fraction

from cleancli.language.syntax.node import Node


class Name(Node):
    """An identifier, or a variable without its `?`."""

    text: str


class Number(Node):
    """A number or fraction as written, signed only as a function's value; `denominator_is_zero` marks `n/0`,
    whose value is 0."""

    value: Fraction
    is_whole: bool
    denominator_is_zero: bool = False


class Quantity(Node):
    """A signed number with a unit, if one is written."""

    value: Fraction
    unit: str | None


class Group(Node):
    """`a b - type`; without a type only in the `types` block."""

    names: tuple[Name, ...]
    type: Name | None


class TermNode(Node):
    """A variable (`name` without `?`) or the name of an object."""

    name: str
    is_variable: bool


class Application(Node):
    """A symbol with terms."""

    symbol: Name
    terms: tuple[TermNode, ...]
