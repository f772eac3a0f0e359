"""The syntax tree: what the text says, token by token, before anything is known about its names.

Guaranteed by the parser: the structure is that of grammar/nid.lark; every node's span lies in the text it
was read from. Equality ignores spans, so that two layouts of one text give equal trees.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from fractions import Fraction

from cleancli.language.diagnostics import Span


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Node:
    """Anything that stands in the text.

    Equality, hash and text are written once here: made anew for every node they would take longer than
    checking a file does.
    """

    span: Span = field(compare=False, kw_only=True)

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self._said() == other._said()

    def __hash__(self) -> int:
        return hash((type(self), self._said()))

    def __repr__(self) -> str:
        said = ", ".join(map(repr, self._said()))
        return f"{type(self).__name__}({said})"

    def _said(self) -> tuple[object, ...]:
        """The values of all fields but the span."""
        return tuple(getattr(self, part.name) for part in fields(self) if part.compare)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Name(Node):
    """An identifier, or a variable without its `?`."""

    text: str


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Number(Node):
    """A number or fraction as written, signed only as a function's value; `denominator_is_zero` marks `n/0`,
    whose value is 0."""

    value: Fraction
    is_whole: bool
    denominator_is_zero: bool = False


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Quantity(Node):
    """A signed number with a unit, if one is written."""

    value: Fraction
    unit: str | None


# ---- names with types


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Group(Node):
    """`a b - type`; without a type only in the `types` block."""

    names: tuple[Name, ...]
    type: Name | None


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Attribute(Node):
    """`name` or `name = value` between brackets."""

    name: Name
    value: Quantity | None


# ---- conditions and effects


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TermNode(Node):
    """A variable (`name` without `?`) or the name of an object."""

    name: str
    is_variable: bool


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Application(Node):
    """A symbol with terms."""

    symbol: Name
    terms: tuple[TermNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Truth(Node):
    """`p(...)` or `not p(...)`."""

    application: Application
    positive: bool


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Comparison(Node):
    """`f(...) relation value`; the relation is one of = != < <= > >=."""

    application: Application
    relation: str
    value: Name | Number


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class EqualityNode(Node):
    """`?a = ?b` or `?a != ?b`."""

    left: TermNode
    right: TermNode
    equal: bool


LiteralNode = Truth | Comparison | EqualityNode


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ExistsNode(Node):
    """`exists groups: literals`, or `not exists`."""

    groups: tuple[Group, ...]
    literals: tuple[LiteralNode, ...]
    positive: bool


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class EveryNode(Node):
    """`forall groups: guard => literal` in a condition; without a guard, `forall groups: literal`."""

    groups: tuple[Group, ...]
    guard: tuple[LiteralNode, ...]
    literal: LiteralNode


PartNode = LiteralNode | ExistsNode | EveryNode


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ConditionNode(Node):
    """Literals and quantified parts joined by commas; the grammar says where there are only literals."""

    parts: tuple[PartNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SetTruth(Node):
    """The effect `p(...)` or `not p(...)`."""

    application: Application
    value: bool


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SetValue(Node):
    """The effect `f(...) := value`."""

    application: Application
    value: Name | Number


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ShiftNode(Node):
    """The effect `f(...) += n` or `f(...) -= n`."""

    application: Application
    rises: bool
    amount: Number


Assignment = SetTruth | SetValue | ShiftNode


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ForAllNode(Node):
    """`forall groups: condition => effects`."""

    groups: tuple[Group, ...]
    condition: ConditionNode | None
    effects: tuple[Assignment, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Nothing(Node):
    """The result `nothing`."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Noise(Node):
    """The result `noise`."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Effects(Node):
    """A result that lists effects."""

    effects: tuple[Assignment | ForAllNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Rest(Node):
    """The word `rest` in the place of a probability."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Prior(Node):
    """`prior p`."""

    probability: Number


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Seen(Node):
    """`seen n`."""

    count: Number


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Fixed(Node):
    """The mark `fixed`."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Share(Node):
    """The name of a shared parameter in the place of a probability."""

    name: Name


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Weight(Node):
    """A probability with what the learner noted beside it; that of a shared parameter is a number."""

    chance: Number | Rest | Share
    marks: tuple[Prior | Seen | Fixed, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class OutcomeNode(Node):
    """`weight: result`."""

    weight: Weight
    result: Nothing | Noise | Effects


# ---- the sections of a domain


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Include(Node):
    """`include "path"`; the path is as written."""

    path: str


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Types(Node):
    """`types { ... }`."""

    groups: tuple[Group, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Constants(Node):
    """`constants { ... }`."""

    groups: tuple[Group, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PredicateNode(Node):
    """`p(parameters) [attributes]`."""

    name: Name
    parameters: tuple[Group, ...]
    attributes: tuple[Attribute, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Predicates(Node):
    """`predicates { ... }`."""

    predicates: tuple[PredicateNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Bounds(Node):
    """`low..high`."""

    low: Number
    high: Number


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FunctionNode(Node):
    """`f(parameters): v < w < ...` or `f(parameters): low..high`, with attributes."""

    name: Name
    parameters: tuple[Group, ...]
    values: tuple[Name, ...] | Bounds
    attributes: tuple[Attribute, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Functions(Node):
    """`functions { ... }`."""

    functions: tuple[FunctionNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class CountNode(Node):
    """`name := count parameters: condition`."""

    name: Name
    parameters: tuple[Group, ...]
    condition: ConditionNode


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class DefinitionNode(Node):
    """`p(parameters) := condition`."""

    name: Name
    parameters: tuple[Group, ...]
    condition: ConditionNode


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ClosureNode(Node):
    """`p(parameters) := closure of`."""

    name: Name
    parameters: tuple[Group, ...]
    of: Name


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Derived(Node):
    """`derived { ... }`."""

    items: tuple[CountNode | DefinitionNode | ClosureNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ParameterNode(Node):
    """`name = probability [marks]`."""

    name: Name
    weight: Weight


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Shared(Node):
    """`parameters { ... }`."""

    parameters: tuple[ParameterNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ActionNode(Node):
    """`a(parameters) [attributes]`."""

    name: Name
    parameters: tuple[Group, ...]
    attributes: tuple[Attribute, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Actions(Node):
    """`actions { ... }`."""

    actions: tuple[ActionNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ReferenceNode(Node):
    """`with groups: condition`, of literals."""

    groups: tuple[Group, ...]
    condition: ConditionNode


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class RuleNode(Node):
    """`rule name: action(terms) [attributes] { when condition references then outcomes }`."""

    name: Name
    action: Name
    terms: tuple[TermNode, ...]
    attributes: tuple[Attribute, ...]
    condition: ConditionNode | None
    references: tuple[ReferenceNode, ...]
    outcomes: tuple[OutcomeNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Default(Node):
    """`default { outcomes }`."""

    outcomes: tuple[OutcomeNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Decrease(Node):
    """`decrease(count)`."""

    count: Name


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class CountValue(Node):
    """The name of a count in a reward."""

    count: Name


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ReachedGoal(Node):
    """`goal` in a reward."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ActionCost(Node):
    """`cost` in a reward."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Payment(Node):
    """`weight * what`, the sign before it included; without a weight the sign alone."""

    weight: Number | None
    what: Decrease | CountValue | ReachedGoal | ActionCost
    negative: bool = False


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Reward(Node):
    """`reward { payment + payment ... }`."""

    payments: tuple[Payment, ...]


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
)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class DomainNode(Node):
    """A whole domain."""

    name: Name
    sections: tuple[DomainSection, ...]


# ---- the sections of a problem


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class DomainName(Node):
    """`domain = name`."""

    name: Name


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Objects(Node):
    """`objects { ... }`."""

    groups: tuple[Group, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FactNode(Node):
    """`p(objects)` or `f(objects) = value`."""

    application: Application
    value: Name | Number | None


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Init(Node):
    """`init { ... }`."""

    facts: tuple[FactNode, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Goal(Node):
    """`goal { condition }`."""

    condition: ConditionNode


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class HorizonNode(Node):
    """`horizon = n`, `horizon = count` or `horizon = n + count`."""

    constant: Number | None
    count: Name | None


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Discount(Node):
    """`discount = number`."""

    value: Number


# ---- settings


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Pair(Node):
    """`(x, y)`."""

    x: Quantity
    y: Quantity


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Points(Node):
    """`((x, y), ...)`."""

    points: tuple[Pair, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ImageSize(Node):
    """`width x height`."""

    width: Number
    height: Number


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Call(Node):
    """`name(numbers)`."""

    name: Name
    arguments: tuple[Number, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Word(Node):
    """A name as a value."""

    text: str


SettingValue = Quantity | Pair | Points | ImageSize | Call | Word


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Setting(Node):
    """`key = value`."""

    key: Name
    value: SettingValue


# ---- problems and scenes


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Planner(Node):
    """`planner { settings }`."""

    settings: tuple[Setting, ...]


ProblemSection = DomainName | Objects | Init | Goal | HorizonNode | Discount | Planner


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ProblemNode(Node):
    """A whole problem."""

    name: Name
    sections: tuple[ProblemSection, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Section(Node):
    """`name { entries }`, or `name title { entries }` for one of several that are told apart by a title."""

    name: Name
    title: Name | None
    entries: tuple[Setting | Section, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SceneNode(Node):
    """A whole scene."""

    name: Name
    entries: tuple[Setting | Section, ...]


Root = DomainNode | ProblemNode | SceneNode
