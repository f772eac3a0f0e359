"""The scripted robot behind the protocol, with limits that are wide enough for strokes."""

from __future__ import annotations

from dataclasses import replace

from cleancli.geometry.rgbd import Frame
from cleancli.remote.messages import FramePair
from support.scripted_robot import Scripted
from support.toy_driver import TOY

WIDE = replace(TOY, limits=replace(TOY.limits, low=(-1.0, -1.0, -0.1), high=(1.0, 1.0, 1.0)))


class ScriptedDriver(Scripted):
    """A `Driver`; it is told what happens to it."""

    def observe(self) -> FramePair:  # type: ignore[override]
        frame: Frame = super().observe()
        camera, now = frame.camera, (self.clock, self.clock)
        focal = (camera.focal, camera.focal)
        return FramePair(frame.colour, frame.depth, *now, focal, camera.centre, camera.pose)
