"""What is finished of studies: a line of JSON an episode, as soon as it is over.

Each line is written at once, so that a kill leaves at most a last one without its end, which counts for
nothing and is cut off before the next is written. What is read may be anybody's: it is decoded against types.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

import msgspec

from cleancli.experiment.episode import Finished
from cleancli.files.plain import read_plain
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused

LINES = "episodes.jsonl"
"""The file, in the folder of a study's results."""

LARGEST = 1 << 30
"""Bytes of it: a row takes two thousand at most, and what a series has learned some more."""


@dataclass(frozen=True, slots=True)
class Store:
    """The open file; `add` a finished episode. Close it in the end, as a context does."""

    handle: int

    @classmethod
    def opened(cls, folder: Path) -> Store:
        """That of a folder, which is made if there is none; the end of a line that was cut short is cut off.
        Raises OSError."""
        folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(folder / LINES, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o666)
        try:
            os.ftruncate(handle, _whole(handle))
        except BaseException:
            os.close(handle)
            raise
        return cls(handle)

    def add(self, finished: Finished) -> None:
        """One more line, which a kill of this process cannot take back. Raises OSError."""
        line = memoryview(msgspec.json.encode(finished) + b"\n")
        while line:
            line = line[os.write(self.handle, line) :]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self.handle)


def _whole(handle: int) -> int:
    """How many bytes of a file are whole lines."""
    size = os.fstat(handle).st_size
    while size:
        start = max(0, size - 65536)
        end = os.pread(handle, size - start, start).rfind(b"\n")
        if end >= 0:
            return start + end + 1
        size = start
    return 0


def read_finished(folder: Path) -> Mapping[str, Finished]:
    """The episodes that are finished, by their keys; none where there is no file. Raises Refused (E702) for
    lines that are no such, OSError."""
    path = folder / LINES
    if not path.exists():
        return {}
    text = read_plain(path, LARGEST).decode("utf-8", errors="replace")
    source = Source(str(path), text)
    found: dict[str, Finished] = {}
    mistakes = []
    for line, span in _lines(source):
        try:
            finished = msgspec.json.decode(line, type=Finished)
            found.setdefault(finished.row.key, finished)
        except (msgspec.MsgspecError, RecursionError) as error:
            mistakes.append(Diagnostic("E702", f"not a line of finished episodes: {error}", span))
    if mistakes:
        raise Refused(mistakes, [source])
    return found


def _lines(source: Source) -> Iterator[tuple[str, Span]]:
    """Whole lines, with their places."""
    start = 0
    for line in source.text.split("\n")[:-1]:
        yield line, Span(source.path, start, start + len(line))
        start += len(line) + 1
