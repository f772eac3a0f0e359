"""What a PPDDL domain means by definition, state by state: slow, and with nothing of the conversion but the
syntax tree.

After Younes and Littman, PPDDL1.0 (2004): an action may be taken where its precondition holds. All conditions
of an effect are asked of the state before. What is probabilistic is drawn independently of all else, for each
binding of a `forall` by itself. Of what is deleted and added, all is added.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from cleancli.conversion.pddl.syntax import (
    ActionNode,
    AllNode,
    AndNode,
    AtomNode,
    ChanceNode,
    CompareNode,
    ConditionNode,
    DomainNode,
    EachNode,
    EffectNode,
    EqualNode,
    FactsNode,
    Name,
    NotNode,
    OrNode,
    PayNode,
    ProblemNode,
    QuantifiedNode,
    SetNode,
    Typed,
    WhenNode,
)

Atom = tuple[str, ...]
"""A predicate and its objects."""

World = frozenset[Atom]
"""The atoms that hold."""

Binding = Mapping[str, str]
Change = tuple[frozenset[Atom], frozenset[Atom], Fraction]
"""What is added, what is deleted, and what it costs by numbers that the text says."""

Called = tuple[str, tuple[str, ...]]


@dataclass(frozen=True)
class Meaning:
    """A domain and a problem of it."""

    domain: DomainNode
    problem: ProblemNode

    # ---- types

    def _is_a(self, kind: str, wanted: str) -> bool:
        if wanted in ("object", kind):
            return True
        above = [parent.text for t in self.domain.types if t.name.text == kind for parent in t.types]
        return any(self._is_a(parent, wanted) for parent in above)

    def fitting(self, typed: Typed) -> list[str]:
        """The objects that a variable may stand for."""
        wanted = [name.text for name in typed.types] or ["object"]
        return [
            word.text
            for each in (*self.domain.constants, *self.problem.objects)
            if any(self._is_a(own, w) for own in [n.text for n in each.types] or ["object"] for w in wanted)
            for word in each.words
        ]

    def bindings(self, variables: tuple[Typed, ...]) -> Iterator[dict[str, str]]:
        """All that variables may stand for."""
        for chosen in product(*map(self.fitting, variables)):
            yield {each.name.text: one for each, one in zip(variables, chosen, strict=True)}

    # ---- conditions

    def atom(self, node: AtomNode, binding: Binding) -> Atom:
        """The ground atom."""
        return (node.symbol.text, *(_stands(term, binding) for term in node.terms))

    def holds(self, node: ConditionNode, world: World, binding: Binding) -> bool:
        """Whether a condition holds."""
        match node:
            case AtomNode():
                return self.atom(node, binding) in world
            case EqualNode():
                return _stands(node.left, binding) == _stands(node.right, binding)
            case NotNode():
                return not self.holds(node.part, world, binding)
            case AndNode():
                return all(self.holds(part, world, binding) for part in node.parts)
            case OrNode():
                return any(self.holds(part, world, binding) for part in node.parts)
            case QuantifiedNode():
                every = (
                    self.holds(node.part, world, {**binding, **own}) for own in self.bindings(node.variables)
                )
                return any(every) if node.exists else all(every)
            case CompareNode():
                raise NotImplementedError

    @property
    def earns(self) -> bool:
        """Whether a reward is to be great, and not the goal alone to be reached."""
        metric = self.problem.metric
        return metric is not None and metric.greatest

    # ---- effects

    def changes(self, node: EffectNode, world: World, binding: Binding) -> dict[Change, Fraction]:
        """What an effect may add and delete, with its probabilities."""
        match node:
            case SetNode():
                one = frozenset({self.atom(node.atom, binding)})
                none = frozenset[Atom]()
                change: Change = (one, none, Fraction(0)) if node.value else (none, one, Fraction(0))
                return {change: Fraction(1)}
            case AllNode():
                return _together([self.changes(part, world, binding) for part in node.parts])
            case WhenNode():
                held = self.holds(node.condition, world, binding)
                return self.changes(node.effect, world, binding) if held else _together([])
            case EachNode():
                own = self.bindings(node.variables)
                return _together([self.changes(node.effect, world, {**binding, **one}) for one in own])
            case ChanceNode():
                found: dict[Change, Fraction] = {}
                for chance, effect in node.branches:
                    for change, likely in self.changes(effect, world, binding).items():
                        found[change] = found.get(change, Fraction(0)) + chance * likely
                rest = 1 - sum((chance for chance, _ in node.branches), Fraction(0))
                nothing: Change = (frozenset(), frozenset(), Fraction(0))
                found[nothing] = found.get(nothing, Fraction(0)) + rest
                return found
            case PayNode():
                return {(frozenset(), frozenset(), self.cost(node, world, binding)): Fraction(1)}

    def cost(self, node: EffectNode, world: World, binding: Binding) -> Fraction:
        """What an effect costs on average: how much the function rises that the metric wants small, or falls
        that it wants great."""
        match node:
            case PayNode(function, amount):
                metric = self.problem.metric
                if metric is None or metric.function != function.symbol:
                    return Fraction(0)
                rise = self.rise(amount, binding)
                return -rise if metric.greatest else rise
            case AllNode(parts):
                return sum((self.cost(part, world, binding) for part in parts), Fraction(0))
            case WhenNode():
                held = self.holds(node.condition, world, binding)
                return self.cost(node.effect, world, binding) if held else Fraction(0)
            case EachNode():
                own = self.bindings(node.variables)
                return sum((self.cost(node.effect, world, {**binding, **one}) for one in own), Fraction(0))
            case ChanceNode():
                found = (chance * self.cost(each, world, binding) for chance, each in node.branches)
                return sum(found, Fraction(0))
            case SetNode():
                return Fraction(0)

    def is_known(self, node: EffectNode, world: World, binding: Binding) -> bool:
        """Whether the values are known that an effect may cost in a state."""
        match node:
            case PayNode(function, amount):
                metric = self.problem.metric
                counts = metric is not None and metric.function == function.symbol
                asked = [each for _, each in amount or () if each is not None] if counts else []
                return all(self.value(each, binding) is not None for each in asked)
            case AllNode(parts):
                return all(self.is_known(part, world, binding) for part in parts)
            case ChanceNode():
                return all(self.is_known(each, world, binding) for _, each in node.branches)
            case WhenNode():
                held = self.holds(node.condition, world, binding)
                return not held or self.is_known(node.effect, world, binding)
            case EachNode():
                own = self.bindings(node.variables)
                return all(self.is_known(node.effect, world, {**binding, **one}) for one in own)
            case SetNode():
                return True

    def rise(self, amount: Sequence[tuple[Fraction, AtomNode | None]] | None, binding: Binding) -> Fraction:
        """What a sum of multiples of functions' values comes to at first."""
        found = Fraction(0)
        for weight, function in amount or ():
            value = Fraction(1) if function is None else self.value(function, binding)
            assert value is not None
            found += weight * value
        return found

    def value(self, function: AtomNode, binding: Binding) -> Fraction | None:
        """The value that a numeric function has at first."""
        wanted = self.atom(function, binding)
        return next((v.value for v in self.problem.values if self.atom(v.function, {}) == wanted), None)

    def successors(self, world: World, action: ActionNode, binding: Binding) -> dict[World, Fraction]:
        """The worlds that an action may lead to, where it may be taken; otherwise the one that is."""
        if not self.holds(action.precondition, world, binding) or not self.is_known(
            action.effect, world, binding
        ):
            return {world: Fraction(1)}
        found: dict[World, Fraction] = {}
        for (after, _), chance in self.results(world, action, binding).items():
            found[after] = found.get(after, Fraction(0)) + chance
        return found

    def results(
        self, world: World, action: ActionNode, binding: Binding
    ) -> dict[tuple[World, Fraction], Fraction]:
        """The worlds that an action may lead to, where it may be taken, each with what that costs by numbers
        that the text says."""
        found: dict[tuple[World, Fraction], Fraction] = {}
        for (added, deleted, cost), chance in self.changes(action.effect, world, binding).items():
            if chance:
                key = (world - deleted) | added, cost
                found[key] = found.get(key, Fraction(0)) + chance
        return found

    def actions(self) -> Iterator[tuple[Called, ActionNode, dict[str, str]]]:
        """All actions on objects."""
        for action in self.domain.actions:
            for binding in self.bindings(action.parameters):
                yield (action.name.text, tuple(binding.values())), action, binding

    def initial(self) -> World:
        """The world at first, where chance has no part in it."""
        plain = {names for each in self.problem.init if isinstance(each, FactsNode) for names in each.names}
        facts = [fact for fact in self.problem.init if isinstance(fact, SetNode)]
        return frozenset(plain | {self.atom(fact.atom, {}) for fact in facts if fact.value})

    def initial_worlds(self) -> dict[World, Fraction]:
        """The worlds that there may be at first."""
        drawn = [
            self.changes(node, frozenset(), {}) for node in self.problem.init if isinstance(node, ChanceNode)
        ]
        found: dict[World, Fraction] = {}
        for (added, deleted, _), chance in _together(drawn).items():
            world = (self.initial() - deleted) | added
            found[world] = found.get(world, Fraction(0)) + chance
        return {world: chance for world, chance in found.items() if chance}

    def reachable(self, most: int) -> list[World]:
        """The worlds that can come about, the initial ones first; up to some number."""
        found = dict.fromkeys(self.initial_worlds())
        waiting = deque(found)
        actions = list(self.actions())
        while waiting and len(found) < most:
            world = waiting.popleft()
            for _, action, binding in actions:
                for after in self.successors(world, action, binding):
                    if after not in found:
                        found[after] = None
                        waiting.append(after)
        return list(found)

    def goal_probability(self, most: int) -> float | None:
        """The greatest probability with which the goal can be reached, by value iteration from 0; None where
        there are more worlds than `most`."""
        worlds = self.reachable(most + 1)
        if len(worlds) > most or self.problem.goal is None:
            return None
        goal = self.problem.goal
        ways = {
            world: [self.successors(world, action, binding) for _, action, binding in self.actions()]
            for world in worlds
            if not self.holds(goal, world, {})
        }
        value = {world: float(world not in ways) for world in worlds}
        change = 1.0
        while change > 1e-14:
            change = 0.0
            for world, options in ways.items():
                best = max((sum(float(p) * value[w] for w, p in o.items()) for o in options), default=0.0)
                change = max(change, best - value[world])
                value[world] = best
        return sum(float(chance) * value[world] for world, chance in self.initial_worlds().items())


def _stands(term: Name, binding: Binding) -> str:
    return binding[term.text] if term.is_variable else term.text


def _together(parts: list[dict[Change, Fraction]]) -> dict[Change, Fraction]:
    """The changes of independent parts."""
    found: dict[Change, Fraction] = {(frozenset(), frozenset(), Fraction(0)): Fraction(1)}
    for part in parts:
        joint: dict[Change, Fraction] = {}
        for (added, deleted, cost), chance in found.items():
            for (more, less, dearer), likely in part.items():
                change = added | more, deleted | less, cost + dearer
                joint[change] = joint.get(change, Fraction(0)) + chance * likely
        found = joint
    return found
