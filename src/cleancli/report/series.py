"""A series as its folder tells it: what it was begun for, and its episodes as far as they have come."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cleancli.recording.folder import refused
from cleancli.recording.series import SeriesHeader, read_header, run_folders
from cleancli.report.run import Run, read_run


@dataclass(frozen=True, slots=True)
class Series:
    """The folder of a series; `runs`, at least one, are in the order of their seeds, which is that of the
    episodes."""

    folder: Path
    header: SeriesHeader
    runs: tuple[Run, ...]

    @property
    def name(self) -> str:
        """The folder's name."""
        return self.folder.resolve().name


def read_series(folder: Path) -> Series:
    """The series in a folder, which may be anybody's. Raises what `read_header` and `read_run` do, and
    Refused (E705) where no episode has begun."""
    header = read_header(folder)
    runs = sorted(map(read_run, run_folders(folder)), key=lambda run: (run.header.seed, run.name))
    if not runs:
        raise refused(folder, "no episode has begun", "start a new series")
    return Series(folder, header, tuple(runs))
