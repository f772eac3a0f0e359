"""Effects of PDDL as trees over .nid symbols, and what such a tree comes to.

`forall` is pushed inwards to the atoms that are set. What is drawn or paid inside of it is so for each object
by itself, so there it is written out for all objects of the problem (Younes and Littman 2004, section 2.2).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from itertools import groupby, product
from math import prod

from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Formula,
    Known,
    MayBeOne,
    both,
    either,
    free_variables,
    quantified,
    substituted,
)
from cleancli.conversion.pddl.functions import Functions
from cleancli.conversion.pddl.resolve import Scope, Words
from cleancli.conversion.pddl.statics import Statics
from cleancli.conversion.pddl.syntax import (
    AllNode,
    ChanceNode,
    EachNode,
    EffectNode,
    Name,
    PayNode,
    SetNode,
    WhenNode,
)
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import NOTHING_PAID, Literal, Object, Price, Term, Variable

MOST_OUTCOMES = 512
"""Outcomes that one rule may have. Chosen: more than people read, and few enough to plan with."""

MOST_SHARED = 64
"""Draws beside each other of which it is looked up which of them no state lets happen together. Chosen: each
two are compared."""

MOST_BINDINGS = 1000
"""Bindings that one `forall` may be written out for. Chosen: where chance has a part far fewer are of use."""


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


def paid_by(price: Price) -> Paid:
    """What costs so much; what is below 0 is earned."""
    cost, reward = price.by_sign()
    return Paid(reward, cost)


@dataclass(frozen=True, slots=True)
class Pay:
    """So much is paid; `asked` says that the values for it are known."""

    paid: Paid = Paid()
    asked: Formula = ALWAYS


Tree = Change | All | Branch | Chance | Pay

NOTHING = All(())


class TooMany(Exception):
    """An action has more outcomes than `MOST_OUTCOMES`."""


class Effects:
    """Makes trees of effects. `counted` is the numeric function that is to be small, with 1, or great, with
    -1; other functions count nothing. `earned` tells whether it counts up to a horizon."""

    def __init__(
        self,
        words: Words,
        counted: Mapping[str, int],
        functions: Functions,
        statics: Statics,
        earned: bool,
    ) -> None:
        self._words = words
        self._functions = functions
        self._statics = statics
        self.counted = counted
        self.earned = earned
        self._written_out = self._drawn_once = False

    @property
    def notes(self) -> tuple[str, ...]:
        """What the trees do not say as the files do."""
        found = []
        if self._written_out:
            found.append("rules are written out for the objects where something is drawn or paid for each")
        if self._drawn_once:
            found.append("chance decides once where the problem's facts leave at most one object")
        return tuple(found)

    def never_both(self, one: Literal, other: Literal) -> bool:
        """Whether static facts let two literals that are true hold together in no state of all problems."""
        if one.symbol != other.symbol or {*one.values, *other.values} != {True}:
            return False
        pairs = list(zip(one.terms, other.terms, strict=True))
        places = tuple(place for place, (left, right) in enumerate(pairs) if left != right)
        if not any(isinstance(pairs[p][0], Object) and isinstance(pairs[p][1], Object) for p in places):
            return False
        name = next(name for name, each in self._words.predicates.items() if each.name == one.symbol)
        found = self._statics.never_differ(name, places)
        self._drawn_once = self._drawn_once or found
        return found

    def tree(
        self, node: EffectNode, scope: Scope, variables: tuple[Variable, ...] = (), guard: Formula = ALWAYS
    ) -> Tree:
        """The tree of an effect, for each binding of the variables that a guard holds for; E916, E917."""
        match node:
            case SetNode():
                return self._set(node, scope, variables, guard)
            case AllNode(parts):
                return All(tuple(self.tree(part, scope, variables, guard) for part in parts))
            case WhenNode():
                condition = self._words.formula(node.condition, scope)
                if variables:
                    return self.tree(node.effect, scope, variables, both([guard, condition]))
                part = self.tree(node.effect, scope)
                return NOTHING if condition == NEVER else Branch(condition, part)
            case EachNode():
                return self._each(node, scope, variables, guard)
            case ChanceNode(branches):
                drawn = ((p, self.tree(part, scope, variables, guard)) for p, part in branches if p)
                return Chance(tuple(drawn))
            case PayNode():
                return self._pay(node, scope)

    def _set(self, node: SetNode, scope: Scope, variables: tuple[Variable, ...], guard: Formula) -> Tree:
        found = self._words.atom(node.atom, scope)
        if found is None:
            return NOTHING
        symbol, terms = found
        bound = tuple(variable for variable in variables if variable in terms)
        others = [variable for variable in variables if variable not in terms]
        asked = quantified(True, others, guard)
        if asked == NEVER:
            return NOTHING
        self._words.warn_of_empty([v for v in others if v not in free_variables(guard)], node.atom.span)
        change = Change(bound, asked if bound else ALWAYS, symbol, terms, node.value)
        return change if bound or asked == ALWAYS else Branch(asked, change)

    def _each(self, node: EachNode, scope: Scope, variables: tuple[Variable, ...], guard: Formula) -> Tree:
        if self._is_for_each(node.effect):
            if self._pays(node.effect) or not self._statics.leave_one(node):
                return self._each_object(node, scope, variables, guard)
            self._drawn_once = True
        own, inner, asked = self._words.bound(node.variables, scope)
        if any(self._words.is_empty(variable.type) for variable in own):
            return NOTHING
        return self.tree(node.effect, inner, (*variables, *own), both([guard, asked]))

    def _each_object(
        self, node: EachNode, scope: Scope, variables: tuple[Variable, ...], guard: Formula
    ) -> Tree:
        """The effect once for each binding, in the order in which the objects are declared."""
        words = self._words
        found = [self._objects(each.types, node.span) for each in node.variables]
        if prod(map(len, found)) > MOST_BINDINGS:
            message = (
                f"chance or what is paid has a part in this for each of more than {MOST_BINDINGS} bindings"
            )
            words.findings.error("E917", message, node.span)
            return NOTHING
        self._written_out = True
        parts = []
        for chosen in product(*found):
            bound = {each.name.text: thing for each, thing in zip(node.variables, chosen, strict=True)}
            parts.append(self.tree(node.effect, scope.inside(bound), variables, guard))
        return All(tuple(parts))

    def _objects(self, types: Sequence[Name], span: Span) -> tuple[Object, ...]:
        kind, members = self._words.types.of(types)
        objects = self._words.of_type(kind)
        if objects is None and self._words.is_open:
            return ()
        if objects is None:
            message = "this is drawn or paid for each object, and it is not known which objects there are"
            help = "give the problem too; of several, one at a time"
            self._words.findings.error("E917", message, span, help=help)
            return ()
        fits = self._words.types.is_a
        return tuple(o for o in objects if not members or any(fits(o.type, one) for one in members))

    def _pay(self, node: PayNode, scope: Scope) -> Tree:
        sign = self.counted.get(node.function.symbol.text)
        if sign is None:
            return NOTHING
        if node.amount is None:
            message = "a cost is a sum of numbers and of multiples of values that never change"
            self._words.findings.error("E917", message, node.span)
            return NOTHING
        price, asked = NOTHING_PAID, list[Formula]()
        for weight, function in node.amount:
            if function is None:
                price += Price(sign * weight)
            elif (found := self._functions.price(function, scope)) is not None:
                price += found[0].times(sign * weight)
                asked.append(found[1])
        return Pay(paid_by(price), both(asked))

    def _is_for_each(self, node: EffectNode) -> bool:
        """Whether something in an effect is drawn or paid, for each binding of a `forall` by itself then."""
        return _has_chance(node) or self._pays(node)

    def _pays(self, node: EffectNode) -> bool:
        """Whether something in an effect is paid that counts."""
        match node:
            case PayNode():
                return node.function.symbol.text in self.counted
            case AllNode(parts):
                return any(map(self._pays, parts))
            case WhenNode() | EachNode():
                return self._pays(node.effect)
            case ChanceNode(branches):
                return any(self._pays(part) for _, part in branches)
            case SetNode():
                return False


def _has_chance(node: EffectNode) -> bool:
    match node:
        case ChanceNode():
            return True
        case AllNode(parts):
            return any(map(_has_chance, parts))
        case WhenNode() | EachNode():
            return _has_chance(node.effect)
        case SetNode() | PayNode():
            return False


# ---- what a tree comes to


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


class UnevenCost(Exception):
    """What an action costs depends on more conditions than it is divided by."""


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


@dataclass(frozen=True, slots=True)
class Result:
    """How likely some changes are, in the order of the text, with what is paid beside them."""

    chance: Fraction
    changes: tuple[Change, ...] = ()
    paid: Paid = Paid()


Results = tuple[Result, ...]
"""What something may come to, each once."""

MayMeet = Callable[[Formula, Formula], bool]
"""Whether two conditions may hold in one state."""


def results_of(tree: Tree, may_meet: MayMeet | None = None) -> Results:
    """What a tree without conditions but those of its changes may come to, with probabilities that sum to 1.
    `may_meet` tells whether two conditions may hold in one state; None: any two. Raises `TooMany`."""
    match tree:
        case Change():
            return (Result(Fraction(1), (tree,)),)
        case All(parts):
            return reduce(_product, _drawn_apart(parts, may_meet), (Result(Fraction(1)),))
        case Chance(branches):
            rest = 1 - sum((p for p, _ in branches), Fraction(0))
            likely = [
                replace(each, chance=p * each.chance)
                for p, part in branches
                for each in results_of(part, may_meet)
            ]
            return _merged([*likely, *([Result(rest)] if rest else [])])
        case Pay(paid):
            return (Result(Fraction(1), (), paid),)
        case Branch():
            raise AssertionError("conditions are decided before")


def _product(found: Results, others: Results) -> Results:
    """All pairs of results that are drawn independently."""
    if len(found) * len(others) > 64 * MOST_OUTCOMES:
        raise TooMany
    made = _merged([_beside(one, other, one.chance * other.chance) for one in found for other in others])
    if len(made) > MOST_OUTCOMES:
        raise TooMany
    return made


def _beside(one: Result, other: Result, chance: Fraction) -> Result:
    """Both results, which happen together with some probability."""
    return Result(chance, (*one.changes, *other.changes), one.paid + other.paid)


def _drawn_apart(parts: Sequence[Tree], may_meet: MayMeet | None) -> Iterator[Results]:
    """The results of parts that are drawn independently of each other. Parts of which no state lets two
    happen share one draw: of one that happens alone it makes no difference what the others would do."""
    if may_meet is None or len(parts) > MOST_SHARED:
        for is_sure, several in groupby(parts, key=lambda part: isinstance(part, Change)):
            if is_sure:
                yield (Result(Fraction(1), tuple(part for part in several if isinstance(part, Change))),)
            else:
                yield from (results_of(part, may_meet) for part in several)
        return
    groups: list[list[tuple[Formula, Results]]] = []
    for part in parts:
        asked, results = _asked(part), results_of(part, may_meet)
        for group in groups if len(results) > 1 and asked != ALWAYS else ():
            if not any(len(found) == 1 or may_meet(asked, other) for other, found in group):
                group.append((asked, results))
                break
        else:
            groups.append([(asked, results)])
    for group in groups:
        yield _sharing([results for _, results in group])


def _asked(tree: Tree) -> Formula:
    """Where a tree changes or pays anything, whatever chance decides."""
    match tree:
        case Change(variables, guard):
            return quantified(True, variables, guard)
        case All(parts):
            return either(map(_asked, parts))
        case Branch(condition, part):
            return both([condition, _asked(part)])
        case Chance(branches):
            return either(_asked(part) for _, part in branches)
        case Pay(paid):
            return ALWAYS if paid else NEVER


def _sharing(several: Sequence[Results]) -> Results:
    """Results of several draws that one number between 0 and 1 decides: each has its own probabilities. The
    likeliest results come first in each, so that most of them end where those of others do."""
    if len(several) == 1:
        return several[0]
    waiting = [sorted(results, key=lambda each: -each.chance) for results in several]
    found = []
    while waiting[0]:
        chance = min(results[0].chance for results in waiting)
        together = Result(chance)
        for results in waiting:
            together = _beside(together, results[0], chance)
            left = results[0].chance - chance
            results[:1] = [replace(results[0], chance=left)] if left else []
        found.append(together)
    return _merged(found)


def _merged(results: Sequence[Result]) -> Results:
    """Each result once, by what happens."""
    if len(results) == 1:
        return (Result(results[0].chance, tuple(dict.fromkeys(results[0].changes)), results[0].paid),)
    found: dict[tuple[frozenset[Change], Paid], Result] = {}
    for each in results:
        changes = dict.fromkeys(each.changes)
        key = frozenset(changes), each.paid
        before = found.get(key)
        if before is None:
            found[key] = Result(each.chance, tuple(changes), each.paid)
        else:
            found[key] = replace(before, chance=before.chance + each.chance)
    return tuple(found.values())


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


def changes_of(tree: Tree) -> list[Change]:
    """All that a tree may change."""
    match tree:
        case Change():
            return [tree]
        case All(parts):
            return [change for part in parts for change in changes_of(part)]
        case Branch(_, part):
            return changes_of(part)
        case Chance(branches):
            return [change for _, part in branches for change in changes_of(part)]
        case Pay():
            return []
