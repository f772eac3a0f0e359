"""What happens in an episode, as records that the terminal, the run folder and tests read alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cleancli.language.model import Object, State
from cleancli.learning.experience import Transition
from cleancli.motion.path import ToolPath
from cleancli.perception.area import Area
from cleancli.perception.frame import Frame
from cleancli.planning.plan import Plan


@dataclass(frozen=True, slots=True)
class Situation:
    """What is believed of the table after a look: the areas, and what they mean in the domain's words."""

    frame: Frame
    areas: tuple[Area, ...]
    objects: tuple[Object, ...]
    state: State


@dataclass(frozen=True, slots=True)
class Looked:
    """The camera was read with the tool out of view; `seconds` of perception."""

    situation: Situation
    seconds: float


@dataclass(frozen=True, slots=True)
class Planned:
    """A plan was made for `situation`; `seconds` of grounding and planning, loading the kernel aside."""

    situation: Situation
    plan: Plan
    seconds: float


@dataclass(frozen=True, slots=True)
class Started:
    """The robot sets off along `path` to carry out an action."""

    number: int
    action: str
    arguments: tuple[str, ...]
    path: ToolPath


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
class Acted:
    """An action is over and what came of it has been seen; `seconds` of robot time, transits included."""

    number: int
    transition: Transition
    seconds: float
    situation: Situation


@dataclass(frozen=True, slots=True)
class Ended:
    """The episode is over. `clean`: nothing dirty is seen any more. `seconds` by what they were spent on."""

    reason: str
    clean: bool
    actions: int
    seconds: Mapping[str, float]


Event = Looked | Planned | Started | Moved | StrokeEnded | Acted | Ended
