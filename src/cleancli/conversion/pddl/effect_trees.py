"""Effects of PDDL as trees over .nid symbols, and what is left of a tree where some formulas hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Formula,
    Known,
    MayBeOne,
    both,
    substituted,
)
from cleancli.language.model import NOTHING_PAID, Price, Term, Variable


@dataclass(frozen=True, slots=True)
class Change:
    """A predicate becomes `value` for some terms, for each binding of `variables` that `guard` holds for;
    each of these variables is among the terms. Without variables it does so where `guard` holds."""

    variables: tuple[Variable, ...]
    guard: Formula
    symbol: str
    terms: tuple[Term, ...]
    value: bool


@dataclass(frozen=True, slots=True)
class All:
    """All of these happen; none is no change."""

    parts: tuple[Tree, ...]


@dataclass(frozen=True, slots=True)
class Branch:
    """This happens where a condition held before."""

    condition: Formula
    part: Tree


@dataclass(frozen=True, slots=True)
class Chance:
    """One of these happens; what their probabilities leave of 1 changes nothing."""

    branches: tuple[tuple[Fraction, Tree], ...]


@dataclass(frozen=True, slots=True)
class Paid:
    """What is earned and what it costs, 0 or more each."""

    reward: Price = NOTHING_PAID
    cost: Price = NOTHING_PAID

    def __bool__(self) -> bool:
        return bool(self.reward or self.cost)

    def __add__(self, other: Paid) -> Paid:
        return Paid(self.reward + other.reward, self.cost + other.cost)

    @property
    def in_all(self) -> Paid:
        """The same as a cost, or as a reward where more is earned."""
        return paid_by(self.cost + self.reward.times(Fraction(-1)))


UNPAID = Paid()


def paid_by(price: Price) -> Paid:
    """What costs so much; what is below 0 is earned."""
    cost, reward = price.by_sign()
    return Paid(reward, cost)


@dataclass(frozen=True, slots=True)
class Pay:
    """So much is paid; `asked` says that the values for it are known."""

    paid: Paid = UNPAID
    asked: Formula = ALWAYS


Tree = Change | All | Branch | Chance | Pay


NOTHING = All(())


def decided(tree: Tree, known: Known) -> Tree:
    """What is left of a tree where some formulas hold."""
    match tree:
        case Change():
            guard = known.left_of(tree.guard)
            if guard == tree.guard:
                return tree
            return NOTHING if guard == NEVER else replace(tree, guard=guard)
        case All(parts):
            return All(tuple([found for part in parts if (found := decided(part, known)) != NOTHING]))
        case Branch(condition, part):
            asked = known.left_of(condition)
            inner = decided(part, Known([*known.formulas, asked]))
            if asked == NEVER or inner == NOTHING:
                return NOTHING
            return inner if asked == ALWAYS else Branch(asked, inner)
        case Chance(branches):
            return Chance(tuple([(p, decided(part, known)) for p, part in branches]))
        case Pay():
            return tree


def renamed(tree: Tree, terms: Mapping[Term, Term], may_be_one: MayBeOne) -> Tree:
    """The tree with other terms in place of some of the rule's own."""
    match tree:
        case Change():
            guard = substituted(tree.guard, terms, may_be_one)
            changed = tuple([terms.get(term, term) for term in tree.terms])
            return Change(tree.variables, guard, tree.symbol, changed, tree.value)
        case All(parts):
            return All(tuple(renamed(part, terms, may_be_one) for part in parts))
        case Branch(condition, part):
            return Branch(substituted(condition, terms, may_be_one), renamed(part, terms, may_be_one))
        case Chance(branches):
            return Chance(tuple((p, renamed(part, terms, may_be_one)) for p, part in branches))
        case Pay():
            return tree  # by either name a function has the same value


def guarded(tree: Tree, guard: Formula = ALWAYS) -> Tree:
    """The tree, in which costs depend on no condition, with the conditions of its parts as those of the
    changes in them."""
    match tree:
        case Change():
            return replace(tree, guard=both([guard, tree.guard]))
        case All(parts):
            return All(tuple(guarded(part, guard) for part in parts))
        case Branch(condition, part):
            return guarded(part, both([guard, condition]))
        case Chance(branches):
            return Chance(tuple((p, guarded(part, guard)) for p, part in branches))
        case Pay():
            return tree


def first_condition(tree: Tree, *, paying: bool = False) -> Formula | None:
    """The condition of the first part that happens where one holds, None where there is no such part; with
    `paying` of the first that costs something."""
    match tree:
        case Branch(condition, part):
            return condition if not paying or _costs(part) else None
        case All(parts):
            inner = parts
        case Chance(branches):
            inner = tuple(part for _, part in branches)
        case Change() | Pay():
            return None
    return next((c for part in inner if (c := first_condition(part, paying=paying)) is not None), None)


def _costs(tree: Tree) -> bool:
    """Whether a part of a tree costs something."""
    match tree:
        case Pay(paid):
            return bool(paid)
        case All(parts):
            return any(map(_costs, parts))
        case Branch(_, part):
            return _costs(part)
        case Chance(branches):
            return any(_costs(part) for _, part in branches)
        case Change():
            return False


def known_for(tree: Tree) -> Iterator[Formula]:
    """What has to be known for what is paid whatever conditions hold."""
    match tree:
        case Pay(asked=asked):
            yield asked
        case All(parts):
            for part in parts:
                yield from known_for(part)
        case Chance(branches):
            for _, part in branches:
                yield from known_for(part)
        case Branch() | Change():
            return
