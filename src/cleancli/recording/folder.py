"""A run's folder as something that others may have changed: what is read of it, and how much.

Nothing is read or written through a link, and nothing outside the folder. Whoever changes it while it is
being read is not met here: `cleancli.api.run_session.alone_in` keeps other runs away.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator
from pathlib import Path

from cleancli.files.plain import read_plain
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused

RUN = "run.json"
JOURNAL = "journal.jsonl"
EXPERIENCE = "experience.jsonl"
PAGE = "report.html"
FILES = "files"
STATE = "state"
APPENDED = (JOURNAL, EXPERIENCE)
"""The files that only grow."""

LARGEST = 64 << 20
"""Bytes of a text or of a checkpoint. Chosen: a journal of some 1,000 actions with 26 areas."""

_PICTURE = re.compile(r"step-(\d{3,9})\.png")
_CHECKPOINT = re.compile(r"(\d{3,9})\.npz")
_VIDEO = re.compile(r"video(?:-(\d{1,6}))?\.mp4")


def check_folder(folder: Path) -> None:
    """Refuse (E705) a folder in which something is a link, or is no plain file where a run writes one. Raises
    OSError where it cannot be read."""
    wrong = [_refused(folder / name, why) for name, why in _wrong(folder)]
    if wrong:
        raise Refused(wrong)


def refused(path: Path, why: str, help: str = "") -> Refused:
    """That a file of a run's folder is not what a run leaves there (E705)."""
    return Refused([_refused(path, why, help)])


def read_text(folder: Path, name: str, largest: int = LARGEST) -> Source:
    """A text of the folder, under its path. Raises Refused (E705), FileNotFoundError, OSError."""
    path = folder / name
    data = read_inside(folder, name, largest)
    try:
        return Source(str(path), data.decode("utf-8"))
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise refused(path, f"it is no UTF-8 text (line {line})") from None


def read_inside(folder: Path, name: str, largest: int = LARGEST) -> bytes:
    """The bytes of a file of the folder, whose name may lead into folders of it. Raises Refused (E705),
    FileNotFoundError, OSError."""
    parts = Path(name).parts
    if Path(name).is_absolute() or not parts or {"..", "."} & set(parts) or "\0" in name:
        raise refused(folder / name, "its path leaves the folder")
    for number in range(1, len(parts)):
        if folder.joinpath(*parts[:number]).is_symlink():
            raise refused(folder.joinpath(*parts[:number]), "it is a link")
    try:
        return read_plain(folder / name, largest, follow=False)
    except (FileNotFoundError, PermissionError):
        raise
    except OSError as error:
        raise refused(folder / name, error.strerror or str(error)) from None


def size_of(folder: Path, name: str) -> int:
    """Bytes of a file; 0 where there is none."""
    try:
        return (folder / name).stat(follow_symlinks=False).st_size
    except FileNotFoundError:
        return 0


def checkpoints(folder: Path) -> tuple[Path, ...]:
    """The files of all checkpoints, the earliest first."""
    return tuple(path for _, path in sorted(_numbered(folder, STATE, _CHECKPOINT)))


def pictures(folder: Path) -> dict[int, Path]:
    """The pictures of steps by number."""
    return dict(_numbered(folder, "", _PICTURE))


def videos(folder: Path) -> tuple[str, ...]:
    """The names of the videos, the earliest first."""
    numbers = {int(match[1] or 1): match[0] for match in map(_VIDEO.fullmatch, _names(folder)) if match}
    return tuple(name for _, name in sorted(numbers.items()))


def refuse_other_names(folder: Path) -> None:
    """Refuse (E705) files that are appended to and have other names, which a backup may have given them."""
    for name in APPENDED:
        path = folder / name
        if path.exists() and path.stat().st_nlink > 1:
            why = "it has another name (a hard link), so that going on would change another file"
            raise refused(path, why, "copy the folder, and go on with the copy")


def _numbered(folder: Path, name: str, pattern: re.Pattern[str]) -> Iterator[tuple[int, Path]]:
    for entry in _entries(folder, name):
        match = pattern.fullmatch(entry.name)
        if match is not None and entry.is_file(follow_symlinks=False):
            yield int(match[1]), Path(entry.path)


def _wrong(folder: Path) -> Iterator[tuple[str, str]]:
    for name in ("", FILES, STATE):
        for entry in sorted(_entries(folder, name), key=lambda entry: entry.name):
            below = str(Path(name) / entry.name)
            kind = entry.stat(follow_symlinks=False).st_mode
            if stat.S_ISLNK(kind):
                yield below, "it is a link"
            elif below in (FILES, STATE) and not stat.S_ISDIR(kind):
                yield below, "it is no folder"
            elif _is_written(below) and not stat.S_ISREG(kind):
                yield below, "it is no regular file"


def _is_written(name: str) -> bool:
    """Whether runs and reports write a file of that name."""
    numbered = re.fullmatch(r"step-.*\.png|state/.*\.npz|video.*\.mp4", name)
    return name in (RUN, PAGE, *APPENDED) or numbered is not None


def _names(folder: Path) -> list[str]:
    return [entry.name for entry in _entries(folder, "") if entry.is_file(follow_symlinks=False)]


def _entries(folder: Path, name: str) -> list[os.DirEntry[str]]:
    """What is in the folder, or in one of its folders: nothing where that is missing, a link or a file."""
    if name and (folder / name).is_symlink():
        return []
    try:
        with os.scandir(folder / name) as entries:
            return list(entries)
    except (FileNotFoundError, NotADirectoryError):
        return []


def _refused(path: Path, why: str, help: str = "") -> Diagnostic:
    return Diagnostic("E705", f"`{path}` is not as a run leaves it: {why}", None, help=help)
