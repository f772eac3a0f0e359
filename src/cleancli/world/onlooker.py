"""The onlooker's camera: pictures of the table for people, with shadows, that never reach perception.

The engine's renderer needs most of its time for what stands still, and twice as much with its own shadows. So
the furniture is rendered once, and again only what moves, on a *stage*: an engine of its own that has nothing
else in it and never lets time pass. Each pixel shows whichever is nearer. Shadows come of another picture of
the stage, from where the light falls (shadow mapping: Williams 1978, "Casting curved shadows on curved
surfaces"): what stands still looks to the same pixel of it in each picture.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from math import degrees, sin, tan

import numpy as np

from cleancli.array_types import Bools, Floats, Image, Longs
from cleancli.scene.model import Light, Scene
from cleancli.world import camera, furniture
from cleancli.world import constants as par
from cleancli.world.image_effects import Finish
from cleancli.world.physics import Engine
from cleancli.world.state import bodies, place
from cleancli.world.viewpoint import Viewpoint, around

NOTHING = 1 - 1e-6
"""In a depth buffer, from here on there is nothing to be seen: the renderer rounds."""


@dataclass(frozen=True, slots=True)
class Backdrop:
    """What stands still as one view shows it, (height, width) of each: `colour`, the depth `buffer`, x, y and
    z of its `places`, the pixel of the light's picture that each of them looks `to`, counted along its rows,
    its own depth there (`from_light`), and which of them are in the `shade` of furniture."""

    colour: Image
    buffer: Floats
    places: camera.Places
    to: Longs
    from_light: Floats
    shade: Bools


class Onlooker:
    """Takes pictures of one size of what moves on a table. `close` it."""

    def __init__(
        self,
        scene: Scene,
        stage: Engine,
        actors: tuple[int, ...],
        view: Viewpoint,
        points: Floats,
        size: tuple[int, int],
    ) -> None:
        self._stage, self._actors, self._light = stage, actors, scene.light
        self._lens = _lens(stage, view, size, par.PICTURE_RANGE)
        self._lamp = _lamp(stage, scene.light, points)
        self._backdrop = _backdrop(scene, self._lens, self._lamp)
        self._ink = np.empty(0, np.float32)
        self._still: Image | None = None

    def close(self) -> None:
        """Free the stage."""
        self._stage.close()

    def picture(self, engine: Engine, particles: tuple[int, ...], finish: Finish) -> Image:
        """What is to be seen of the world in `engine`, (height, width, 3) uint8 RGB."""
        place(self._stage, self._actors, *bodies(engine, particles))
        still = self._backdrop
        image = self._finished(finish).copy()
        shade = in_shade(_distance(self._stage, self._lamp, self._light), still)
        _darken(image, shade & ~still.shade, self._light)
        colour, buffer = camera.rasterise(self._stage, self._lens, self._light)
        nearer = buffer < still.buffer
        image[nearer] = colour[nearer]
        return image

    def _finished(self, finish: Finish) -> Image:
        """The furniture with its shadows, and with texture and ink as they are now."""
        ink = finish.ink_amount
        if self._still is None or not np.array_equal(ink, self._ink):
            self._still, self._ink = self._backdrop.colour.copy(), ink.copy()
            if finish.changes:
                finish.put_on(self._still, *self._backdrop.places)
            _darken(self._still, self._backdrop.shade, self._light)
        return self._still


def in_shade(distance: Floats, still: Backdrop) -> Bools:
    """(height, width) which places have something before them, given the light's picture as distances."""
    # What lies outside the light's picture looks to one pixel more, which shows nothing.
    nearest = np.append(distance, np.inf)
    return np.asarray(nearest[still.to] < still.from_light - par.SHADOW_BIAS)


def _darken(image: Image, shade: Bools, light: Light) -> None:
    """Leave a level surface what light it has where none falls straight on it."""
    straight = (1 - light.ambient) * sin(light.elevation)
    share = light.ambient / (light.ambient + straight)
    image[shade] = (image[shade] * share).astype(np.uint8)


def _backdrop(scene: Scene, lens: camera.Lens, lamp: camera.Lens) -> Backdrop:
    with closing(Engine()) as room:
        furniture.build(room, scene)
        colour, buffer = camera.rasterise(room, lens, scene.light)
        distance = _distance(room, lamp, scene.light)
    places = camera.places(buffer, lens)
    to, from_light = _towards(lamp, places)
    # The floor has no thickness for people.
    empty = (buffer > NOTHING) | (places[2] < -par.TABLE_HEIGHT - par.LEVEL)
    colour[empty] = par.WALL_COLOUR
    # Faces that turn away from the light are dark already; of the others, shadows are seen on level ones.
    to[empty | ~_level(places[2])] = lamp.width * lamp.height
    bare = Backdrop(colour, buffer, places, to, from_light, np.zeros_like(empty))
    return Backdrop(colour, buffer, places, to, from_light, in_shade(distance, bare))


def _level(heights: Floats) -> Bools:
    """Which pixels belong to a level face: the next one in its column is as high, and the next in its row."""
    level = np.ones(heights.shape, np.bool_)
    for axis in (0, 1):
        same = np.abs(np.diff(heights, axis=axis)) < par.LEVEL
        before, after = [(0, 0), (0, 0)], [(0, 0), (0, 0)]
        before[axis], after[axis] = (1, 0), (0, 1)
        level &= np.pad(same, before) | np.pad(same, after)
    return level


def _towards(lamp: camera.Lens, places: camera.Places) -> tuple[Longs, Floats]:
    """The pixel of the light's picture that shows each place, along its rows, and the place's distance."""
    seen = np.einsum("ij,jhw->ihw", lamp.matrix, np.stack((*places, np.ones_like(places[0]))))
    x, y, _, distance = seen
    # As `camera.places` has it, the other way round.
    column = np.rint((x / distance + 1) / 2 * lamp.width).astype(np.int64)
    row = np.rint((1 - y / distance) / 2 * lamp.height - 1).astype(np.int64)
    inside = (column >= 0) & (column < lamp.width) & (row >= 0) & (row < lamp.height)
    return np.where(inside, row * lamp.width + column, lamp.width * lamp.height), distance


def _distance(engine: Engine, lamp: camera.Lens, light: Light) -> Floats:
    """How far from the light the nearest thing is for each pixel of its picture; infinite without any."""
    buffer = camera.rasterise(engine, lamp, light)[1]
    return np.where(buffer < NOTHING, lamp.depth(buffer), np.inf)


def _lens(engine: Engine, view: Viewpoint, size: tuple[int, int], reach: tuple[float, float]) -> camera.Lens:
    near, far = max(view.near - reach[0], par.NEAR), view.far + reach[1]
    opening = degrees(view.field)
    return camera.lens(engine, view.eye, view.eye - view.back, view.up, opening, size, (near, far))


def _lamp(engine: Engine, light: Light, points: Floats) -> camera.Lens:
    """The view of all `points` (n, 3) from the light, which falls nearly in parallel."""
    view = around(points, light.azimuth, light.elevation, par.LAMP_FIELD, 1.0)
    wide = 2 * view.far * tan(par.LAMP_FIELD / 2)
    side = round(wide / par.SHADOW_CELL)
    return _lens(engine, view, (side, side), par.LAMP_RANGE)
