"""The folder of a series: series.json, and a run folder for each episode (docs/runs.md); maybe anybody's."""

from __future__ import annotations

import itertools
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta

from cleancli.files.replace import replace_file
from cleancli.files.untrusted import decoded
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.recording.folder import RUN, read_text, refused

SERIES = "series.json"

FORMAT = 1
"""Of series.json."""

LARGEST = 1 << 16
"""Bytes of series.json. Chosen: it has a few numbers."""

MOST_EPISODES = 10_000
"""Of one series."""


@dataclass(frozen=True, slots=True)
class SeriesHeader:
    """What a series was begun for: so many episodes, the first with this seed; whether they are filmed, and
    whether what is learned is written into the domain's file after each. `called`: the folder's path as it
    was when the series began, by which that file names its records."""

    episodes: Annotated[int, Meta(ge=1, le=MOST_EPISODES)]
    seed: Annotated[int, Meta(ge=0)]
    video: bool
    writes: bool
    called: str
    format: Annotated[int, Meta(ge=1, le=FORMAT)] = FORMAT


def begun_series(
    parent: Path, stem: str, episodes: int, seed: int, video: bool, writes: bool
) -> tuple[Path, SeriesHeader]:
    """A new folder under a name after `stem`, numbered so that nothing is overwritten. Raises OSError."""
    parent.mkdir(parents=True, exist_ok=True)
    for number in itertools.count(1):
        folder = parent / f"{stem}-{number:03d}"
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        break
    header = SeriesHeader(episodes, seed, video, writes, printable(str(folder)))
    replace_file(folder / SERIES, msgspec.json.format(msgspec.json.encode(asdict(header))).decode() + "\n")
    return folder, header


def remove_if_empty(folder: Path) -> None:
    """Remove the folder of a series none of whose episodes was begun: it would tell nothing."""
    if {entry.name for entry in os.scandir(folder)} == {SERIES}:
        (folder / SERIES).unlink()
        folder.rmdir()


def is_series(folder: Path) -> bool:
    """Whether it is the folder of a series."""
    return (folder / SERIES).is_file()


def to_go_on_from(run: Path) -> Path:
    """What a run that was cut short is gone on with by: the folder of its series, or its own."""
    return run.parent if is_series(run.parent) else run


def read_header(folder: Path) -> SeriesHeader:
    """The series.json of a folder. Raises Refused (E705), OSError."""
    return decoded(read_text(folder, SERIES, LARGEST), SeriesHeader, "E705", "record of a series")


def run_folders(folder: Path) -> tuple[Path, ...]:
    """The run folders in that of a series, by their names. Raises Refused (E705) for links, OSError."""
    found = []
    for entry in sorted(os.scandir(folder), key=lambda entry: entry.name):
        if entry.is_symlink():
            raise refused(Path(entry.path), "it is a link")
        if entry.is_dir() and (folder / entry.name / RUN).exists():
            found.append(folder / entry.name)
    return tuple(found)
