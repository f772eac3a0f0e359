"""Where the camera stands over the surface, by a printed board that lies on it.

The frames are rectified, as all that perception knows. Colour tells where the board's corners are, and depth
how far away the plane is and how it slants: of a board that is seen from straight above, a tenth of a pixel
of its corners is a third of a degree of slant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, sin

import cv2
import numpy as np

from cleancli.array_types import Floats, Longs, Points
from cleancli.cell.board import BAR, Board
from cleancli.cell.corners import LEAST_CORNERS, Corners, corners_in
from cleancli.cell.plane_fit import fitted
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception import geometry
from cleancli.perception.geometry import Plane
from cleancli.perception.surface import LEAST_POINTS, largest_plane
from cleancli.scene.calibration import Thresholds

MOST_SCALE = 0.015
"""Share by which depth may show the board larger or smaller than it was printed; chosen. Cameras' depth is up
to about a hundredth off, and a sheet that is fitted to the page is printed 3 to 6 hundredths too small."""
MOST_MISFIT = 1.0
"""Pixels that corners may be off on average; chosen. With a lens that is known it is a tenth of one."""
MOST_WANDER = 2.0
"""Pixels by which a corner may move from picture to picture."""

_EAST = np.array([1.0, 0.0, 0.0])


class NoBoard(Exception):
    """Pictures that do not tell where the camera stands; the message is a sentence about them."""


@dataclass(frozen=True, slots=True)
class Laid:
    """How the board lies on the surface: the place of its middle in the scene, metres, and by how much it is
    turned, radians counter-clockwise; `bar` is what the bar on it measures, metres."""

    at: tuple[float, float] = (0.0, 0.0)
    turn: float = 0.0
    bar: float = BAR

    def places(self, board: Board, numbers: Longs) -> Points:
        """Where corners lie in the scene, (n, 2), metres."""
        turned = np.array([[cos(self.turn), sin(self.turn)], [-sin(self.turn), cos(self.turn)]])
        places: Points = self.bar / BAR * board.places[numbers] @ turned + np.array(self.at)
        return places


@dataclass(frozen=True, slots=True)
class Sighted:
    """Where the camera stands by a board.

    `pose` (4, 4) maps the camera's coordinates to the scene's. `misfit`: by how many pixels the `corners` of
    all pictures are off on average where the camera stands so. `depth_scale`: how much larger the board was
    printed than depth shows it, and `points` of depth that tell the plane; None and 0 where depth is not
    known, and colour alone tells the pose. `doubts` say in words what speaks against it.
    """

    pose: Floats
    board: Board
    corners: int
    pictures: int
    misfit: float
    depth_scale: float | None
    points: int
    doubts: tuple[str, ...]


def sighted(frames: Sequence[Frame], laid: Laid, rng: np.random.Generator) -> Sighted:
    """Where the camera of `frames` stands, which stands still as the board does. Frames that do not show
    enough of it count for nothing. Raises NoBoard. `rng` draws RANSAC's triples."""
    camera = replace(frames[0].camera, pose=np.eye(4), located=False)
    if any(replace(frame.camera, pose=camera.pose, located=False) != camera for frame in frames):
        raise NoBoard("they were taken by different cameras")
    seen = [(frame, each) for frame in frames if (each := corners_in(frame.colour)) is not None]
    if not seen:
        raise NoBoard(
            f"no picture shows {LEAST_CORNERS} corners of a board that `cleancli cell board` writes, in "
            "several rows: is all of it in view, flat, sharp and without glare, and large enough, 3 pixels "
            "to a sixth of a marker's side?"
        )
    board = seen[0][1].board
    if any(corners.board != board for _, corners in seen):
        raise NoBoard("they show different boards")
    wandered = _wander([corners for _, corners in seen])
    if wandered > MOST_WANDER:
        raise NoBoard(f"the board moves by {wandered:.0f} pixels from picture to picture")
    numbers = np.concatenate([corners.numbers for _, corners in seen])
    pixels = np.concatenate([corners.pixels for _, corners in seen])
    places = laid.places(board, numbers)
    by_colour = _pose_by_colour(camera, places, pixels)
    plane, points = _plane_by_depth([frame for frame, _ in seen], camera, pixels, by_colour, rng)
    pose, scale = by_colour, None
    if plane is not None:
        found = fitted(geometry.on_plane(camera, plane, pixels), places)
        pose, scale = found.pose @ np.linalg.inv(plane.pose), found.scale
    misfit = _misfit(replace(camera, pose=pose), places, pixels)
    doubts = _doubts(misfit, scale)
    return Sighted(pose, board, len(pixels), len(seen), misfit, scale, points, doubts)


def _wander(seen: Sequence[Corners]) -> float:
    """By how many pixels a corner moves at most, from the first picture that shows it to any other."""
    first: dict[int, Floats] = {}
    moved = 0.0
    for corners in seen:
        for number, pixel in zip(corners.numbers.tolist(), corners.pixels, strict=True):
            moved = max(moved, float(np.linalg.norm(pixel - first.setdefault(number, pixel))))
    return moved


def _pose_by_colour(camera: Camera, places: Points, pixels: Points) -> Floats:
    """The camera's pose (4, 4) in the scene by the places (n, 2) that pixels (n, 2) show: of the two that a
    plane allows (IPPE, Collins and Bartoli 2014) the one that fits better, refined by Levenberg and
    Marquardt."""
    flat = np.column_stack([places, np.zeros(len(places))])
    matrix = np.array(
        [[camera.focal, 0, camera.centre[0]], [0, camera.focal, camera.centre[1]], [0, 0, 1]], np.float64
    )
    _, turns, shifts, _ = cv2.solvePnPGeneric(flat, pixels, matrix, None, flags=cv2.SOLVEPNP_IPPE)
    turn, shift = cv2.solvePnPRefineLM(flat, pixels, matrix, None, turns[0], shifts[0])
    to_camera = np.eye(4)
    to_camera[:3, :3], to_camera[:3, 3] = cv2.Rodrigues(turn)[0], np.ravel(shift)
    return np.asarray(np.linalg.inv(to_camera), np.float64)


def _plane_by_depth(
    frames: Sequence[Frame], camera: Camera, pixels: Points, by_colour: Floats, rng: np.random.Generator
) -> tuple[Plane | None, int]:
    """The plane in the camera's coordinates that depth shows behind the board, and how many points tell it;
    None where fewer than `LEAST_POINTS` are known, or most of them lie on no plane."""
    hull = cv2.convexHull(pixels.astype(np.float32)).astype(np.int32)
    inside = cv2.fillConvexPoly(np.zeros((camera.height, camera.width), np.uint8), hull, 1)
    rows, columns = np.nonzero(inside)
    depth = np.stack([frame.depth[rows, columns] for frame in frames])
    depth = np.where(np.isfinite(depth) & (depth > 0), depth, np.nan)
    known = ~np.isnan(depth).all(axis=0)
    if known.sum() < LEAST_POINTS:
        return None, 0
    at = np.column_stack([columns, rows])[known].astype(np.float64)
    # The mean of what is known: each picture has its own noise, and a median would keep the steps of depth.
    away = np.nanmean(depth[:, known], axis=0)
    points = away[:, None] * geometry.rays(camera, at)
    normal, offset, close = largest_plane(points, np.zeros(3), Thresholds().tolerance, rng)
    if close.mean() < 0.5:
        return None, 0
    # Any direction within the plane does for x: the corners tell it.
    along = by_colour[:3, :3].T @ _EAST
    return Plane.below(normal * offset, normal, offset, along), int(close.sum())


def _misfit(camera: Camera, places: Points, pixels: Points) -> float:
    """Root of the mean squared distance of pixels (n, 2) from those that should show `places` (n, 2)."""
    off = geometry.project(camera, places) - pixels
    return float(np.sqrt((off**2).sum(axis=1).mean()))


def _doubts(misfit: float, scale: float | None) -> tuple[str, ...]:
    found = []
    if scale is None:
        found.append(
            "the depth of the board is not known: colour alone tells how high the camera stands and how it "
            "slants, which it does worse"
        )
    elif abs(scale - 1) > MOST_SCALE:
        way = "smaller" if scale > 1 else "larger"
        found.append(
            f"depth shows the board {abs(1 / scale - 1):.1%} {way} than it was printed: does the bar on it "
            "measure what is said (`--bar`), and are the focal length and the unit of depth right?"
        )
    elif misfit > MOST_MISFIT:  # as it is of a board of another size as well
        found.append(
            f"corners are {misfit:.1f} pixels off on average: does the board lie flat, and is the camera's "
            "lens described rightly?"
        )
    return tuple(found)
