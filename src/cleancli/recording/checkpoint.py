"""What a run needs to go on after it was cut short: state/NNN.npz in its folder (docs/runs.md).

A checkpoint is one file, replaced in one step, and says how long the journal and the experience were then. So
it is the commit point: what was appended after the last whole one is taken away when the run goes on.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np
from msgspec import Meta

from cleancli.execution.episode_state import EpisodeState, World
from cleancli.files.exchange import remove_leftovers
from cleancli.files.replace import replace_file
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.recording.arrays import BadArrays, packed, unpacked
from cleancli.recording.folder import (
    APPENDED,
    JOURNAL,
    LARGEST,
    STATE,
    checkpoints,
    pictures,
    read_inside,
    size_of,
)

KEPT = 2
"""Checkpoints that stay: the last one, and one more should a disk lose it."""


_FRACTION = re.compile(r"-?\d{1,300}(/0*[1-9]\d{0,300})?")
_Size = Annotated[int, Meta(ge=0)]


class _Sizes(msgspec.Struct, rename=dict(zip(("journal", "experience"), APPENDED, strict=True))):
    """Bytes of the files that only grow."""

    journal: _Size
    experience: _Size


class _Rest(msgspec.Struct):
    """What a checkpoint holds besides arrays."""

    episode: EpisodeState
    sizes: _Sizes


@dataclass(frozen=True, slots=True)
class Saved:
    """An episode between two moves, the world as it was then, and the sizes of the files that only grow, in
    bytes."""

    episode: EpisodeState
    world: World
    sizes: Mapping[str, int]


def save(folder: Path, episode: EpisodeState, world: World) -> None:
    """Write the checkpoint after so many actions into a run's folder; what was appended before is on disk
    already. Raises OSError."""
    sizes = {name: (folder / name).stat().st_size for name in APPENDED}
    rest = msgspec.json.encode({"episode": episode, "sizes": sizes}, enc_hook=_plain)
    arrays = {"rest": np.frombuffer(rest, np.uint8)} | {f"world_{n}": array for n, array in world.items()}
    (folder / STATE).mkdir(exist_ok=True)
    replace_file(folder / STATE / f"{episode.actions:03d}.npz", packed(arrays))
    for old in checkpoints(folder)[:-KEPT]:
        old.unlink(missing_ok=True)


def read(folder: Path, path: Path) -> Saved:
    """One of the `checkpoints` of a run's folder. Raises Refused (E706) for a file that is none, or to which
    the files that only grow do not fit any more; OSError."""
    try:
        arrays = unpacked(read_inside(folder, str(path.relative_to(folder)), LARGEST))
        world = {n.removeprefix("world_"): array for n, array in arrays.items() if n != "rest"}
        text = arrays["rest"].tobytes().decode()  # here, since msgspec has several words for what is no text
        rest = msgspec.json.decode(text, type=_Rest, dec_hook=_read)
    except (msgspec.MsgspecError, BadArrays, RecursionError, UnicodeDecodeError) as error:
        raise refused(path, str(error)) from None
    except KeyError:
        raise refused(path, "it has no `rest`") from None
    if rest.episode.actions != int(path.stem):
        raise refused(path, f"it is of another moment, after {plural(rest.episode.actions, 'action')}")
    sizes = dict(zip(APPENDED, (rest.sizes.journal, rest.sizes.experience), strict=True))
    for name, size in sizes.items():
        if not _ends_a_line(folder, name, size):
            raise refused(path, f"{name} has not the lines any more that it goes on from")
    return Saved(rest.episode, world, sizes)


def refused(path: Path, why: str) -> Refused:
    """That a file is no checkpoint to go on from (E706)."""
    return Refused([Diagnostic("E706", f"`{path}` is no checkpoint to go on from: {why}", None)])


def tidy(folder: Path) -> None:
    """Remove what a process that was killed has left beside the files of a run or series, also of one that
    has ended: the last thing that it writes is its end, or its page."""
    for where in (folder, folder / STATE):
        remove_leftovers(where)


def cut_back(folder: Path, saved: Saved | None) -> int:
    """Take away what was written after a checkpoint; returns how many whole lines the journal has lost."""
    dropped, actions = 0, -1 if saved is None else saved.episode.actions
    later = [path for number, path in pictures(folder).items() if number > actions]
    later += [path for path in checkpoints(folder) if int(path.stem) > actions]
    for path in later:
        path.unlink()
    for name in APPENDED:
        path, size = folder / name, 0 if saved is None else saved.sizes[name]
        if not path.exists():
            continue
        with path.open("r+b") as file:
            file.seek(size)
            dropped += file.read().count(b"\n") if name == JOURNAL else 0
            file.truncate(size)
            os.fsync(file.fileno())
    return dropped


def _ends_a_line(folder: Path, name: str, size: int) -> bool:
    """Whether a file has so many bytes or more, of which the last one ends a line."""
    if size == 0 or size > size_of(folder, name):
        return size == 0
    with (folder / name).open("rb") as file:
        file.seek(size - 1)
        return file.read(1) == b"\n"


def _plain(value: object) -> str:
    """What msgspec does not know, as something that it does."""
    if isinstance(value, Fraction):
        return str(value)
    raise NotImplementedError(f"{type(value).__name__} has no form in a checkpoint")


def _read(kind: type, value: Any) -> object:
    """The opposite of `_plain`. Raises ValueError, which msgspec reports with the place."""
    if kind is Fraction and isinstance(value, str) and _FRACTION.fullmatch(value):
        return Fraction(value)
    raise ValueError("no fraction such as `3/4`")
