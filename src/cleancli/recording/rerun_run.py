"""A whole run as a Rerun recording (rerun.io), written while it goes on: a run that is killed has its part.

Everything has its time on the robot's clock, and that of looks and actions by number as well. Coordinates are
those of the scene, metres. No viewer is started, nothing is sent anywhere.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from cleancli.array_types import Points
from cleancli.execution.events import (
    Acted,
    Checkpoint,
    Decided,
    Ended,
    Event,
    Failed,
    Learned,
    Leaving,
    Looked,
    Moved,
    Started,
    StrokeEnded,
)
from cleancli.motion.zone import corners
from cleancli.perception.pictures import boundary
from cleancli.perception.rerun_file import APPLICATION, CLOCK, ELLIPSE, find_rerun, log_areas, log_frame
from cleancli.scene.model import Scene

ACTIONS = "action"
"""The timeline that counts actions."""

EVERY = 0.1
"""Seconds of robot time from one place of the tool to the next."""

STROKE, WAY, ZONE, CONTAINER = (60, 140, 230), (40, 40, 48), (60, 170, 90), (62, 96, 150)
THICKNESS = 0.02  # of the table's top, as it is drawn
ABOVE = 2e-3  # what lies on the surface is drawn so far above it


class RunStream:
    """Writes a run's events into `path`: of a `scene` or, without one, of the symbolic world. `clock()` is
    the robot's, and `tool()` says where above the surface its tool is, metres. Raises MissingRerun, and
    OSError where there is no such file to write."""

    def __init__(
        self,
        path: Path,
        name: str,
        scene: Scene | None,
        clock: Callable[[], float],
        tool: Callable[[], tuple[float, float] | None],
    ) -> None:
        self._rerun = find_rerun()
        path.open("ab").close()  # the library would only warn
        self._clock, self._tool = clock, tool
        self._due, self._way = 0.0, list[tuple[float, float, float]]()
        self._stream = self._rerun.RecordingStream(APPLICATION, recording_id=name, send_properties=False)
        self._stream.save(path)
        if scene is not None:
            self._log_scene(scene)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stream.disconnect()

    def write(self, event: Event) -> None:
        """Record one event."""
        self._stream.set_time(CLOCK, duration=self._clock())
        match event:
            case Looked():
                self._log_look(event)
            case Decided():
                self._log_plan(event)
            case Started():
                self._log_start(event)
            case Moved(clock):
                self._log_tool(clock)
            case Failed(number, move, reason):
                self._say(f"{number}. {move} failed: {reason}", "ERROR")
            case Acted(number, move):
                self._say(f"{number}. {move} is over")
            case Checkpoint(state):
                for kind, seconds in state.spent.by_kind().items():
                    self._log(f"account/{kind}", self._rerun.Scalars(seconds))
                self._stream.flush()
            case Ended(reason, clean):
                self._say(f"{'clean' if clean else 'not clean'}: {reason}")
            case StrokeEnded() | Learned() | Leaving():
                pass

    def _log(self, entity: str, what: Any, *more: Any, static: bool = False) -> None:
        self._stream.log(entity, what, *more, static=static)

    def _say(self, text: str, level: str = "INFO") -> None:
        self._log("events", self._rerun.TextLog(text, level=level))

    def _log_scene(self, scene: Scene) -> None:
        rerun, surface = self._rerun, scene.surface
        half = surface.width / 2, surface.depth / 2
        top = rerun.Boxes3D(
            centers=[(0, 0, -THICKNESS / 2)],
            half_sizes=[(*half, THICKNESS / 2)],
            colors=[surface.colour],
            fill_mode="solid",
        )
        mouth = [(x, y, 0.0) for x, y in scene.mouth()]
        self._log("table/surface", top, static=True)
        container = rerun.LineStrips3D([mouth], colors=[CONTAINER], radii=[4e-3])
        self._log("table/container", container, static=True)
        if scene.zone is not None:
            outline = corners(scene.zone)
            self._log("table/zone", rerun.LineStrips3D([_closed(outline)], colors=[ZONE]), static=True)

    def _log_look(self, event: Looked) -> None:
        situation = event.situation
        if event.frame is not None:
            log_frame(self._rerun, self._stream, event.frame)
            log_areas(self._rerun, self._stream, event.frame.camera, situation.areas, situation.state)
            strips = [_closed(boundary(area.ellipse)) for area in situation.areas]
            names = [area.name for area in situation.areas]
            lines = self._rerun.LineStrips3D(strips, labels=names, colors=[ELLIPSE] * len(strips))
            self._log("table/areas", lines)
        self._say(f"look ({event.purpose.value}), {event.seconds:.2f} s of perception")

    def _log_plan(self, event: Decided) -> None:
        moves = event.moves if event.plan is None else event.plan.actions
        steps = "\n".join(f"{number}. {move}" for number, move in enumerate(moves, start=1))
        self._log("plan", self._rerun.TextDocument(steps or "nothing", media_type="text/markdown"))

    def _log_start(self, event: Started) -> None:
        self._stream.set_time(ACTIONS, sequence=event.number)
        self._say(f"{event.number}. {event.move}")
        self._way = []
        if event.path is not None:
            way = [(w.x, w.y, w.z) for w in event.path.waypoints]
            self._log("table/stroke", self._rerun.LineStrips3D([way], colors=[STROKE], radii=[2e-3]))

    def _log_tool(self, clock: float) -> None:
        tool = self._tool()
        if tool is None or clock < self._due:
            return
        self._due = clock + EVERY
        self._way.append((*tool, ABOVE))
        self._log("table/tool", self._rerun.Points3D([self._way[-1]], colors=[WAY], radii=[8e-3]))
        self._log("table/way", self._rerun.LineStrips3D([self._way], colors=[WAY]))


def _closed(outline: Points) -> Points:
    """An outline (n, 2) on the surface as a line (n + 1, 3) that ends where it begins."""
    return np.column_stack([np.vstack([outline, outline[:1]]), np.full(len(outline) + 1, ABOVE)])
