"""The syntax tree: what the text says, token by token, before anything is known about its names.

Guaranteed by the parser: the structure is that of grammar/nid.lark; every node's span lies in the text it
was read from. Equality ignores spans, so that two layouts of one text give equal trees.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from cleancli.language.diagnostics import Span


@dataclass(frozen=True, slots=True)
class Node:
    """Anything that stands in the text."""

    span: Span = field(compare=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Name(Node):
    """An identifier, or a variable without its `?`."""

    text: str


@dataclass(frozen=True, slots=True)
class Number(Node):
    """An unsigned number or fraction as written; `denominator_is_zero` marks `n/0`, whose value is 0."""

    value: Fraction
    is_whole: bool
    denominator_is_zero: bool = False


@dataclass(frozen=True, slots=True)
class Quantity(Node):
    """A signed number with a unit, if one is written."""

    value: Fraction
    unit: str | None


# ---- names with types


@dataclass(frozen=True, slots=True)
class Group(Node):
    """`a b - type`; without a type only in the `types` block."""

    names: tuple[Name, ...]
    type: Name | None


@dataclass(frozen=True, slots=True)
class Attribute(Node):
    """`name` or `name = value` between brackets."""

    name: Name
    value: Quantity | None


# ---- conditions and effects


@dataclass(frozen=True, slots=True)
class TermNode(Node):
    """A variable (`name` without `?`) or the name of an object."""

    name: str
    is_variable: bool


@dataclass(frozen=True, slots=True)
class Application(Node):
    """A symbol with terms."""

    symbol: Name
    terms: tuple[TermNode, ...]


@dataclass(frozen=True, slots=True)
class Truth(Node):
    """`p(...)` or `not p(...)`."""

    application: Application
    positive: bool


@dataclass(frozen=True, slots=True)
class Comparison(Node):
    """`f(...) relation value`; the relation is one of = != < <= > >=."""

    application: Application
    relation: str
    value: Name


@dataclass(frozen=True, slots=True)
class EqualityNode(Node):
    """`?a = ?b` or `?a != ?b`."""

    left: TermNode
    right: TermNode
    equal: bool


LiteralNode = Truth | Comparison | EqualityNode


@dataclass(frozen=True, slots=True)
class ConditionNode(Node):
    """Literals joined by commas."""

    literals: tuple[LiteralNode, ...]


@dataclass(frozen=True, slots=True)
class SetTruth(Node):
    """The effect `p(...)` or `not p(...)`."""

    application: Application
    value: bool


@dataclass(frozen=True, slots=True)
class SetValue(Node):
    """The effect `f(...) := value`."""

    application: Application
    value: Name


Assignment = SetTruth | SetValue


@dataclass(frozen=True, slots=True)
class ForAllNode(Node):
    """`forall groups: condition => effects`."""

    groups: tuple[Group, ...]
    condition: ConditionNode | None
    effects: tuple[Assignment, ...]


@dataclass(frozen=True, slots=True)
class Nothing(Node):
    """The result `nothing`."""


@dataclass(frozen=True, slots=True)
class Noise(Node):
    """The result `noise`."""


@dataclass(frozen=True, slots=True)
class Effects(Node):
    """A result that lists effects."""

    effects: tuple[Assignment | ForAllNode, ...]


@dataclass(frozen=True, slots=True)
class Rest(Node):
    """The word `rest` in the place of a probability."""


@dataclass(frozen=True, slots=True)
class Prior(Node):
    """`prior p`."""

    probability: Number


@dataclass(frozen=True, slots=True)
class Seen(Node):
    """`seen n`."""

    count: Number


@dataclass(frozen=True, slots=True)
class Weight(Node):
    """An outcome's probability with what the learner noted beside it."""

    chance: Number | Rest
    marks: tuple[Prior | Seen, ...]


@dataclass(frozen=True, slots=True)
class OutcomeNode(Node):
    """`weight: result`."""

    weight: Weight
    result: Nothing | Noise | Effects


# ---- the sections of a domain


@dataclass(frozen=True, slots=True)
class Types(Node):
    """`types { ... }`."""

    groups: tuple[Group, ...]


@dataclass(frozen=True, slots=True)
class Constants(Node):
    """`constants { ... }`."""

    groups: tuple[Group, ...]


@dataclass(frozen=True, slots=True)
class PredicateNode(Node):
    """`p(parameters) [attributes]`."""

    name: Name
    parameters: tuple[Group, ...]
    attributes: tuple[Attribute, ...]


@dataclass(frozen=True, slots=True)
class Predicates(Node):
    """`predicates { ... }`."""

    predicates: tuple[PredicateNode, ...]


@dataclass(frozen=True, slots=True)
class FunctionNode(Node):
    """`f(parameters): v < w < ...`."""

    name: Name
    parameters: tuple[Group, ...]
    values: tuple[Name, ...]


@dataclass(frozen=True, slots=True)
class Functions(Node):
    """`functions { ... }`."""

    functions: tuple[FunctionNode, ...]


@dataclass(frozen=True, slots=True)
class CountNode(Node):
    """`name := count parameters: condition`."""

    name: Name
    parameters: tuple[Group, ...]
    condition: ConditionNode


@dataclass(frozen=True, slots=True)
class Derived(Node):
    """`derived { ... }`."""

    counts: tuple[CountNode, ...]


@dataclass(frozen=True, slots=True)
class ActionNode(Node):
    """`a(parameters) [attributes]`."""

    name: Name
    parameters: tuple[Group, ...]
    attributes: tuple[Attribute, ...]


@dataclass(frozen=True, slots=True)
class Actions(Node):
    """`actions { ... }`."""

    actions: tuple[ActionNode, ...]


@dataclass(frozen=True, slots=True)
class RuleNode(Node):
    """`rule name: action(terms) { when condition then outcomes }`."""

    name: Name
    action: Name
    terms: tuple[TermNode, ...]
    condition: ConditionNode | None
    outcomes: tuple[OutcomeNode, ...]


@dataclass(frozen=True, slots=True)
class Default(Node):
    """`default { outcomes }`."""

    outcomes: tuple[OutcomeNode, ...]


@dataclass(frozen=True, slots=True)
class Reward(Node):
    """`reward { decrease(count) }`."""

    count: Name


DomainSection = Types | Constants | Predicates | Functions | Derived | Actions | RuleNode | Default | Reward


@dataclass(frozen=True, slots=True)
class DomainNode(Node):
    """A whole domain."""

    name: Name
    sections: tuple[DomainSection, ...]


# ---- the sections of a problem


@dataclass(frozen=True, slots=True)
class DomainName(Node):
    """`domain = name`."""

    name: Name


@dataclass(frozen=True, slots=True)
class Objects(Node):
    """`objects { ... }`."""

    groups: tuple[Group, ...]


@dataclass(frozen=True, slots=True)
class FactNode(Node):
    """`p(objects)` or `f(objects) = value`."""

    application: Application
    value: Name | None


@dataclass(frozen=True, slots=True)
class Init(Node):
    """`init { ... }`."""

    facts: tuple[FactNode, ...]


@dataclass(frozen=True, slots=True)
class HorizonNode(Node):
    """`horizon = n`, `horizon = count` or `horizon = n + count`."""

    constant: Number | None
    count: Name | None


@dataclass(frozen=True, slots=True)
class Discount(Node):
    """`discount = number`."""

    value: Number


ProblemSection = DomainName | Objects | Init | HorizonNode | Discount


@dataclass(frozen=True, slots=True)
class ProblemNode(Node):
    """A whole problem."""

    name: Name
    sections: tuple[ProblemSection, ...]


# ---- scenes


@dataclass(frozen=True, slots=True)
class Pair(Node):
    """`(x, y)`."""

    x: Quantity
    y: Quantity


@dataclass(frozen=True, slots=True)
class ImageSize(Node):
    """`width x height`."""

    width: Number
    height: Number


@dataclass(frozen=True, slots=True)
class Call(Node):
    """`name(numbers)`."""

    name: Name
    arguments: tuple[Number, ...]


@dataclass(frozen=True, slots=True)
class Word(Node):
    """A name as a value."""

    text: str


SettingValue = Quantity | Pair | ImageSize | Call | Word


@dataclass(frozen=True, slots=True)
class Setting(Node):
    """`key = value`."""

    key: Name
    value: SettingValue


@dataclass(frozen=True, slots=True)
class Section(Node):
    """`name { entries }`."""

    name: Name
    entries: tuple[Setting | Section, ...]


@dataclass(frozen=True, slots=True)
class SceneNode(Node):
    """A whole scene."""

    name: Name
    entries: tuple[Setting | Section, ...]


Root = DomainNode | ProblemNode | SceneNode
