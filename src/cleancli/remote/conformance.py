"""Whether a driver keeps to docs/protocol.md: steps that a lab runs against its own, each fault by its name.

The robot is moved: above the middle of its workspace, at half of its highest speed.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import ceil, dist

import numpy as np

from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.remote.client import Broken, Client, Refusal
from cleancli.remote.messages import FramePair, Limits, mistimed
from cleancli.remote.robot import ENDED
from cleancli.scene.address import Address
from cleancli.world.errors import RobotError
from cleancli.world.robot import Status

HELLO = "says who it is"

PAIRS = 5
"""Pairs of pictures that are asked for."""
LONGEST = 60.0
"""Real seconds after which a motion of the check has no end, and is begun no more."""
ARRIVED = 3.0
"""The same with the tool at the end of its path."""
SLOW = 0.5
"""Real seconds by which a poll may be answered later than the driver says."""
STOPPING = 0.1
"""Real seconds that a robot has to stop in."""
LASTING = 3.0
"""Times the lease and `STOPPING` that a motion lasts which nobody polls."""
STRAY = 2e-3
"""Metres by which a tool that stands still may be measured elsewhere."""
BEYOND, FASTER = 1e-3, 1.01
"""Metres outside of a limit, and times the highest speed, at which a path must be refused."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A step of the check, and the `fault` that it found with words about it, or none."""

    step: str
    fault: str = ""
    what: str = ""


class Fault(Exception):
    """What a driver does wrong: a name for it, and a sentence without its end."""

    def __init__(self, name: str, what: str) -> None:
        super().__init__(what)
        self.name = name


def conformance(address: Address, moves: bool = True) -> Iterator[Finding]:
    """Each step of the check as it is done; those that move the robot only where it `moves`. Where `hello` is
    answered wrongly there are no others. Raises RobotError where nobody answers, the robot has tripped, or
    another client has control."""
    try:
        with Client(address, control=False) as client:
            trip = client.state.trip
        if trip:
            raise RobotError(f"the robot has tripped: {trip}; re-arm it first")
        with Client(address):
            pass
    except Broken as error:
        yield Finding(HELLO, error.fault, str(error))
        return
    yield Finding(HELLO)
    for step, check in (STILL_STEPS | MOVING_STEPS if moves else STILL_STEPS).items():
        yield _tried(step, check, address)


def number_of_steps(moves: bool) -> int:
    """Of a check that finds what it is to look at."""
    return 1 + len(STILL_STEPS) + (len(MOVING_STEPS) if moves else 0)


def _tried(step: str, check: Callable[[Client], None], address: Address) -> Finding:
    try:
        with Client(address) as client:
            try:
                check(client)
            finally:
                _calm(client)
    except Fault as fault:
        return Finding(step, fault.name, str(fault))
    except Broken as error:
        return Finding(step, error.fault, str(error))
    except RobotError as error:
        return Finding(step, "no-answer", str(error))
    return Finding(step)


def _calm(client: Client) -> None:
    """As before the step: nothing moves, and the robot has not tripped; a person has asked for the check."""
    try:
        client.stop()
        client.rearm()
    except RobotError:
        client.close()  # the step has told of it, or the next one will


# Without motion


def _frames(client: Client) -> None:
    before: FramePair | None = None
    for _ in range(PAIRS):
        client.refresh()
        asked = client.state.clock
        pair = client.observe()
        if (wrong := mistimed(pair, asked, client.state.clock)) is not None:
            raise Fault(*wrong)
        if before is not None and _is_same(pair, before):
            raise Fault("repeats-frames", "two pairs in a row are the same, to the last bit")
        before = pair


def _is_same(pair: FramePair, other: FramePair) -> bool:
    return np.array_equal(pair.colour, other.colour) and np.array_equal(pair.depth, other.depth)


def _limits(client: Client) -> None:
    limits = client.description.limits
    middle, speed = _middle(limits), limits.speed
    beside = (limits.high[0] + BEYOND, middle[1], middle[2])
    below = (middle[0], middle[1], -limits.depth - BEYOND)
    paths = {
        "1 mm outside of its workspace": _path(middle, beside, speed=speed),
        "1 % faster than it may": _path(middle, speed=FASTER * speed),
        "1 mm deeper than it may": _path(middle, below, speed=speed),
    }
    for what, path in paths.items():
        if not isinstance(client.start(path), Refusal):
            client.stop()
            raise Fault("forgets-limits", f"it sets off on a path {what}")


def _nonsense(client: Client) -> None:
    """On a connection of its own; the client's must outlive it."""
    address = client.address
    try:
        with socket.create_connection((address.host, address.port), 2.0) as other:
            other.sendall(b"GET / HTTP/1.1\r\n\r\n")
            other.settimeout(2.0)
            while other.recv(1 << 16):
                pass
    except TimeoutError:
        raise Fault("keeps-nonsense", "it does not end a connection on which no message came") from None
    except OSError:
        pass  # ended as well, if less politely
    try:
        client.refresh()
    except RobotError as error:
        raise Fault("dies-of-nonsense", f"after nonsense on another connection, {error}") from None


# With motion


def _motion(client: Client) -> None:
    until = time.monotonic() + LONGEST
    while not _carried_out(client, until):
        client.rearm()


def _carried_out(client: Client, until: float) -> bool:
    """Whether a motion went on to its end. It did not where this machine was so busy that its lease may have
    run out between two polls, which is no fault of the driver; the one before may have renewed it as soon as
    it was asked."""
    asked, arrived = time.monotonic(), None
    path, motion = _begun(client)
    end, clock = path.waypoints[-1], client.state.clock
    while True:
        before, asked = asked, time.monotonic()
        now = client.poll(motion)
        answered = time.monotonic()
        if answered - asked > client.description.period + SLOW:
            raise Fault("slow-polls", f"a poll took {answered - asked:.1f} s")
        if client.state.trip and answered - before >= client.description.lease and answered < until:
            return False
        away = dist(client.state.tool, (end.x, end.y, end.z))
        if now.status is not Status.RUNNING:
            break
        arrived = (arrived or answered) if away <= ENDED else None
        if answered > until or (arrived is not None and answered - arrived > ARRIVED):
            raise Fault("never-ends", "a motion goes on though its tool is at the end of its path")
    if now.status is Status.FAILED:
        raise Fault("fails", f"it does not reach the middle of its workspace: {now.failure}")
    if away > ENDED:
        raise Fault("ends-at-once", f"a motion is over with the tool {100 * away:.0f} cm from its end")
    if client.state.clock <= clock:
        raise Fault("clock-still", "its clock stands still in a motion")
    return True


def _stop(client: Client) -> None:
    _, motion = _begun(client)
    _moving(client, motion)
    client.stop()
    if client.poll(motion).status is Status.RUNNING:
        raise Fault("ignores-stop", "a motion goes on after it was stopped")
    _stands_still(client, "ignores-stop", "the tool moves on after it was stopped")


def _one_at_a_time(client: Client) -> None:
    _, motion = _begun(client)
    client.poll(motion)
    if not isinstance(client.withdraw(), Refusal):
        raise Fault("two-motions", "it begins a motion while another one is under way")


def _lease(client: Client) -> None:
    """The motion outlasts the lease: one that has ended by itself trips nothing."""
    lease = client.description.lease
    _, motion = _begun(client, lasting=LASTING * (lease + STOPPING))
    client.poll(motion)
    time.sleep(lease + STOPPING)
    _has_tripped(client, "forgets-lease", "it has not tripped after its lease without a poll")
    client.rearm()
    if client.state.trip:
        raise Fault("no-rearming", "it has still tripped after it was re-armed")
    _begun(client)


def _lost(client: Client) -> None:
    """The connection ends; the robot is looked at through another one."""
    _, motion = _begun(client)
    client.poll(motion)
    client.close()
    time.sleep(client.description.lease + STOPPING)
    with Client(client.address) as other:
        _has_tripped(other, "forgets-clients", "it has not tripped though its client has gone")
        _calm(other)


def _has_tripped(client: Client, fault: str, what: str) -> None:
    client.refresh()
    if not client.state.trip:
        raise Fault(fault, what)
    _stands_still(client, fault, "the tool moves on after it has tripped")
    if not isinstance(client.start(_path(_middle(client.description.limits), speed=0.01)), Refusal):
        raise Fault("moves-tripped", "it sets off though it has tripped")


def _stands_still(client: Client, fault: str, what: str) -> None:
    time.sleep(STOPPING)
    client.refresh()
    before = client.state.tool
    time.sleep(STOPPING)
    client.refresh()
    if dist(before, client.state.tool) > STRAY:
        raise Fault(fault, what)


def _moving(client: Client, motion: int) -> None:
    """Poll until the tool has set off, or the motion is over."""
    before, end = client.state.tool, time.monotonic() + LONGEST
    while client.poll(motion).status is Status.RUNNING and time.monotonic() < end:
        if dist(before, client.state.tool) > 5 * STRAY:
            return


def _begun(client: Client, lasting: float = 0.0) -> tuple[ToolPath, int]:
    """A motion to the middle of the workspace, from wherever the tool is, and so often to and fro there that
    it takes `lasting` seconds at least."""
    limits = client.description.limits
    x, y, z = _middle(limits)
    side = x + min(0.05, (limits.high[0] - limits.low[0]) / 4)
    ends = (
        ((side, y, z), (x, y, z)) if dist(client.state.tool, (x, y, z)) < ENDED else ((x, y, z), (side, y, z))
    )
    speed = limits.speed / 2
    times = ceil(lasting * speed / (2 * (side - x))) + 1
    path = _path(*(times * ends), speed=speed)
    begun = client.start(path)
    if isinstance(begun, Refusal):
        raise Fault("refuses", f"it refuses a path within its limits: {begun.reason}")
    return path, begun


def _middle(limits: Limits) -> tuple[float, float, float]:
    """Of the workspace, 10 cm above the surface, or as near to that as may be."""
    x, y = ((low + high) / 2 for low, high in zip(limits.low[:2], limits.high[:2], strict=True))
    return x, y, min(max(0.1, limits.low[2]), limits.high[2])


def _path(*points: tuple[float, float, float], speed: float) -> ToolPath:
    return ToolPath(tuple(Waypoint(*point, 0.0, speed) for point in points), Interpolation.STRAIGHT)


STILL_STEPS: dict[str, Callable[[Client], None]] = {
    "takes pictures when it is asked": _frames,
    "refuses what is beyond its limits": _limits,
    "outlives nonsense": _nonsense,
}
MOVING_STEPS: dict[str, Callable[[Client], None]] = {
    "carries a motion out": _motion,
    "stops when it is asked": _stop,
    "does one motion at a time": _one_at_a_time,
    "stops when nobody polls": _lease,
    "stops when its client goes": _lost,
}
