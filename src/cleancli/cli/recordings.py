"""Recorded frames as commands take them: what is left out is told, and so is a part that is missing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cleancli.cell.cell_file import BadCell, Cell, placed, read_cell
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import MissingPart
from cleancli.cli.progress import working
from cleancli.geometry.rgbd import Frame
from cleancli.perception.bag_file import MissingBags
from cleancli.perception.frame_source import BadRecording
from cleancli.perception.reading import Reading
from cleancli.perception.rerun_file import MissingRerun, find_rerun
from cleancli.perception.sources import recorded_frames, recorded_looks


def open_looks(
    path: Path, reading: Reading
) -> tuple[Iterator[tuple[str, tuple[Frame, ...]]], tuple[str, ...]]:
    """The looks of a recording, each with where it comes from, and what is left out. Raises MissingPart,
    OSError."""
    cell = cell_of(reading)
    with _opening(path):
        found, notes = recorded_looks(path, reading)
    _warn(notes)
    return ((name, placed(frames, cell)) for name, frames in found), notes


def open_frames(path: Path, reading: Reading, count: int) -> tuple[Frame, ...]:
    """Frames of a surface that does not change. Raises MissingPart, OSError."""
    cell = cell_of(reading)
    with _opening(path):
        found, notes = recorded_frames(path, reading, count)
    _warn(notes)
    return placed(found, cell)


def cell_of(reading: Reading) -> Cell:
    """What is known of the cell that a recording is of. Raises OSError."""
    if reading.cell is None:
        return Cell()
    try:
        return read_cell(reading.cell)
    except BadCell as error:
        raise BadRecording(str(error)) from None


def refuse_without_rerun() -> None:
    """Before the work, and not after it. Raises MissingPart."""
    try:
        find_rerun()
    except MissingRerun as error:
        raise MissingPart(str(error)) from error


@contextmanager
def _opening(path: Path) -> Iterator[None]:
    try:
        with working(f"reading {path}"):
            yield
    except MissingBags as error:
        raise MissingPart(str(error)) from error


def _warn(notes: tuple[str, ...]) -> None:
    for note in notes:
        echo(f"warning: {note}", err=True)
