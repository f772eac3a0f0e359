"""The path of picking up (§3.2.2): a dustpan waits on the left of the dirt, the rag pushes from the right,
and the dustpan is emptied into the container. Where that is out of reach, the dustpan waits elsewhere."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cleancli.geometry.ellipse import Ellipse, Point, boundary
from cleancli.motion.pace import LIFT, STRAIGHT_SPEED, TRANSIT_SPEED, VERTICAL_SPEED
from cleancli.motion.path import EDGE_MARGIN, Dustpan, Interpolation, ToolPath, Waypoint
from cleancli.scene.model import Scene

PAN_SLOPE = 0.12  # measured: at 0.25 nothing climbs it
# Chosen, all that follows.
PAN_LENGTH = 0.16  # from its lip back to where it is held
ONTO_PAN = 0.05  # the rag goes so far onto it
RAG_GAP = 2e-3  # and so far above it, so that the cloth does not push it away
CLEARANCE = 0.02  # the rag comes down this far behind the dirt; the lip lies half as far before it
TIP_HEIGHT = 0.12  # of the held end, while it is tipped
CARRY_HEIGHT = 0.06  # and when it is lifted
TIP_BEYOND = 0.03  # the tipped lip is so far past the table's edge
TIP = -1.0  # rad: lentils slide down
TURNS = (30.0, 60.0, 90.0)  # degrees from left towards the robot at which the dustpan waits, if not there


def pick_ups(area: Ellipse, scene: Scene) -> Iterator[ToolPath]:
    """Ways to pick up an area, the best first: from right to left (§3.2.2), then with the dustpan nearer to
    the robot, as long as its lip stands on the surface.

    Left and right are those of the robot, which looks at the surface from behind the container.
    """
    yield pick_up(area, scene)
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    for turn in TURNS:
        path = pick_up(area, scene, np.radians(turn))
        lip = path.waypoints[2]
        if (np.abs((lip.x, lip.y)) < half).all():
            yield path


def pick_up(area: Ellipse, scene: Scene, turn: float = 0.0) -> ToolPath:
    """The rag's path from right to left, or turned from there towards the robot, in radians; and with it
    where the dustpan stands and where it is emptied."""
    out = np.array(scene.outwards())
    left = np.array((out[1], -out[0]))
    aim = np.cos(turn) * left + np.sin(turn) * out
    points = boundary(area)
    begin, end = points[np.argmin(points @ aim)], points[np.argmax(points @ aim)]
    way = (end - begin) / np.linalg.norm(end - begin)
    yaw = float(np.arctan2(way[1], way[0]))
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 - EDGE_MARGIN
    first, lip = np.clip(begin - CLEARANCE * way, -half, half), end + CLEARANCE / 2 * way
    last, top = lip + ONTO_PAN * way, PAN_SLOPE * ONTO_PAN + RAG_GAP
    (x0, y0), (x1, y1) = scene.mouth()
    middle = np.array(((x0 + x1) / 2, (y0 + y1) / 2))
    empty = middle + (TIP_BEYOND - PAN_LENGTH * np.cos(TIP)) * out
    back = float(np.arctan2(-out[1], -out[0]))
    place = _at(lip + PAN_LENGTH * way, 0.0, yaw, VERTICAL_SPEED)
    return ToolPath(
        (
            _at(first, LIFT, yaw, TRANSIT_SPEED),
            _at(first, 0.0, yaw, VERTICAL_SPEED),
            _at(lip, 0.0, yaw, STRAIGHT_SPEED),
            _at(last, top, yaw, STRAIGHT_SPEED),
            _at(last, top + LIFT, yaw, VERTICAL_SPEED),
        ),
        Interpolation.STRAIGHT,
        Dustpan(place, _at(empty, TIP_HEIGHT, back, TRANSIT_SPEED), TIP),
    )


def _at(
    point: Point | np.ndarray[tuple[int], np.dtype[np.float64]], z: float, yaw: float, speed: float
) -> Waypoint:
    return Waypoint(float(point[0]), float(point[1]), z, yaw, speed)
