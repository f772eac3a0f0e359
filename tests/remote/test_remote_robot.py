"""A robot at the end of a socket, as the executor knows it: what it believes of its driver, and what not."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from cleancli.motion.path import Dustpan, Interpolation, ToolPath, Waypoint
from cleancli.perception.lens import Lens, rectified
from cleancli.remote.client import Broken, Client, Tripped
from cleancli.remote.messages import FramePair
from cleancli.remote.robot import RemoteRobot
from cleancli.remote.server import Server
from cleancli.world.errors import RobotError
from cleancli.world.robot import Status, finish
from support.broken_drivers import broken
from support.toy_driver import REST, TOY, Toy, path, served

HOP = path((0.0, 0.3, 0.1), (0.05, 0.3, 0.1))


@pytest.fixture
def toy() -> Toy:
    return Toy()


@pytest.fixture
def server(toy: Toy) -> Iterator[Server]:
    with served(toy) as server:
        yield server


@pytest.fixture
def robot(server: Server) -> Iterator[RemoteRobot]:
    with RemoteRobot(server.address) as robot:
        yield robot


def test_a_motion_is_followed_to_its_end(robot: RemoteRobot) -> None:
    assert robot.can_follow(HOP)
    started = robot.clock
    robot.start(HOP)
    assert robot.poll() is Status.RUNNING
    assert finish(robot) is Status.DONE
    assert robot.tool == pytest.approx((0.05, 0.3, 0.1))
    assert robot.clock - started >= 0.18 / 0.25, "18 cm of way at 25 cm/s"
    assert robot.poll() is Status.DONE, "asked again"
    robot.withdraw()
    assert finish(robot) is Status.DONE


def test_between_motions_the_clock_is_that_of_now(robot: RemoteRobot) -> None:
    """Else what went by since the last reply would be counted as the way to the next stroke."""
    before = robot.clock
    time.sleep(0.05)
    assert robot.clock >= before + 0.05


def test_what_the_driver_refuses_has_failed_at_once(robot: RemoteRobot, toy: Toy) -> None:
    before = toy.tool
    robot.start(path((0.0, 0.0, 0.05), (0.6, 0.0, 0.05)))
    assert robot.poll() is Status.FAILED
    assert "outside of the workspace" in robot.failure
    assert toy.tool == before
    robot.start(HOP)
    assert robot.failure == ""


def test_a_robot_that_has_tripped_ends_the_run(robot: RemoteRobot, server: Server, toy: Toy) -> None:
    robot.start(HOP)
    time.sleep(TOY.lease + 0.1)
    with pytest.raises(Tripped, match=f"cleancli robot rearm {server.address}"):
        robot.poll()
    for begin in (robot.withdraw, lambda: robot.start(HOP)):
        with pytest.raises(Tripped, match="nobody has asked"):
            begin()
    robot.stop()
    with Client(server.address, control=False) as person:
        person.rearm()
    robot.start(HOP)
    assert finish(robot) is Status.DONE


def test_who_ends_in_good_order_trips_nothing(server: Server, toy: Toy) -> None:
    with RemoteRobot(server.address) as robot:
        robot.start(HOP)
        robot.poll()
    assert toy.stops == 1
    assert server.guard.state.trip == ""


def test_a_driver_that_has_gone_is_told_and_its_last_state_kept(server: Server) -> None:
    with RemoteRobot(server.address) as robot:
        before = robot.clock
        server.close()
        assert robot.clock >= before
        with pytest.raises(RobotError, match=r"has ended the connection|can no longer be reached"):
            robot.observe()


def test_how_a_driver_broke_the_protocol_is_told_to_all_that_ask_later(server: Server, toy: Toy) -> None:
    """The clock is asked for in many places, and tells nobody what it found."""
    with RemoteRobot(server.address) as robot:
        assert robot.clock >= 0
        toy._began += 100
        assert robot.clock >= 0, "as it was known last"
        for ask in (robot.observe, robot.withdraw, robot.stop):
            with pytest.raises(Broken, match="its clock runs back"):
                ask()


def test_pictures_are_rectified_by_the_drivers_lens(toy: Toy, monkeypatch: pytest.MonkeyPatch) -> None:
    through = Lens((500.0, 510.0), (40.0, 30.0), (0.1, -0.05, 0.001, 0.0, 0.0))
    big = Toy((60, 80))
    pair = replace(
        big.observe(),
        focal=through.focal,
        centre=through.centre,
        distortion="plumb_bob",
        coefficients=through.coefficients,
    )

    def seen() -> FramePair:
        return replace(pair, colour_stamp=toy.clock, depth_stamp=toy.clock)

    monkeypatch.setattr(toy, "observe", seen)
    with served(toy) as server, RemoteRobot(server.address) as robot:
        frame = robot.observe()
    colour, depth = rectified(pair.colour, pair.depth, through)
    np.testing.assert_array_equal(frame.colour, colour)
    np.testing.assert_array_equal(frame.depth, depth)
    assert (frame.camera.focal, frame.camera.centre) == (500.0, (40.0, 30.0))


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"distortion": "equidistant", "coefficients": (0.1, 0, 0, 0)}, "`equidistant` is not known"),
        ({"distortion": "plumb_bob", "coefficients": (0.1, 0, 0)}, "has 4 or 5 coefficients, not 3"),
        ({"focal": (525.0, 0.0)}, "focal lengths must be above 0"),
        ({"pose": np.zeros((4, 4))}, "no rotation and place"),
        ({"pose": np.diag((1.0, 1.0, -1.0, 1.0))}, "no rotation and place"),
    ],
)
def test_cameras_that_cannot_be_are_refused_by_name(
    changed: dict[str, object], reason: str, toy: Toy, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(toy, "observe", lambda: replace(Toy.observe(toy), **changed))  # type: ignore[arg-type]
    with served(toy) as server, RemoteRobot(server.address) as robot, pytest.raises(Broken, match=reason):
        robot.observe()


@pytest.mark.parametrize("fault", ["stamp-past", "stamp-future", "unpaired", "wrong-sizes"])
def test_pictures_that_were_not_taken_for_the_request_are_refused(fault: str) -> None:
    with broken(fault) as address, RemoteRobot(address) as robot:
        with pytest.raises(Broken) as refused:
            robot.observe()
        assert refused.value.fault == fault


def test_a_motion_that_ends_elsewhere_has_failed() -> None:
    with broken("ends-at-once") as address, RemoteRobot(address) as robot:
        robot.start(path((0.2, -0.3, 0.1)))
        assert robot.poll() is Status.FAILED
        assert "cm from its end" in robot.failure


def test_a_tool_may_wait_anywhere_while_a_dustpan_is_emptied() -> None:
    """docs/protocol.md: only of other paths is it known where they end."""
    pan = Waypoint(0.1, 0.1, 0.1, 0.3, 0.1)
    pushing = path((0.0, 0.3, 0.2))
    picking = replace(pushing, dustpan=Dustpan(pan, pan, -1.2))

    class Aside(Toy):
        def start(self, path: ToolPath) -> None:
            super().start(replace(path, waypoints=(*path.waypoints, REST)))

    with served(Aside(), skills=("straight", "dustpan")) as server, RemoteRobot(server.address) as robot:
        robot.start(picking)
        assert finish(robot) is Status.DONE
        robot.start(pushing)
        assert finish(robot) is Status.FAILED


def test_a_motion_that_never_ends_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cleancli.world.robot.LONGEST", 0.3)
    with broken("never-ends") as address, RemoteRobot(address) as robot:
        robot.start(HOP)
        assert finish(robot) is Status.FAILED
        assert robot.clock < 5


def test_a_driver_may_say_nothing_of_a_failure(robot: RemoteRobot, toy: Toy) -> None:
    def fails() -> Status:
        return Status.FAILED

    toy.poll = fails  # type: ignore[method-assign]
    robot.start(HOP)
    assert robot.poll() is Status.FAILED
    assert robot.failure == "the driver does not say why"


def test_a_path_with_a_dustpan_comes_as_it_was(monkeypatch: pytest.MonkeyPatch, toy: Toy) -> None:
    came: list[ToolPath] = []
    monkeypatch.setattr(toy, "start", came.append)
    pan = Waypoint(0.1, 0.1, 0.1, 0.3, 0.1)
    both = replace(HOP, dustpan=Dustpan(pan, replace(pan, x=-0.1), -1.2), interpolation=Interpolation.JOINT)
    with served(toy, skills=("joint", "dustpan")) as server, RemoteRobot(server.address) as robot:
        robot.start(both)
    assert came == [both]
