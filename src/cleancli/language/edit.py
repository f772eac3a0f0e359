"""The one place that changes files of the user: edits at spans, and writes that replace all or nothing."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from cleancli.language.diagnostics import Diagnostic, Refused, Span
from cleancli.language.hold import Meanwhile, Original, locked
from cleancli.language.swap import New, overwrite, put_in_place, written_by_another


@dataclass(frozen=True, slots=True)
class Edit:
    """Replace what stands at `span` by `replacement`; an empty span inserts."""

    span: Span
    replacement: str


def apply_edits(text: str, edits: Iterable[Edit]) -> str:
    """The text with all edits made; offsets mean the old text, and nothing outside the spans changes.

    Raises ValueError for spans that overlap, insert at one place twice, or lie outside the text.
    """
    ordered = sorted(edits, key=lambda edit: (edit.span.start, edit.span.end))
    parts = []
    done = 0
    previous: Span | None = None
    for edit in ordered:
        span = edit.span
        if not 0 <= span.start <= span.end <= len(text):
            raise ValueError(f"edit at {span.start}..{span.end} lies outside the text")
        if span.start < done or span == previous:
            raise ValueError(f"edits overlap at {span.start}")
        parts += [text[done : span.start], edit.replacement]
        done, previous = span.end, span
    return "".join(parts) + text[done:]


def write_atomically(path: Path | str, text: str, expected_old_text: str | None) -> None:
    """Replace a file in one step, if it still reads `expected_old_text` (None: it must not exist); see
    `write_all`."""
    write_all([Change(Path(path), text, expected_old_text)])


@dataclass(frozen=True, slots=True)
class Change:
    """A file to be replaced by `text` if it still reads `expected`; None: it must not exist."""

    path: Path
    text: str
    expected: str | None


def write_all(changes: Iterable[Change]) -> None:
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


def _unexpected(change: Change, original: Original | None) -> Diagnostic | None:
    expected = None if change.expected is None else change.expected.encode("utf-8")
    if (None if original is None else original.content) == expected:
        return None
    return _refusal(
        change.path, "already exists" if expected is None else "has changed on disk since it was read"
    )


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
