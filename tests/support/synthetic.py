"""Frames whose truth is known, drawn ray by ray without any of perception's own geometry."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cleancli.geometry.rgbd import Camera, Frame
from cleancli.scene.grasps import WIDE
from cleancli.scene.model import CameraSetup, Container, Rag, Scene, Surface, SymbolThresholds

Places = NDArray[np.float64]

HEIGHT, FOCAL, WIDTH_PX, HEIGHT_PX = 0.9, 525.0, 640, 480
RADIUS = 0.003
LENTIL = np.array([92.0, 70.0, 38.0])
FLOOR = np.array([228.0, 228.0, 224.0])


def scene(edge: str = "east", offset: float = 0.0, link: float = 0.035) -> Scene:
    """A table of 90 x 70 cm under a camera 0.9 m up."""
    return Scene(
        name="synthetic",
        surface=Surface(0.9, 0.7, 0.45, (205, 198, 184)),
        container=Container(edge, offset, 0.32, 0.16),
        robot="gantry",
        rag=Rag(WIDE, 0.12),
        camera=CameraSetup(HEIGHT, WIDTH_PX, HEIGHT_PX, FOCAL),
        dirt=(),
        symbols=SymbolThresholds(link, small=0.05, medium=0.10, density=0.3, near=0.20, traversal=0.06),
        seed=1,
    )


@dataclass(frozen=True)
class Box:
    """Something standing on the table: low and high corner (x, y), height and colour."""

    low: tuple[float, float]
    high: tuple[float, float]
    height: float
    colour: tuple[int, int, int] = (40, 90, 200)


def camera() -> Camera:
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = HEIGHT
    return Camera(WIDTH_PX, HEIGHT_PX, FOCAL, (320.0, 239.0), pose)


def frame(
    lentils: Places,
    seed: int,
    tilt: tuple[float, float] = (0.0, 0.0),
    light: float = 0.0,
    boxes: Sequence[Box] = (),
    colour: tuple[int, int, int] = (205, 198, 184),
    noise: bool = True,
) -> Frame:
    """The table, whose height is tilt · (x, y), lit by 1 + `light` * x, with `lentils` (n, 2) on it."""
    rng = np.random.default_rng(seed)
    columns, rows = np.meshgrid(np.arange(WIDTH_PX, dtype=float), np.arange(HEIGHT_PX, dtype=float))
    x, y, depth = _meet(columns, rows, tilt)
    image = np.broadcast_to(np.array(colour, float), (*depth.shape, 3)).copy()
    for lentil in lentils:
        _draw_lentil(image, lentil, tilt)
    image *= (1 + light * x)[:, :, None]
    floor = (np.abs(x) > 0.45) | (np.abs(y) > 0.35)
    depth = np.where(floor, HEIGHT + 0.7, depth)
    image[floor] = FLOOR
    for box in boxes:
        top = HEIGHT - box.height
        at_x, at_y = (columns - 320) / FOCAL * top, -(rows - 239) / FOCAL * top
        inside = (box.low[0] < at_x) & (at_x < box.high[0]) & (box.low[1] < at_y) & (at_y < box.high[1])
        depth[inside], image[inside] = top, box.colour
    if noise:
        depth = np.round((depth + rng.normal(0, 0.0012, depth.shape)) / 0.0023) * 0.0023
        image = image + rng.normal(0, 3, image.shape)
    return Frame(
        np.clip(np.round(image), 0, 255).astype(np.uint8), depth.astype(np.float32), camera(), clock=0.0
    )


def grouped(rng: np.random.Generator, count: int, centre: tuple[float, float], radius: float) -> Places:
    """Lentils that touch no other, within `radius` of `centre`."""
    return _spread(rng, count, lambda: np.array(centre) + radius * rng.uniform(-1, 1, 2))


def scattered(rng: np.random.Generator, count: int) -> Places:
    return _spread(rng, count, lambda: rng.uniform((-0.28, -0.28), (0.28, 0.28)))


def _spread(rng: np.random.Generator, count: int, draw: Callable[[], Places]) -> Places:
    places: list[NDArray[np.float64]] = []
    while len(places) < count:
        place = draw()
        if all(np.hypot(*(place - other)) > 2.2 * RADIUS for other in places):
            places.append(place)
    return np.array(places)


def _meet(columns: Places, rows: Places, tilt: tuple[float, float]) -> tuple[Places, Places, Places]:
    """x, y and depth where rays through pixels meet the table."""
    east, north = (columns - 320) / FOCAL, -(rows - 239) / FOCAL
    depth = HEIGHT / (1 + tilt[0] * east + tilt[1] * north)
    return east * depth, north * depth, depth


def _draw_lentil(image: Places, lentil: Places, tilt: tuple[float, float]) -> None:
    """Blend a disc in, by the share of 8 x 8 points of each pixel that it covers."""
    depth = HEIGHT - tilt[0] * lentil[0] - tilt[1] * lentil[1]
    column, row = 320 + lentil[0] / depth * FOCAL, 239 - lentil[1] / depth * FOCAL
    left, top = int(column) - 4, int(row) - 4
    points = (np.arange(80) + 0.5) / 8 - 0.5
    x, y, _ = _meet(*np.meshgrid(left + points, top + points), tilt)
    covered = np.hypot(x - lentil[0], y - lentil[1]) < RADIUS
    share = covered.reshape(10, 8, 10, 8).mean(axis=(1, 3))[:, :, None]
    patch = image[top : top + 10, left : left + 10]
    patch[:] = (1 - share) * patch + share * LENTIL
