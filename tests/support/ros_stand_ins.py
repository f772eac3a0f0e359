"""Stand-ins for the parts of ROS 2 that no wheel brings: an arm whose joints are x, y, z and yaw of its tool
in the coordinates of its base, MoveIt and a controller for it, and a node whose topics tests publish on."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Mapping
from math import atan2, ceil, dist
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

CANCELLED, ABORTED, SUCCEEDED = 5, 6, 4
HASTE = 3.0


class Blank:
    """A message or a part of one: what is not set yet is another part."""

    def __init__(self, **parts: Any) -> None:
        self.__dict__.update(parts)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        made = Blank()
        self.__dict__[name] = made
        return made


def only(*names: str) -> type[Blank]:
    """A message with these fields alone, as its definition has them: a driver that sets another one would
    fail at a real arm."""

    class Message(Blank):
        def __init__(self, **parts: Any) -> None:
            for name, part in parts.items():
                setattr(self, name, part)

        def __setattr__(self, name: str, part: Any) -> None:
            assert name in names, f"the message has no field `{name}`"
            self.__dict__[name] = part

        def __getattr__(self, name: str) -> Any:
            assert name in names or name.startswith("__"), f"the message has no field `{name}`"
            return super().__getattr__(name)

    return Message


# The fields by moveit_msgs/srv/GetCartesianPath, control_msgs/action/FollowJointTrajectory and their parts.
CartesianRequest = only(
    *("header", "start_state", "group_name", "link_name", "waypoints", "max_step", "jump_threshold"),
    *("avoid_collisions", "path_constraints"),
)
TrajectoryGoal = only("trajectory", "path_tolerance", "goal_tolerance", "goal_time_tolerance")
TrajectoryPoint = only("positions", "velocities", "accelerations", "effort", "time_from_start")
Pose = only("position", "orientation")
Duration = only("sec", "nanosec")


class Trajectory:
    """trajectory_msgs/JointTrajectory."""

    __slots__ = ("header", "joint_names", "points")

    def __init__(self) -> None:
        self.joint_names: list[str] = []
        self.points: list[Any] = []


class Future:
    """What rclpy hands out for an answer."""

    def __init__(self) -> None:
        self._done: list[Callable[[Future], object]] = []
        self._answer: tuple[Any, ...] = ()

    def set(self, answer: Any) -> Future:
        self._answer = (answer,)
        for each in self._done:
            each(self)
        return self

    def add_done_callback(self, told: Callable[[Future], object]) -> None:
        if self._answer:
            told(self)
        else:
            self._done.append(told)

    def result(self) -> Any:
        return self._answer[0]


class Cell:
    """The arm, and what is wrong with it: `reach` of MoveIt (metres from the base), a jump of a joint in
    what it plans, a goal that is not `accepted`, or is aborted as soon as it moves."""

    def __init__(self) -> None:
        self.joints = np.array([0.6, -0.1, 0.12, 2.0])
        self.reach, self.jumps, self.accepted, self.aborts = 2.0, False, True, False
        self.trajectories: list[Trajectory] = []
        self.subscribed: dict[str, Callable[[Any], None]] = {}

    def create_subscription(self, kind: object, topic: str, told: Callable[[Any], None], qos: object) -> None:
        self.subscribed[topic] = told

    def create_client(self, kind: object, name: str) -> Cell:
        return self

    def wait_for_service(self, seconds: float) -> bool:
        return True

    wait_for_server = wait_for_service

    def get_clock(self) -> Any:
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=time.monotonic_ns()))

    def call_async(self, request: Any) -> Future:
        """MoveIt's service: points each `max_step`, as far as the arm reaches."""
        known = request.start_state.joint_state
        start = np.array(known.position) if isinstance(known.position, list) else self.joints
        (pose,) = request.waypoints
        at, turn = pose.position, pose.orientation
        yaw = 2 * atan2(turn.z, turn.w)
        end = np.array([at.x, at.y, at.z, start[3] + (yaw - start[3] + np.pi) % (2 * np.pi) - np.pi])
        count = ceil(dist(start[:3], end[:3]) / request.max_step) + 2
        joints = np.linspace(start, end, count)
        if self.jumps:
            joints[count // 2 :, 3] += 1.0
        reached = np.linalg.norm(joints[:, :2], axis=1) <= self.reach
        found = Trajectory()
        found.joint_names = ["x", "y", "z", "yaw"]
        found.points = [
            TrajectoryPoint(positions=row.tolist(), time_from_start=Duration(sec=0, nanosec=0))
            for row in joints[: count if reached.all() else int(reached.argmin())]
        ]
        answer = Blank(fraction=len(found.points) / count, error_code=Blank(val=1))
        answer.solution.joint_trajectory = found
        return Future().set(answer)

    def send_goal_async(self, goal: Any) -> Future:
        """The controller's action: joints go along the trajectory, `HASTE` times as fast as it says."""
        return Future().set(Goal(self, goal.trajectory))

    def lookup_transform(self, base: str, tool: str, when: object) -> Any:
        """tf: where the tool is."""
        x, y, z, yaw = self.joints.tolist()
        place = SimpleNamespace(x=x, y=y, z=z)
        turn = SimpleNamespace(x=0.0, y=0.0, z=np.sin(yaw / 2), w=np.cos(yaw / 2))
        return SimpleNamespace(transform=SimpleNamespace(translation=place, rotation=turn))


class Goal:
    """The handle of a goal, which moves the arm by a thread of its own."""

    def __init__(self, cell: Cell, trajectory: Trajectory) -> None:
        self.accepted = cell.accepted
        self._cell, self._trajectory = cell, trajectory
        self._result, self._cancelled = Future(), threading.Event()
        if self.accepted:
            cell.trajectories.append(trajectory)
            threading.Thread(target=self._move, daemon=True).start()

    def get_result_async(self) -> Future:
        return self._result

    def cancel_goal_async(self) -> Future:
        self._cancelled.set()
        return Future().set(None)

    def _move(self) -> None:
        times = times_of(self._trajectory)
        joints = np.array([point.positions for point in self._trajectory.points])
        began, status = time.monotonic(), ABORTED if self._cell.aborts else SUCCEEDED
        while status == SUCCEEDED and (now := HASTE * (time.monotonic() - began)) < times[-1]:
            self._cell.joints = np.array([np.interp(now, times, row) for row in joints.T])
            if self._cancelled.wait(0.002):
                status = CANCELLED
        if status == SUCCEEDED:
            self._cell.joints = joints[-1]
        told = SimpleNamespace(error_string="a joint is too far behind", error_code=-4)
        self._result.set(SimpleNamespace(status=status, result=told))


def times_of(trajectory: Trajectory) -> np.ndarray:
    """Seconds at which points are reached."""
    return np.array([p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in trajectory.points])


def put_in_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the driver's modules be imported anew, with these instead of ROS."""
    parts: Mapping[str, Mapping[str, Any]] = {
        "rclpy": {"__path__": []},
        "rclpy.qos": {"qos_profile_sensor_data": None},
        "rclpy.time": {"Time": Blank},
        "rclpy.action": {"ActionClient": lambda node, kind, name: node},
        "rclpy.executors": {"MultiThreadedExecutor": Blank},
        "sensor_msgs": {"__path__": []},
        "sensor_msgs.msg": {"CameraInfo": Blank, "Image": Blank},
        "builtin_interfaces": {"__path__": []},
        "builtin_interfaces.msg": {"Duration": Duration},
        "geometry_msgs": {"__path__": []},
        "geometry_msgs.msg": {"Pose": Pose},
        "control_msgs": {"__path__": []},
        "control_msgs.action": {"FollowJointTrajectory": SimpleNamespace(Goal=TrajectoryGoal)},
        "moveit_msgs": {"__path__": []},
        "moveit_msgs.srv": {"GetCartesianPath": SimpleNamespace(Request=CartesianRequest)},
        "trajectory_msgs": {"__path__": []},
        "trajectory_msgs.msg": {"JointTrajectory": Trajectory, "JointTrajectoryPoint": TrajectoryPoint},
        "tf2_ros": {"Buffer": Frames, "TransformListener": Frames.listen},
    }
    for name, held in parts.items():
        module = ModuleType(name)
        module.__dict__.update(held)
        monkeypatch.setitem(sys.modules, name, module)
    forget(monkeypatch)


def forget(monkeypatch: pytest.MonkeyPatch) -> None:
    """Modules of the driver that were imported with other parts of ROS."""
    for name in ("ros2_camera", "ros2_arm", "ros2_driver"):
        monkeypatch.delitem(sys.modules, name, raising=False)


class Frames:
    """tf2's buffer, which the listener connects with the node's arm."""

    def __init__(self) -> None:
        self.lookup_transform: Callable[[str, str, object], Any]

    def listen(self, node: Cell) -> None:
        self.lookup_transform = node.lookup_transform
