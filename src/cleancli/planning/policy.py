"""A policy: what to do, by what has come of it so far."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from cleancli.compiler.task import GroundState


class Course(NamedTuple):
    """The `actions` of a policy where each has the result that is `followed`, and the `states` that these
    results are. A sequence, which is carried out whatever its results are, has no states."""

    actions: tuple[int, ...] = ()
    states: tuple[GroundState, ...] = ()


class Place(NamedTuple):
    """How far a policy has come: the state, its action there (-1 to stop), how many actions were done, which
    without a horizon makes no difference and is 0, and what else it goes by, such as its place in a tree."""

    state: GroundState
    action: int
    step: int
    memory: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Policy:
    """Where a policy begins, where it is when its action at a place has led to a state, and its likeliest
    course from a place on."""

    start: Place
    after: Callable[[Place, GroundState], Place]
    course: Callable[[Place], Course]


def sequence(initial: GroundState, actions: tuple[int, ...]) -> Policy:
    """The policy that does the actions, whatever comes of them."""

    def at(step: int, state: GroundState) -> Place:
        return Place(state, actions[step] if step < len(actions) else -1, step)

    return Policy(
        at(0, initial),
        lambda place, state: at(place.step + 1, state),
        lambda place: Course(actions[place.step :]),
    )
