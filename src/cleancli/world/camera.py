"""The RGB-D camera above the table, and what it shares with that for people: pybullet's own renderer."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, cos, sin

import numpy as np

from cleancli.array_types import Depth, Floats, Image
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.scene.model import CameraSetup, Light
from cleancli.world import constants as par
from cleancli.world.image_effects import Finish
from cleancli.world.physics import Engine

_Range = tuple[float, float]
Places = tuple[Floats, Floats, Floats]
"""x, y and z of what each pixel shows, (height, width) each."""


@dataclass(frozen=True, slots=True)
class Lens:
    """Size of a picture in pixels, the engine's matrices of the view and of the projection, by columns, and
    between which distances things are seen, metres."""

    width: int
    height: int
    view: list[float]
    projection: list[float]
    near: float
    far: float

    @property
    def matrix(self) -> Floats:
        """(4, 4) from places of the scene to the renderer's cube."""
        return _matrix(self.projection) @ _matrix(self.view)

    def depth(self, buffer: Floats) -> Floats:
        """Metres along the view, by the renderer's depth `buffer`."""
        return self.far * self.near / (self.far - (self.far - self.near) * buffer)


def lens(
    engine: Engine, eye: Floats, ahead: Floats, up: Floats, field: float, size: tuple[int, int], range: _Range
) -> Lens:
    """One that stands at `eye` and looks at `ahead`; `field` is the vertical opening angle, degrees, `size`
    width and height in pixels, `range` the nearest and the farthest that is seen."""
    width, height = size
    view = engine.computeViewMatrix(eye.tolist(), ahead.tolist(), up.tolist())
    projection = engine.computeProjectionMatrixFOV(field, width / height, *range)
    return Lens(width, height, view, projection, *range)


def overhead(setup: CameraSetup) -> Camera:
    """The camera above the surface as the scene places it; straight above the middle its y points south."""
    pose = np.eye(4)
    pose[:3, :3] = np.transpose(setup.axes())
    pose[:3, 3] = *setup.at, setup.height
    # Where the renderer puts the optical axis, in pixel middles (tests/world/test_camera.py measures it).
    centre = setup.image_width / 2, setup.image_height / 2 - 1
    return Camera(setup.image_width, setup.image_height, setup.focal, centre, pose)


def photograph(
    engine: Engine,
    camera: Camera,
    light: Light,
    finish: Finish,
    clock: float,
    rng: np.random.Generator,
) -> Frame:
    """One frame with the noise of a Kinect."""
    colour, depth = render(engine, camera, light, finish)
    return Frame(noisy_colour(colour, rng), noisy_depth(depth, rng), camera, clock)


def render(engine: Engine, camera: Camera, light: Light, finish: Finish | None = None) -> tuple[Image, Depth]:
    """What an ideal camera would see: colour (height, width, 3), and depth (height, width) in metres."""
    eye = camera.pose[:3, 3]
    ahead, up = eye + camera.pose[:3, 2], -camera.pose[:3, 1]
    opening = 2 * float(np.degrees(atan(camera.height / 2 / camera.focal)))
    view = lens(engine, eye, ahead, up, opening, (camera.width, camera.height), (par.NEAR, par.FAR))
    colour, buffer = rasterise(engine, view, light)
    if finish is not None and finish.changes:
        finish.put_on(colour, *places(buffer, view))
    return colour, view.depth(buffer).astype(np.float32)


def rasterise(engine: Engine, view: Lens, light: Light, shadows: bool = False) -> tuple[Image, Floats]:
    """Colour (height, width, 3) and the depth buffer (height, width), which is 1 where there is nothing."""
    level = cos(light.elevation)
    direction = level * cos(light.azimuth), level * sin(light.azimuth), sin(light.elevation)
    _, _, colour, buffer, _ = engine.getCameraImage(
        view.width,
        view.height,
        view.view,
        view.projection,
        lightDirection=direction,
        shadow=int(shadows),
        lightAmbientCoeff=light.ambient,
        lightDiffuseCoeff=1 - light.ambient,
        lightSpecularCoeff=0.0,
        renderer=engine.ER_TINY_RENDERER,
        flags=engine.ER_NO_SEGMENTATION_MASK,
    )
    size = view.height, view.width
    image = np.ascontiguousarray(np.asarray(colour, dtype=np.uint8).reshape(*size, 4)[:, :, :3])
    return image, np.asarray(buffer, dtype=np.float64).reshape(size)


def places(buffer: Floats, view: Lens) -> Places:
    """Where what each pixel shows is, by the depth `buffer` (height, width)."""
    height, width = buffer.shape
    rows, columns = np.indices(buffer.shape)
    # The optical axis is where `overhead` says: in the middle of the columns, a pixel above that of the rows.
    cube = np.stack(
        (2 * columns / width - 1, 1 - 2 * (rows + 1) / height, 2 * buffer - 1, np.ones_like(buffer))
    )
    x, y, z, w = np.einsum("ij,jhw->ihw", np.linalg.inv(view.matrix), cube)
    return x / w, y / w, z / w


def noisy_depth(depth: Depth, rng: np.random.Generator) -> Depth:
    """Depth as a Kinect reports it: edges jittered, some unknown (0), noise and steps growing with z²."""
    rows, columns = np.indices(depth.shape)
    jitter = rng.integers(-par.EDGE_JITTER, par.EDGE_JITTER + 1, (2, *depth.shape), dtype=np.int8)
    rows = np.clip(rows + jitter[0], 0, depth.shape[0] - 1)
    columns = np.clip(columns + jitter[1], 0, depth.shape[1] - 1)
    seen = depth[rows, columns]
    edge = np.abs(seen - depth) > par.EDGE_JUMP
    square = seen * seen
    seen = seen + par.DEPTH_NOISE * square * rng.standard_normal(depth.shape, dtype=np.float32)
    step = par.DEPTH_STEP * square
    seen = np.round(seen / step) * step
    seen[edge & (rng.random(depth.shape, dtype=np.float32) < par.EDGE_DROPOUT)] = 0
    reported: Depth = seen.astype(np.float32)
    return reported


def noisy_colour(colour: Image, rng: np.random.Generator) -> Image:
    """Colour registered to depth with an error, and with noise on every channel."""
    shifted = np.roll(colour, par.COLOUR_SHIFT, axis=1)
    shifted[:, : par.COLOUR_SHIFT] = colour[:, : par.COLOUR_SHIFT]
    noise = par.COLOUR_NOISE * rng.standard_normal(colour.shape, dtype=np.float32)
    return np.clip(np.round(shifted + noise), 0, 255).astype(np.uint8)


def _matrix(columns: list[float]) -> Floats:
    """The engine lists a matrix of 4 x 4 by columns."""
    return np.array(columns).reshape(4, 4).T
