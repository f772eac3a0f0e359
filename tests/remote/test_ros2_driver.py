"""The driver for ROS 2: an arm and a camera behind the guard, with stand-ins where ROS is not installed."""

from __future__ import annotations

import argparse
import importlib
import json
import threading
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from ros2_timing import NoWay, in_base, in_scene, length_of, quaternion, timed

from cleancli.motion.path import Interpolation, ToolPath, Waypoint, pressed
from cleancli.remote.client import Client
from cleancli.remote.conformance import conformance
from cleancli.remote.guard import Guard
from cleancli.remote.server import Server
from cleancli.scene.address import Address
from cleancli.world.robot import Status
from support import ros_stand_ins
from support.ros_stand_ins import Cell, times_of

TABLE = np.array([[0.0, -1, 0, 0.6], [1, 0, 0, -0.1], [0, 0, 1, 0.02], [0, 0, 0, 1]])
"""The robot stands south of the table and looks north: the scene's x is its y."""
CAMERA = np.diag([1.0, -1.0, -1.0, 1.0])
STROKE = ToolPath(
    (
        Waypoint(0.0, 0.0, 0.05, 0.5, 0.5),
        Waypoint(0.0, 0.0, 0.0, 0.5, 0.3),
        Waypoint(0.06, 0.0, 0.0, 0.5, 0.3),
        Waypoint(0.06, 0.0, 0.05, 0.5, 0.3),
    ),
    Interpolation.STRAIGHT,
)


@pytest.fixture
def cell_file(tmp_path: Path) -> Path:
    path = tmp_path / "cell.json"
    camera, table = ({"pose": pose.tolist()} for pose in (CAMERA, TABLE))
    path.write_text(json.dumps({"format": "cleancli cell 1", "camera": camera, "table": table}))
    return path


@pytest.fixture
def modules(monkeypatch: pytest.MonkeyPatch) -> Iterator[SimpleNamespace]:
    ros_stand_ins.put_in_place(monkeypatch)
    yield SimpleNamespace(**{n: importlib.import_module(f"ros2_{n}") for n in ("camera", "arm", "driver")})
    ros_stand_ins.forget(monkeypatch)


@pytest.fixture
def cell() -> Cell:
    return Cell()


@pytest.fixture
def options(modules: SimpleNamespace, cell_file: Path) -> argparse.Namespace:
    words = ["--cell", str(cell_file), "--surface", "0.9", "0.7", "--rest", "-0.1", "0.05", "0.1", "0"]
    words += [
        "--press",
        "0",
        "--speed",
        "0.5",
        "--lease",
        "0.3",
        "--colour",
        "c",
        "--depth",
        "d",
        "--info",
        "i",
    ]
    found = modules.driver.parser().parse_args(words)
    assert isinstance(found, argparse.Namespace)
    return found


@pytest.fixture
def driver(modules: SimpleNamespace, options: argparse.Namespace, cell: Cell) -> Any:
    made = modules.driver.Ros2Driver(cell, options)
    made.arm.ready()
    return made


@pytest.fixture
def guard(driver: Any, modules: SimpleNamespace, options: argparse.Namespace) -> Iterator[Guard]:
    made = Guard(driver, modules.driver.description(options))
    yield made
    made.close()


def ended(guard: Guard, motion: int | str) -> tuple[Status, str]:
    """How a motion ends, if it is polled as it should be."""
    assert isinstance(motion, int), motion
    for _ in range(1000):
        now = guard.poll(motion)
        assert now is not None
        if now.status is not Status.RUNNING:
            return now.status, now.failure
    raise AssertionError("it does not end")


def in_the_scene(trajectory: Any) -> np.ndarray:
    """x, y and z of a trajectory's points (n, 3) in the scene."""
    return np.array([in_scene(TABLE, np.array(point.positions[:3])) for point in trajectory.points])


def test_a_stroke_goes_straight_through_its_waypoints_at_their_speed(guard: Guard, cell: Cell) -> None:
    assert ended(guard, guard.start(STROKE)) == (Status.DONE, "")
    assert guard.state.tool == pytest.approx((0.06, 0, 0.05), abs=1e-6)
    assert cell.joints[3] == pytest.approx(0.5 + np.pi / 2), "yaw is turned with the table"
    (trajectory,) = cell.trajectories
    places, times = in_the_scene(trajectory), times_of(trajectory)
    for waypoint in STROKE.waypoints:
        assert np.abs(places - (waypoint.x, waypoint.y, waypoint.z)).max(axis=1).min() < 1e-6
    on_surface = places[np.abs(places[:, 2]) < 1e-9]
    assert np.abs(on_surface[:, 1]).max() < 1e-9
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(times)
    down = int(np.flatnonzero(np.abs(places[:, 2]) < 1e-9)[0])
    assert speeds.max() <= 0.5 * 1.001
    assert speeds[down:].max() <= 0.3 * 1.001
    still = [point for point in trajectory.points if not any(point.velocities)]
    assert len(still) == 5, "it begins at rest, and stands still at each waypoint"


def test_strokes_are_pressed_and_no_deeper_than_is_allowed(
    modules: SimpleNamespace, options: argparse.Namespace, cell: Cell
) -> None:
    """A cloth gives way. What the guard lets through is less deep by what is pressed."""
    options.press, options.deepest = 0.002, 0.005
    limits = modules.driver.description(options).limits
    assert limits.depth == pytest.approx(0.003)
    modules.driver.Ros2Driver(cell, options).start(pressed(STROKE, limits.depth))
    heights = in_the_scene(cell.trajectories[0])[:, 2]
    assert heights.min() == pytest.approx(-0.005)
    assert heights[-1] == pytest.approx(0.05), "what is above the surface stays"


def test_a_driver_may_go_at_a_pace_of_its_own(
    modules: SimpleNamespace, options: argparse.Namespace, cell: Cell
) -> None:
    """The same way at a fifth of the speed, so that nothing is refused while a lab tries it."""
    options.pace = 0.2
    driver = modules.driver.Ros2Driver(cell, options)
    assert modules.driver.description(options).limits.speed == 0.5
    driver.start(STROKE)
    places, times = in_the_scene(cell.trajectories[0]), times_of(cell.trajectories[0])
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(times)
    assert 0.9 * 0.2 * 0.3 < speeds.max() <= 0.2 * 0.5 * 1.001
    driver.stop()
    for wrong in ("0", "1.5", "fast"):
        with pytest.raises(SystemExit):
            modules.driver.parser().parse_args(["--pace", wrong])


def test_withdrawing_goes_up_and_then_to_rest(guard: Guard, cell: Cell) -> None:
    ended(guard, guard.start(STROKE))
    assert ended(guard, guard.withdraw()) == (Status.DONE, "")
    assert guard.state.tool == pytest.approx((-0.1, 0.05, 0.1), abs=1e-6)
    places = in_the_scene(cell.trajectories[-1])
    low = places[:, 2] < 0.1 - 1e-6
    assert np.ptp(places[low][:, :2], axis=0).max() < 1e-6, "not sideways before it is up"


def test_an_arm_that_is_there_already_has_ended_at_once(guard: Guard, driver: Any, cell: Cell) -> None:
    """As docs/protocol.md says of withdrawing; a path that leads nowhere is no failure either."""
    ended(guard, guard.start(STROKE))
    assert ended(guard, guard.withdraw()) == (Status.DONE, "")
    sent = len(cell.trajectories)
    assert ended(guard, guard.withdraw()) == (Status.DONE, "")
    here = replace(STROKE, waypoints=(Waypoint(-0.1, 0.05, 0.1, 0.0, 0.3),))
    assert driver.can_follow(here)
    assert ended(guard, guard.start(here)) == (Status.DONE, "")
    assert len(cell.trajectories) == sent


def test_a_path_that_no_joints_follow_fails_and_nothing_moves(guard: Guard, driver: Any, cell: Cell) -> None:
    cell.reach = 0.55
    before = cell.joints
    assert not driver.can_follow(STROKE)
    status, failure = ended(guard, guard.start(STROKE))
    assert status is Status.FAILED
    assert "of the way to (0.0, 0.0, 5.0) cm" in failure
    cell.reach, cell.jumps = 2.0, True
    assert "turns over" in ended(guard, guard.start(STROKE))[1]
    assert cell.joints is before
    cell.jumps = False
    assert driver.can_follow(STROKE)
    assert ended(guard, guard.start(STROKE))[0] is Status.DONE, "a failure is no trip"


def test_what_the_controller_gives_up_has_failed_and_what_it_refuses_trips(guard: Guard, cell: Cell) -> None:
    cell.aborts = True
    assert ended(guard, guard.start(STROKE)) == (
        Status.FAILED,
        "the controller gave the motion up: a joint is too far behind",
    )
    cell.aborts, cell.accepted = False, False
    refused = guard.start(STROKE)
    assert isinstance(refused, str)
    assert "does not take the motion" in refused


def down_on_the_table(guard: Guard) -> None:
    """Begin a long stroke, and come back when the tool is down."""
    ahead = replace(STROKE.waypoints[1], x=0.4, speed=0.1)
    motion = guard.start(replace(STROKE, waypoints=(*STROKE.waypoints[:2], ahead)))
    assert isinstance(motion, int), motion
    while guard.state.tool[2] > 1e-6:
        now = guard.poll(motion)
        assert now is not None
        assert now.status is Status.RUNNING


def test_stopping_ends_a_stroke_with_the_tool_raised(guard: Guard, cell: Cell) -> None:
    down_on_the_table(guard)
    guard.stop()
    x, _, z = guard.state.tool
    assert z == pytest.approx(0.05, abs=1e-6)
    assert x < 0.4 - 1e-6, "before its end"
    cell.joints = np.array([*cell.joints[:2], 0.2, cell.joints[3]])
    guard.stop()
    assert len(cell.trajectories) == 2, "what is up is not raised"
    assert ended(guard, guard.start(STROKE))[0] is Status.DONE


def test_a_client_that_is_gone_trips_the_robot_with_the_tool_raised(guard: Guard) -> None:
    down_on_the_table(guard)
    due = time.monotonic() + 3
    while guard.state.tool[2] < 0.05 - 1e-6 and time.monotonic() < due:
        time.sleep(0.01)
    assert "0.3" in guard.state.trip
    refused = guard.start(STROKE)
    assert isinstance(refused, str)
    assert "tripped" in refused
    guard.rearm()
    assert ended(guard, guard.start(STROKE))[0] is Status.DONE


def test_beyond_the_limits_nothing_is_planned(guard: Guard, cell: Cell) -> None:
    for waypoint in (
        Waypoint(0, 0, -0.006, 0, 0.1),
        Waypoint(0.71, 0, 0.1, 0, 0.1),
        Waypoint(0, 0, 0.1, 0, 0.51),
    ):
        assert isinstance(guard.start(ToolPath((waypoint,), Interpolation.STRAIGHT)), str)
    assert cell.trajectories == []


# The camera


def stamped(seconds: float, began: int) -> Any:
    whole, part = divmod(began + round(1e9 * seconds), 10**9)
    return SimpleNamespace(stamp=SimpleNamespace(sec=whole, nanosec=part))


COLOUR = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
DEPTH = np.array([[900, 0, 901], [902, 903, 904]], np.uint16)


def image(pixels: np.ndarray, encoding: str, header: Any, padding: int = 0, big: bool = False) -> Any:
    """A message of a picture, whose rows end with some bytes that mean nothing."""
    stored = pixels.astype(pixels.dtype.newbyteorder(">" if big else "<"))
    rows = stored.reshape(len(pixels), -1).view(np.uint8)
    padded = np.pad(rows, ((0, 0), (0, padding)), constant_values=7)
    size = {"height": pixels.shape[0], "width": pixels.shape[1], "step": padded.shape[1]}
    return SimpleNamespace(**size, encoding=encoding, is_bigendian=big, data=padded.tobytes(), header=header)


INFO = SimpleNamespace(
    k=[525.0, 0, 320, 0, 526.0, 239, 0, 0, 1], d=[0.1, -0.2, 0, 0, 0], distortion_model="plumb_bob"
)


def test_a_pair_is_taken_after_it_was_asked_for(driver: Any, cell: Cell) -> None:
    began = driver._began
    cell.subscribed["i"](INFO)

    def publish(seconds: float) -> None:
        cell.subscribed["c"](image(COLOUR[:, :, ::-1], "bgr8", stamped(seconds, began), padding=2))
        cell.subscribed["d"](image(DEPTH, "16UC1", stamped(seconds + 0.01, began)))

    publish(driver.clock - 0.1)
    before = driver.clock
    later = threading.Timer(0.1, lambda: publish(driver.clock))
    later.start()
    found = driver.observe()
    later.join()
    assert before < found.colour_stamp <= found.depth_stamp - 0.009
    assert (found.colour == COLOUR).all()
    assert found.depth == pytest.approx(DEPTH / 1000)
    assert (found.focal, found.centre) == ((525, 526), (320, 239))
    assert (found.distortion, found.coefficients) == ("plumb_bob", (0.1, -0.2, 0, 0, 0))
    assert (found.pose == CAMERA).all()


def test_what_of_a_pair_does_not_come_is_told(
    driver: Any, cell: Cell, modules: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(modules.camera, "PATIENCE", 0.02)
    header = stamped(100.0, driver._began)
    with pytest.raises(TimeoutError, match="no camera_info"):
        driver.observe()
    cell.subscribed["i"](INFO)
    with pytest.raises(TimeoutError, match="no picture of colour"):
        driver.observe()
    cell.subscribed["c"](image(COLOUR, "rgb8", header))
    cell.subscribed["d"](image(DEPTH, "16UC1", stamped(-5.0, driver._began)))
    with pytest.raises(
        TimeoutError, match=r"no new picture of depth came; the last one's stamp is 5.\d\d s old"
    ):
        driver.observe()
    cell.subscribed["d"](image(DEPTH, "16UC1", stamped(101.0, driver._began)))
    with pytest.raises(TimeoutError, match=r"more than 0\.05 s apart"):
        driver.observe()
    cell.subscribed["d"](image(DEPTH[:, :2], "16UC1", header))
    with pytest.raises(ValueError, match="register depth to colour"):
        driver.observe()


METRES = np.array([[0.9, np.nan, 0.901], [0.902, 0.903, 0.904]], np.float32)


@pytest.mark.parametrize(("encoding", "stored", "big"), [("32FC1", METRES, False), ("mono16", DEPTH, True)])
def test_depth_is_in_metres_whatever_it_comes_in(
    encoding: str, stored: np.ndarray, big: bool, modules: SimpleNamespace
) -> None:
    metres = modules.camera.depth_of(image(stored, encoding, None, padding=4, big=big))
    assert metres == pytest.approx(DEPTH / 1000)
    with pytest.raises(ValueError, match="`yuv`"):
        modules.camera.depth_of(image(stored, "yuv", None))


def test_colour_has_red_first(modules: SimpleNamespace) -> None:
    with_alpha = np.dstack([COLOUR[:, :, ::-1], np.full((2, 3), 255, np.uint8)])
    assert (modules.camera.colour_of(image(with_alpha, "bgra8", None, padding=1)) == COLOUR).all()
    with pytest.raises(ValueError, match="`mono8`"):
        modules.camera.colour_of(image(COLOUR, "mono8", None))


def test_a_client_drives_it_through_the_protocol(
    driver: Any, modules: SimpleNamespace, options: argparse.Namespace, cell: Cell
) -> None:
    server = Server(driver, modules.driver.description(options), Address("127.0.0.1", 0))
    threading.Thread(target=server.serve, daemon=True).start()
    cell.subscribed["i"](INFO)
    header = stamped(60.0, driver._began)  # as a camera would whose clock runs ahead by a minute
    with closing(server), Client(server.address) as client:
        assert client.description.robot == "arm of ROS 2"
        motion = client.start(STROKE)
        assert isinstance(motion, int), motion
        while (now := client.poll(motion)).status is Status.RUNNING:
            pass
        assert now.status is Status.DONE
        assert client.state.tool == pytest.approx((0.06, 0, 0.05), abs=1e-6)
        cell.subscribed["c"](image(COLOUR, "rgb8", header))
        cell.subscribed["d"](image(DEPTH, "16UC1", header))
        assert (client.observe().colour == COLOUR).all()


# What it is told by files and rests on


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{}", "no file of `cleancli cell`"),
        ('{"format": "cleancli cell 1"}', "where the camera is"),
        (json.dumps({"format": "cleancli cell 1", "camera": {"pose": []}}), "where the table is"),
    ],
)
def test_a_cell_that_lacks_something_is_refused(
    text: str, told: str, modules: SimpleNamespace, tmp_path: Path
) -> None:
    (tmp_path / "cell.json").write_text(text)
    with pytest.raises(ValueError, match=told):
        modules.driver.poses(tmp_path / "cell.json")


def test_places_of_the_scene_and_of_the_base() -> None:
    place, turn = in_base(TABLE, Waypoint(0.1, 0.2, 0.05, 0.0, 0.1))
    assert place == pytest.approx((0.4, 0.0, 0.07))
    assert turn == pytest.approx((0, 0, np.sqrt(0.5), np.sqrt(0.5)))
    assert in_scene(TABLE, place) == pytest.approx((0.1, 0.2, 0.05))


def test_quaternions_turn_as_their_rotations_do() -> None:
    """By the formula of a quaternion's rotation, for drawn rotations and the half turns."""
    rng = np.random.default_rng(2)
    drawn = [np.linalg.qr(rng.normal(size=(3, 3)))[0] for _ in range(50)]
    half = [np.diag(signs) for signs in ((1.0, -1, -1), (-1.0, 1, -1), (-1.0, -1, 1))]
    for turn in [each * np.linalg.det(each) for each in drawn] + half:
        *v, w = quaternion(turn)
        assert w >= 0
        point = rng.normal(size=3)
        turned = point + 2 * np.cross(v, np.cross(v, point) + w * point)
        assert turned == pytest.approx(turn @ point)


@pytest.mark.parametrize(("length", "speed"), [(0.4, 0.25), (0.02, 0.25), (0.4, 0.02)])
def test_the_tool_keeps_its_speed_between_two_ramps(length: float, speed: float) -> None:
    """As far as it went is what its speeds add up to: half a metre a second squared up, and down again."""
    joints = np.linspace(0, length, 101)[:, None]
    times, moving = timed(joints, length, speed, 0.0)
    assert (np.diff(times) > 0).all()
    assert moving.max() <= speed * (1 + 1e-9)
    assert (moving[0], moving[-1]) == (0, 0)
    went, step = 0.0, 1e-4
    for when in np.arange(0, times[-1], step):
        went += step * min(0.5 * when, speed, 0.5 * max(times[-1] - when, 0))
    assert went == pytest.approx(length, rel=1e-3)


def test_joints_that_need_longer_get_it_and_jumps_are_no_way() -> None:
    joints = np.linspace(0, 0.1, 21)[:, None]
    assert timed(joints, 0.1, 0.25, 7.0)[0][-1] == pytest.approx(7.0)
    joints[10:] += 0.25
    with pytest.raises(NoWay, match="turns over"):
        timed(joints, 0.1, 0.25, 0.0)
    assert length_of(Waypoint(0, 0, 0, 3.0, 1), Waypoint(0, 0, 0, -3.0, 1)) == pytest.approx(
        0.1 * (2 * np.pi - 6)
    )


def test_the_camera_listens_to_ros_where_it_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    """With rclpy itself: topics, messages and quality of service are what a camera's driver uses."""
    rclpy = pytest.importorskip("rclpy", reason="ROS 2 is not installed")
    messages = pytest.importorskip("sensor_msgs.msg")
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.qos import qos_profile_sensor_data

    ros_stand_ins.forget(monkeypatch)
    camera = importlib.import_module("ros2_camera")
    rclpy.init()
    node = rclpy.create_node("test_of_cleancli")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    kinds = {"c": messages.Image, "d": messages.Image, "i": messages.CameraInfo}
    topics = {t: node.create_publisher(kind, t, qos_profile_sensor_data) for t, kind in kinds.items()}
    began = node.get_clock().now().nanoseconds
    seconds = lambda stamp: 1e-9 * (stamp.sec * 10**9 + stamp.nanosec - began)  # noqa: E731
    listening = camera.Camera(node, "c", "d", "i", CAMERA, seconds)
    over = threading.Event()

    def publish() -> None:
        while not over.wait(0.05):
            now = node.get_clock().now().to_msg()
            for topic, pixels, encoding in (("c", COLOUR, "rgb8"), ("d", DEPTH, "16UC1")):
                made = image(pixels, encoding, None)
                sent = messages.Image(height=2, width=3, step=made.step, encoding=encoding, data=made.data)
                sent.header.stamp = now
                topics[topic].publish(sent)
            topics["i"].publish(messages.CameraInfo(k=INFO.k))

    publisher = threading.Thread(target=publish)
    publisher.start()
    try:
        asked = 1e-9 * (node.get_clock().now().nanoseconds - began)
        pair = listening.pair(asked)
    finally:
        over.set()
        publisher.join()
        executor.shutdown()
        rclpy.try_shutdown()
    assert (pair.colour == COLOUR).all()
    assert pair.depth == pytest.approx(DEPTH / 1000)
    assert min(pair.colour_stamp, pair.depth_stamp) > asked


def test_it_keeps_to_the_protocol(
    driver: Any, modules: SimpleNamespace, options: argparse.Namespace, cell: Cell
) -> None:
    """What `cleancli robot check` asks of any driver, with a camera that takes twenty pairs a second."""
    server = Server(driver, modules.driver.description(options), Address("127.0.0.1", 0))
    threading.Thread(target=server.serve, daemon=True).start()
    cell.subscribed["i"](INFO)
    over = threading.Event()

    def publish() -> None:
        shown = 0
        while not over.wait(0.05):
            shown += 1
            header = stamped(driver.clock, driver._began)
            cell.subscribed["c"](image(COLOUR + np.uint8(shown), "rgb8", header))
            cell.subscribed["d"](image(DEPTH, "16UC1", header))

    camera = threading.Thread(target=publish)
    camera.start()
    try:
        with closing(server):
            found = list(conformance(server.address))
    finally:
        over.set()
        camera.join()
    assert len(found) > 5
    assert [finding for finding in found if finding.fault] == []
