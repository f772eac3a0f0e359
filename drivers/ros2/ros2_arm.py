"""An arm that MoveIt plans for and a joint trajectory controller of ros2_control moves."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from builtin_interfaces.msg import Duration
from control_msgs.action import FollowJointTrajectory
from geometry_msgs.msg import Pose
from moveit_msgs.srv import GetCartesianPath
from rclpy.action import ActionClient
from rclpy.time import Time
from ros2_timing import NoWay, in_base, in_scene, length_of, timed
from tf2_ros import Buffer, TransformListener
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from cleancli.array_types import Floats
from cleancli.motion.pace import LIFT
from cleancli.motion.path import Waypoint
from cleancli.world.robot import Status

STEP = 0.005
"""Metres between the points that MoveIt finds joints for."""
PLANNING, ANSWERING, LIFTING = 10.0, 2.0, 5.0
"""Real seconds that MoveIt may take for a piece, the controller for an answer, and the tool for being
raised."""
RAISING_SPEED = 0.05
"""m/s."""
SUCCEEDED = 4
"""The status of a goal of ROS that was reached (action_msgs/GoalStatus)."""


class Arm:
    """Follows waypoints of the scene straight from one to the next, and stands still at each. `table` (4, 4)
    leads from the scene's coordinates to those of `base`; the link `tool` is the middle of the rag's lower
    edge, x where the rag pushes to, z up. `poll` and `stop` may be called by different threads."""

    def __init__(self, node: Any, table: Floats, group: str, base: str, tool: str, controller: str) -> None:
        self._table, self._group, self._base, self._tool = table, group, base, tool
        self._planner = node.create_client(GetCartesianPath, "/compute_cartesian_path")
        self._controller = ActionClient(node, FollowJointTrajectory, controller)
        self._frames = Buffer()
        self._listener = TransformListener(self._frames, node)
        self._sending = threading.Lock()
        self._stops = 0
        self._goal: Any = None
        self._ended = threading.Event()
        self._result: Any = None
        self.failure = ""

    def ready(self) -> None:
        """Raises TimeoutError where MoveIt or the controller does not answer."""
        if not self._planner.wait_for_service(PLANNING):
            raise TimeoutError("MoveIt's /compute_cartesian_path is not there: is move_group running?")
        if not self._controller.wait_for_server(PLANNING):
            raise TimeoutError("the controller's action is not there: is it loaded and active?")

    @property
    def place(self) -> tuple[float, float, float]:
        """Where the tool is in the scene, by tf."""
        x, y, z = self._pose()[0]
        return x, y, z

    def can_follow(self, waypoints: Sequence[Waypoint]) -> bool:
        """Whether MoveIt finds joints for all of the way. Nothing moves."""
        try:
            self._planned(waypoints)
        except NoWay:
            return False
        return True

    def start(self, waypoints: Sequence[Waypoint]) -> None:
        """Begin to move; where there is no way, the motion has failed before it began. Raises TimeoutError,
        and RuntimeError where the controller does not take it."""
        stops = self._stops
        self.failure, self._goal, self._result = "", None, None
        self._ended.clear()
        try:
            trajectory = self._planned(waypoints)
        except NoWay as error:
            self.failure = str(error)
            self._ended.set()
            return
        with self._sending:
            was_stopped = stops != self._stops  # while it was planned
            if was_stopped or not trajectory.points:
                self._ended.set()
                return
            self._send(trajectory)

    def poll(self, seconds: float) -> Status:
        """Where the motion stands, after so many seconds or when it ends."""
        if not self._ended.wait(seconds):
            return Status.RUNNING
        result = self._result
        if result is not None and result.status != SUCCEEDED and not self.failure:
            told = result.result.error_string or f"error {result.result.error_code}"
            self.failure = f"the controller gave the motion up: {told}"
        return Status.FAILED if self.failure else Status.DONE

    def stop(self) -> None:
        """End the motion, and raise the tool. Raises TimeoutError and RuntimeError where it cannot."""
        with self._sending:
            self._stops += 1
            if self._goal is not None and not self._ended.is_set():
                _waited(self._goal.cancel_goal_async(), ANSWERING, "the controller does not cancel")
                if not self._ended.wait(ANSWERING):
                    raise TimeoutError("the controller does not end what was cancelled")
            (x, y, z), yaw = self._pose()
            if z < LIFT:
                self.failure = ""
                self._ended.clear()
                try:
                    raising = self._planned([Waypoint(x, y, LIFT, yaw, RAISING_SPEED)])
                except NoWay as error:
                    raise RuntimeError(f"the tool cannot be raised: {error}") from error
                if not raising.points:  # less is missing than an arm can go
                    self._ended.set()
                    return
                self._send(raising)
                if not self._ended.wait(LIFTING):
                    raise TimeoutError("the tool was not raised in time")

    def _pose(self) -> tuple[tuple[float, float, float], float]:
        """Where the tool is in the scene, and its yaw. Raises what tf2 does where nobody tells."""
        found = self._frames.lookup_transform(self._base, self._tool, Time()).transform
        place = in_scene(self._table, np.array([getattr(found.translation, axis) for axis in "xyz"]))
        x, y, z, w = (getattr(found.rotation, part) for part in "xyzw")
        # Where the tool's x points to, in the base's coordinates.
        ahead = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)])
        east, north, _ = self._table[:3, :3].T @ ahead
        return place, float(np.arctan2(north, east))

    def _planned(self, waypoints: Sequence[Waypoint]) -> JointTrajectory:
        """Joints along all waypoints from where the arm is, and when; no points where that is no way at all.
        Raises NoWay, TimeoutError."""
        (x, y, z), yaw = self._pose()
        found = JointTrajectory()
        began = 0.0
        way = [Waypoint(x, y, z, yaw, waypoints[0].speed), *waypoints]
        for before, after in pairwise(way):
            length = length_of(before, after)
            if length < 1e-6:
                continue
            piece = self._piece(after, found)
            joints = np.array([point.positions for point in piece.points], np.float64)
            last = piece.points[-1].time_from_start
            times, moving = timed(joints, length, after.speed, last.sec + 1e-9 * last.nanosec)
            found.joint_names = piece.joint_names
            found.points.extend(_points(began + times, joints, moving, is_first=not found.points))
            began += float(times[-1])
        return found

    def _piece(self, to: Waypoint, before: JointTrajectory) -> JointTrajectory:
        """What MoveIt finds for a straight piece, from where the trajectory before ends."""
        request = GetCartesianPath.Request()
        request.header.frame_id = self._base
        request.group_name, request.link_name = self._group, self._tool
        request.start_state.is_diff = True  # where the arm is now, but for what is said
        if before.points:
            request.start_state.joint_state.name = list(before.joint_names)
            request.start_state.joint_state.position = list(before.points[-1].positions)
        (x, y, z), (qx, qy, qz, qw) = in_base(self._table, to)
        pose = Pose()
        pose.position.x, pose.position.y, pose.position.z = float(x), float(y), float(z)
        pose.orientation.x, pose.orientation.y = float(qx), float(qy)
        pose.orientation.z, pose.orientation.w = float(qz), float(qw)
        request.waypoints = [pose]
        request.max_step, request.avoid_collisions = STEP, True
        answer = _waited(self._planner.call_async(request), PLANNING, "MoveIt does not answer")
        if answer.fraction < 1 - 1e-6 or len(answer.solution.joint_trajectory.points) < 2:
            raise NoWay(
                f"MoveIt finds {answer.fraction:.0%} of the way to ({100 * to.x:.1f}, {100 * to.y:.1f}, "
                f"{100 * to.z:.1f}) cm (error {answer.error_code.val})"
            )
        return answer.solution.joint_trajectory

    def _send(self, trajectory: JointTrajectory) -> None:
        goal = FollowJointTrajectory.Goal()
        goal.trajectory = trajectory
        taken = _waited(self._controller.send_goal_async(goal), ANSWERING, "the controller does not answer")
        if not taken.accepted:
            raise RuntimeError("the controller does not take the motion: is it active?")
        self._goal = taken
        taken.get_result_async().add_done_callback(lambda done: self._end(taken, done))

    def _end(self, goal: Any, done: Any) -> None:
        if goal is self._goal:  # and not one that was given up before
            self._result = done.result()
            self._ended.set()


def _points(times: Floats, joints: Floats, moving: Floats, is_first: bool) -> Iterator[JointTrajectoryPoint]:
    """Points of a trajectory; the first of a piece is the last of the one before."""
    for when, positions, velocities in list(zip(times, joints, moving, strict=True))[0 if is_first else 1 :]:
        point = JointTrajectoryPoint()
        point.positions, point.velocities = positions.tolist(), velocities.tolist()
        seconds, nanoseconds = divmod(round(1e9 * float(when)), 10**9)
        point.time_from_start = Duration(sec=seconds, nanosec=nanoseconds)
        yield point


def _waited(future: Any, seconds: float, told: str) -> Any:
    """What a future of rclpy comes to, which the node's own thread carries out. Raises TimeoutError."""
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    if not done.wait(seconds):
        raise TimeoutError(told)
    return future.result()
