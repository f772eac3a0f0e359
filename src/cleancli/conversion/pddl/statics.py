"""How many objects static facts leave for a variable: at most one, as where a road leads to one place.

Where that is so for the variables of a `forall`, what chance decides for each binding it decides once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cleancli.conversion.pddl.syntax import (
    AndNode,
    AtomNode,
    ConditionNode,
    DomainNode,
    EachNode,
    EffectNode,
    FactsNode,
    ProblemNode,
    SetNode,
    WhenNode,
    all_within,
)


class Statics:
    """What the facts of all problems say of predicates that nothing changes."""

    def __init__(self, domain: DomainNode, problems: Sequence[ProblemNode]) -> None:
        self._actions = domain.actions
        self._problems = problems
        self._changing: frozenset[str] | None = None
        self._found: dict[tuple[str, tuple[int, ...]], bool] = {}

    def leave_one(self, node: EachNode) -> bool:
        """Whether a `forall` is about at most one binding of its variables in each state of all problems,
        whatever the variables around it stand for."""
        if not isinstance(node.effect, WhenNode):
            return False
        atoms = list(_atoms(node.effect.condition))
        waiting = {each.name.text for each in node.variables}
        while waiting:
            found = next((own for atom in atoms if (own := self._determined(atom, waiting))), None)
            if found is None:
                return False
            waiting -= found
        return True

    def _determined(self, atom: AtomNode, waiting: set[str]) -> set[str]:
        """Those of some variables that an atom leaves one object for where its other terms are known."""
        places = tuple(place for place, term in enumerate(atom.terms) if term.text in waiting)
        if not places or not self.never_differ(atom.symbol.text, places):
            return set()
        return {atom.terms[place].text for place in places}

    def never_differ(self, name: str, places: tuple[int, ...]) -> bool:
        """Whether no two facts of a predicate, in any state of a problem, differ at some places alone. No for
        one without facts, of which nothing is known."""
        key = name, places
        if key not in self._found:
            self._found[key] = bool(self._problems) and self._is_function(name, places)
        return self._found[key]

    def _is_function(self, name: str, places: Sequence[int]) -> bool:
        if self._changing is None:
            drawn = (part for each in self._problems for part in each.init if not isinstance(part, FactsNode))
            effects = (action.effect for action in self._actions)
            self._changing = frozenset().union(*map(_set_by, effects), *map(_set_by, drawn))
        if name in self._changing:
            return False
        several = [_facts(problem, name) for problem in self._problems]
        return any(several) and all(
            len({_without(fact, places) for fact in facts}) == len(facts) for facts in several
        )


def _facts(problem: ProblemNode, name: str) -> frozenset[tuple[str, ...]]:
    return frozenset(
        fact for part in problem.init if isinstance(part, FactsNode) for fact in part.names if fact[0] == name
    )


def _without(fact: tuple[str, ...], places: Sequence[int]) -> tuple[str, ...]:
    return tuple(term for place, term in enumerate(fact[1:]) if place not in places)


def _atoms(condition: ConditionNode) -> Iterator[AtomNode]:
    """The atoms that hold wherever a condition does."""
    if isinstance(condition, AtomNode):
        yield condition
    elif isinstance(condition, AndNode):
        for part in condition.parts:
            yield from _atoms(part)


def _set_by(node: EffectNode) -> frozenset[str]:
    """The predicates that an effect sets."""
    return frozenset(each.atom.symbol.text for each in all_within(node) if isinstance(each, SetNode))
