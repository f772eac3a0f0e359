"""From an action and the ellipses it acts upon to the tool's path (§3.2).

Each skill gives the corners of its stroke, as the paper defines them; `tool_path` adds what all share: the
tool comes down straight, just behind the dirt, stands perpendicular to the motion, and is lifted at the end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, cos, hypot, radians, sin
from types import MappingProxyType

from cleancli.geometry.ellipse import Ellipse, Point, farthest, major_ends, nearest
from cleancli.motion.corners import CLEARANCE, behind, behind_middle, direction, distinct, turning
from cleancli.motion.pace import FAST_SPEED, STRAIGHT_SPEED
from cleancli.motion.path import Interpolation, ToolPath, along
from cleancli.motion.pick_up import pick_ups
from cleancli.motion.way_out import way_out
from cleancli.motion.wiping import wiping
from cleancli.motion.zone import way_in
from cleancli.scene.model import Scene

OVERSHOOT = 0.02  # the whole rag ends this far past the edge
PICK_UP = "pickUp"
PICK_UPS = (PICK_UP, "pickUp2", "pickUp3")  # the actions that take two arms
BRINGING = (0.0, 20.0, -20.0, 40.0, -40.0, 60.0, -60.0)  # degrees aside of the middle
NEAR_MIDDLE = 0.05  # nearer to the middle than so, nothing is brought

Areas = tuple[Ellipse, ...]


class NoSkill(Exception):
    """The robot can't execute this action with these arguments (picking up takes two arms, §3.2.2)."""

    def __init__(self, action: str, arity: int) -> None:
        known = ", ".join(f"{name}/{areas}" for name, areas in ARITIES.items() if name not in PICK_UPS)
        super().__init__(f"this robot can't execute {action}/{arity}; it can execute {known}")


@dataclass(frozen=True, slots=True)
class Skill:
    """How many ellipses an action takes, the corners of its stroke, given where else there is dirt, and how
    the drive goes between them."""

    arity: int
    stroke: Callable[[Areas, Scene, Areas], tuple[Point, ...]]
    speed: float
    interpolation: Interpolation


def can_execute(action: str, arity: int, arms: int) -> bool:
    """Whether a robot of so many arms has a skill for this action with so many areas."""
    return ARITIES.get(action) == arity and (action not in PICK_UPS or arms == 2)


def tool_path(action: str, areas: Areas, scene: Scene, others: Iterable[Ellipse] = ()) -> ToolPath:
    """The path of an action upon these ellipses, in scene coordinates (§3.2.1, §3.2.3); pushes and wiping
    take along what they can of the `others` that are dirty.

    Raises `NoSkill` for an action that the scene's robot doesn't have, ValueError for a push into the zone of
    a scene that has none.
    """
    return next(tool_paths(action, areas, scene, others))


def tool_paths(
    action: str, areas: tuple[Ellipse, ...], scene: Scene, others: Iterable[Ellipse] = ()
) -> Iterator[ToolPath]:
    """As `tool_path`, and then, of an action that can be done in several ways, what to try where the robot
    can't follow those before."""
    if not can_execute(action, len(areas), scene.arms):
        raise NoSkill(action, len(areas))
    if action in PICK_UPS:
        yield from pick_ups(areas, scene)
        if action == PICK_UP:
            yield from _nearer(areas[0], scene)
        return
    if action in WIPES:
        yield wiping(areas, scene, others)
        return
    if action in TO_ZONE:
        yield _to_zone(areas[0], scene, others)
        return
    skill = SKILLS[action]
    corners = skill.stroke(areas, scene, tuple(others))
    yield path_along(corners, scene, skill.speed, skill.interpolation)


def path_along(
    corners: Sequence[Point],
    scene: Scene,
    speed: float = STRAIGHT_SPEED,
    interpolation: Interpolation = Interpolation.STRAIGHT,
) -> ToolPath:
    """The path of a stroke with these corners, two at least: down behind the first, and up after the last."""
    corners = distinct(corners)
    stroke = turning((behind(corners, scene), *corners[1:]))
    return along(stroke, speed, interpolation)


def _nearer(area: Ellipse, scene: Scene) -> Iterator[ToolPath]:
    """Pushes of an area to the middle of the surface, where two arms reach best: for what they cannot pick up
    where it lies."""
    x, y = area.centre
    far = hypot(x, y)
    if far < NEAR_MIDDLE:
        return
    for aside in BRINGING:
        angle = atan2(-y, -x) + radians(aside)
        end = x + far * cos(angle), y + far * sin(angle)
        yield path_along((behind_middle(area, end), end), scene)


def _to_container(areas: Areas, scene: Scene, dirt: Areas) -> tuple[Point, ...]:
    """From behind the area over its middle into the container (§3.2.1)."""
    (area,) = areas
    _, *on = into_container(area.centre, scene, dirt)
    return behind_middle(area, on[0]), *on


def into_container(start: Point, scene: Scene, dirt: Areas) -> tuple[Point, ...]:
    """The corners of a stroke from `start` over the container's mouth, past the edge."""
    *corners, crossing = way_out(start, scene, dirt).corners
    return (*corners, past_edge(corners[-1], crossing, scene))


def gathering(areas: Areas) -> tuple[Point, ...]:
    """The corners of a stroke from behind the first ellipse to the near side of the next, and so on to the
    last without stopping (§3.2.3)."""
    corners = [farthest(areas[0], areas[1])]
    for first, second in pairwise(areas):
        corners += nearest(first, second)
    return tuple(corners)


def _join(areas: Areas, scene: Scene, dirt: Areas) -> tuple[Point, ...]:
    """Joining two or three (§3.2.3)."""
    return gathering(areas)


def _sweep(areas: Areas, scene: Scene, dirt: Areas) -> tuple[Point, ...]:
    """From behind the first area over the middles of all, and on from the last into the container."""
    first, *inner, last = areas
    on = into_container(last.centre, scene, (*dirt, first, *inner))
    return behind_middle(first, areas[1].centre), *(area.centre for area in inner), *on


def _to_zone(area: Ellipse, scene: Scene, dirt: Iterable[Ellipse]) -> ToolPath:
    """From behind the area over its middle into the zone."""
    way = way_in(area, scene, dirt)
    x, y = direction(way.begin, way.end)
    first = way.begin[0] + CLEARANCE * x, way.begin[1] + CLEARANCE * y  # behind which the rag comes down
    return path_along((first, way.end), scene)


def _group_scattered(areas: Areas, scene: Scene, dirt: Areas) -> tuple[Point, ...]:
    """From an end of the longer axis to the middle (§3.2.3): the end farther from the container, chosen
    because the dirt then comes nearer to it."""
    (area,) = areas
    middle = _mouth_middle(scene)
    start = max(major_ends(area), key=lambda end: hypot(end[0] - middle[0], end[1] - middle[1]))
    return start, area.centre


SKILLS: Mapping[str, Skill] = MappingProxyType(
    {
        "moveToContainerFast": Skill(1, _to_container, FAST_SPEED, Interpolation.JOINT),
        "moveToContainerStraight": Skill(1, _to_container, STRAIGHT_SPEED, Interpolation.STRAIGHT),
        "join2": Skill(2, _join, STRAIGHT_SPEED, Interpolation.STRAIGHT),
        "join3": Skill(3, _join, STRAIGHT_SPEED, Interpolation.STRAIGHT),
        "groupScattered": Skill(1, _group_scattered, STRAIGHT_SPEED, Interpolation.STRAIGHT),
        "sweep1": Skill(1, _to_container, FAST_SPEED, Interpolation.STRAIGHT),
        "sweep2": Skill(2, _sweep, FAST_SPEED, Interpolation.STRAIGHT),
        "sweep3": Skill(3, _sweep, FAST_SPEED, Interpolation.STRAIGHT),
    }
)
"""What one arm can do."""

SWEEPS = ("sweep1", "sweep2", "sweep3")
"""Strokes that go over several areas and on into the container."""

TO_ZONE = ("pushToZone",)
"""Strokes that end within a zone of the surface."""

WIPES = ("wipe", "wipe2", "wipe3")
"""Wiping areas away where they are, one after the other without lifting the rag."""

ARITIES: Mapping[str, int] = MappingProxyType(
    {
        **{name: skill.arity for name, skill in SKILLS.items()},
        **{name: number for number, name in enumerate(PICK_UPS, 1)},
        **{name: number for number, name in enumerate(WIPES, 1)},
        **dict.fromkeys(TO_ZONE, 1),
    }
)
"""How many areas each action takes: the six of §3.2, sweeps, which collect more in one stroke, wiping, and
pushing into a zone."""


def past_edge(start: Point, crossing: Point, scene: Scene) -> Point:
    """Where a push from `start` over `crossing` ends, with the rag's hindmost end past the edge as well."""
    x, y = direction(start, crossing)
    out = scene.outwards()
    straightness = x * out[0] + y * out[1]
    hindmost = scene.rag.width / 2 * abs(x * out[1] - y * out[0])
    beyond = min(hindmost + OVERSHOOT, scene.container.depth) / straightness
    return crossing[0] + beyond * x, crossing[1] + beyond * y


def _mouth_middle(scene: Scene) -> Point:
    (x0, y0), (x1, y1) = scene.mouth()
    return (x0 + x1) / 2, (y0 + y1) / 2
