"""The sections of a domain."""

from __future__ import annotations

from cleancli.language.syntax.conditions import ConditionNode
from cleancli.language.syntax.marks import Attribute
from cleancli.language.syntax.node import Node
from cleancli.language.syntax.outcomes import OutcomeNode, Weight
from cleancli.language.syntax.scene import Quoted, Setting
from cleancli.language.syntax.words import Group, Name, Number, TermNode


class Include(Node):
    """`include "path"`; the path is as written."""

    path: str


class Types(Node):
    """`types { ... }`."""

    groups: tuple[Group, ...]


class Constants(Node):
    """`constants { ... }`."""

    groups: tuple[Group, ...]


class PredicateNode(Node):
    """`p(parameters) [attributes]`."""

    name: Name
    parameters: tuple[Group, ...]
    attributes: tuple[Attribute, ...]


class Predicates(Node):
    """`predicates { ... }`."""

    predicates: tuple[PredicateNode, ...]


class Bounds(Node):
    """`low..high`."""

    low: Number
    high: Number


class FunctionNode(Node):
    """`f(parameters): v < w < ...` or `f(parameters): low..high`, with attributes."""

    name: Name
    parameters: tuple[Group, ...]
    values: tuple[Name, ...] | Bounds
    attributes: tuple[Attribute, ...]


class Functions(Node):
    """`functions { ... }`."""

    functions: tuple[FunctionNode, ...]


class CountNode(Node):
    """`name := count parameters: condition`."""

    name: Name
    parameters: tuple[Group, ...]
    condition: ConditionNode


class DefinitionNode(Node):
    """`p(parameters) := condition`."""

    name: Name
    parameters: tuple[Group, ...]
    condition: ConditionNode


class ClosureNode(Node):
    """`p(parameters) := closure of`."""

    name: Name
    parameters: tuple[Group, ...]
    of: Name


class Derived(Node):
    """`derived { ... }`."""

    items: tuple[CountNode | DefinitionNode | ClosureNode, ...]


class ParameterNode(Node):
    """`name = probability [marks]`."""

    name: Name
    weight: Weight


class Shared(Node):
    """`parameters { ... }`."""

    parameters: tuple[ParameterNode, ...]


class ActionNode(Node):
    """`a(parameters) [attributes]`."""

    name: Name
    parameters: tuple[Group, ...]
    attributes: tuple[Attribute, ...]


class Actions(Node):
    """`actions { ... }`."""

    actions: tuple[ActionNode, ...]


class ReferenceNode(Node):
    """`with groups: condition`, of literals."""

    groups: tuple[Group, ...]
    condition: ConditionNode


class RuleNode(Node):
    """`rule name: action(terms) [attributes] { when condition references then outcomes }`."""

    name: Name
    action: Name
    terms: tuple[TermNode, ...]
    attributes: tuple[Attribute, ...]
    condition: ConditionNode | None
    references: tuple[ReferenceNode, ...]
    outcomes: tuple[OutcomeNode, ...]


class Default(Node):
    """`default { outcomes }`."""

    outcomes: tuple[OutcomeNode, ...]


class Decrease(Node):
    """`decrease(count)`."""

    count: Name


class CountValue(Node):
    """The name of a count in a reward."""

    count: Name


class ReachedGoal(Node):
    """`goal` in a reward."""


class ActionCost(Node):
    """`cost` in a reward."""


class ActionDuration(Node):
    """`duration` in a reward."""


class Payment(Node):
    """`weight * what`, the sign before it included; without a weight the sign alone."""

    weight: Number | None
    what: Decrease | CountValue | ReachedGoal | ActionCost | ActionDuration
    negative: bool = False


class Reward(Node):
    """`reward { payment + payment ... }`."""

    payments: tuple[Payment, ...]


class ExperienceNode(Node):
    """`experience "name" [sha256 = "...", transitions = n]`."""

    name: Quoted
    sha256: Quoted
    transitions: Number


class Learned(Node):
    """`learned { settings and experience }`."""

    entries: tuple[Setting | ExperienceNode, ...]


DomainSection = (
    Include
    | Types
    | Constants
    | Predicates
    | Functions
    | Derived
    | Shared
    | Actions
    | RuleNode
    | Default
    | Reward
    | Learned
)


class DomainNode(Node):
    """A whole domain."""

    name: Name
    sections: tuple[DomainSection, ...]
