"""A run's videos, inside its page where they are short."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from cleancli.files.plain import NotPlain, TooLarge, read_plain

LARGEST = 8 << 20
"""Bytes of all videos that a page holds; what is more lies beside it. Chosen: some ten minutes of a robot's
work, and a page that can still be mailed."""


@dataclass(frozen=True, slots=True)
class Embedded:
    """A video's `name` in the run's folder, and the `address` that the page has for it."""

    name: str
    address: str
    inside: bool


def embedded(folder: Path, names: Sequence[str]) -> tuple[Embedded, ...]:
    """The videos in their order, those inside the page that still fit into it."""
    room, found = LARGEST, []
    for name in names:
        content = _content(folder / name, room)
        if content is None:
            found.append(Embedded(name, quote(name), inside=False))
        else:
            room -= len(content)
            address = f"data:video/mp4;base64,{base64.b64encode(content).decode()}"
            found.append(Embedded(name, address, inside=True))
    return tuple(found)


def _content(path: Path, largest: int) -> bytes | None:
    """An MP4 file of at most so many bytes, None where it is larger, or none."""
    try:
        content = read_plain(path, largest, follow=False)
    except (FileNotFoundError, NotPlain, TooLarge):
        return None
    # The first box of an MP4 file says which kind it is (ISO 14496-12).
    return content if content[4:8] == b"ftyp" else None
