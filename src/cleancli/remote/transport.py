"""A connection that carries messages, each within a time: neither side waits for ever for the other."""

from __future__ import annotations

import socket
import time
from contextlib import suppress

from cleancli.remote.wire import LARGEST_BODY, Message, encoded, received

_KEPT_ALIVE = (("TCP_KEEPIDLE", 10), ("TCP_KEEPINTVL", 5), ("TCP_KEEPCNT", 3))
"""Seconds and counts until the system ends a connection whose other side has vanished; where it has them."""


class TooLate(TimeoutError):
    """The other side does something too late; the text says what, as a sentence without its subject. So does
    that of an EOFError."""


class Transport:
    """One end of a connection, used by one thread; `close` may be called by any."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        for name, value in _KEPT_ALIVE:
            if hasattr(socket, name):
                connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)

    def send(self, message: Message, patience: float) -> None:
        """All of a message within so many seconds. Raises OSError, of which TooLate is one."""
        end = time.monotonic() + patience
        try:
            for piece in encoded(message):
                self._socket.settimeout(_left(end))
                self._socket.sendall(piece)
        except TimeoutError as error:
            raise _told(error, f"does not take what it is sent within {patience:g} s") from None

    def receive(self, until_first: float | None, patience: float, most: int = LARGEST_BODY) -> Message:
        """The next message: its first byte within `until_first` seconds, or whenever it comes, the rest
        within `patience`. Raises OSError, EOFError where the other side has ended, and BadMessage."""
        end = None if until_first is None else time.monotonic() + until_first
        has_begun = False

        def fill(memory: memoryview) -> None:
            nonlocal end, has_begun
            filled = 0
            while filled < len(memory):
                self._socket.settimeout(None if end is None else _left(end))
                count = self._socket.recv_into(memory[filled:])
                if not count:
                    raise EOFError("has ended the connection")
                filled += count
                if not has_begun:
                    has_begun, end = True, time.monotonic() + patience

        try:
            return received(fill, most)
        except TimeoutError as error:
            if has_begun:
                raise _told(error, f"has begun a message and not ended it within {patience:g} s") from None
            raise _told(error, f"does not answer within {until_first or patience:g} s") from None

    def close(self) -> None:
        """Also for a thread that waits in the other methods, which then raise."""
        with suppress(OSError):  # the other side may have been quicker
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()


def _left(end: float) -> float:
    left = end - time.monotonic()
    if left <= 0:
        raise TimeoutError
    return left


def _told(error: TimeoutError, what: str) -> TimeoutError:
    """An error of the system's own, by which a side that has vanished is known, or what else is too late."""
    return error if error.errno is not None else TooLate(what)
