"""What conditions are made of."""

from __future__ import annotations

from cleancli.language.syntax.node import Node
from cleancli.language.syntax.words import Application, Group, Name, Number, TermNode


class Truth(Node):
    """`p(...)` or `not p(...)`."""

    application: Application
    positive: bool


class Comparison(Node):
    """`f(...) relation value`; the relation is one of = != < <= > >=."""

    application: Application
    relation: str
    value: Name | Number


class EqualityNode(Node):
    """`?a = ?b` or `?a != ?b`."""

    left: TermNode
    right: TermNode
    equal: bool


LiteralNode = Truth | Comparison | EqualityNode


class EitherNode(Node):
    """`(literal or literal)`, of two or more."""

    literals: tuple[LiteralNode, ...]


class ExistsNode(Node):
    """`exists groups: literals`, or `not exists`."""

    groups: tuple[Group, ...]
    literals: tuple[LiteralNode, ...]
    positive: bool


class EveryNode(Node):
    """`forall groups: guard => literal` in a condition; without a guard, `forall groups: literal`."""

    groups: tuple[Group, ...]
    guard: tuple[LiteralNode, ...]
    literal: LiteralNode


PartNode = LiteralNode | EitherNode | ExistsNode | EveryNode


class ConditionNode(Node):
    """Literals and quantified parts joined by commas; the grammar says where there are only literals."""

    parts: tuple[PartNode, ...]
