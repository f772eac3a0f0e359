"""Effects of PDDL, read into trees over .nid symbols.

`forall` is pushed inwards to the atoms that are set. What is drawn or paid inside of it is so for each object
by itself, so there it is written out for all objects of the problem (Younes and Littman 2004, section 2.2).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from math import prod

from cleancli.conversion.pddl.effect_trees import NOTHING, All, Branch, Chance, Change, Pay, Tree, paid_by
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Formula,
    both,
    free_variables,
    quantified,
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
    all_within,
)
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import NOTHING_PAID, Literal, Object, Price, Variable

MOST_BINDINGS = 1000
"""Bindings that one `forall` may be written out for. Chosen: where chance has a part far fewer are of use."""


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
        if self._pays(node.effect):
            return self._each_object(node, scope, variables, guard)
        if _has_chance(node.effect):
            if not self._statics.leave_one(node):
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

    def _pays(self, node: EffectNode) -> bool:
        """Whether something in an effect is paid that counts."""
        return any(
            isinstance(each, PayNode) and each.function.symbol.text in self.counted
            for each in all_within(node)
        )


def _has_chance(node: EffectNode) -> bool:
    return any(isinstance(each, ChanceNode) for each in all_within(node))
