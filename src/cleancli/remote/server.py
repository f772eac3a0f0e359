"""A driver at a port of this machine: one client has control, and anybody here may ask how the robot is.

Each connection has a thread of its own, so that whoever wants to re-arm is heard while another one hangs.
"""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from types import MappingProxyType

from cleancli.remote import messages
from cleancli.remote.fields import Fields, fields_of
from cleancli.remote.guard import CLOSING, Driver, Guard, Told, beyond
from cleancli.remote.messages import Description
from cleancli.remote.transport import Transport
from cleancli.remote.wire import BadMessage, Message
from cleancli.scene.address import Address, is_here

MOST_CLIENTS = 8
"""Connections at a time."""
LARGEST_REQUEST = messages.MOST_WAYPOINTS * 5 * 8
"""Bytes of all arrays of a request."""
RETRY = 0.05
"""Seconds until connections are accepted again after that failed."""
LEAVING = 1.0
"""Seconds in which a client that has gone is noticed, before another one is told that it has control."""
PATIENCE = 5.0
"""Seconds that the rest of a message may take once it has begun, and that a client may take to accept a
reply."""


class Server:
    """Listens as soon as it is made; `serve` answers until `close`. Raises OSError where the port is taken,
    and ValueError for an address that other machines reach: whoever does can move the robot. `told` is told
    what a person at the driver's terminal should know."""

    def __init__(
        self,
        driver: Driver,
        description: Description,
        address: Address,
        told: Told = lambda text: None,
    ) -> None:
        if not is_here(address.host):
            raise ValueError(f"a driver listens at 127.0.0.1 or ::1, and not at {address.host}")
        self.guard = Guard(driver, description, told)
        family = socket.AF_INET6 if ":" in address.host else socket.AF_INET
        try:
            self._listener = socket.create_server((address.host, address.port), family=family)
        except OSError:
            self.guard.close()
            raise
        self.address = Address(address.host, self._listener.getsockname()[1])
        self._guarding = threading.RLock()  # a signal's handler may close in a thread that holds it
        self._controller: Transport | None = None
        self._clients: dict[Transport, threading.Thread] = {}
        self._is_open = True

    def serve(self) -> None:
        """Answer clients until `close`, which another thread calls, or a signal's handler."""
        while self._is_open:
            try:
                connection, _ = self._listener.accept()
                client = Transport(connection)
            except OSError:  # closed, gone already, or for the moment out of what connections take
                time.sleep(RETRY)
                continue
            thread = threading.Thread(target=self._converse, args=(client,), daemon=True)
            with self._guarding:
                is_one_too_many = len(self._clients) >= MOST_CLIENTS
                if not is_one_too_many:
                    self._clients[client] = thread
            if is_one_too_many:
                client.close()
                continue
            try:
                thread.start()
            except RuntimeError:  # the system has no thread to give; who has control keeps it
                self._leave(client)

    def close(self) -> None:
        """Stop the robot if it moves, and listen no longer."""
        self._is_open = False
        with suppress(OSError):  # wakes `accept`, which `close` alone would not
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self.guard.close()
        with self._guarding:
            clients = dict(self._clients)
        for client, thread in clients.items():
            client.close()
            if thread.is_alive():
                thread.join(CLOSING)
        self.guard.tell.close()

    def _converse(self, client: Transport) -> None:
        """Requests and their replies in turn. What is no message ends the connection: nobody knows where the
        next one begins."""
        try:
            while True:
                try:
                    asked = client.receive(None, PATIENCE, LARGEST_REQUEST)
                except BadMessage as error:
                    client.send(messages.error(str(error)), PATIENCE)
                    return
                reply = self._answered(asked, client)
                try:
                    client.send(reply, PATIENCE)
                except ValueError as error:  # what the driver gave fits into no message; nothing was sent
                    client.send(messages.error(f"the driver failed: {error}"), PATIENCE)
        except (OSError, EOFError):
            return
        finally:
            self._leave(client)

    def _leave(self, client: Transport) -> None:
        with self._guarding:
            had_control = client is self._controller
            if had_control:
                self._controller = None
        client.close()
        if had_control:
            self.guard.lost("the client's connection ended while the robot moved")
            self.guard.tell("the client has gone")
        with self._guarding:
            self._clients.pop(client, None)

    def _answered(self, asked: Message, client: Transport) -> Message:
        try:
            fields = fields_of(asked)
            name = fields.text("request")
            if name == "hello":
                return self._hello(fields, client)
            if name == "state":
                fields.end()
                return messages.reply(self.guard.state)
            if name == "rearm":
                return self._rearmed(fields)
            if name not in _CONTROLLED:
                return messages.error(f"there is no request `{name[:40]}`")
            if client is not self._controller:
                return messages.error("it takes control to ask for that, which `hello` gives")
            return _CONTROLLED[name](self, fields)
        except BadMessage as error:
            return messages.error(str(error))
        except Exception as error:  # of the driver: nobody knows what the robot does now
            self.guard.trip(f"the driver failed: {error!r}")
            return messages.error(f"the driver failed: {error!r}")

    def _hello(self, fields: Fields, client: Transport) -> Message:
        version, wants_control = fields.whole("version"), fields.flag("control")
        fields.end()
        if version != messages.VERSION:
            return messages.error(f"this driver speaks version {messages.VERSION} of the protocol")
        if wants_control:
            self._wait_for_who_leaves(client)
        with self._guarding:
            before = None if self._controller is client else self._controller
            if wants_control and before is not None and not self.guard.state.trip:
                return messages.error("another client has control")
            self._controller = client if wants_control else self._controller
        if wants_control:
            if before is not None:  # it let its lease run out: it hangs, or sits behind a cable that is cut
                before.close()
            self.guard.tell("a client has control")
        return messages.reply(self.guard.state, **messages.described(self.guard.description))

    def _wait_for_who_leaves(self, client: Transport) -> None:
        """A connection that was closed just now is read to its end by a thread that may not have run yet."""
        patient_until = time.monotonic() + LEAVING
        while self._controller not in (None, client) and time.monotonic() < patient_until:
            if self.guard.state.trip:
                return
            time.sleep(RETRY / 5)

    def _rearmed(self, fields: Fields) -> Message:
        fields.end()
        self.guard.rearm()
        self.guard.tell("re-armed")
        return messages.reply(self.guard.state)

    def _observed(self, fields: Fields) -> Message:
        fields.end()
        pair = self.guard.driver.observe()
        return messages.frames_reply(pair, self.guard.state)

    def _can_follow(self, fields: Fields) -> Message:
        path, errors = messages.path_of(fields), fields.number("errors")
        fields.end()
        follows = not beyond(path, self.guard.description) and self.guard.driver.can_follow(path, errors)
        return messages.reply(self.guard.state, follows=follows)

    def _start(self, fields: Fields) -> Message:
        path = messages.path_of(fields)
        fields.end()
        return self._begun(self.guard.start(path))

    def _withdraw(self, fields: Fields) -> Message:
        fields.end()
        return self._begun(self.guard.withdraw())

    def _begun(self, begun: int | str) -> Message:
        if isinstance(begun, int):
            return messages.reply(self.guard.state, motion=begun)
        self.guard.tell(f"refused: {begun}")
        return messages.refusal(begun, self.guard.state)

    def _poll(self, fields: Fields) -> Message:
        motion = fields.whole("motion")
        fields.end()
        now = self.guard.poll(motion)
        if now is None:
            return messages.error(f"the motion that began last is not {motion}")
        return messages.poll_reply(now, self.guard.state)

    def _stop(self, fields: Fields) -> Message:
        fields.end()
        self.guard.stop()
        return messages.reply(self.guard.state)


_CONTROLLED: Mapping[str, Callable[[Server, Fields], Message]] = MappingProxyType(
    {
        "observe": Server._observed,
        "can_follow": Server._can_follow,
        "start": Server._start,
        "withdraw": Server._withdraw,
        "poll": Server._poll,
        "stop": Server._stop,
    }
)
"""What only the client in control may ask for."""
