"""The RGB-D camera above the table and the onlooker's camera at its corner, drawn by pybullet's own renderer.

The onlooker's pictures have no noise; they are for people, and never reach perception.
"""

from __future__ import annotations

from math import atan, cos, sin

import numpy as np

from cleancli.array_types import Depth, Floats, Image
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.scene.model import CameraSetup, Light, Surface
from cleancli.world import constants as par
from cleancli.world.image_effects import Finish
from cleancli.world.physics import Engine

_Places = tuple[Floats, Floats, Floats]


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
    view = engine.computeViewMatrix(eye.tolist(), ahead.tolist(), up.tolist())
    opening = 2 * np.degrees(atan(camera.height / 2 / camera.focal))
    projection = engine.computeProjectionMatrixFOV(opening, camera.width / camera.height, par.NEAR, par.FAR)
    colour, buffer = _draw(engine, camera.width, camera.height, view, projection, light, finish)
    depth = par.FAR * par.NEAR / (par.FAR - (par.FAR - par.NEAR) * buffer)
    return colour, depth.astype(np.float32)


def onlook(engine: Engine, surface: Surface, light: Light, finish: Finish, width: int, height: int) -> Image:
    """The table from above its south-east corner, (height, width, 3) uint8 RGB."""
    eye = [0.85 * surface.width, -1.35 * surface.depth, 0.75]
    view = engine.computeViewMatrix(eye, [0.02, 0.0, -0.05], [0, 0, 1])
    opening = float(np.degrees(par.PICTURE_FIELD))
    projection = engine.computeProjectionMatrixFOV(opening, width / height, par.NEAR, par.FAR)
    return _draw(engine, width, height, view, projection, light, finish)[0]


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


def _draw(
    engine: Engine,
    width: int,
    height: int,
    view: list[float],
    projection: list[float],
    light: Light,
    finish: Finish | None,
) -> tuple[Image, Floats]:
    level = cos(light.elevation)
    direction = level * cos(light.azimuth), level * sin(light.azimuth), sin(light.elevation)
    _, _, colour, buffer, _ = engine.getCameraImage(
        width,
        height,
        view,
        projection,
        lightDirection=direction,
        shadow=0,
        lightAmbientCoeff=light.ambient,
        lightDiffuseCoeff=1 - light.ambient,
        lightSpecularCoeff=0.0,
        renderer=engine.ER_TINY_RENDERER,
        flags=engine.ER_NO_SEGMENTATION_MASK,
    )
    image = np.ascontiguousarray(np.asarray(colour, dtype=np.uint8).reshape(height, width, 4)[:, :, :3])
    depth = np.asarray(buffer, dtype=np.float64).reshape(height, width)
    if finish is not None and finish.changes:
        finish.put_on(image, *_places(depth, _matrix(projection) @ _matrix(view)))
    return image, depth


def _places(buffer: Floats, projected: Floats) -> _Places:
    """x, y and z of what each pixel shows, (height, width) each; `projected` (4, 4) takes the scene to the
    renderer's cube."""
    height, width = buffer.shape
    rows, columns = np.indices(buffer.shape)
    # The optical axis is where `overhead` says: in the middle of the columns, a pixel above that of the rows.
    cube = np.stack(
        (2 * columns / width - 1, 1 - 2 * (rows + 1) / height, 2 * buffer - 1, np.ones_like(buffer))
    )
    x, y, z, w = np.einsum("ij,jhw->ihw", np.linalg.inv(projected), cube)
    return x / w, y / w, z / w


def _matrix(columns: list[float]) -> Floats:
    """The engine lists a matrix of 4 x 4 by columns."""
    return np.array(columns).reshape(4, 4).T
