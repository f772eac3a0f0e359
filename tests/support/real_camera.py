"""Frames as a real camera takes them: noise whose neighbours are alike, exposure, vignetting, soft shadows.

The numbers of the noise are those that `python benchmarks/camera_noise.py FOLDER` measures on ten pictures of
a RealSense (docs/real_tables.md); the rest is chosen and says so. Nothing here uses perception's own code.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import cv2
import numpy as np
from numpy.typing import NDArray

from cleancli.geometry.rgbd import Camera, Frame
from support import synthetic

Array = NDArray[np.float64]

COLOUR_NOISE = (4.1, 3.4, 5.0)
"""Standard deviations of red, green and blue, of 255; they hardly depend on the brightness. The measure takes
the slow part of the noise away with the scene, so they are a quarter larger than what it gives."""
SHARED = 0.3
"""Correlation of the noise of two channels."""
FINE, COARSE, COARSE_SHARE = 0.6, 2.2, 0.5
"""Noise is white noise blurred by these standard deviations (pixels), the second with so much of the
variance: the measure gives 0.5 for neighbours, as on the pictures."""
DEPTH_NOISE = 0.0014
"""Metres at one metre; it grows with the square of the distance."""
DEPTH_COARSE = 1.1
"""Pixels by which white noise of depth is blurred: neighbours correlate by 0.65."""
MILLIMETRE = 0.001
"""What depth is rounded to."""
HOLES = 0.01
"""Share of pixels without depth; chosen. Of the pictures it is 0.4 to 22 %, most of them at edges."""
SHARPNESS = 0.6
"""Pixels by which optics blur the picture; chosen."""
VIGNETTING = 0.15
"""Share by which the picture's corners are darker than its middle; chosen: the pictures do not tell."""

SHADES = {"brown": (0.50, 0.42, 0.28), "pale": (0.72, 0.70, 0.62), "dim": (0.79, 0.76, 0.70)}
"""What particles reflect, as a share of what the surface does: red, green and blue. Dim ones differ by a
quarter of its brightness, the least of the tables of benchmarks/perception.py."""
SURFACES = {
    "beige": (205, 198, 184),
    "grey": (140, 142, 146),
    "wood": (170, 130, 90),
    "blue": (96, 120, 160),
    "green": (120, 150, 120),
}
RADIUS = synthetic.RADIUS
BUMP = 0.0025
"""Metres by which a particle is higher than the surface."""
_FINER = 8
"""Parts of a pixel's side for which is asked whether a particle covers them."""


@dataclass(frozen=True)
class Light:
    """`exposure`: factor of all brightness. `gradient`: share by which it changes from one side of the
    picture to the other, towards `angle` (radians). `shadow`: share of the light that it takes, along a line
    through `shadow_at` (share of the picture's width) with a penumbra of `softness` pixels."""

    exposure: float = 1.0
    gradient: float = 0.0
    angle: float = 0.0
    shadow: float = 0.0
    shadow_at: float = 0.5
    softness: float = 40.0


def drawn_light(rng: np.random.Generator, low: float = 0.7, high: float = 1.4) -> Light:
    """Exposure of `low` to `high`, a gradient up to 45 %, and in every second a soft shadow of 20 to 40 %."""
    return Light(
        exposure=float(np.exp(rng.uniform(np.log(low), np.log(high)))),
        gradient=float(rng.uniform(0, 0.45)),
        angle=float(rng.uniform(0, 2 * np.pi)),
        shadow=float(rng.choice([0.0, rng.uniform(0.2, 0.4)])),
        shadow_at=float(rng.uniform(0.2, 0.8)),
        softness=float(rng.uniform(15, 60)),
    )


def taken(
    seed: int,
    colour: tuple[int, int, int] = SURFACES["grey"],
    light: Light = Light(),
    places: Array | None = None,
    shade: tuple[float, float, float] = SHADES["brown"],
    boxes: tuple[synthetic.Box, ...] = (),
    texture: Array | None = None,
) -> Frame:
    """The table of `synthetic.scene()`, with particles at `places` (n, 2), as the camera takes it.

    `texture` (height, width): what the surface reflects, as a factor of its colour. Objects (`boxes`) cast a
    soft shadow of their own, ten pixels wide.
    """
    rng = np.random.default_rng(seed)
    camera = synthetic.camera()
    plain = synthetic.frame(np.zeros((0, 2)), 0, boxes=boxes, colour=(255, 255, 255), noise=False)
    share = _covered(camera, np.zeros((0, 2)) if places is None else places)[:, :, None]
    reflected = np.array(colour) * (1 - share + share * np.array(shade))
    if texture is not None:
        reflected = reflected * texture[:, :, None]
    is_table = (plain.colour == 255).all(axis=2)
    image = np.where(is_table[:, :, None], reflected, plain.colour)
    if boxes:
        stands = (plain.depth < synthetic.HEIGHT - 1e-6).astype(np.float64)
        image *= np.where(is_table, 1 - 0.5 * cv2.GaussianBlur(stands, (0, 0), 5), 1)[:, :, None]
    lit = image * _lit(camera, light)[:, :, None]
    image = np.asarray(cv2.GaussianBlur(lit, (0, 0), SHARPNESS), np.float64)
    image += _colour_noise(image.shape[:2], rng)
    depth = plain.depth - BUMP * share[:, :, 0]
    depth = depth + DEPTH_NOISE * depth**2 * _blurred(depth.shape, rng, DEPTH_COARSE)
    depth = np.round(depth / MILLIMETRE) * MILLIMETRE
    depth[rng.random(depth.shape) < HOLES] = 0
    return Frame(np.clip(np.round(image), 0, 255).astype(np.uint8), depth.astype(np.float32), camera, 0.0)


def wood(seed: int, strength: float = 0.06) -> Array:
    """Grain along the rows, as a factor of the surface's colour: lines 2 to 20 pixels wide. Chosen."""
    rng = np.random.default_rng(seed)
    camera = synthetic.camera()
    whole = np.zeros((camera.height, camera.width))
    for wide in (1.0, 3.0, 8.0):
        grain = cv2.GaussianBlur(rng.standard_normal(whole.shape), (0, 0), sigmaX=12 * wide, sigmaY=wide)
        whole += grain / grain.std()
    return np.asarray(1 + strength * whole / whole.std())


def _lit(camera: Camera, light: Light) -> Array:
    columns, rows = np.meshgrid(np.linspace(-1, 1, camera.width), np.linspace(-1, 1, camera.height))
    along = np.cos(light.angle) * columns + np.sin(light.angle) * rows
    beyond = (np.arange(camera.width)[None, :] - light.shadow_at * camera.width) / light.softness
    shadow = 1 - light.shadow / (1 + np.exp(-4 * beyond))
    vignette = 1 - VIGNETTING * (columns**2 + rows**2) / 2
    return np.asarray(light.exposure * (1 + light.gradient / 2 * along) * shadow * vignette)


def _colour_noise(size: tuple[int, ...], rng: np.random.Generator) -> Array:
    """(height, width, 3) with the fitted spread and correlations."""

    def one() -> Array:
        fine, coarse = _blurred(size, rng, FINE), _blurred(size, rng, COARSE)
        return np.asarray(np.sqrt(1 - COARSE_SHARE) * fine + np.sqrt(COARSE_SHARE) * coarse)

    common = one()
    each = [np.sqrt(1 - SHARED) * one() + np.sqrt(SHARED) * common for _ in range(3)]
    return np.asarray(np.stack(each, axis=2) * np.array(COLOUR_NOISE))


def _blurred(size: tuple[int, ...], rng: np.random.Generator, pixels: float) -> Array:
    """White noise, blurred, with variance 1."""
    noise = cv2.GaussianBlur(rng.standard_normal(size), (0, 0), pixels)
    return np.asarray(noise / noise.std(), np.float64)


def _covered(camera: Camera, places: Array) -> Array:
    """The share of each pixel that round particles at `places` cover."""
    scale = camera.focal / synthetic.HEIGHT
    pixels = np.array(camera.centre) + places * (scale, -scale)
    return covered((camera.height, camera.width), pixels, np.full(len(places), RADIUS * scale))


def covered(size: tuple[int, int], pixels: Array, radii: Array) -> Array:
    """The share of each pixel of a picture of this `size` that discs cover, with middles at `pixels` (n, 2),
    as (column, row), and `radii` (n,) in pixels."""
    whole = np.zeros(size)
    for (column, row), radius in zip(pixels, radii, strict=True):
        reach = ceil(radius) + 2
        parts = (np.arange(2 * reach * _FINER) + 0.5) / _FINER - 0.5
        left, top = int(column) - reach, int(row) - reach
        if not (0 <= left < size[1] - 2 * reach and 0 <= top < size[0] - 2 * reach):
            continue
        away = np.hypot(*np.meshgrid(left + parts - column, top + parts - row))
        share = (away < radius).reshape(2 * reach, _FINER, 2 * reach, _FINER).mean(axis=(1, 3))
        window = whole[top : top + 2 * reach, left : left + 2 * reach]
        window[:] = np.maximum(window, share)
    return whole
