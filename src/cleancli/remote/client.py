"""What a program asks a driver, and the reply to it as a record, checked against the protocol.

Of time it is checked that the clock never runs back; what a reply says beyond that is for the caller to
judge.
"""

from __future__ import annotations

import socket
from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import Self, TypeVar

from cleancli.motion.path import ToolPath
from cleancli.remote import messages
from cleancli.remote.fields import BadArray, Fields, fields_of
from cleancli.remote.messages import Description, FramePair, Poll, State
from cleancli.remote.transport import TooLate, Transport
from cleancli.remote.wire import BadMessage, Message
from cleancli.scene.address import Address
from cleancli.world.errors import RobotError

_Read = TypeVar("_Read")

CONNECTING = 5.0
"""Seconds that a driver may take to accept a connection."""
ANSWERING = 30.0
"""Seconds until a driver must begin to answer. Planning a stroke takes an arm a second or two, and longer on
a busy machine that does it for the first time."""
PATIENCE = 5.0
"""Seconds that the rest of a message may take."""


class Broken(RobotError):
    """A driver breaks the protocol; `fault` is a word for how."""

    def __init__(self, address: Address, fault: str, what: str) -> None:
        super().__init__(f"the driver at {address} breaks the protocol: {what}")
        self.fault = fault


class Tripped(RobotError):
    """A robot has tripped, and waits for a person to re-arm it."""


@dataclass(frozen=True, slots=True)
class Refusal:
    """A motion that the driver does not carry out."""

    reason: str


class Client:
    """A connection to a driver. `state` is where the robot was in the last reply. Raises RobotError from all
    methods, and once the connection has ended, from all that come after it the reason again; `close` it, or
    use it in a `with` statement. Without `control` it can only ask and re-arm."""

    state: State

    def __init__(self, address: Address, control: bool = True, answering: float = ANSWERING) -> None:
        self.address, self._answering, self._clock = address, answering, 0.0
        self._reason: RobotError | None = None  # why there is no connection any more
        try:
            connection = socket.create_connection((address.host, address.port), CONNECTING)
        except OSError as error:
            raise RobotError(f"no driver answers at {address}: {error.strerror or error}") from None
        self._transport = Transport(connection)
        try:
            self.description = self.hello(control)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the connection. A motion that is under way then trips the robot."""
        self._transport.close()

    def hello(self, control: bool) -> Description:
        """Who the robot is. With `control`, no other client may move it until this one has gone."""
        return self._ask(messages.hello(control), messages.description_of)

    def refresh(self) -> None:
        """Ask where the robot is."""
        self._ask(messages.request("state"), _nothing)

    def observe(self) -> FramePair:
        """A new pair of pictures."""
        return self._ask(messages.request("observe"), messages.frames_of)

    def can_follow(self, path: ToolPath, errors: float) -> bool:
        """Whether the path can be carried out from here."""
        asked = messages.path_request("can_follow", path, errors=errors)
        return self._ask(asked, lambda said: said.flag("follows"))

    def start(self, path: ToolPath) -> int | Refusal:
        """The number of the motion that has begun."""
        return self._ask(messages.path_request("start", path), _begun)

    def withdraw(self) -> int | Refusal:
        """The same out of the camera's view."""
        return self._ask(messages.request("withdraw"), _begun)

    def poll(self, motion: int) -> Poll:
        """Where a motion stands; what the reply says of the lease is that it begins anew."""
        return self._ask(messages.poll_request(motion), messages.poll_of)

    def stop(self) -> None:
        """End the motion now, with the tool raised."""
        self._ask(messages.request("stop"), _nothing)

    def rearm(self) -> None:
        """Let the robot carry motions out again after a trip. For a person to say."""
        self._ask(messages.request("rearm"), _nothing)

    def _ask(self, asked: Message, read: Callable[[Fields], _Read]) -> _Read:
        """What the reply says beside the state. After an error nobody knows where the next reply begins, so
        the connection ends; not after one that the driver tells of itself."""
        try:
            fields = fields_of(self._exchanged(asked))
            if fields.has("error"):
                raise RobotError(f"the driver at {self.address} says: {fields.text('error')}")
            found = read(fields)
            state = messages.state_of(fields)
            fields.end()
        except BadMessage as error:
            fault = "wrong-sizes" if isinstance(error, BadArray) else "wrong-fields"
            raise self._ended(Broken(self.address, fault, str(error))) from None
        if state.clock < self._clock:
            what = f"its clock runs back, from {self._clock:g} to {state.clock:g} s"
            raise self._ended(Broken(self.address, "clock-back", what))
        self.state, self._clock = state, state.clock
        return found

    def _exchanged(self, asked: Message) -> Message:
        if self._reason is not None:
            raise self._reason
        try:
            self._transport.send(asked, PATIENCE)
            return self._transport.receive(self._answering, PATIENCE)
        except BadMessage as error:
            raise self._ended(Broken(self.address, "garbage", str(error))) from None
        except (TooLate, EOFError) as error:
            what = str(error)
        except OSError as error:
            what = f"can no longer be reached: {error.strerror or error}"
        raise self._ended(RobotError(f"the driver at {self.address} {what}"))

    def _ended(self, reason: RobotError) -> RobotError:
        """End the connection, and keep the reason for whoever asks next."""
        self._reason = reason
        self.close()
        return reason


def _begun(said: Fields) -> int | Refusal:
    return Refusal(said.text("refused")) if said.has("refused") else said.whole("motion")


def _nothing(said: Fields) -> None:
    """Only the state is told."""
