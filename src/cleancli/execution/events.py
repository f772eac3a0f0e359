"""What happens in an episode, as records that the terminal, the run folder and tests read alike."""

from __future__ import annotations

import enum
from dataclasses import dataclass

from cleancli.execution.episode_state import Account, EpisodeState, Move, Situation
from cleancli.geometry.rgbd import Frame
from cleancli.language.model import Domain
from cleancli.learning.experience import Transition
from cleancli.learning.intervals import Intervals
from cleancli.learning.learn import Lesson
from cleancli.motion.path import ToolPath
from cleancli.planning.plan import Plan


class Purpose(enum.Enum):
    """Why a look was taken."""

    FIRST = "first"  # before anything has moved
    AFTER = "after"  # while the arm is where an action left it (§4.2.3)
    EXTRA = "extra"  # with the arm moved out of view, because nothing is left to do where it was (§4.2.3)
    LEARNING = "learning"  # with the arm moved out of view, to see what an unknown action did (§5.2)


@dataclass(frozen=True, slots=True)
class Looked:
    """The camera was read; `seconds` of perception. `frame` is what it saw last, None in the symbolic
    world."""

    situation: Situation
    frame: Frame | None
    seconds: float
    purpose: Purpose


@dataclass(frozen=True, slots=True)
class Decided:
    """The strategy chose `moves` for `situation`; `seconds` of grounding and planning, loading the kernel
    aside. `plan` is the whole plan of strategies that plan, of which the moves are the beginning.
    `is_taught`: a teacher has shown what to do."""

    situation: Situation
    moves: tuple[Move, ...]
    plan: Plan | None
    seconds: float
    is_taught: bool = False


@dataclass(frozen=True, slots=True)
class Started:
    """The robot sets off to carry out a move, along `path`; the symbolic world has no paths."""

    number: int
    move: Move
    path: ToolPath | None


@dataclass(frozen=True, slots=True)
class Leaving:
    """The arm sets off to leave the camera's view."""


@dataclass(frozen=True, slots=True)
class Moved:
    """One control period has passed; `clock` in seconds of robot time."""

    clock: float


@dataclass(frozen=True, slots=True)
class StrokeEnded:
    """The tool has reached the end of its path and still stands there."""

    number: int
    clock: float


@dataclass(frozen=True, slots=True)
class Failed:
    """The robot could not carry out a move, or not to its end; it is not asked for again as things stand."""

    number: int
    move: Move
    reason: str


@dataclass(frozen=True, slots=True)
class Acted:
    """A move is over, done or failed, and what came of it has been looked at.

    `transition` is what was believed before and after, None for moves that are no action of the domain or
    were never begun; only where `seen` was nothing of it hidden, so that a learner may count it. `transit`
    and `seconds` of robot time: to where the stroke begins, and from there on.
    """

    number: int
    move: Move
    transition: Transition | None
    seen: bool
    transit: float
    seconds: float
    situation: Situation


@dataclass(frozen=True, slots=True)
class Learned:
    """What was learned so far, and the domain with what is believed since, and how surely: after each action
    that is learned from, and first of all in an episode that goes on from what was learned before."""

    lesson: Lesson
    domain: Domain
    intervals: Intervals


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """Between two moves: with `state`, and the workcell as it is now, the episode can go on later."""

    state: EpisodeState


@dataclass(frozen=True, slots=True)
class Ended:
    """The episode is over. `clean`: nothing is left to do, as far as is seen. `spent`: what it took.
    `clock` of the robot. `loading`: seconds that numba took once to load or compile the planner."""

    reason: str
    clean: bool
    actions: int
    spent: Account
    clock: float
    loading: float


Event = (
    Looked | Decided | Started | Leaving | Moved | StrokeEnded | Failed | Acted | Learned | Checkpoint | Ended
)
