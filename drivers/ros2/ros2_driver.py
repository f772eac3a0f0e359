"""A driver for arms under ROS 2: python ros2_driver.py --cell cell.json --surface 0.9 0.7 --rest 0 0.5 0.3 0

It speaks the protocol of cleancli (docs/protocol.md) at a port of this machine, through cleancli's own guard.
The camera's driver, MoveIt and a joint trajectory controller run already. It needs the environment of ROS 2,
and cleancli without its dependencies: docs/cell.md says how it is installed and tried.

It is no emergency stop. Begin with --pace 0.1 and without the rag.
"""

from __future__ import annotations

import argparse
import json
import signal
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from rclpy.executors import MultiThreadedExecutor
from ros2_arm import Arm
from ros2_camera import Camera

from cleancli.array_types import Floats
from cleancli.motion.path import ToolPath, Waypoint
from cleancli.remote.messages import Description, FramePair, Limits
from cleancli.remote.server import Server
from cleancli.scene.address import PORT, Address
from cleancli.world.robot import Status

PERIOD = 0.02
"""Real seconds that a poll takes at most."""
AROUND, HIGHEST = 0.25, 0.4
"""Metres of the workspace beyond the surface's edges, and above it: strokes end above the container."""


class Ros2Driver:
    """A `Driver`: an arm and a camera of one ROS 2 node. Its clock is the node's."""

    def __init__(self, node: Any, options: argparse.Namespace) -> None:
        self._node = node
        self._began = node.get_clock().now().nanoseconds
        camera, table = poses(options.cell)
        x, y, z, yaw = options.rest
        self._rest = Waypoint(x, y, z, yaw, options.speed)
        self._press, self._pace = options.press, options.pace
        self._camera = Camera(node, options.colour, options.depth, options.info, camera, self._seconds)
        self.arm = Arm(node, table, options.group, options.base, options.tool, options.controller)

    @property
    def clock(self) -> float:
        """Seconds of ROS's time since it began."""
        return 1e-9 * float(self._node.get_clock().now().nanoseconds - self._began)

    @property
    def tool(self) -> tuple[float, float, float]:
        """Where the tool is, by tf."""
        return self.arm.place

    @property
    def failure(self) -> str:
        """Why the last motion failed."""
        return self.arm.failure

    def observe(self) -> FramePair:
        """A pair that is taken after the call."""
        return self._camera.pair(self.clock)

    def can_follow(self, path: ToolPath, errors: float = 2.0) -> bool:
        """By planning it, whatever the errors."""
        return self.arm.can_follow(self._truly(path.waypoints))

    def start(self, path: ToolPath) -> None:
        """Plan, and set off. What may go as is shortest for the arm goes straight as well."""
        self.arm.start(self._truly(path.waypoints))

    def withdraw(self) -> None:
        """Up to the resting place's height, and there."""
        x, y, _ = self.arm.place
        above = Waypoint(x, y, self._rest.z, self._rest.yaw, self._rest.speed)
        self.arm.start(self._truly((above, self._rest)))

    def poll(self) -> Status:
        """Wait for a period, or for the motion's end."""
        return self.arm.poll(PERIOD)

    def stop(self) -> None:
        """Cancel, and raise the tool."""
        self.arm.stop()

    def _truly(self, waypoints: tuple[Waypoint, ...]) -> tuple[Waypoint, ...]:
        """Where the tool goes, and how fast: pressed where it is told to be on the surface, at the driver's
        own pace."""
        return tuple(
            replace(each, z=each.z - self._press * (each.z <= 0), speed=self._pace * each.speed)
            for each in waypoints
        )

    def _seconds(self, stamp: Any) -> float:
        return 1e-9 * float(stamp.sec * 10**9 + stamp.nanosec - self._began)


def poses(cell: Path) -> tuple[Floats, Floats]:
    """The camera's pose in the scene and the scene's in the robot's base, (4, 4) each, of a file that
    `cleancli cell` wrote. Raises ValueError."""
    known = json.loads(cell.read_text(encoding="utf-8"))
    if known.get("format") != "cleancli cell 1":
        raise ValueError(f"{cell}: no file of `cleancli cell`")
    for part, command in (("camera", "cell camera"), ("table", "cell touch")):
        if part not in known:
            raise ValueError(f"{cell}: it does not say where the {part} is: `cleancli {command}`")
    return np.array(known["camera"]["pose"], np.float64), np.array(known["table"]["pose"], np.float64)


def description(options: argparse.Namespace) -> Description:
    """What the driver says of its robot."""
    x, y = (side / 2 + AROUND for side in options.surface)
    depth = options.deepest - options.press
    limits = Limits((-x, -y, -depth), (x, y, HIGHEST), options.speed, depth)
    return Description(options.name, ("straight", "joint"), limits, options.lease, PERIOD)


def parser() -> argparse.ArgumentParser:
    """The options."""
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--cell", type=Path, required=True, help="what `cleancli cell` wrote")
    made.add_argument("--surface", type=float, nargs=2, required=True, metavar=("WIDTH", "DEPTH"))
    made.add_argument("--rest", type=float, nargs=4, required=True, metavar=("X", "Y", "Z", "YAW"))
    made.add_argument("--speed", type=float, default=0.25, help="of the tool, m/s, at most")
    made.add_argument("--pace", type=_share, default=1.0, help="share of the speeds asked for that it goes")
    made.add_argument("--deepest", type=float, default=0.005, help="metres below the surface, at most")
    made.add_argument("--press", type=float, default=0.002, help="metres below that strokes are pressed")
    made.add_argument("--lease", type=float, default=1.0, help="seconds without a poll until it stops")
    made.add_argument("--name", default="arm of ROS 2")
    made.add_argument("--group", default="manipulator", help="MoveIt's planning group")
    made.add_argument("--base", default="base_link", help="the frame in which the table was touched")
    made.add_argument("--tool", default="rag", help="the link that is the middle of the rag's lower edge")
    made.add_argument("--controller", default="/joint_trajectory_controller/follow_joint_trajectory")
    made.add_argument("--colour", default="/camera/camera/color/image_raw")
    made.add_argument("--depth", default="/camera/camera/aligned_depth_to_color/image_raw")
    made.add_argument("--info", default="/camera/camera/color/camera_info")
    made.add_argument("--port", type=int, default=PORT)
    return made


def _share(text: str) -> float:
    share = float(text)
    if not 0 < share <= 1:
        raise argparse.ArgumentTypeError("a share is above 0 and at most 1")
    return share


def main() -> None:
    """Serve until Ctrl-C."""
    options = parser().parse_args()
    rclpy.init()
    node = rclpy.create_node("cleancli_driver")
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    threading.Thread(target=executor.spin, name="ros", daemon=True).start()
    driver = Ros2Driver(node, options)
    driver.arm.ready()
    server = Server(driver, description(options), Address("127.0.0.1", options.port), print)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: server.close())
    print(f"listening at {server.address}", flush=True)
    server.serve()
    executor.shutdown()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
