"""RGB-D frames: colour, depth, the camera's intrinsics and pose. No heavy imports: worlds use it too."""

from __future__ import annotations

from dataclasses import dataclass

from cleancli.array_types import Depth, Floats, Image


@dataclass(frozen=True, slots=True)
class Camera:
    """Pinhole camera. `pose` (4, 4) maps camera coordinates (x right, y down, z forward, metres) to the
    scene's; focal length and principal point in pixels. Where nobody knows where the camera stands, it is not
    `located`: then its own coordinates serve as the scene's."""

    width: int
    height: int
    focal: float
    centre: tuple[float, float]
    pose: Floats
    located: bool = True


@dataclass(frozen=True, slots=True)
class Frame:
    """One RGB-D image: `colour` (height, width, 3) uint8 RGB, `depth` (height, width) float32 in metres
    along the optical axis, 0 where unknown; `clock` in seconds of robot time."""

    colour: Image
    depth: Depth
    camera: Camera
    clock: float
