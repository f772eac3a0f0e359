"""What PPDDL files say, with places that equality ignores; names are in lower case, since letter case says
nothing.

The language is that of Younes and Littman, PPDDL1.0 (2004), over PDDL2.1 without durative actions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import NamedTuple

from cleancli.conversion.pddl.words import Group, Word
from cleancli.language.diagnostics.diagnostic import Span


@dataclass(frozen=True, slots=True)
class Node:
    """Something that stands at a place."""

    span: Span = field(compare=False, repr=False, kw_only=True)


@dataclass(frozen=True, slots=True)
class Name:
    """A name; that of a variable begins with `?`. Its span is made when it is asked for, as it seldom is."""

    text: str
    path: str = field(compare=False, repr=False)
    start: int = field(compare=False, repr=False)

    @property
    def span(self) -> Span:
        """Where it stands."""
        return Span(self.path, self.start, self.start + len(self.text))

    @property
    def is_variable(self) -> bool:
        """Whether it is the name of a variable."""
        return self.text.startswith("?")


@dataclass(frozen=True, slots=True)
class Typed:
    """A name with its type: several are `either` of them, none is any object."""

    name: Name
    types: tuple[Name, ...]


class ObjectsNode(NamedTuple):
    """Objects that are declared together, with their type as in `Typed`. Problems have thousands of them, and
    hardly one has a mistake: the place of one is made of its word where it is told."""

    words: tuple[Word, ...]
    types: tuple[Name, ...]


@dataclass(frozen=True, slots=True)
class Signature(Node):
    """A declared predicate or numeric function."""

    name: Name
    parameters: tuple[Typed, ...]


# ---- conditions


@dataclass(frozen=True, slots=True)
class AtomNode(Node):
    """A predicate, or a numeric function, of some terms."""

    symbol: Name
    terms: tuple[Name, ...]


@dataclass(frozen=True, slots=True)
class EqualNode(Node):
    """That two terms are one object."""

    left: Name
    right: Name


@dataclass(frozen=True, slots=True)
class NotNode(Node):
    """That a condition does not hold."""

    part: ConditionNode


@dataclass(frozen=True, slots=True)
class AndNode(Node):
    """That all of these hold; none is always true."""

    parts: tuple[ConditionNode, ...]


@dataclass(frozen=True, slots=True)
class OrNode(Node):
    """That one of these holds; none is never true."""

    parts: tuple[ConditionNode, ...]


@dataclass(frozen=True, slots=True)
class QuantifiedNode(Node):
    """That some binding of the variables satisfies a condition (`exists`), or each does."""

    exists: bool
    variables: tuple[Typed, ...]
    part: ConditionNode


@dataclass(frozen=True, slots=True)
class CompareNode(Node):
    """A comparison of numbers, of which no more is known."""


ConditionNode = AtomNode | EqualNode | NotNode | AndNode | OrNode | QuantifiedNode | CompareNode


# ---- effects


@dataclass(frozen=True, slots=True)
class SetNode(Node):
    """That an atom becomes true, or false."""

    atom: AtomNode
    value: bool


@dataclass(frozen=True, slots=True)
class AllNode(Node):
    """That all of these happen, independently of each other where chance has a part in them."""

    parts: tuple[EffectNode, ...]


@dataclass(frozen=True, slots=True)
class WhenNode(Node):
    """That an effect happens where a condition held before."""

    condition: ConditionNode
    effect: EffectNode


@dataclass(frozen=True, slots=True)
class EachNode(Node):
    """That an effect happens for each binding of the variables, independently of each other."""

    variables: tuple[Typed, ...]
    effect: EffectNode


@dataclass(frozen=True, slots=True)
class ChanceNode(Node):
    """That one of these effects happens, with its probability; what they leave of 1 changes nothing."""

    branches: tuple[tuple[Fraction, EffectNode], ...]


@dataclass(frozen=True, slots=True)
class PayNode(Node):
    """That a numeric function rises by an amount, below 0 where it falls: a sum of multiples of functions'
    values, or of 1 (None in the place of a function). None for an amount that is no such sum."""

    function: AtomNode
    amount: tuple[tuple[Fraction, AtomNode | None], ...] | None


EffectNode = SetNode | AllNode | WhenNode | EachNode | ChanceNode | PayNode


def all_within(node: EffectNode) -> Iterator[EffectNode]:
    """An effect, and all effects in it, whatever has to hold or to be drawn for them."""
    yield node
    match node:
        case AllNode(parts):
            inner = parts
        case WhenNode() | EachNode():
            inner = (node.effect,)
        case ChanceNode(branches):
            inner = tuple(part for _, part in branches)
        case SetNode() | PayNode():
            return
    for part in inner:
        yield from all_within(part)


# ---- files


@dataclass(frozen=True, slots=True)
class ActionNode(Node):
    """An action schema; what is missing is always true, and changes nothing."""

    name: Name
    parameters: tuple[Typed, ...]
    precondition: ConditionNode
    effect: EffectNode


@dataclass(frozen=True, slots=True)
class DomainNode(Node):
    """A domain; each of its sections may be missing."""

    name: Name
    types: tuple[Typed, ...] = ()
    constants: tuple[ObjectsNode, ...] = ()
    predicates: tuple[Signature, ...] = ()
    functions: tuple[Signature, ...] = ()
    actions: tuple[ActionNode, ...] = ()


class FactsNode(NamedTuple):
    """Facts of predicates and objects by their names, and an `:init` with nothing else in it. Problems have
    thousands of facts, and hardly one has a mistake: what has places is made of a group where one is told."""

    names: Sequence[tuple[str, ...]]
    section: Group

    @property
    def groups(self) -> Iterator[Group]:
        """The group of each."""
        return (item for item in self.section.items if isinstance(item, Group))


@dataclass(frozen=True, slots=True)
class ValueNode(Node):
    """The value of a numeric function at first."""

    function: AtomNode
    value: Fraction


@dataclass(frozen=True, slots=True)
class MetricNode(Node):
    """What is to be greatest or least: the value of a numeric function, `total-time` or the like; None for an
    expression."""

    greatest: bool
    function: Name | None


@dataclass(frozen=True, slots=True)
class ProblemNode(Node):
    """A problem; `init` has the facts that hold, and what chance decides of them."""

    name: Name
    domain: Name | None
    objects: tuple[ObjectsNode, ...] = ()
    init: tuple[FactsNode | SetNode | ChanceNode, ...] = ()
    values: tuple[ValueNode, ...] = ()
    goal: ConditionNode | None = None
    metric: MetricNode | None = None
    goal_reward: Fraction | None = None
    goal_probability: Fraction | None = None
