"""Pictures of a printed board on a table whose truth is known, drawn by a homography from the board's raster,
without any of perception's own geometry: what a camera with noise, blur and a lens sees."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, radians, sin

import cv2
import numpy as np
from numpy.typing import NDArray

from cleancli.cell.board import Board, raster
from cleancli.cell.camera import Laid
from cleancli.geometry.rgbd import Camera, Frame
from cleancli.perception.lens import lens, rectified

Array = NDArray[np.float64]

WIDTH, HEIGHT, FOCAL = 640, 480, 525.0
FINER = 4
"""Samples to a pixel's side."""
MODULE = 12
"""Pixels to a module of the board's texture."""
MARGIN = 2 * MODULE
"""White paper around the board, in the texture's pixels."""
DARK, LIGHT = 35.0, 215.0


@dataclass(frozen=True)
class Optics:
    """`blur` in pixels, noise of `colour` (of 255) and of `depth` (metres at one metre), the share by which
    all depth is too large (`bias`), plumb bob `distortion`, and the share of the board's width that something
    lies on (`covered`)."""

    blur: float = 0.7
    colour: float = 4.0
    depth: float = 0.0014
    bias: float = 0.0
    distortion: tuple[float, ...] = ()
    covered: float = 0.0


def looking(height: float, slant: float = 0.0, towards: float = 0.0, yaw: float = 0.0) -> Array:
    """The pose (4, 4) of a camera that looks at the surface's middle from `height` metres above it, turned by
    `yaw` and then `slant`ed towards a direction, in degrees: where all are 0, the picture's x is east."""
    down = np.diag([1.0, -1.0, -1.0])
    axis = np.array([-sin(radians(towards)), cos(radians(towards)), 0.0])
    tilt, turn = (
        np.asarray(cv2.Rodrigues(vector)[0], np.float64)
        for vector in (radians(slant) * axis, radians(yaw) * np.array([0.0, 0.0, 1.0]))
    )
    pose = np.eye(4)
    pose[:3, :3] = tilt @ turn @ down
    pose[:3, 3] = height / pose[2, 2] * pose[:3, 2]
    return pose


def picture(
    board: Board, laid: Laid, pose: Array, rng: np.random.Generator, optics: Optics = Optics(), scale: int = 1
) -> Frame:
    """One frame of a camera whose place is not told; `scale` makes the picture so many times larger. The lens
    is rectified as recordings are read."""
    width, height, focal = scale * WIDTH, scale * HEIGHT, scale * FOCAL
    inner = np.array([[focal, 0, width / 2 + 3.3], [0, focal, height / 2 - 2.1], [0, 0, 1.0]])
    grey = _grey(board, laid, pose, inner, (width, height), optics)
    noisy = grey[:, :, None] + rng.normal(0, optics.colour, (height, width, 3))
    away = _depth(pose, inner, (width, height))
    away = away * (1 + optics.bias) + optics.depth * away**2 * rng.normal(size=away.shape)
    colour = np.clip(np.round(noisy), 0, 255).astype(np.uint8)
    camera = Camera(width, height, focal, (float(inner[0, 2]), float(inner[1, 2])), np.eye(4), located=False)
    return _rectified(Frame(colour, away.astype(np.float32), camera, 0.0), optics)


def errors(found: Array, truth: Array) -> tuple[float, float]:
    """By how many millimetres and degrees a pose (4, 4) is off."""
    turned = found[:3, :3].T @ truth[:3, :3]
    angle = np.degrees(np.arccos(np.clip((np.trace(turned) - 1) / 2, -1, 1)))
    return 1000 * float(np.linalg.norm(found[:3, 3] - truth[:3, 3])), float(angle)


def _grey(
    board: Board, laid: Laid, pose: Array, inner: Array, size: tuple[int, int], optics: Optics
) -> Array:
    texture = np.kron(raster(board) > 0, np.ones((MODULE, MODULE))) * (LIGHT - DARK) + DARK
    if optics.covered:
        texture[:, : int(optics.covered * texture.shape[1])] = 0.6 * LIGHT
    texture = np.pad(texture, MARGIN, constant_values=LIGHT)
    to_camera = np.linalg.inv(pose)
    on_surface = inner @ to_camera[:3, [0, 1, 3]]
    # Whole numbers are the middles of the texture's pixels; the board's middle is that of the texture.
    side = laid.bar / 0.2 * board.square / 8 / MODULE
    turned = np.array([[cos(laid.turn), -sin(laid.turn)], [sin(laid.turn), cos(laid.turn)]])
    middle = (np.array(texture.shape[::-1]) - 1) / 2
    to_place = np.eye(3)
    to_place[:2, :2] = side * turned @ np.diag([1.0, -1.0])
    to_place[:2, 2] = np.array(laid.at) - to_place[:2, :2] @ middle
    finer = np.array([[FINER, 0, (FINER - 1) / 2], [0, FINER, (FINER - 1) / 2], [0, 0, 1.0]])
    large = cv2.warpPerspective(
        texture.astype(np.float32),
        finer @ on_surface @ to_place,
        (FINER * size[0], FINER * size[1]),
        borderValue=0.8 * LIGHT,
    )
    sharp = cv2.resize(large, size, interpolation=cv2.INTER_AREA)
    if any(optics.distortion):
        across, along = _bent(inner, size, optics)
        sharp = cv2.remap(sharp, across, along, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    blurred = cv2.GaussianBlur(sharp, (0, 0), optics.blur) if optics.blur else sharp
    return np.asarray(blurred, np.float64)


def _bent(
    inner: Array, size: tuple[int, int], optics: Optics
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Where in a straight picture each pixel of the bent one looks, columns and rows."""
    columns, rows = np.meshgrid(np.arange(size[0], dtype=float), np.arange(size[1], dtype=float))
    pixels = np.column_stack([columns.ravel(), rows.ravel()])[:, None, :]
    straight = cv2.undistortPoints(pixels, inner, np.array(optics.distortion), P=inner).reshape(-1, 2)
    across, along = straight.astype(np.float32).T
    return across.reshape(size[::-1]), along.reshape(size[::-1])


def _depth(pose: Array, inner: Array, size: tuple[int, int]) -> Array:
    """Metres along the axis to z = 0, which a lens that bends is taken to have as well."""
    columns, rows = np.meshgrid(np.arange(size[0], dtype=float), np.arange(size[1], dtype=float))
    east, south = (columns - inner[0, 2]) / inner[0, 0], (rows - inner[1, 2]) / inner[1, 1]
    down = pose[2, 0] * east + pose[2, 1] * south + pose[2, 2]
    return np.asarray(-pose[2, 3] / down)


def _rectified(frame: Frame, optics: Optics) -> Frame:
    if not any(optics.distortion):
        return frame
    camera = frame.camera
    seen_through = lens((camera.focal, camera.focal), camera.centre, "plumb_bob", optics.distortion)
    colour, _ = rectified(frame.colour, frame.depth, seen_through)
    return replace(frame, colour=colour)
