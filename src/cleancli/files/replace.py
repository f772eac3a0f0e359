"""Replaces files, and is the only one that does: those of users as expected, all or none, and own files."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from cleancli.files.exchange import New, overwrite, put_in_place, written_by_another
from cleancli.files.lease import Meanwhile, Original, locked
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused


def write_atomically(path: Path | str, text: str, expected_old_text: str | None) -> None:
    """Replace a file in one step, if it still reads `expected_old_text` (None: it must not exist); see
    `write_all`."""
    write_all([Replacement(Path(path), text, expected_old_text)])


_EXISTS = "already exists"


@dataclass(frozen=True, slots=True)
class Replacement:
    """A file to be replaced by `text` if it still reads `expected`; None: it must not exist."""

    path: Path
    text: str
    expected: str | None


def write_all(changes: Iterable[Replacement]) -> None:
    """Replace several files, all of them or none, after all were found to read as expected.

    What another program saves meanwhile stays: then nothing is written (E006, naming all files that do not
    read as expected). Owner, group and mode stay, and a link still leads where it led. Raises OSError where a
    file cannot be read or written, is read-only, or has several names.
    """
    changes = tuple(changes)
    places = {change.path: Path(os.path.realpath(change.path)) for change in changes}
    with locked(places.values()) as originals:
        now = {path: originals[place] for path, place in places.items()}
        refused = [
            found for change in changes if (found := _unexpected(change, now[change.path])) is not None
        ]
        if refused:
            raise Refused(refused)
        for path, original in now.items():
            if original is not None:
                _refuse_unwritable(path, original.status)
        try:
            put_in_place([New(places[c.path], c.text.encode("utf-8"), now[c.path]) for c in changes])
        except Meanwhile as meanwhile:
            named = next(path for path, place in places.items() if place == meanwhile.path)
            raise Refused([_refusal(named, meanwhile.what)]) from None


def refuse_existing(path: Path) -> None:
    """Refuse (E006) what is to be a new file before long work goes into it; `write_all` looks again."""
    if path.exists():
        raise Refused([_refusal(path, _EXISTS)])


def _unexpected(change: Replacement, original: Original | None) -> Diagnostic | None:
    expected = None if change.expected is None else change.expected.encode("utf-8")
    if (None if original is None else original.content) == expected:
        return None
    return _refusal(change.path, _EXISTS if expected is None else "has changed on disk since it was read")


def _refusal(path: Path, what: str) -> Diagnostic:
    return Diagnostic("E006", f"`{path}` {what}", None, help="nothing was written")


def _refuse_unwritable(path: Path, status: os.stat_result) -> None:
    """A file could be replaced wherever its folder can be written; one that is read-only is meant to stay,
    and one with several names would be parted from the others."""
    if not (status.st_mode & 0o222 and os.access(path, os.W_OK)):
        raise PermissionError(errno.EACCES, "read-only, and so nothing was written", str(path))
    if status.st_nlink > 1:
        told = "it has several names (hard links), which would be parted, and so nothing was written"
        raise OSError(errno.EMLINK, told, str(path))


def replaced_by(path: Path | str) -> AbstractContextManager[Path]:
    """As `replace_file`, for a file that a library writes: the path that it is to write to. Nothing is
    replaced where this is left by an exception."""
    return written_by_another(Path(os.path.realpath(path)))


def replace_file(path: Path | str, content: str | bytes, mode: int | None = None) -> None:
    """Write a file, text as UTF-8, so that it holds the old content or the new one, whatever happens.

    For files that this program has made: what another program has put there is replaced. Line ends are
    written as they are, and permissions are kept, or those of `mode`; a symlink stays and its target is
    replaced. Raises OSError where the file cannot be written.
    """
    raw = content.encode("utf-8") if isinstance(content, str) else content
    overwrite(Path(os.path.realpath(path)), raw, mode)
