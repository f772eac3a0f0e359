"""Adds to a rendered picture what the engine's renderer lacks: texture, ink, and a gradient of light."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from cleancli.array_types import Floats, Image, Longs, Singles
from cleancli.motion.zone import inwards
from cleancli.scene.model import Light, Scene, Surface, Zone
from cleancli.world import constants as par
from cleancli.world.ink import InkLayer


class Finish:
    """Puts it into a picture, of which every pixel's place is known. `ink` may change meanwhile. A `zone` is
    painted for people: no camera of a robot sees any."""

    def __init__(self, scene: Scene, ink: InkLayer | None, zone: Zone | None = None) -> None:
        self._surface, self._light, self._ink, self._zone = scene.surface, scene.light, ink, zone
        self._texture = texture(scene.surface) if scene.surface.texture > 0 else None

    @property
    def changes(self) -> bool:
        """Whether there is anything that the renderer leaves out."""
        parts = self._ink, self._texture, self._zone
        return any(part is not None for part in parts) or self._light.gradient > 0

    @property
    def ink_amount(self) -> Singles:
        """How much ink each cell of the surface holds now, (rows, columns); empty where there is none."""
        return np.empty((0, 0), np.float32) if self._ink is None else self._ink.amount

    def put_on(self, image: Image, x: Floats, y: Floats, z: Floats) -> None:
        """Change `image` (height, width, 3), of which (height, width) pixels show the places (x, y, z)."""
        painted = image.astype(np.float64)
        top = np.abs(z) < par.INK_HEIGHT
        if self._texture is not None:
            top &= (np.abs(x) <= self._surface.width / 2) & (np.abs(y) <= self._surface.depth / 2)
            painted[top] *= (
                1
                + self._texture[_cell(y[top], self._surface.depth), _cell(x[top], self._surface.width)][
                    :, None
                ]
            )
        if self._ink is not None:
            share = self._ink.share_at(x, y) * top
            covered = share > 0
            # Ink takes as much light as the surface around it, whose brightness isn't known here: it is dark.
            ink = self._ink.colour_at(x[covered], y[covered])
            painted[covered] += share[covered, None] * (ink - painted[covered])
        if self._zone is not None:
            deep = inwards(self._zone, np.column_stack((x[top], y[top])))
            painted[top] += np.where(deep >= 0, par.ZONE_PAINT, 0.0)[:, None] * (
                np.array(par.ZONE_COLOUR) - painted[top]
            )
        if self._light.gradient > 0:
            painted *= brightness(self._light, self._surface, x, y)[:, :, None]
        image[:] = np.clip(np.round(painted), 0, 255).astype(np.uint8)


def brightness(light: Light, surface: Surface, x: Floats, y: Floats) -> Floats:
    """The light that places get, as a share of what the middle of the surface gets."""
    east, north = cos(light.azimuth), sin(light.azimuth)
    farthest = abs(east) * surface.width / 2 + abs(north) * surface.depth / 2
    return np.asarray(1 + light.gradient * np.clip((east * x + north * y) / farthest, -1, 1))


def texture(surface: Surface) -> Floats:
    """How much lighter each cell of the surface is than all on average, as a share; (rows, columns) from the
    south-west. White noise through a Gaussian filter; one surface always has the same."""
    rows, columns = (round(side / par.TEXTURE_CELL) + 1 for side in (surface.depth, surface.width))
    noise = np.random.default_rng(par.TEXTURE_SEED).standard_normal((rows, columns))
    # Lighter and darker places lie `grain` apart for a filter with this standard deviation.
    sigma = surface.grain / 4 / par.TEXTURE_CELL
    down, across = np.fft.fftfreq(rows)[:, None], np.fft.rfftfreq(columns)[None, :]
    kept = np.exp(-2 * (np.pi * sigma) ** 2 * (down**2 + across**2))
    smooth = np.fft.irfft2(np.fft.rfft2(noise) * kept, (rows, columns))
    return np.asarray(np.clip(surface.texture * smooth / smooth.std(), -1, 1))


def _cell(place: Floats, side: float) -> Longs:
    """Rows of y, or columns of x."""
    return np.asarray(np.floor((place + side / 2) / par.TEXTURE_CELL), np.int64)
