"""Drivers that break docs/protocol.md, each in one way, and the word that `robot check` has for it."""

from __future__ import annotations

import socket
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from threading import Thread

import numpy as np

from cleancli.motion.path import ToolPath
from cleancli.remote.messages import FramePair
from cleancli.remote.server import Server
from cleancli.scene.address import Address
from cleancli.world.robot import Status
from support.toy_driver import TOY, Toy, served


class _IgnoresStop(Toy):
    def stop(self) -> None:
        return


class _RepeatsFrames(Toy):
    same: FramePair | None = None

    def observe(self) -> FramePair:
        self.same = self.same or super().observe()
        now = self.clock
        return replace(self.same, colour_stamp=now, depth_stamp=now)


class _StampsFromThePast(Toy):
    def observe(self) -> FramePair:
        pair, old = super().observe(), self.pace
        return replace(pair, colour_stamp=pair.colour_stamp - old, depth_stamp=pair.depth_stamp - old)


class _StampsFromTheFuture(Toy):
    def observe(self) -> FramePair:
        pair, early = super().observe(), self.pace
        return replace(pair, colour_stamp=pair.colour_stamp + early, depth_stamp=pair.depth_stamp + early)


class _Unpaired(Toy):
    def observe(self) -> FramePair:
        colour = super().observe()
        time.sleep(0.1)
        return replace(colour, depth_stamp=self.clock)


class _ClockRunsBack(Toy):
    @property
    def clock(self) -> float:
        now, back = super().clock, 0.2 * self.pace
        return now - back if now % (2 * back) > back else now


class _NeverEnds(Toy):
    def poll(self) -> Status:
        super().poll()
        return Status.RUNNING


class _EndsAtOnce(Toy):
    def poll(self) -> Status:
        return Status.DONE


class _WrongSizes(Toy):
    def observe(self) -> FramePair:
        return replace(super().observe(), depth=np.ones((3, 4), np.float32))


def _forget_limits(server: Server) -> None:
    guard = server.guard

    def start(path: ToolPath) -> int | str:
        return guard._begun(lambda: guard.driver.start(path))

    guard.start = start  # type: ignore[method-assign]


def _forget_lease(server: Server) -> None:
    server.guard._watched = lambda: None  # type: ignore[method-assign]
    server.guard.trip = lambda reason: None  # type: ignore[method-assign]


def _as_it_is(server: Server) -> None:
    return


BROKEN: Mapping[str, tuple[type[Toy], Callable[[Server], None]]] = {
    "ignores-stop": (_IgnoresStop, _as_it_is),
    "repeats-frames": (_RepeatsFrames, _as_it_is),
    "stamp-past": (_StampsFromThePast, _as_it_is),
    "stamp-future": (_StampsFromTheFuture, _as_it_is),
    "unpaired": (_Unpaired, _as_it_is),
    "clock-back": (_ClockRunsBack, _as_it_is),
    "never-ends": (_NeverEnds, _as_it_is),
    "ends-at-once": (_EndsAtOnce, _as_it_is),
    "wrong-sizes": (_WrongSizes, _as_it_is),
    "forgets-limits": (Toy, _forget_limits),
    "forgets-lease": (Toy, _forget_lease),
}
FAULTS = (*BROKEN, "garbage")


@contextmanager
def broken(fault: str, sees: type[Toy] = Toy) -> Iterator[Address]:
    """Where a driver with this fault listens, which is a `sees` otherwise."""
    if fault == "garbage":
        with _garbage() as address:
            yield address
        return
    driver, change = BROKEN[fault]
    bases = (sees,) if driver is Toy else (driver,) if sees is Toy else (driver, sees)
    with served(type(fault, bases, {})(), TOY) as server:
        change(server)
        yield server.address


@contextmanager
def _garbage() -> Iterator[Address]:
    """Answers whatever is asked with what is no message."""
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def answer() -> None:
            with suppress(OSError):
                while True:
                    connection, _ = listener.accept()
                    connection.recv(1 << 16)
                    connection.sendall(bytes(range(200)))
                    connection.close()

        Thread(target=answer, daemon=True).start()
        yield Address("127.0.0.1", listener.getsockname()[1])
        listener.shutdown(socket.SHUT_RDWR)
