"""Recorded frames as commands take them: what is left out is told, and so is a part that is missing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import MissingPart
from cleancli.cli.progress import working
from cleancli.geometry.rgbd import Frame
from cleancli.perception.bag_file import MissingBags
from cleancli.perception.reading import Reading
from cleancli.perception.rerun_file import MissingRerun, find_rerun
from cleancli.perception.sources import recorded_frames, recorded_looks


def open_looks(
    path: Path, reading: Reading
) -> tuple[Iterator[tuple[str, tuple[Frame, ...]]], tuple[str, ...]]:
    """The looks of a recording, each with where it comes from, and what is left out. Raises MissingPart,
    OSError."""
    with _opening(path):
        found, notes = recorded_looks(path, reading)
    _warn(notes)
    return found, notes


def open_frames(path: Path, reading: Reading, count: int) -> tuple[Frame, ...]:
    """Frames of a clean surface. Raises MissingPart, OSError."""
    with _opening(path):
        found, notes = recorded_frames(path, reading, count)
    _warn(notes)
    return found


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
