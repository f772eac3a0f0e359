"""Remote robots that lose their clients: python benchmarks/remote_kills.py [--kind NAME...] [--keep FILE]

--kills times each, a client is killed (KILL) or frozen (STOP) in mid-motion, its connection goes silent, or
the driver is killed or frozen; how long the tool moves on, whether the robot has tripped and refuses to move,
and whether it moves once it is re-armed. `run KILL`: the client is `cleancli execute`, and the run is resumed
and killed time after time, until the table is clean.

Each kill is a line of FILE as soon as it is over; those that FILE holds are not done again. How many are done
is told to standard error. Exits with 1 if the tool moves on for too long, or a kill is not told or not
survived.

Fifty kills of each kind take about 17 minutes, most of it waiting; `--quick` (one each of the first three
kinds) takes about 5 seconds of CPU.
"""

from __future__ import annotations

import argparse
import random
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from math import dist
from pathlib import Path
from statistics import median

from kept import Kept, Row

from cleancli.motion.path import Interpolation, ToolPath, Waypoint
from cleancli.remote.client import Client, Refusal
from cleancli.resources import shipped
from cleancli.scene.address import Address, address_of
from cleancli.world.errors import RobotError
from cleancli.world.robot import Status

KINDS = ("client KILL", "client STOP", "silent", "driver KILL", "driver STOP", "run KILL")
SCENE = "two_groups"
LEASE, IN_TIME = 1.0, 0.1
"""Seconds: the lease of the drivers, and how much later than that a tool may still move."""
WATCHED, WATCHED_AGAIN = LEASE + 4 * IN_TIME, 0.3
"""Seconds for which a tool is looked at after a kill, and after a driver that was frozen goes on."""
TRIES = 10
"""Clients that are started until one sets off."""
PATIENCE = 3.0
"""Seconds for which a client waits for a driver that is frozen, a tenth of what the program's own does."""
STILL = 1e-3
"""Metres by which a tool that stands still may be elsewhere."""
LATEST, LATEST_OF_RUN = 1.0, 8.0
"""Seconds after the tool has set off in which something is killed; a stroke of a run takes as long."""
MOST_ACTIONS = 1000
"""Of a run that is killed in most of its strokes."""
SET_OFF = 1e-2
"""Metres by which a tool must be elsewhere to have set off."""
ENDS = ((-0.3, 0.0, 0.1), (0.3, 0.0, 0.1))

Outcome = tuple[float, bool]
"""For how long a tool moved on, and whether all was told and survived."""


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
    """Moves the tool to and fro until it is killed; says when it has set off."""
    with Client(address, answering=PATIENCE) as connection:
        at = connection.state.tool
        near, far = sorted(ENDS, key=lambda end: dist(end, at))
        has_set_off = False
        while True:
            for end in (far, near):
                motion = connection.start(_path(end))
                assert isinstance(motion, int), motion
                while connection.poll(motion).status is Status.RUNNING:
                    if not has_set_off and dist(connection.state.tool, at) > SET_OFF:
                        has_set_off = True
                        print("moving", flush=True)


class Relay:
    """A connection between a client and a driver that can go silent: neither side is told of it, until
    `close`."""

    def __init__(self, to: Address) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = Address("127.0.0.1", self._listener.getsockname()[1])
        self.is_silent = False
        self._ends: tuple[socket.socket, ...] = ()
        threading.Thread(target=self._carry, args=(to,), daemon=True).start()

    def close(self) -> None:
        """End what is left of it."""
        for end in (self._listener, *self._ends):
            with suppress(OSError):  # ended already
                end.shutdown(socket.SHUT_RDWR)
            end.close()

    def _carry(self, to: Address) -> None:
        near, _ = self._listener.accept()
        far = socket.create_connection((to.host, to.port))
        self._ends = near, far
        for one, other in ((near, far), (far, near)):
            threading.Thread(target=self._pass_on, args=(one, other), daemon=True).start()

    def _pass_on(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while (data := one.recv(1 << 16)) and not self.is_silent:
                other.sendall(data)
            if not self.is_silent:
                other.shutdown(socket.SHUT_RDWR)


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


def kill(kind: str, driver: subprocess.Popen[str], address: Address, delay: float) -> Outcome | None:
    """One kill of a kind, a while after the tool has set off; None where it has not done so: the machine was
    too busy for the lease before anything was killed."""
    if kind == "silent":
        with closing(Relay(address)) as relay, moving(relay.address) as process:
            if process is None:
                return None
            time.sleep(delay)
            relay.is_silent = True
            moved = moves_on(address, time.monotonic(), WATCHED)
        return moved, is_tripped_and_rearmed(address)
    with moving(address) as process:
        if process is None:
            return None
        time.sleep(delay)
        whom, since = (driver if kind.startswith("driver") else process), time.monotonic()
        whom.send_signal(signal.SIGKILL if kind.endswith("KILL") else signal.SIGSTOP)
        if whom is process:
            moved, is_told = moves_on(address, since, WATCHED), True
        else:  # its client is told at once, or when its patience is over
            moved, is_told = 0.0, process.wait(timeout=60) != 0
    if kind == "driver KILL":
        return moved, is_told
    if kind == "driver STOP":
        driver.send_signal(signal.SIGCONT)
        moved = moves_on(address, time.monotonic(), WATCHED_AGAIN)
    return moved, is_told and is_tripped_and_rearmed(address)


def killed(kind: str, driver: subprocess.Popen[str], address: Address, delay: float) -> Outcome:
    """One kill of a kind, tried again where the machine was too busy."""
    for _ in range(TRIES):
        if (outcome := kill(kind, driver, address, delay)) is not None:
            return outcome
        with Client(address, control=False) as person:
            person.rearm()
    raise SystemExit(f"{kind}: of {TRIES} clients none has set off")


def kills(kind: str, numbers: Sequence[int], seed: int) -> Iterator[Row]:
    """A kill for each number. A driver is there for all of them, but for one that is killed."""
    served = [[number] for number in numbers] if kind == "driver KILL" else [numbers]
    for some in served:
        with serving(SCENE, "--real-time", "--lease", str(LEASE)) as (driver, address):
            for number in some:
                delay = _rng(kind, seed, number).uniform(0, LATEST)
                yield _row(kind, seed, number, killed(kind, driver, address, delay))


# Runs


def killed_runs(kind: str, numbers: Sequence[int], seed: int) -> Iterator[Row]:
    """A kill of a run for each number; a run that has come clean is followed by one on another table."""
    left = list(numbers)
    while left:
        with tempfile.TemporaryDirectory() as folder:
            yield from _killed_until_clean(kind, left, seed, Path(folder))


def _killed_until_clean(kind: str, left: list[int], seed: int, folder: Path) -> Iterator[Row]:
    """Kills of the run on one table, whose numbers leave `left`."""
    words = [SCENE, "--real-time", "--lease", str(LEASE), "--seed", str(seed + left[0])]
    with serving(*words) as (_, address):
        scene = folder / "remote.nid"
        drive = f'drive = remote  address = "{address}"'
        text = (shipped("problems") / f"{SCENE}.nid").read_text(encoding="utf-8")
        scene.write_text(text.replace("drive = gantry", drive), encoding="utf-8")
        runs = folder / "runs"
        run = _execute("cleaning", str(scene), "--runs", str(runs), "--max-actions", str(MOST_ACTIONS))
        while left and sets_off(run, address):
            number = left.pop(0)
            time.sleep(_rng(kind, seed, number).uniform(0, LATEST_OF_RUN))
            if not sets_off(run, address):  # it came clean first
                left.insert(0, number)
                break
            since = time.monotonic()
            run.kill()
            moved = moves_on(address, since, WATCHED)
            is_well = is_tripped_and_rearmed(address)
            run = _execute("--resume", str(next(runs.iterdir())))
            is_well &= sets_off(run, address) if left else run.wait() == 0
            yield _row(kind, seed, number, (moved, is_well or run.poll() == 0))
        assert run.wait() == 0, f"a run that was killed time after time ended with {run.returncode}"


def sets_off(run: subprocess.Popen[bytes], address: Address) -> bool:
    """Whether the tool moves from now on, before the run is over."""
    with Client(address, control=False) as watch:
        at = watch.state.tool
        while run.poll() is None:
            watch.refresh()
            if dist(watch.state.tool, at) > SET_OFF:
                return True
            time.sleep(1e-2)
    return False


def _execute(*words: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-m", "cleancli", "execute", "--quiet", *words])


# All


def told(kind: str, rows: Sequence[Row]) -> tuple[str, bool]:
    """What the kills of a kind come to, and whether that is as it must be."""
    moved, well = [row["moved"] for row in rows], sum(row["well"] for row in rows)
    most = LEASE + IN_TIME
    late = sum(each > most for each in moved)
    text = (
        f"{kind}: {len(rows)} times, told and survived {well}; the tool moved on {median(moved):.2f} s "
        f"(median) and {max(moved):.2f} s at most, {late} times for more than {most:g} s"
    )
    return text, not late and well == len(rows)


def _rng(kind: str, seed: int, number: int) -> random.Random:
    return random.Random(f"{kind} {seed} {number}")


def _row(kind: str, seed: int, number: int, outcome: Outcome) -> Row:
    moved, is_well = outcome
    return {"job": [kind, seed, number], "moved": round(moved, 3), "well": is_well}


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
    parser.add_argument("--keep", type=Path, metavar="FILE", help="kills done before are in it")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--client", type=address_of, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.client is not None:
        with suppress(RobotError):
            client(given.client)
        return 1
    number, kinds = (1, KINDS[:3]) if given.quick else (given.kills, given.kind)
    kept, is_good = Kept(given.keep), True
    known = {tuple(row["job"]): row for row in kept.rows()}
    for kind in kinds:
        jobs = [(kind, given.seed, each) for each in range(number)]
        missing = [each for *_, each in jobs if (kind, given.seed, each) not in known]
        for row in (killed_runs if kind == "run KILL" else kills)(kind, missing, given.seed):
            kept.add(known.setdefault(tuple(row["job"]), row))
            done = sum(job in known for job in jobs)
            print(f"{kind}: {done} of {number}", file=sys.stderr, flush=True)
        text, is_as_it_must = told(kind, [known[job] for job in jobs])
        print(text, flush=True)
        is_good &= is_as_it_must
    return not is_good


if __name__ == "__main__":
    sys.exit(main())
