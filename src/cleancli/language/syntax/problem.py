"""The sections of a problem."""

from __future__ import annotations

from cleancli.language.syntax.conditions import ConditionNode
from cleancli.language.syntax.node import Node
from cleancli.language.syntax.scene import Setting
from cleancli.language.syntax.words import Application, Group, Name, Number


class DomainName(Node):
    """`domain = name`."""

    name: Name


class Objects(Node):
    """`objects { ... }`."""

    groups: tuple[Group, ...]


class FactNode(Node):
    """`p(objects)` or `f(objects) = value`."""

    application: Application
    value: Name | Number | None


class Init(Node):
    """`init { ... }`."""

    facts: tuple[FactNode, ...]


class Goal(Node):
    """`goal { condition }`."""

    condition: ConditionNode


class HorizonNode(Node):
    """`horizon = n`, `horizon = count`, `horizon = n + count`; `horizon = unlimited` has neither."""

    constant: Number | None
    count: Name | None


class Discount(Node):
    """`discount = number`."""

    value: Number


class Planner(Node):
    """`planner { settings }`."""

    settings: tuple[Setting, ...]


ProblemSection = DomainName | Objects | Init | Goal | HorizonNode | Discount | Planner


class ProblemNode(Node):
    """A whole problem."""

    name: Name
    sections: tuple[ProblemSection, ...]
