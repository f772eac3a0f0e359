"""The printing robot at the end of a socket: python examples/printing_driver.py FOLDER... [--port N]

A driver to begin from (docs/protocol.md). It moves nothing: it prints where it is told to go, and shows the
recorded frames of a folder for each look, as examples/printing_robot.py does. Of this program it needs what
reads frames, and what `cleancli.remote` needs: a driver with a camera of its own needs NumPy alone.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from printing_robot import PrintingRobot

from cleancli.perception.recorded import load_frames
from cleancli.remote.messages import Description, FramePair, Limits
from cleancli.remote.server import Server
from cleancli.scene.address import PORT, Address

DESCRIPTION = Description(
    robot="printing robot",
    skills=("straight", "joint"),
    limits=Limits(low=(-0.7, -0.6, -0.02), high=(0.7, 0.6, 0.3), speed=0.25, depth=0.005),
    lease=5.0,
    period=0.02,
)
"""Where it goes, how fast and how deep; seconds without a poll after which it stops by itself."""


class PrintingDriver(PrintingRobot):
    """A `Driver`: the printing robot, whose pictures come as a driver gives them."""

    def observe(self) -> FramePair:  # type: ignore[override]
        """The next frame of the look that is due, colour and depth of one moment."""
        frame = super().observe()
        camera = frame.camera
        return FramePair(
            colour=frame.colour,
            depth=frame.depth,
            colour_stamp=self.clock,
            depth_stamp=self.clock,
            focal=(camera.focal, camera.focal),
            centre=camera.centre,
            pose=camera.pose,
        )


def main() -> None:
    """Listen until Ctrl-C."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER")
    parser.add_argument("--port", type=int, default=PORT)
    given = parser.parse_args()
    driver = PrintingDriver([load_frames(folder) for folder in given.folders])
    server = Server(driver, DESCRIPTION, Address("127.0.0.1", given.port), print)
    print(f"listens at {server.address}; Ctrl-C ends it", flush=True)
    try:
        server.serve()
    except KeyboardInterrupt:
        pass
    finally:
        server.close()


if __name__ == "__main__":
    main()
