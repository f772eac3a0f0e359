"""What the guard of docs/protocol.md refuses and stops, on a driver without physics."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from itertools import pairwise
from math import dist
from threading import Event, Thread

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.motion.path import Dustpan, Interpolation, ToolPath, Waypoint
from cleancli.remote.guard import Guard, beyond
from cleancli.remote.messages import Poll
from cleancli.world.robot import Status
from support.toy_driver import TOY, Toy, path

LOW, HIGH = TOY.limits.low, TOY.limits.high
ACROSS = path((-0.4, 0.0, 0.05), (-0.4, 0.0, 0.0), (0.4, 0.0, 0.0), (0.4, 0.0, 0.05))


@pytest.fixture
def toy() -> Toy:
    return Toy()


@pytest.fixture
def guard(toy: Toy) -> Iterator[Guard]:
    guard = Guard(toy, TOY)
    yield guard
    guard.close()


def begun(guard: Guard) -> int:
    motion = guard.start(ACROSS)
    assert isinstance(motion, int), motion
    return motion


def status(guard: Guard, motion: int) -> Status:
    now = guard.poll(motion)
    assert now is not None
    return now.status


# What is beyond the limits


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_millimetre_outside_is_refused(guard: Guard, toy: Toy, axis: int, side: int) -> None:
    corner = [0.0, 0.0, 0.1]
    corner[axis] = (HIGH if side > 0 else LOW)[axis]
    deep = replace(TOY, limits=replace(TOY.limits, depth=0.1))
    assert not beyond(path((0, 0, 0.05), tuple(corner)), deep)  # type: ignore[arg-type]
    corner[axis] += side * 1e-3
    assert "1.00 mm outside" in beyond(path((0, 0, 0.05), tuple(corner)), deep)  # type: ignore[arg-type]
    before = toy.tool
    assert isinstance(guard.start(path((0, 0, 0.05), tuple(corner))), str)  # type: ignore[arg-type]
    time.sleep(0.02)
    assert toy.tool == before, "nothing has moved"


def test_a_percent_too_fast_is_refused(guard: Guard) -> None:
    assert isinstance(guard.start(path((0, 0, 0.05), (0.1, 0, 0.05), speed=0.2525)), str)
    assert not beyond(path((0, 0, 0.05), speed=0.25), TOY)
    assert "0.2525 m/s" in beyond(path((0, 0, 0.05), speed=0.2525), TOY)


def test_a_millimetre_too_deep_is_refused(guard: Guard) -> None:
    assert not beyond(path((0, 0, 0.05), (0, 0, -0.005)), TOY)
    assert "6.00 mm below the surface" in beyond(path((0, 0, 0.05), (0, 0, -0.006)), TOY)
    assert isinstance(guard.start(path((0, 0, 0.05), (0, 0, -0.006))), str)


def test_what_takes_another_skill_is_refused() -> None:
    joint = replace(ACROSS, interpolation=Interpolation.JOINT)
    assert "joint" in beyond(joint, replace(TOY, skills=("straight",)))
    pan = Waypoint(0, 0, 0.1, 0, 0.1)
    with_pan = replace(ACROSS, dustpan=Dustpan(pan, replace(pan, x=0.6), 1.0))
    assert "dustpan" in beyond(with_pan, TOY)
    able = replace(TOY, skills=("straight", "dustpan"))
    assert "100.00 mm outside" in beyond(with_pan, able)


POINT = st.tuples(st.floats(-0.6, 0.6), st.floats(-0.5, 0.5), st.floats(-0.03, 0.4))


@settings(deadline=None)
@given(st.lists(POINT, min_size=1, max_size=4), st.floats(0.2, 0.3))
def test_all_that_it_lets_pass_stays_within(points: list[tuple[float, float, float]], speed: float) -> None:
    """Point by point along the whole path, which is the slow and obvious way to ask."""
    passes = not beyond(path(*points, speed=speed), TOY)
    on_the_way = [points[0]] + [
        tuple(np.array(a) + share * (np.array(b) - np.array(a)))
        for a, b in pairwise(points)
        for share in np.linspace(0, 1, 11)
    ]
    within = all(
        low - 1e-8 <= value <= high + 1e-8
        for point in on_the_way
        for low, value, high in zip(LOW, point, HIGH, strict=True)
    )
    shallow = all(point[2] >= -0.005 - 1e-8 for point in on_the_way)
    assert passes == (within and shallow and speed <= 0.25 + 1e-8)


# Leases, trips and re-arming


def test_a_motion_that_is_polled_ends(guard: Guard, toy: Toy) -> None:
    motion = guard.start(path((0.0, 0.2, 0.05)))
    assert isinstance(motion, int)
    while status(guard, motion) is Status.RUNNING:
        pass
    assert dist(toy.tool, (0.0, 0.2, 0.05)) < 1e-9
    assert guard.poll(motion) == Poll(Status.DONE, ""), "asked again"
    time.sleep(1.2 * TOY.lease)
    assert guard.state.trip == "", "between motions there is no lease"


def test_a_motion_that_nobody_asks_about_is_stopped(toy: Toy) -> None:
    """By a lease that a busy machine does not outsleep."""
    lease = 1.0
    with closing(Guard(toy, replace(TOY, lease=lease))) as guard:
        motion = begun(guard)
        began = time.monotonic()
        time.sleep(0.5 * lease)
        assert status(guard, motion) is Status.RUNNING
        renewed = time.monotonic()
        time.sleep(0.8 * lease)
        assert not guard.state.trip, (
            f"{time.monotonic() - began:.2f} s after the start, the poll has renewed the lease"
        )
        while not toy.stops:
            assert time.monotonic() - renewed < lease + 0.1
            time.sleep(1e-3)
        stood = toy.tool
        assert stood[2] >= 0.05
        time.sleep(0.05)
        assert toy.tool == stood
        assert "nobody has asked" in guard.state.trip
        assert guard.poll(motion) == Poll(Status.FAILED, guard.state.trip)


def test_a_robot_that_has_tripped_moves_only_once_re_armed(guard: Guard, toy: Toy) -> None:
    motion = begun(guard)
    guard.lost("the client has gone")
    for answer in (guard.start(ACROSS), guard.withdraw()):
        assert answer == "it has tripped: the client has gone"
    guard.stop()
    assert guard.state.trip, "stopping is no re-arming"
    assert status(guard, motion) is Status.FAILED
    guard.rearm()
    assert guard.state.trip == ""
    assert begun(guard) == motion + 1
    assert guard.poll(motion) is None


def test_who_re_arms_waits_until_the_robot_stands_still(
    guard: Guard, toy: Toy, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else the next motion would be planned from where the tool is while it is raised."""
    stops, is_up = Event(), Event()

    def stop() -> None:
        stops.set()
        is_up.wait()
        Toy.stop(toy)

    begun(guard)
    monkeypatch.setattr(toy, "stop", stop)
    tripping, rearming = Thread(target=guard.trip, args=("a door was opened",)), Thread(target=guard.rearm)
    tripping.start()
    stops.wait()
    rearming.start()
    rearming.join(0.05)
    assert guard.start(ACROSS) == "it has tripped: a door was opened"
    is_up.set()
    for thread in (tripping, rearming):
        thread.join()
    assert toy.stops == 1
    begun(guard)


def test_nothing_is_lost_where_nothing_moves(guard: Guard) -> None:
    guard.lost("the client has gone")
    assert guard.state.trip == ""


def test_planning_takes_none_of_the_lease(guard: Guard, toy: Toy, monkeypatch: pytest.MonkeyPatch) -> None:
    def planned(path: ToolPath) -> None:
        time.sleep(1.5 * TOY.lease)
        Toy.start(toy, path)

    monkeypatch.setattr(toy, "start", planned)
    assert status(guard, begun(guard)) is Status.RUNNING


def test_one_motion_at_a_time(guard: Guard) -> None:
    begun(guard)
    assert guard.withdraw() == "a motion is under way"


def test_what_is_asked_to_stop_has_not_tripped(guard: Guard) -> None:
    motion = begun(guard)
    guard.stop()
    assert status(guard, motion) is Status.DONE
    assert guard.state.trip == ""


@pytest.mark.parametrize("method", ["start", "poll", "stop"])
def test_a_driver_that_raises_trips(
    guard: Guard, toy: Toy, monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    def broken(*_: object) -> None:
        raise RuntimeError("no current")

    monkeypatch.setattr(toy, method, broken)
    motion = guard.start(ACROSS)
    if isinstance(motion, int):
        guard.poll(motion)
        guard.stop()
    assert "no current" in guard.state.trip
    assert isinstance(guard.start(ACROSS), str)


def test_a_poll_that_hangs_does_not_keep_the_robot_going(
    guard: Guard, toy: Toy, monkeypatch: pytest.MonkeyPatch
) -> None:
    hangs = Event()

    def hanging() -> Status:
        hangs.wait()
        return Status.RUNNING

    motion = begun(guard)
    monkeypatch.setattr(toy, "poll", hanging)
    answers: list[Poll | None] = []
    waiting = Thread(target=lambda: answers.append(guard.poll(motion)))
    waiting.start()
    time.sleep(TOY.lease + 0.1)
    assert toy.stops == 1
    hangs.set()
    waiting.join()
    assert answers == [Poll(Status.FAILED, guard.state.trip)]


def test_a_motion_under_way_is_stopped_when_the_driver_ends(toy: Toy) -> None:
    guard = Guard(toy, TOY)
    begun(guard)
    guard.close()
    assert toy.stops == 1


def test_ctrl_c_twice_while_the_tool_is_raised_hangs_nothing(
    toy: Toy, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The handler of a signal closes in the thread that closes already."""
    guard = Guard(toy, TOY)

    def stop() -> None:
        Toy.stop(toy)
        guard.close()

    monkeypatch.setattr(toy, "stop", stop)
    begun(guard)
    closing = Thread(target=guard.close, daemon=True)
    closing.start()
    closing.join(10)
    assert not closing.is_alive()
    assert toy.stops == 1


def test_a_motion_that_is_being_planned_is_stopped_when_the_driver_ends(
    toy: Toy, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else the arm would set off when nobody watches it any more."""
    plans, may_go = Event(), Event()

    def planned(path: ToolPath) -> None:
        plans.set()
        may_go.wait()
        Toy.start(toy, path)

    monkeypatch.setattr(toy, "start", planned)
    guard = Guard(toy, TOY)
    asking, ending = Thread(target=guard.start, args=(ACROSS,)), Thread(target=guard.close)
    asking.start()
    plans.wait()
    ending.start()
    may_go.set()
    for thread in (asking, ending):
        thread.join()
    assert toy.stops == 1
    assert guard.start(ACROSS) == f"it has tripped: {guard.state.trip}"


def test_who_cannot_be_told_keeps_nobody_from_watching(toy: Toy) -> None:
    """As where the terminal of the driver has been closed."""

    def told(reason: str) -> None:
        raise BrokenPipeError

    guard = Guard(toy, TOY, told)
    for stops in (1, 2):
        begun(guard)
        time.sleep(TOY.lease + 0.1)
        assert toy.stops == stops
        guard.rearm()
    guard.close()


def test_a_terminal_that_is_paused_keeps_nobody_from_watching(toy: Toy) -> None:
    """Ctrl-S, or a pipe that is full: the text waits, and the watch does not."""
    goes_on, said = Event(), list[str]()

    def told(reason: str) -> None:
        goes_on.wait()
        said.append(reason)

    guard = Guard(toy, TOY, told)
    for stops in (1, 2):
        begun(guard)
        time.sleep(TOY.lease + 0.1)
        assert toy.stops == stops
        guard.rearm()
    goes_on.set()
    guard.close()
    guard.tell.close()
    assert said == ["tripped: nobody has asked for 0.3 s how a motion goes on"] * 2


def test_drivers_need_nothing_but_numpy() -> None:
    script = (
        "import sys\n"
        "class Finder:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        known = sys.stdlib_module_names | {'numpy', 'cleancli'}\n"
        "        if name.partition('.')[0] not in known: raise ImportError(name)\n"
        "sys.meta_path.insert(0, Finder())\n"
        "import cleancli.remote.server\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
