"""A robot at the end of a socket: python benchmarks/remote_robot.py [--part NAME...] [--seed N] [--quick]

`same`: an episode through `cleancli robot serve` in lockstep and one in process; all events but for real
time, and where the tool was after each poll. `real`: the same in real time; the seconds of the robot's clock,
and the longest gap between two polls of a motion. `frames`: pairs of 640 x 480 pictures at 30 Hz for
--seconds; those that came late, their latency, and what share of a CPU each side takes.

Exits with 1 if an episode differs. All of it takes about 4 minutes, half of which are CPU; `--quick` takes
about 10 seconds of CPU.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import threading
import time
from contextlib import closing
from dataclasses import fields, replace
from typing import Any

import numpy as np
from remote_kills import serving

from cleancli.execution.events import Decided, Looked, Moved
from cleancli.execution.loop import clean
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.session import Session, remote_session, robot_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.language.load import read_source
from cleancli.language.model import Domain
from cleancli.motion.path import ToolPath
from cleancli.remote.client import Client
from cleancli.remote.messages import Description, FramePair, Limits
from cleancli.remote.server import Server
from cleancli.resources import shipped
from cleancli.scene.address import Address, address_of
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.robot import Status
from cleancli.world.table import PybulletTable

SCENES = ("two_groups", "layout_c", "wam_groups", "reem_pick_up")
HERTZ = 30


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
    parts = ("same", "real", "frames")
    parser.add_argument("--part", nargs="*", choices=parts, default=parts)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--max-actions", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--film", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.film:
        film(given.seed)
        return 0
    scenes = SCENES[:1] if given.quick else SCENES
    if given.quick:
        given.seconds, given.max_actions = 1.0, 1
    options = EpisodeOptions(strategy="reactive", max_actions=given.max_actions, seed=given.seed)
    good = True
    if "same" in given.part:
        for name in scenes:
            good &= compared(_domain(), name, options)
    if "real" in given.part:
        good &= compared(_domain(), "wam_groups", options, "--real-time")
    if "frames" in given.part:
        frames(given.seconds, given.seed)
    return not good


if __name__ == "__main__":
    sys.exit(main())
