"""What the loop needs of the place where it works: a simulated table, or the symbolic world."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping
from dataclasses import dataclass
from typing import Protocol

from cleancli.compiler.task import GroundAction
from cleancli.execution.episode_state import ActionKey, Move, Situation
from cleancli.execution.events import Moved, StrokeEnded
from cleancli.geometry.rgbd import Frame
from cleancli.language.model import Problem
from cleancli.motion.path import ToolPath
from cleancli.perception.tracking import Stroke

Motion = Generator[Moved | StrokeEnded, None, "Motions"]


@dataclass(frozen=True, slots=True)
class LookResult:
    """What a look found; `named` areas so far, `seconds` of real time."""

    situation: Situation
    frame: Frame | None
    named: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Motions:
    """How a motion went: seconds of robot time to where its stroke began, and from there on; `failure` says
    why it was not carried out to its end, and is empty otherwise. `stroke`: where the tool went."""

    transit: float
    seconds: float
    failure: str = ""
    stroke: Stroke | None = None


class Workcell(Protocol):
    """A place with dirt, or any other facts, and who changes them. Keeps nothing that the loop needs to go on
    but where things truly are."""

    @property
    def clock(self) -> float:
        """Seconds of robot time since the start."""

    @property
    def tool(self) -> tuple[float, float] | None:
        """Where the tool is above the surface, metres; None in the symbolic world."""

    def look(self, before: Situation | None, stroke: Stroke | None, number: int, named: int) -> LookResult:
        """Look from where everything stands now, for the `number`-th time.

        What was there `before` keeps its name, `stroke` being where the tool went since; what is hidden is
        believed to be as before. `named` areas have had names. Raises `NoSurface`.
        """

    def problem(self, situation: Situation) -> Problem:
        """What there is to plan for."""

    def is_done(self, situation: Situation) -> bool:
        """Whether nothing is left to do."""

    def seconds(self, situation: Situation, actions: Iterable[GroundAction]) -> Mapping[ActionKey, float]:
        """About how many seconds actions take here, with the way to where they begin, by their keys; an
        action is left out of which only its domain says that."""

    def path(self, move: Move, situation: Situation, vain: int = 0) -> ToolPath | None:
        """Where the tool will go for a move that was just tried so many times in `vain`; None in the symbolic
        world."""

    def carry_out(self, number: int, move: Move, path: ToolPath | None) -> Motion:
        """Do it, as the `number`-th move; whatever happens, the tool is above the surface afterwards."""

    def withdraw(self) -> Motion:
        """Move the arm out of the camera's view."""
