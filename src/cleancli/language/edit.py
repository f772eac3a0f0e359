"""The one place that changes files of the user: edits at spans, and a write that replaces all or nothing."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from cleancli.language.diagnostics import Diagnostic, Refused, Span


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
    """Replace a file in one step, if it still reads as it did; see `replace_file`.

    Refuses (E006) if the file no longer reads `expected_old_text` (None: it must not exist). Raises OSError
    where it cannot be read or written.
    """
    write_all([Change(Path(path), text, expected_old_text)])


@dataclass(frozen=True, slots=True)
class Change:
    """A file to be replaced by `text` if it still reads `expected`; None: it must not exist."""

    path: Path
    text: str
    expected: str | None


def write_all(changes: Iterable[Change]) -> None:
    """Replace several files, each in one step, after all of them were found to read as expected.

    Refuses (E006) before the first is replaced, naming all that do not. Raises OSError where one cannot be
    read or written, or is read-only; none is replaced then.
    """
    changes = tuple(changes)
    refused = [diagnostic for change in changes if (diagnostic := _unexpected(change)) is not None]
    if refused:
        raise Refused(refused)
    for change in changes:
        if change.expected is not None:
            _refuse_read_only(change.path)
    _replace((change.path, change.text) for change in changes)


def _unexpected(change: Change) -> Diagnostic | None:
    try:
        now: bytes | None = change.path.read_bytes()
    except FileNotFoundError:
        now = None
    if now == (None if change.expected is None else change.expected.encode("utf-8")):
        return None
    what = "already exists" if change.expected is None else "has changed on disk since it was read"
    return Diagnostic("E006", f"`{change.path}` {what}", None, help="nothing was written")


def _refuse_read_only(path: Path) -> None:
    """A file could be replaced wherever its folder can be written; one that is read-only is meant to stay."""
    if not (path.stat().st_mode & 0o222 and os.access(path, os.W_OK)):
        raise PermissionError(errno.EACCES, "read-only, and so nothing was written", str(path))


def replace_file(path: Path | str, content: str | bytes) -> None:
    """Write a file, text as UTF-8, so that it holds the old content or the new one, whatever happens.

    Line ends are written as they are and permissions kept; a symlink stays and its target is replaced.
    Raises OSError where the file cannot be written.
    """
    _replace([(Path(path), content)])


def _replace(files: Iterable[tuple[Path, str | bytes]]) -> None:
    """Write every content beside its file before the first file is replaced: a full disk or a folder that
    cannot be written then changes none."""
    written: list[tuple[Path, Path]] = []
    try:
        for path, content in files:
            target = path.resolve()
            mode = target.stat().st_mode & 0o7777 if target.exists() else _default_mode()
            handle, name = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
            written.append((Path(name), target))
            with os.fdopen(handle, "wb") as file:
                file.write(content.encode("utf-8") if isinstance(content, str) else content)
                file.flush()
                os.fsync(file.fileno())
            Path(name).chmod(mode)
        for temporary, target in written:
            temporary.replace(target)
    finally:
        for temporary, _ in written:
            temporary.unlink(missing_ok=True)
    for folder in sorted({target.parent for _, target in written}):
        _sync_folder(folder)


def _default_mode() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _sync_folder(folder: Path) -> None:
    """Make the rename itself durable where the system lets a folder be opened."""
    if os.name == "posix":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
