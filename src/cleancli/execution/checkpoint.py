"""What a run needs to go on after it was cut short: state/NNN.npz in its folder (docs/runs.md).

A checkpoint is one file, replaced in one step, and says how long the journal and the experience were then. So
it is the commit point: what was appended after the last whole one is taken away when the run goes on.
"""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from cleancli.execution.journal import JOURNAL
from cleancli.execution.state import EpisodeState
from cleancli.language.diagnostics import Diagnostic, Refused
from cleancli.language.edit import replace_file

EXPERIENCE = "experience.jsonl"
FOLDER = "state"
APPENDED = (JOURNAL, EXPERIENCE)
"""The files that only grow."""

KEPT = 2
"""Checkpoints that stay: the last one, and one more should a disk lose it."""

World = Mapping[str, NDArray[Any]]
"""What the world is like, as arrays by name."""


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
    file = io.BytesIO()
    arrays = {"rest": np.frombuffer(rest, np.uint8)} | {f"world_{n}": array for n, array in world.items()}
    np.savez_compressed(file, allow_pickle=False, **arrays)
    (folder / FOLDER).mkdir(exist_ok=True)
    replace_file(_path(folder, episode.actions), file.getvalue())
    for old in _paths(folder)[:-KEPT]:
        old.unlink(missing_ok=True)


def last(folder: Path) -> Saved | None:
    """The last checkpoint of a run; None where it was cut short before the first. Raises Refused (E706) for a
    file that is none, OSError."""
    paths = _paths(folder)
    if not paths:
        return None
    path = paths[-1]
    try:
        with np.load(path, allow_pickle=False) as arrays:
            world = {n.removeprefix("world_"): arrays[n] for n in arrays.files if n != "rest"}
            rest = msgspec.json.decode(arrays["rest"].tobytes(), type=dict[str, msgspec.Raw])
        episode = msgspec.json.decode(rest["episode"], type=EpisodeState, dec_hook=_read)
        sizes = msgspec.json.decode(rest["sizes"], type=dict[str, int])
    except (msgspec.MsgspecError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        help = "remove it to go on from the checkpoint before" if len(paths) > 1 else ""
        raise Refused([Diagnostic("E706", f"`{path}` is no checkpoint: {error}", None, help=help)]) from None
    return Saved(episode, world, sizes)


def cut_back(folder: Path, saved: Saved | None) -> int:
    """Take away what was written after a checkpoint; returns how many whole lines the journal has lost."""
    dropped, actions = 0, -1 if saved is None else saved.episode.actions
    pictures = [path for path in folder.glob("step-*.png") if int(path.stem.removeprefix("step-")) > actions]
    unfinished = [path for where in (folder, folder / FOLDER) for path in where.glob(".*") if path.is_file()]
    for path in (*pictures, *unfinished):
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


def _path(folder: Path, actions: int) -> Path:
    return folder / FOLDER / f"{actions:03d}.npz"


def _paths(folder: Path) -> list[Path]:
    """Those of all checkpoints, the earliest first."""
    return sorted((folder / FOLDER).glob("[0-9]*.npz"), key=lambda path: int(path.stem))


def _plain(value: object) -> str:
    """What msgspec does not know, as something that it does."""
    if isinstance(value, Fraction):
        return str(value)
    raise NotImplementedError(f"{type(value).__name__} has no form in a checkpoint")


def _read(kind: type, value: Any) -> object:
    """The opposite of `_plain`."""
    return kind(value)
