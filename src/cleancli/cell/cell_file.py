"""`cell.json`: where a cell's camera stands over the surface, and where its robot finds it.

Drivers read it as well, in whatever language: docs/cell.md says what its keys mean.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import msgspec
import numpy as np

from cleancli.array_types import Floats
from cleancli.files.plain import read_plain
from cleancli.geometry.rgbd import Frame
from cleancli.perception.camera_file import is_rigid

FORMAT = "cleancli cell 1"
"""What the file's key `format` says; another number means other keys."""
LARGEST_CELL = 1 << 20
"""Bytes."""
FARTHEST_PLACE = 100.0
"""Metres: what is farther away is no place in a cell."""

Row = tuple[float, float, float, float]
Matrix = tuple[Row, Row, Row, Row]
"""A pose: a rotation and a place in metres, its last row 0 0 0 1."""


class BadCell(Exception):
    """A file that describes no cell; the message says what is wrong in it."""


@dataclass(frozen=True, slots=True)
class CameraPlace:
    """`pose` leads from the camera's coordinates (x right, y down, z forward) to the scene's; corners of the
    board were `misfit` pixels off on average."""

    pose: Matrix
    misfit: float


@dataclass(frozen=True, slots=True)
class TablePlace:
    """`pose` leads from the scene's coordinates to those in which the robot tells where its tool is; places
    that were touched lay `spread` metres off the plane (standard deviation), None where it is not known."""

    pose: Matrix
    spread: float | None


@dataclass(frozen=True, slots=True)
class Cell:
    """What is known of a cell."""

    camera: CameraPlace | None = None
    table: TablePlace | None = None


def as_text(cell: Cell) -> str:
    """The file's text, JSON."""
    parts = {name: part for name, part in asdict(cell).items() if part is not None}
    return json.dumps({"format": FORMAT} | parts, indent=2) + "\n"


def read_cell(path: Path) -> Cell:
    """Raises OSError, and BadCell, whose message names the file."""
    try:
        return decode(read_plain(path, LARGEST_CELL))
    except BadCell as error:
        raise BadCell(f"{path}: {error}") from None


class _File(msgspec.Struct, forbid_unknown_fields=True):
    format: str
    camera: CameraPlace | None = None
    table: TablePlace | None = None


def decode(content: bytes) -> Cell:
    """The cell that a file's bytes describe. Raises BadCell."""
    try:
        read = msgspec.json.decode(content.decode("utf-8"), type=_File)
    except RecursionError:
        raise BadCell("it is nested too deeply") from None
    except msgspec.ValidationError as error:
        raise BadCell(f"it describes no cell ({error})") from error
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise BadCell("it is no JSON") from error
    if read.format != FORMAT:
        raise BadCell(f'its `format` is not "{FORMAT}"')
    for name, part in (("camera", read.camera), ("table", read.table)):
        if part is not None and not _is_possible(np.array(part.pose)):
            raise BadCell(
                f"the `pose` of its `{name}` must be a rotation and a place in metres, its last row 0 0 0 1"
            )
    return Cell(read.camera, read.table)


def matrix(pose: Floats) -> Matrix:
    """A pose (4, 4) as files keep it."""
    first, second, third, fourth = ((float(a), float(b), float(c), float(d)) for a, b, c, d in pose)
    return first, second, third, fourth


def placed(frames: Sequence[Frame], cell: Cell) -> tuple[Frame, ...]:
    """Frames whose camera stands where the cell says, unless they tell it themselves."""
    if cell.camera is None:
        return tuple(frames)
    pose = np.array(cell.camera.pose)
    return tuple(
        frame
        if frame.camera.located
        else replace(frame, camera=replace(frame.camera, pose=pose, located=True))
        for frame in frames
    )


def _is_possible(pose: Floats) -> bool:
    return is_rigid(pose) and bool(np.abs(pose[:3, 3]).max() <= FARTHEST_PLACE)
