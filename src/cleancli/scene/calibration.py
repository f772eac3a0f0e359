"""What `cleancli calibrate` found out about a surface in its light (§3.1), and the file that keeps it."""

from __future__ import annotations

import json
from base64 import b64encode
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Annotated, Any

import msgspec
from msgspec import structs

from cleancli.files.plain import read_plain
from cleancli.files.untrusted import is_whole_png

FORMAT = "cleancli calibration 2"
"""What the file's key `format` says; another number means other keys."""

LARGEST = 32 << 20
"""Bytes of such a file."""


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Everything that perception compares with, in units that no camera changes (docs/perception.md).

    The defaults are used where there is no calibration. Lengths in metres, areas in square metres.
    """

    tolerance: float = 0.010
    """Distance from the plane up to which a point belongs to it, for a point one metre away; it grows with
    the square of the distance, as the noise of depth does. Over six times that noise."""
    heap: float = 0.015
    """Height above the plane up to which a point still belongs to it: dirt lies in heaps."""
    surface_edge: int = 2
    """Pixels beside the surface's outline whose colour may be another thing's."""
    object_edge: int = 8
    """Pixels around what stands on the surface whose colour may be that thing's."""
    gradient: float = 0.045
    """Change of colour from one pixel to the next, as a share of the brightness, below which a region grows
    on."""
    darkest: float = 100.0
    """Brightness, of 255, that darker places count as having, for `gradient` and `contrast`: the noise of a
    camera does not become less with the light, so that its share of the brightness grows."""
    background: float = 1.2e-3
    """Area above which a region is background."""
    contrast: float = 0.10
    """A pixel whose colour differs from that of the background around it by a smaller share of the brightness
    belongs to it."""
    patch: float = 3.5e-6
    """Area below which a patch is no dirt: a third of a grain of rice."""
    agreement: float = 2 / 3
    """The share of the frames showing a pixel in which it must be dirty to be believed so."""


@dataclass(frozen=True, slots=True)
class Appearance:
    """How the clean surface looked, to tell when it does no longer.

    `colours`: mean red, green and blue, 0 to 255, of equal parts of the surface: `rows` from south to north,
    of `columns` from west to east each; 0 where it was hidden. `tilt`: angle in radians between the camera's
    axis and the surface's normal.
    """

    columns: int
    rows: int
    colours: tuple[tuple[float, float, float], ...]
    tilt: float


@dataclass(frozen=True, slots=True)
class Reference:
    """A picture of the clean surface (PNG), and the thresholds to use where it takes the texture away."""

    thresholds: Thresholds
    picture: bytes = field(repr=False)


@dataclass(frozen=True, slots=True)
class Calibration:
    """`path` as the scene writes it, the thresholds to use, what the surface looked like, and a picture of
    it, if there is one."""

    path: str
    thresholds: Thresholds
    appearance: Appearance
    reference: Reference | None = None


class BadCalibration(Exception):
    """A file that is no calibration; the message says what is wrong in it."""


def as_text(calibration: Calibration) -> str:
    """The file's text, JSON."""
    described: dict[str, Any] = {"format": FORMAT} | {
        part: asdict(getattr(calibration, part)) for part in ("thresholds", "appearance")
    }
    kept = calibration.reference
    if kept is not None:
        picture = b64encode(kept.picture).decode("ascii")
        described["reference"] = {"thresholds": asdict(kept.thresholds), "picture": picture}
    return json.dumps(described, indent=2) + "\n"


def read_calibration(file: Path, path: str) -> Calibration:
    """The calibration in a file that goes by the name `path`. Raises OSError and BadCalibration."""
    return decode(file_content(file), path)


def file_content(file: Path) -> bytes:
    """The bytes of a calibration's file. Raises OSError."""
    return read_plain(file, LARGEST)


class _Appearance(msgspec.Struct):
    columns: Annotated[int, msgspec.Meta(gt=0)]
    rows: Annotated[int, msgspec.Meta(gt=0)]
    colours: tuple[tuple[float, float, float], ...]
    tilt: float


_PIXELS, _AMOUNT = Annotated[int, msgspec.Meta(ge=0, le=100)], Annotated[float, msgspec.Meta(ge=0)]
_Thresholds = msgspec.defstruct(
    "_Thresholds",
    [(each.name, _PIXELS if isinstance(each.default, int) else _AMOUNT) for each in fields(Thresholds)],
)
"""All thresholds: what a file leaves out is not taken to be as usual."""


class _Reference(msgspec.Struct):
    thresholds: _Thresholds  # type: ignore[valid-type]  # mypy knows no types that are made while running
    picture: bytes


class _File(msgspec.Struct):
    format: str
    thresholds: _Thresholds  # type: ignore[valid-type]
    appearance: _Appearance
    reference: _Reference | None = None


def decode(content: bytes, path: str) -> Calibration:
    """The calibration that a file's bytes describe. Raises BadCalibration."""
    try:
        read = msgspec.json.decode(content.decode("utf-8"), type=_File)
    except RecursionError:
        raise BadCalibration("it is nested too deeply") from None
    except msgspec.ValidationError as error:
        raise BadCalibration(str(error)) from error
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise BadCalibration("it is no JSON") from error
    if read.format != FORMAT:
        raise BadCalibration(f'its `format` is not "{FORMAT}"')
    looked = read.appearance
    if len(looked.colours) != looked.columns * looked.rows:
        raise BadCalibration(f"`colours` must list {looked.columns * looked.rows} colours")
    appearance = Appearance(looked.columns, looked.rows, looked.colours, looked.tilt)
    kept = read.reference
    if kept is not None and not is_whole_png(kept.picture):
        raise BadCalibration("the `picture` of its `reference` is no PNG picture")
    picture = None if kept is None else Reference(_read(kept.thresholds), kept.picture)
    return Calibration(path, _read(read.thresholds), appearance, picture)


def _read(thresholds: msgspec.Struct) -> Thresholds:
    return Thresholds(**structs.asdict(thresholds))
