"""Outcomes: a weight, and the effects that it gives a chance to."""

from __future__ import annotations

from cleancli.language.syntax.conditions import ConditionNode
from cleancli.language.syntax.marks import Fixed, Price, Prior, Seen
from cleancli.language.syntax.node import Node
from cleancli.language.syntax.words import Application, Group, Name, Number


class SetTruth(Node):
    """The effect `p(...)` or `not p(...)`."""

    application: Application
    value: bool


class SetValue(Node):
    """The effect `f(...) := value`."""

    application: Application
    value: Name | Number


class ShiftNode(Node):
    """The effect `f(...) += n` or `f(...) -= n`."""

    application: Application
    rises: bool
    amount: Number


Assignment = SetTruth | SetValue | ShiftNode


class ForAllNode(Node):
    """`forall groups: condition => effects`."""

    groups: tuple[Group, ...]
    condition: ConditionNode | None
    effects: tuple[Assignment, ...]


class IfNode(Node):
    """`if condition => effects`."""

    condition: ConditionNode
    effects: tuple[Assignment, ...]


class PayNode(Node):
    """`reward += price`, `reward -= price` or `cost += price`."""

    what: Name
    rises: bool
    price: Price


class Nothing(Node):
    """The result `nothing`."""


class Noise(Node):
    """The result `noise`."""


class Effects(Node):
    """A result that lists effects."""

    effects: tuple[Assignment | ForAllNode | IfNode | PayNode, ...]


class Rest(Node):
    """The word `rest` in the place of a probability."""


class Share(Node):
    """The name of a shared parameter in the place of a probability."""

    name: Name


class Weight(Node):
    """A probability with what the learner noted beside it; that of a shared parameter is a number."""

    chance: Number | Rest | Share
    marks: tuple[Prior | Seen | Fixed, ...]


class OutcomeNode(Node):
    """`weight: result`."""

    weight: Weight
    result: Nothing | Noise | Effects
