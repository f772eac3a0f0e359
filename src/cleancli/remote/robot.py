"""A robot at the end of a socket, as the executor knows robots. What its driver says is checked and not
trusted."""

from __future__ import annotations

from contextlib import suppress
from math import dist
from types import TracebackType
from typing import Self

from cleancli.geometry.rgbd import Frame
from cleancli.motion.path import ToolPath, Waypoint
from cleancli.perception.camera_file import is_rigid
from cleancli.perception.frame_source import MOST_PIXELS
from cleancli.perception.lens import UnknownLens, lens, pinhole_frame
from cleancli.remote.client import Broken, Client, Refusal, Tripped
from cleancli.remote.messages import mistimed
from cleancli.scene.address import Address
from cleancli.world.errors import RobotError
from cleancli.world.robot import Status

ENDED = 0.03
"""Metres from the end of a path within which a motion is over; errors of the tool stay below."""


class RemoteRobot:
    """A `Robot` whose driver listens at `address`; `close` it, or use it in a `with` statement. Methods raise
    RobotError where the driver cannot be worked with, and Tripped where a person has to re-arm it."""

    def __init__(self, address: Address) -> None:
        self._client = Client(address)
        self._motion: int | None = None  # the one under way
        self._end: Waypoint | None = None  # where it leads, if that is known
        self._status, self.failure = Status.DONE, ""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the connection. A motion that is under way is stopped first: to the driver its client is
        lost."""
        if self._motion is not None:
            with suppress(RobotError):
                self.stop()
        self._client.close()

    @property
    def skills(self) -> tuple[str, ...]:
        """What it carries out, as its driver says."""
        return self._client.description.skills

    @property
    def clock(self) -> float:
        """As the last poll told it, in a motion; between motions as it is now, or as it was known last where
        the driver no longer answers, which the next request finds."""
        if self._motion is None:
            with suppress(RobotError):
                self._client.refresh()
        return self._client.state.clock

    @property
    def tool(self) -> tuple[float, float, float]:
        """Where the driver said last that it is."""
        return self._client.state.tool

    def observe(self) -> Frame:
        """A pair that was taken for this request, rectified. Raises Broken for one that was not, and for what
        no camera takes."""
        before = self.clock
        pair = self._client.observe()
        if (wrong := mistimed(pair, before, self._client.state.clock)) is not None:
            raise self._broken(*wrong)
        if pair.depth.size > MOST_PIXELS:
            raise self._broken("wrong-sizes", "its pictures have more than 3840 x 2160 pixels")
        if not is_rigid(pair.pose):
            raise self._broken("wrong-camera", "the camera's `pose` is no rotation and place")
        try:
            through = lens(pair.focal, pair.centre, pair.distortion, pair.coefficients)
        except UnknownLens as error:
            raise self._broken("wrong-camera", str(error)) from None
        return pinhole_frame(pair.colour, pair.depth, through, pair.pose, pair.depth_stamp)

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """As the driver says."""
        return self._client.can_follow(path, errors)

    def start(self, path: ToolPath) -> None:
        """Begin a motion, which has failed at once where the driver refuses it. Where the tool waits while a
        dustpan is emptied, no path says."""
        self._set_off(self._client.start(path), None if path.dustpan else path.waypoints[-1])

    def withdraw(self) -> None:
        """The same out of the camera's view."""
        self._set_off(self._client.withdraw(), None)

    def poll(self) -> Status:
        """Where the motion stands, as the driver says; one that is over far from its end has failed."""
        if self._motion is None:
            return self._status
        now = self._client.poll(self._motion)
        self._refuse_tripped()
        if now.status is Status.RUNNING:
            return now.status
        self._motion, self._status, self.failure = None, now.status, now.failure
        if now.status is Status.FAILED and not now.failure:
            self.failure = "the driver does not say why"
        if now.status is Status.DONE and self._end is not None:
            away = dist(self.tool, (self._end.x, self._end.y, self._end.z))
            if away > ENDED:
                self._status = Status.FAILED
                self.failure = f"the driver ended it {100 * away:.1f} cm from its end"
        return self._status

    def stop(self) -> None:
        """End the motion now, with the tool raised."""
        self._motion, self._status = None, Status.DONE
        self._client.stop()

    def _set_off(self, begun: int | Refusal, end: Waypoint | None) -> None:
        self._refuse_tripped()
        if isinstance(begun, Refusal):
            self._motion, self._status, self.failure = None, Status.FAILED, begun.reason
        else:
            self._motion, self._end, self.failure = begun, end, ""

    def _refuse_tripped(self) -> None:
        if reason := self._client.state.trip:
            self._motion = None
            at = self._client.address
            raise Tripped(
                f"the robot at {at} has tripped: {reason}; look whether it may move, "
                f"and then re-arm it: cleancli robot rearm {at}"
            )

    def _broken(self, fault: str, what: str) -> Broken:
        return Broken(self._client.address, fault, what)
