"""A robot at the end of a socket: python benchmarks/remote_robot.py [--part NAME...] [--seed N] [--quick]

`same`: an episode through `cleancli robot serve` in lockstep and one in process; all events but for real
time, and where the tool was after each poll. `real`: the same in real time; the seconds of the robot's clock,
and the longest gap between two polls of a motion. `kills`: --kills times each, a client is killed (KILL) or
frozen (STOP) in mid-motion, its connection goes silent, or the driver is killed or frozen; how long the tool
moves on, whether the robot has tripped and refuses to move, and whether it moves once it is re-armed.
`frames`: pairs of 640 x 480 pictures at 30 Hz for --seconds; those that came late, their latency, and what
share of a CPU each side takes.

Exits with 1 if an episode differs, or a kill is not told or not survived. All of it takes about 35 minutes,
of which 10 are CPU, and the fifty kills of each kind most of them; how many are done is told to standard
error. `--quick` takes about 20 seconds of CPU.
"""

from __future__ import annotations

import argparse
import random
import re
import resource
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import fields, replace
from math import dist
from typing import Any

import numpy as np

from cleancli.execution.events import Decided, Looked, Moved
from cleancli.execution.loop import clean
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.session import Session, remote_session, robot_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.language.load import read_source
from cleancli.language.model import Domain
from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.remote.client import Client, Refusal
from cleancli.remote.messages import Description, FramePair, Limits
from cleancli.remote.server import Server
from cleancli.resources import shipped
from cleancli.scene.address import Address, address_of
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.errors import RobotError
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable

SCENES = ("two_groups", "layout_c", "wam_groups", "reem_pick_up")
KINDS = ("client KILL", "client STOP", "silent", "driver KILL", "driver STOP")
LEASE, IN_TIME = 1.0, 0.1
"""Seconds: the lease of the drivers that are killed, and how much later than that a tool may still move."""
PATIENCE = 10.0
"""Seconds for which a client waits for a driver that is frozen, a third of what the program's own does."""
STILL = 1e-3
"""Metres by which a tool that stands still may be elsewhere."""
HERTZ = 30
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


# The same episode


def told(event: object) -> tuple[object, ...]:
    """An event without real time and without pictures; what is seen in them is told."""
    real = {"frame", "loading", "spent", "state"}
    real |= {"seconds"} if isinstance(event, Looked | Decided) else set()
    kept = (field.name for field in fields(event) if field.name not in real)  # type: ignore[arg-type]
    return (type(event).__name__, *(getattr(event, name) for name in kept))


def episode(session: Session) -> tuple[list[object], float]:
    """All that happens, with the tool after each poll, and the longest real gap between two polls of a
    motion."""
    found, gap, before = list[object](), 0.0, None
    robot: Any = session.cell._robot  # type: ignore[attr-defined]  # the loop itself needs no heights
    for event in clean(session.setup, session.cell):
        now = time.monotonic()
        if isinstance(event, Moved):
            gap = gap if before is None else max(gap, now - before)
            found.append(robot.tool)
        before = now if isinstance(event, Moved) else None
        found.append(told(event))
    return found, gap


def compared(domain: Domain, name: str, options: EpisodeOptions, *how: str) -> bool:
    """Whether an episode is the same through a socket; `how`: options of the driver."""
    scene = _scene(name)
    with closing(PybulletTable(scene, derived(options.seed, Stream.WORLD))) as table:
        alone, _ = episode(robot_session(domain, scene, table, options))
        clock = table.clock
    # Only the robot of the test lets its client wait.
    with serving(name, "--seed", str(options.seed), "--lease", "30", *how) as (_, address):
        elsewhere = replace(scene, robot="remote", address=address, remote_arms=scene.arms)
        with closing(remote_session(domain, elsewhere, options)) as session:
            far, gap = episode(session)
            far_clock = session.cell.clock
    if how:
        same = abs(far_clock - clock) < 1e-9
        clocks = f"{clock:.2f} s of the robot's clock in process, {far_clock:.2f} s through the socket"
        print(f"{name}, {' '.join(how)}: {clocks}; the longest gap between polls {1000 * gap:.0f} ms")
    else:
        same = far == alone
        print(f"{name}: {len(alone)} events and places of the tool, {'the same' if same else 'NOT the same'}")
    return same


# Kills


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


# Frames


class Film:
    """A driver that shows one of a few pairs of noise, and does nothing else."""

    failure = ""
    tool = (0.0, 0.0, 0.2)

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self._colours = [rng.integers(0, 256, (480, 640, 3), np.uint8) for _ in range(4)]
        self._depths = [rng.random((480, 640), np.float32) for _ in range(4)]
        self._shown = 0

    @property
    def clock(self) -> float:
        """Real seconds."""
        return time.monotonic()

    def observe(self) -> FramePair:
        """The next pair."""
        self._shown += 1
        number, now = self._shown % 4, self.clock
        shown = self._colours[number], self._depths[number], now, now
        return FramePair(*shown, (525.0, 525.0), (320.0, 240.0), np.eye(4))

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """None."""
        return False

    def start(self, path: ToolPath) -> None:
        """Nothing."""

    def withdraw(self) -> None:
        """Nothing."""

    def poll(self) -> Status:
        """Over."""
        return Status.DONE

    def stop(self) -> None:
        """Nothing."""


def film(seed: int) -> None:
    """Serves pictures until standard input ends; says where, and at the end what CPU that took."""
    limits = Limits((-1, -1, -1), (1, 1, 1), 1.0, 0.0)
    server = Server(Film(seed), Description("film", (), limits, 1.0, 0.02), Address("127.0.0.1", 0))
    threading.Thread(target=server.serve, daemon=True).start()
    print(server.address, flush=True)
    before = _cpu()
    sys.stdin.read()
    print(_cpu() - before)


def frames(seconds: float, seed: int) -> None:
    """Pairs at a fixed rate, and what became of them."""
    command = [sys.executable, __file__, "--film", "--seed", str(seed)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        latencies, late, before = list[float](), 0, _cpu()
        with Client(address_of(process.stdout.readline().strip())) as camera:
            begun = time.monotonic()
            for number in range(round(seconds * HERTZ)):
                due = begun + number / HERTZ
                time.sleep(max(0.0, due - time.monotonic()))
                asked = time.monotonic()
                camera.observe()
                latencies.append(time.monotonic() - asked)
                late += time.monotonic() > due + 1 / HERTZ
            lasted = time.monotonic() - begun
        own = (_cpu() - before) / lasted
        told, _ = process.communicate("")
    middle, most = (1000 * np.quantile(latencies, share) for share in (0.5, 0.99))
    came = f"{len(latencies)} pairs in {lasted:.1f} s, {late} late"
    print(f"{came}; {middle:.1f} ms each, 99 % within {most:.1f} ms")
    print(f"CPU: client {own:.1%}, driver {float(told) / lasted:.1%} of one")


def _cpu() -> float:
    return sum(resource.getrusage(resource.RUSAGE_SELF)[:2])


def _path(to: tuple[float, float, float]) -> ToolPath:
    return ToolPath((Waypoint(*to, 0.0, 0.25),), Interpolation.STRAIGHT)


def _scene(name: str) -> Scene:
    return load_scene(read_source(shipped("problems") / f"{name}.nid"))


def _domain() -> Domain:
    from cleancli.api.inputs import load_domain

    return load_domain("cleaning").model


def main() -> int:
    """Each part in turn."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parts = ("same", "real", "kills", "frames")
    parser.add_argument("--part", nargs="*", choices=parts, default=parts)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--kind", nargs="*", choices=KINDS, default=KINDS)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--max-actions", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--client", type=address_of, help=argparse.SUPPRESS)
    parser.add_argument("--film", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.client is not None:
        with suppress(RobotError):
            client(given.client)
        return 1
    if given.film:
        film(given.seed)
        return 0
    scenes, kinds = (SCENES[:1], KINDS[:3]) if given.quick else (SCENES, given.kind)
    if given.quick:
        given.kills, given.seconds, given.max_actions = 1, 1.0, 1
    options = EpisodeOptions(strategy="reactive", max_actions=given.max_actions, seed=given.seed)
    good = True
    if "same" in given.part:
        for name in scenes:
            good &= compared(_domain(), name, options)
    if "real" in given.part:
        good &= compared(_domain(), "wam_groups", options, "--real-time")
    if "kills" in given.part:
        good &= kills(given.kills, kinds, random.Random(given.seed))
    if "frames" in given.part:
        frames(given.seconds, given.seed)
    return not good


if __name__ == "__main__":
    sys.exit(main())
