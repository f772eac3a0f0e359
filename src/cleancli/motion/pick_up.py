"""The path of picking up (§3.2.2): a dustpan waits on the left of the dirt, the rag pushes from the right,
and the dustpan is emptied into the container. Where that is out of reach, the dustpan waits elsewhere. Of
several areas the rag goes over one after the other, and on to the dustpan, which takes all in one go."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cleancli.array_types import Floats
from cleancli.geometry.ellipse import Ellipse, Point, boundary, reach
from cleancli.motion.corners import CLEARANCE, behind, behind_middle, turning
from cleancli.motion.pace import LIFT, STRAIGHT_SPEED, TRANSIT_SPEED, VERTICAL_SPEED
from cleancli.motion.path import EDGE_MARGIN, Dustpan, Interpolation, ToolPath, Waypoint
from cleancli.scene.model import Scene

PAN_SLOPE = 0.12  # measured: at 0.25 nothing climbs it
# Chosen, all that follows.
PAN_LENGTH = 0.16  # from its lip back to where it is held
ONTO_PAN = 0.05  # the rag goes so far onto it
RAG_GAP = 2e-3  # and so far above it, so that the cloth does not push it away
TIP_HEIGHT = 0.12  # of the held end, while it is tipped
CARRY_HEIGHT = 0.06  # and when it is lifted
TIP_BEYOND = 0.03  # the tipped lip is so far past the table's edge
TIP = -1.0  # rad: lentils slide down
ASLANT = np.radians(10.0)  # an area whose farthest points lie so far from left and right of each other
TURNS = (30.0, 60.0, 90.0)  # degrees from left towards the robot at which the dustpan waits, if not there

Pose = tuple[float, float, float]


def pick_ups(areas: Sequence[Ellipse], scene: Scene) -> Iterator[ToolPath]:
    """Ways to pick areas up in one go, the best first: from right to left (§3.2.2), then one that lies aslant
    straight to the left over its middle, then with the dustpan nearer to the robot, as long as its lip stands
    on the surface and no area lies beyond the last one, where the dustpan is.

    Left and right are those of the robot, which looks at the surface from behind the container.
    """
    left = to_pan(scene)
    yield pick_up(areas, scene)
    if len(areas) == 1 and _across(areas[0], left)[1] @ left < np.cos(ASLANT):
        yield pick_up(areas, scene, 0.0)
    half = np.array((scene.surface.width, scene.surface.depth)) / 2
    middles = np.array([area.centre for area in areas])
    for turn in np.radians(TURNS):
        path = pick_up(areas, scene, turn)
        lip, beyond = path.waypoints[-3], (middles @ to_pan(scene, turn)).argmax() < len(areas) - 1
        if (np.abs((lip.x, lip.y)) < half).all() and not beyond:
            yield path


def to_pan(scene: Scene, turn: float = 0.0) -> Floats:
    """(2,) the direction in which the dustpan waits beyond the dirt: left, or turned from there towards the
    robot, in radians."""
    out = np.array(scene.outwards())
    left = np.array((out[1], -out[0]))
    aim: Floats = np.cos(turn) * left + np.sin(turn) * out
    return aim


def pick_up(areas: Sequence[Ellipse], scene: Scene, turn: float | None = None) -> ToolPath:
    """The rag's path over one area, or over several and from the last one's middle; and with it where the
    dustpan stands and is emptied. One area is swept from its farthest point on the right to that on the left,
    or, where a `turn` is given, straight to the left, turned by so many radians towards the robot."""
    aim = to_pan(scene, turn or 0.0)
    poses, way = _over(areas, scene, aim) if len(areas) > 1 else _alone(areas[0], scene, aim, turn is None)
    yaw = float(np.arctan2(way[1], way[0]))
    down, *others = poses
    lip = np.array(poses[-1][:2])
    last, top = lip + ONTO_PAN * way, PAN_SLOPE * ONTO_PAN + RAG_GAP
    return ToolPath(
        (
            Waypoint(*down[:2], LIFT, down[2], TRANSIT_SPEED),
            Waypoint(*down[:2], 0.0, down[2], VERTICAL_SPEED),
            *(Waypoint(x, y, 0.0, turned, STRAIGHT_SPEED) for x, y, turned in others),
            _at(last, top, yaw, STRAIGHT_SPEED),
            _at(last, top + LIFT, yaw, VERTICAL_SPEED),
        ),
        Interpolation.STRAIGHT,
        Dustpan(_at(lip + PAN_LENGTH * way, 0.0, yaw, VERTICAL_SPEED), _emptied(scene), TIP),
    )


def _alone(area: Ellipse, scene: Scene, aim: Floats, across: bool) -> tuple[tuple[Pose, ...], Floats]:
    """Where the rag comes down behind the area, and where it meets the lip; and the way (2,) from there:
    `across` the area, or along `aim` over its middle."""
    middle, half_length = np.array(area.centre), reach(area, (float(aim[0]), float(aim[1])))
    begin, way = _across(area, aim) if across else (middle - half_length * aim, aim)
    end = begin + 2 * ((middle - begin) @ way) * way
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 - EDGE_MARGIN
    first, lip = np.clip(begin - CLEARANCE * way, -half, half), end + CLEARANCE / 2 * way
    yaw = float(np.arctan2(way[1], way[0]))
    return (_pose(first, yaw), _pose(lip, yaw)), way


def _across(area: Ellipse, aim: Floats) -> tuple[Floats, Floats]:
    """The area's farthest point (2,) against `aim`, and the way (2,) from there to the farthest along it."""
    points = boundary(area)
    begin, end = points[np.argmin(points @ aim)], points[np.argmax(points @ aim)]
    way: Floats = (end - begin) / np.linalg.norm(end - begin)
    return begin, way


def _over(areas: Sequence[Ellipse], scene: Scene, aim: Floats) -> tuple[tuple[Pose, ...], Floats]:
    """The same of several areas, with what lies between. The lip lies farther away where the rag, which turns
    before it, would touch it."""
    middle = np.array(areas[-1].centre)
    corners = (behind_middle(areas[0], areas[1].centre), *(area.centre for area in areas[1:]))
    beyond = middle @ aim + reach(areas[-1], (float(aim[0]), float(aim[1]))) + CLEARANCE / 2
    far = max(float(beyond), _reached(corners, aim, scene) + CLEARANCE)
    lip = middle + (far - middle @ aim) * aim
    stroke = *corners, (float(lip[0]), float(lip[1]))
    return turning((behind(stroke, scene), *stroke[1:])), aim


def _reached(corners: Sequence[Point], aim: Floats, scene: Scene) -> float:
    """How far along `aim` (2,) the rag's ends reach while it goes from corner to corner, metres."""
    ends = np.array(corners)
    steps = np.diff(ends, axis=0)
    lengths = np.maximum(np.hypot(*steps.T), 1e-12)
    aside = np.abs(steps[:, 0] * aim[1] - steps[:, 1] * aim[0]) / lengths
    ahead = np.maximum(ends[1:] @ aim, ends[:-1] @ aim)
    return float((ahead + scene.rag.width / 2 * aside).max())


def _emptied(scene: Scene) -> Waypoint:
    """Where the dustpan is held while it is tipped over the container."""
    out = np.array(scene.outwards())
    (x0, y0), (x1, y1) = scene.mouth()
    middle = np.array(((x0 + x1) / 2, (y0 + y1) / 2))
    place = middle + (TIP_BEYOND - PAN_LENGTH * np.cos(TIP)) * out
    return _at(place, TIP_HEIGHT, float(np.arctan2(-out[1], -out[0])), TRANSIT_SPEED)


def _pose(point: Floats, yaw: float) -> Pose:
    return float(point[0]), float(point[1]), yaw


def _at(point: Floats, z: float, yaw: float, speed: float) -> Waypoint:
    return Waypoint(float(point[0]), float(point[1]), z, yaw, speed)
