"""What a path of recorded frames leads to: folders of our own, the TUM layout, bags of ROS."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from cleancli.files.numbered import by_numbers
from cleancli.geometry.rgbd import Frame
from cleancli.perception.bag_file import KINDS, files_of
from cleancli.perception.bags import open_bag
from cleancli.perception.camera_file import CAMERA
from cleancli.perception.frame_source import BadRecording, FrameSource, looks, spread
from cleancli.perception.reading import Reading
from cleancli.perception.recorded import load_frames
from cleancli.perception.tum import is_tum, open_tum

OF_BAGS = {
    "frame": "--frame",
    "colour_topic": "--colour-topic",
    "depth_topic": "--depth-topic",
    "info_topic": "--info-topic",
}
"""What of a `Reading` makes sense of bags alone, and the options that say it."""


def is_recording(path: Path) -> bool:
    """Whether frames may be read from there: a folder, or what is named as the file of a bag."""
    return path.is_dir() or path.suffix in KINDS


def recorded_looks(
    path: Path, reading: Reading
) -> tuple[Iterator[tuple[str, tuple[Frame, ...]]], tuple[str, ...]]:
    """The looks of a recording, each with where it comes from, and notes of what is left out. Raises
    MissingBags, OSError."""
    source = _source(path, reading)
    if source is None:
        return _own_looks(path), ()
    return ((str(path), look) for look in looks(source, reading.every)), source.notes


def recorded_frames(path: Path, reading: Reading, count: int) -> tuple[tuple[Frame, ...], tuple[str, ...]]:
    """All frames of a folder of our own, or `count` of another recording, spread evenly; and notes. Raises
    MissingBags, OSError."""
    source = _source(path, reading)
    if source is None:
        return load_frames(path), ()
    return spread(source, count), source.notes


def _source(path: Path, reading: Reading) -> FrameSource | None:
    """None where frames lie as we write them."""
    if not is_recording(path):
        raise BadRecording(f"{path}: no recording: neither a folder nor a bag ({', '.join(KINDS)})")
    if files_of(path) and not is_tum(path) and not (path / CAMERA).exists():
        return open_bag(path, reading)
    for field, option in OF_BAGS.items():
        if getattr(reading, field) is not None:
            raise BadRecording(f"{path}: `{option}` is for bags of ROS, and this is none")
    return open_tum(path, reading) if is_tum(path) else None


def _own_looks(folder: Path) -> Iterator[tuple[str, tuple[Frame, ...]]]:
    """In the order of their names."""
    if (folder / CAMERA).exists():
        yield str(folder), load_frames(folder)
        return
    found = sorted((path.parent for path in folder.glob(f"*/{CAMERA}")), key=by_numbers)
    if not found:
        raise BadRecording(
            f"{folder}: no recording: neither {CAMERA} nor a folder with one, no rgb.txt, "
            f"no {', '.join(KINDS)}"
        )
    for look in found:
        yield str(look), load_frames(look)
