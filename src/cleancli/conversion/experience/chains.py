"""Experience as other languages have it: states with actions between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from cleancli.compiler.fluents import Values
from cleancli.language.model import Object
from cleancli.learning.experience import Transition

Called = tuple[str, tuple[str, ...]]
"""An action and the names of its objects."""


@dataclass(frozen=True, slots=True)
class Chain:
    """Actions one after the other, and what held of the same objects before and after each of them: there is
    one state more than there are actions."""

    objects: tuple[Object, ...]
    states: tuple[Values, ...]
    actions: tuple[Called, ...]

    def transitions(self) -> Iterator[Transition]:
        """The actions, each with the states around it."""
        for place, (action, names) in enumerate(self.actions):
            yield Transition(action, names, self.objects, self.states[place], self.states[place + 1])


def chains_of(transitions: Iterable[Transition]) -> Iterator[Chain]:
    """The longest chains that transitions form in their order. How long actions took is left out."""
    objects: tuple[Object, ...] = ()
    states: list[Values] = []
    actions: list[Called] = []
    for each in transitions:
        if not states or each.objects != objects or each.before != states[-1]:
            if actions:
                yield Chain(objects, tuple(states), tuple(actions))
            objects, states, actions = each.objects, [each.before], []
        states.append(each.after)
        actions.append((each.action, each.arguments))
    if actions:
        yield Chain(objects, tuple(states), tuple(actions))
