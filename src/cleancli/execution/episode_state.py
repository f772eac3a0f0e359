"""The state of an episode as one value: what decides the next step is kept nowhere else.

An `EpisodeState` with the workcell as it was then is all that it takes to go on; each step of the loop makes
a new one. Random numbers need no state: each use has a seed of its own, made of the run's seed, what it is
for, and how many there were before.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from math import dist
from typing import Any

from numpy.typing import NDArray

from cleancli.compiler.task import GroundAction
from cleancli.language.model import Object, State
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area

ActionKey = tuple[str, tuple[str, ...]]
"""An action's name and what it acts upon."""

SAME_PLACE = 0.01
"""Metres by which the middle and the axes of an ellipse may differ while nothing there has changed: the error
of perception stays below (docs/perception.md)."""

PATIENCE = 4
"""Times in a row that an action may change nothing before it is given up, whatever is believed of it. It was
chosen."""

IMPROBABLE = 0.01
"""An action is given up only where so many failures in a row are less probable than this by what is believed
of it. Chosen: no rule that ships lets an action on a table fail more often than `PATIENCE` says."""

FULLY_SEEN = 0.02
"""Share of the surface that may be hidden in a look that counts as full. Chosen: hardly a lentil."""


@dataclass(frozen=True, slots=True)
class Situation:
    """What is believed after a look: the areas, and what they mean in the domain's words.

    `unseen` names the areas of which something hid the most, and that are believed to be as they were.
    `hidden`: share of the surface about which the look said nothing. `left_out` names the areas that plans
    leave for later (§4.2.1). The symbolic world has no areas.
    """

    areas: tuple[Area, ...]
    objects: tuple[Object, ...]
    state: State
    unseen: frozenset[str] = frozenset()
    hidden: float = 0.0
    left_out: tuple[str, ...] = ()

    @property
    def shows_nothing(self) -> bool:
        """Whether all that is believed to be there is out of sight."""
        return bool(self.unseen) and len(self.unseen) == len(self.areas)

    @property
    def is_full(self) -> bool:
        """Whether everything was seen."""
        return not self.unseen and self.hidden <= FULLY_SEEN


@dataclass(frozen=True, slots=True)
class Move:
    """Something to carry out: an action of the domain on some objects, or a tool path that a strategy made.

    `path` is None for actions: theirs is made when they begin, from where the areas are seen then. A move
    begins only while all its `objects` are there.
    """

    action: str
    objects: tuple[str, ...]
    path: ToolPath | None = None

    @property
    def key(self) -> ActionKey:
        """What the move is remembered by."""
        return self.action, self.objects

    def __str__(self) -> str:
        return f"{self.action}({', '.join(self.objects)})"


@dataclass(frozen=True, slots=True)
class FailedAttempt:
    """A move that was tried in vain, so many `times` in a row, and what its objects looked like. `reason`:
    why the robot failed, or nothing. `chance`: the probability of so many failures in a row by what was
    believed when each began; 0 where nothing is believed of them."""

    key: ActionKey
    areas: tuple[Area, ...]
    facts: State
    times: int
    reason: str = ""
    chance: float = 0.0

    @property
    def is_given_up(self) -> bool:
        """Whether the move is of no use until its objects have changed."""
        return self.times >= PATIENCE and self.chance < IMPROBABLE


@dataclass(frozen=True, slots=True)
class Demonstration:
    """A move that a teacher has shown in a state, and that has changed it."""

    facts: State
    move: Move


@dataclass(frozen=True, slots=True)
class Account:
    """Seconds that whoever waits for the robot has waited, by what they were spent on (Fig. 8b, Fig. 10b).

    `planning` and `perceiving` are real time, all else is the robot's clock; `extra_perceptions` and
    `learning` hold both: moving the arm out of view, and the look that this was for (§4.2.3, §5.2). Looks
    that nobody waited for, because the arm was moving meanwhile, are not in it.
    """

    planning: float = 0.0
    perceiving: float = 0.0
    extra_perceptions: float = 0.0
    transits: float = 0.0
    actions: float = 0.0
    learning: float = 0.0

    @property
    def total(self) -> float:
        """All of it."""
        return sum(self.by_kind().values())

    def by_kind(self) -> dict[str, float]:
        """The seconds by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, slots=True)
class EpisodeState:
    """Everything an episode knows.

    `situation` is None before the first look. `looks` taken and areas `named` so far; `actions` begun.
    `clear_looks`: looks in a row since the last move for which the tool was out of view. `queue`: moves
    decided upon and not yet begun; `rest`: what is left of the plan beyond them. `examples`: pairs (rule's
    index, times it was carried out and seen, with those that the domain's text counts), sorted. `shown`: what
    a teacher has shown. `loading`: seconds that numba took to load, once. `reason`: why the episode is over,
    empty while it is not.
    """

    situation: Situation | None = None
    looks: int = 0
    named: int = 0
    actions: int = 0
    clear_looks: int = 0
    queue: tuple[Move, ...] = ()
    rest: tuple[GroundAction, ...] = ()
    vain: tuple[FailedAttempt, ...] = ()
    examples: tuple[tuple[int, Fraction], ...] = ()
    evidence: Evidence = NO_EVIDENCE
    shown: tuple[Demonstration, ...] = ()
    spent: Account = Account()
    loading: float = 0.0
    reason: str = ""

    def times_in_vain(self, key: ActionKey) -> int:
        """How often a move was tried in a row while nothing about its objects has changed since."""
        before = None if self.situation is None else last_failure(self.vain, key, self.situation)
        return 0 if before is None else before.times

    @property
    def excluded(self) -> frozenset[ActionKey]:
        """Moves that are of no use as things stand."""
        if self.situation is None:
            return frozenset()
        return frozenset(
            vain.key for vain in self.vain if vain.is_given_up and unchanged(vain, self.situation)
        )


def last_failure(vain: Iterable[FailedAttempt], key: ActionKey, situation: Situation) -> FailedAttempt | None:
    """How a move was tried in vain, if its objects look in this situation as they did then."""
    return next((each for each in vain if each.key == key and unchanged(each, situation)), None)


def shown_before(shown: Iterable[Demonstration], situation: Situation) -> tuple[Move, ...]:
    """The move that a teacher has shown in just this state, if any."""
    return next(((each.move,) for each in shown if each.facts == situation.state), ())


def without_vain(
    shown: tuple[Demonstration, ...], move: Move, before: Situation, after: Situation
) -> tuple[Demonstration, ...]:
    """What was shown, less a move that has just changed nothing: the teacher may know a better one."""
    if before.state != after.state:
        return shown
    return tuple(each for each in shown if each != Demonstration(before.state, move))


def unchanged(vain: FailedAttempt, situation: Situation) -> bool:
    """Whether the objects of a move look as they did when it was tried in vain."""
    areas, facts = about(vain.key[1], situation)
    return (
        facts == vain.facts
        and len(areas) == len(vain.areas)
        and all(_alike(old, new) for old, new in zip(vain.areas, areas, strict=True))
    )


def about(objects: tuple[str, ...], situation: Situation) -> tuple[tuple[Area, ...], State]:
    """The areas of these names, in their order, and the facts that speak of them alone; where nothing has a
    place, all facts, because an action may be meant to change what it does not name."""
    if not situation.areas:
        return (), situation.state
    areas = {area.name: area for area in situation.areas}
    facts = frozenset(fact for fact in situation.state if set(fact.objects) <= set(objects))
    return tuple(areas[name] for name in objects if name in areas), facts


def _alike(old: Area, new: Area) -> bool:
    """Whether an area may be the other one, seen again: where it was, as long and wide, and as dirty."""
    return (
        dist(old.ellipse.centre, new.ellipse.centre) <= SAME_PLACE
        and dist(old.ellipse.axes, new.ellipse.axes) <= SAME_PLACE
        and abs(old.covered - new.covered) <= 0.2 * max(old.covered, new.covered)
    )


World = Mapping[str, NDArray[Any]]
"""What the world is like, as arrays by name."""
