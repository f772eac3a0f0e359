"""What client and driver say to each other (docs/protocol.md), as records; each is written and read here.

Lengths in metres, angles in radians, times in seconds of the robot's clock, pixels in images. All readers
raise BadMessage.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from cleancli.array_types import Depth, Floats, Image
from cleancli.motion.path import Dustpan, Interpolation, ToolPath, Waypoint
from cleancli.remote.fields import Fields, line
from cleancli.remote.wire import BadMessage, Message
from cleancli.world.robot import Status

VERSION = 1
"""Of the protocol. Another one means other messages."""

MOST_WAYPOINTS = 10_000
"""Of a path: wiping a whole table takes some hundreds."""

APART = 0.05
"""Seconds of the robot's clock between colour and depth of a pair, at most: a frame and a half of a camera
that takes thirty a second."""

DUSTPAN = "dustpan"
"""The skill of a second hand."""

SKILLS = ("straight", "joint", DUSTPAN)
"""What a path may ask for: its ways from waypoint to waypoint, and a second hand."""

_Numbers = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Limits:
    """What a driver carries out: waypoints in the box from `low` to `high` (x, y, z), at most at this `speed`
    (m/s), and at most this `depth` below the surface."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    speed: float
    depth: float


@dataclass(frozen=True, slots=True)
class Description:
    """A robot: its name for people, its `skills` out of `SKILLS`, its limits, the `lease`: real seconds
    without a poll after which a motion is stopped, and the `period`: real seconds that a poll takes at
    most."""

    robot: str
    skills: tuple[str, ...]
    limits: Limits
    lease: float
    period: float


@dataclass(frozen=True, slots=True)
class State:
    """The robot's clock, where its tool is (x, y, z), and why it has tripped, or nothing."""

    clock: float
    tool: tuple[float, float, float]
    trip: str


@dataclass(frozen=True, slots=True)
class FramePair:
    """Colour (height, width, 3) and depth (height, width; 0 where unknown) of one view, each with the clock
    at which it was taken; focal lengths along columns and rows, the optical centre, a model of distortion by
    ROS's name for it (empty: none) with its coefficients; the camera's `pose` (4, 4) in the scene."""

    colour: Image
    depth: Depth
    colour_stamp: float
    depth_stamp: float
    focal: tuple[float, float]
    centre: tuple[float, float]
    pose: Floats
    distortion: str = ""
    coefficients: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class Poll:
    """Where a motion stands, and why it failed, or nothing."""

    status: Status
    failure: str


# Requests


def hello(control: bool) -> Message:
    """Who only asks takes no control."""
    return Message({"request": "hello", "version": VERSION, "control": control})


def request(name: str) -> Message:
    """One without particulars: `state`, `observe`, `withdraw`, `stop` or `rearm`."""
    return Message({"request": name})


def path_request(name: str, path: ToolPath, **more: float) -> Message:
    """`start` or `can_follow`, of a path."""
    head: dict[str, Any] = {"request": name, "interpolation": path.interpolation.value, **more}
    if path.dustpan is not None:
        head["dustpan"] = asdict(path.dustpan)
    waypoints = [(w.x, w.y, w.z, w.yaw, w.speed) for w in path.waypoints]
    return Message(head, {"waypoints": np.array(waypoints, np.float64).reshape(-1, 5)})


def poll_request(motion: int) -> Message:
    """Of the motion of this number."""
    return Message({"request": "poll", "motion": motion})


def path_of(fields: Fields) -> ToolPath:
    """The path of a request, of which each waypoint is finite and has a speed above 0."""
    word = fields.text("interpolation")
    if word not in (each.value for each in Interpolation):
        raise BadMessage("`interpolation` is neither `straight` nor `joint`")
    rows = fields.array("waypoints", "float64", (None, 5))
    if not 1 <= len(rows) <= MOST_WAYPOINTS:
        raise BadMessage(f"a path has 1 to {MOST_WAYPOINTS} waypoints, and this {len(rows)}")
    if not np.isfinite(rows).all() or not (rows[:, 4] > 0).all():
        raise BadMessage("the numbers of a waypoint are finite, and its speed is above 0")
    dustpan = _dustpan(fields.within("dustpan")) if fields.has("dustpan") else None
    return ToolPath(tuple(Waypoint(*row) for row in rows.tolist()), Interpolation(word), dustpan)


def _dustpan(fields: Fields) -> Dustpan:
    read = Dustpan(_waypoint(fields.within("place")), _waypoint(fields.within("empty")), fields.number("tip"))
    fields.end()
    return read


def _waypoint(fields: Fields) -> Waypoint:
    read = Waypoint(*(fields.number(key) for key in ("x", "y", "z", "yaw", "speed")))
    fields.end()
    if read.speed <= 0:
        raise BadMessage("the speed of a waypoint is above 0")
    return read


# Replies


def refusal(reason: str, state: State) -> Message:
    """To `start` and `withdraw`: nothing moves."""
    return reply(state, refused=line(reason))


def error(reason: str) -> Message:
    """To what is no request, or not one that may be made now."""
    return Message({"error": line(reason)})


def poll_reply(poll: Poll, state: State) -> Message:
    """To `poll`."""
    return reply(state, status=poll.status.value, failure=line(poll.failure))


def reply(state: State, **more: Any) -> Message:
    """Where the robot is, and whatever else was asked for."""
    return Message({**more, "state": {**asdict(state), "trip": line(state.trip)}})


def frames_reply(pair: FramePair, state: State) -> Message:
    """To `observe`."""
    camera: Mapping[str, Any] = {
        "focal": pair.focal,
        "centre": pair.centre,
        "pose": [float(value) for value in pair.pose.ravel()],
        "distortion": pair.distortion,
        "coefficients": pair.coefficients,
    }
    stamps = {"colour_stamp": pair.colour_stamp, "depth_stamp": pair.depth_stamp}
    head = reply(state, camera=camera, **stamps).head
    return Message(head, {"colour": pair.colour, "depth": pair.depth})


def description_of(fields: Fields) -> Description:
    """What `hello` is answered with, but for the state."""
    if (version := fields.whole("version")) != VERSION:
        raise BadMessage(f"it speaks version {version} of the protocol, and this is {VERSION}")
    skills = fields.words("skills")
    if unknown := set(skills) - set(SKILLS):
        raise BadMessage(f"`skills` names `{min(unknown)}`; there are {', '.join(SKILLS)}")
    limits = fields.within("limits")
    box = limits.numbers("low", 3), limits.numbers("high", 3)
    read = Description(
        fields.text("robot"),
        skills,
        Limits(_three(box[0]), _three(box[1]), _above(limits, "speed"), limits.number("depth")),
        _above(fields, "lease"),
        _above(fields, "period"),
    )
    limits.end()
    if any(low >= high for low, high in zip(*box, strict=True)) or read.limits.depth < 0:
        raise BadMessage("`limits` are a box, `low` below `high`, and a depth from 0")
    return read


def described(description: Description) -> dict[str, Any]:
    """The same for the reply."""
    return {"version": VERSION, **asdict(description)}


def state_of(fields: Fields) -> State:
    """Part of each reply."""
    state = fields.within("state")
    read = State(state.number("clock"), _three(state.numbers("tool", 3)), state.text("trip"))
    state.end()
    return read


def frames_of(fields: Fields) -> FramePair:
    """What `observe` is answered with, but for the state."""
    camera = fields.within("camera")
    colour = fields.array("colour", "uint8", (None, None, 3))
    depth = fields.array("depth", "float32", (*colour.shape[:2],))
    if not depth.size:
        raise BadMessage("the pictures have no pixels")
    focal, centre = camera.numbers("focal", 2), camera.numbers("centre", 2)
    pair = FramePair(
        colour,
        depth,
        fields.number("colour_stamp"),
        fields.number("depth_stamp"),
        (focal[0], focal[1]),
        (centre[0], centre[1]),
        np.array(camera.numbers("pose", 16)).reshape(4, 4),
        camera.text("distortion"),
        camera.some_numbers("coefficients"),
    )
    camera.end()
    return pair


def mistimed(pair: FramePair, before: float, after: float) -> tuple[str, str] | None:
    """What is wrong with the stamps of a pair that was asked for at the clock `before` and came at `after`,
    in a word and in a sentence without its end; None where nothing is."""
    stamps = {"colour": pair.colour_stamp, "depth": pair.depth_stamp}
    for what, stamp in stamps.items():
        if stamp < before:
            return "stamp-past", f"{what} is of {before - stamp:.3f} s before it was asked for"
        if stamp > after:
            return "stamp-future", f"{what} is of {stamp - after:.3f} s after it came"
    if (apart := abs(pair.colour_stamp - pair.depth_stamp)) > APART:
        return "unpaired", f"colour and depth are {apart:.3f} s apart, and {APART:g} s is the limit"
    return None


def poll_of(fields: Fields) -> Poll:
    """What `poll` is answered with, but for the state."""
    word = fields.text("status")
    if word not in (each.value for each in Status):
        raise BadMessage("`status` is none of running, done and failed")
    return Poll(Status(word), fields.text("failure"))


def _three(values: _Numbers) -> tuple[float, float, float]:
    x, y, z = values
    return x, y, z


def _above(fields: Fields, key: str) -> float:
    value = fields.number(key)
    if value <= 0:
        raise BadMessage(f"`{key}` is not above 0")
    return value
