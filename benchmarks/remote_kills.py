"""Remote robots that lose their clients: python benchmarks/remote_kills.py [--kind NAME...] [--seed N]

--kills times each, a client is killed (KILL) or frozen (STOP) in mid-motion, its connection goes silent, or
the driver is killed or frozen; how long the tool moves on, whether the robot has tripped and refuses to move,
and whether it moves once it is re-armed.

Exits with 1 if a kill is not told or not survived. Fifty kills of each kind take about 35 minutes, of which
10 are CPU; how many are done is told to standard error. `--quick` takes about 10 seconds of CPU.
"""

from __future__ import annotations

import argparse
import random
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from math import dist

from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.remote.client import Client, Refusal
from cleancli.scene.address import Address, address_of
from cleancli.world.errors import RobotError
from cleancli.world.robot import Status

KINDS = ("client KILL", "client STOP", "silent", "driver KILL", "driver STOP")
LEASE, IN_TIME = 1.0, 0.1
"""Seconds: the lease of the drivers that are killed, and how much later than that a tool may still move."""
PATIENCE = 10.0
"""Seconds for which a client waits for a driver that is frozen, a third of what the program's own does."""
STILL = 1e-3
"""Metres by which a tool that stands still may be elsewhere."""
ENDS = ((-0.3, 0.0, 0.1), (0.3, 0.0, 0.1))


@contextmanager
def serving(*words: str) -> Iterator[tuple[subprocess.Popen[str], Address]]:
    """`cleancli robot serve` in a process of its own."""
    command = [sys.executable, "-m", "cleancli", "robot", "serve", *words, "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        told = re.search(r"listens at (\S+),", process.stdout.readline())
        assert told is not None, "it has not begun to listen"
        # What it says of its clients would fill the pipe.
        threading.Thread(target=process.stdout.read, daemon=True).start()
        try:
            yield process, address_of(told[1])
        finally:
            process.kill()


def client(address: Address) -> None:
    """Moves the tool to and fro until it is killed; says when it has begun."""
    with Client(address, answering=PATIENCE) as connection:
        for number in range(1000):
            motion = connection.start(_path(ENDS[number % 2]))
            assert isinstance(motion, int), motion
            while connection.poll(motion).status is Status.RUNNING:
                if number == 1:
                    print("moving", flush=True)
                    number = 2


class Relay:
    """A connection between a client and a driver that can go silent: neither side is told of it."""

    def __init__(self, to: Address) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = Address("127.0.0.1", self._listener.getsockname()[1])
        self.is_silent = False
        threading.Thread(target=self._carry, args=(to,), daemon=True).start()

    def _carry(self, to: Address) -> None:
        near, _ = self._listener.accept()
        far = socket.create_connection((to.host, to.port))
        for one, other in ((near, far), (far, near)):
            threading.Thread(target=self._pass_on, args=(one, other), daemon=True).start()

    def _pass_on(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while data := one.recv(1 << 16):
                while self.is_silent:
                    time.sleep(0.1)
                other.sendall(data)


def moves_on(address: Address, since: float, seconds: float) -> float:
    """How long after a moment the tool still moved, looked at for so many seconds."""
    with Client(address, control=False) as watch:
        place, last = watch.state.tool, since
        while time.monotonic() < since + seconds:
            watch.refresh()
            if dist(watch.state.tool, place) > STILL:
                place, last = watch.state.tool, time.monotonic()
            time.sleep(2e-3)
    return last - since


def is_tripped_and_rearmed(address: Address) -> bool:
    """Whether the robot refuses to move, stands still, and moves once a person has re-armed it."""
    with Client(address) as connection:
        before, refused = connection.state.tool, connection.start(_path(ENDS[0]))
        time.sleep(0.05)
        connection.refresh()
        if not isinstance(refused, Refusal) or dist(before, connection.state.tool) > STILL:
            return False
        connection.rearm()
        begun = connection.start(_path(ENDS[0]))
        connection.stop()
        return isinstance(begun, int)


@contextmanager
def moving(address: Address) -> Iterator[subprocess.Popen[str] | None]:
    """A client in a process of its own whose tool has set off; None where it has not come so far."""
    command = [sys.executable, __file__, "--client", str(address)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        try:
            yield process if process.stdout.readline() == "moving\n" else None
        finally:
            process.kill()


def kill(kind: str, driver: subprocess.Popen[str], address: Address, delay: float) -> tuple[float, bool]:
    """One kill of a kind, a while after the tool has set off: for how long it moved on, and whether all was
    told and survived."""
    relay = Relay(address) if kind == "silent" else None
    with moving(address if relay is None else relay.address) as process:
        if process is None:  # the machine was too busy for the lease before anything was killed
            with Client(address, control=False) as person:
                person.rearm()
            return kill(kind, driver, address, delay)
        time.sleep(delay)
        since = time.monotonic()
        whom = driver if kind.startswith("driver") else process
        match kind.split():
            case [_, "KILL"]:
                whom.kill()
            case [_, "STOP"]:
                whom.send_signal(signal.SIGSTOP)
            case _:
                assert relay is not None
                relay.is_silent = True
        if whom is driver:
            # A client is told at once, or when its patience is over.
            ended = process.wait(timeout=60) != 0
            driver.send_signal(signal.SIGCONT)
            if kind == "driver KILL":
                return 0.0, ended
            return moves_on(address, time.monotonic(), 0.3), ended and is_tripped_and_rearmed(address)
        moved = moves_on(address, since, LEASE + 4 * IN_TIME)
        process.kill()
    return moved, is_tripped_and_rearmed(address)


def kills(number: int, kinds: Sequence[str], rng: random.Random) -> bool:
    """Each kind so often; whether all were told and survived, in time."""
    good = True
    for kind in kinds:
        results = list[tuple[float, bool]]()
        for each in _by_driver(kind, number):
            with serving("two_groups", "--real-time", "--lease", str(LEASE)) as (driver, address):
                for _ in range(each):
                    results.append(kill(kind, driver, address, rng.uniform(0, 1)))
                    print(f"{kind}: {len(results)} of {number}", file=sys.stderr, flush=True)
        worst, told_well = max(moved for moved, _ in results), sum(fine for _, fine in results)
        most = LEASE + IN_TIME
        late = sum(moved > most for moved, _ in results)
        good &= (kind.startswith("driver") or not late) and told_well == number
        moved_on = f"the tool moved on {worst:.2f} s at most, {late} times for more than {most:g} s"
        print(f"{kind}: {number} times, told and survived {told_well}; {moved_on}", flush=True)
    return good


def _by_driver(kind: str, number: int) -> list[int]:
    """How many kills each driver is there for: one that is killed for one alone."""
    return [1] * number if kind == "driver KILL" else [number]


def _path(to: tuple[float, float, float]) -> ToolPath:
    return ToolPath((Waypoint(*to, 0.0, 0.25),), Interpolation.STRAIGHT)


def main() -> int:
    """Each kind in turn."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--kind", nargs="*", choices=KINDS, default=KINDS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--client", type=address_of, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.client is not None:
        with suppress(RobotError):
            client(given.client)
        return 1
    number, kinds = (1, KINDS[:3]) if given.quick else (given.kills, given.kind)
    return not kills(number, kinds, random.Random(given.seed))


if __name__ == "__main__":
    sys.exit(main())
