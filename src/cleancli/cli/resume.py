"""What `cleancli execute --resume` goes on from: a run's folder holds all that it takes (docs/runs.md)."""

from __future__ import annotations

import hashlib
import os
import signal
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import click
import msgspec

from cleancli import __version__
from cleancli.execution import checkpoint
from cleancli.execution.checkpoint import Saved
from cleancli.execution.setup import EpisodeOptions, Job
from cleancli.language.diagnostics import Diagnostic, Refused, Source
from cleancli.language.load import checked_domain, kind_of, load_problem
from cleancli.language.model import Domain, Problem
from cleancli.report.run import Header, InputFile, Run, read_run
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene


@dataclass(frozen=True, slots=True)
class Inputs:
    """What goes into a run; `sources` are the texts of the domain and of what is `given`, which come last."""

    domain: Domain
    given: Problem | Scene
    sources: tuple[Source, ...]
    options: EpisodeOptions
    job: Job | None


@dataclass(frozen=True, slots=True)
class Unfinished:
    """A run to go on with, and its last checkpoint, if it came so far. `header` is its run.json."""

    inputs: Inputs
    header: Mapping[str, Any]
    saved: Saved | None
    video: bool


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Keep other processes from working on the same run. Raises UsageError where one does already."""
    try:
        import fcntl  # not on Windows, where two at once are the user's own concern
    except ImportError:
        yield
        return
    # The folder itself: its files are replaced by others while the run goes on.
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(handle)
        raise click.UsageError(f"another process works on {folder}") from None
    try:
        yield
    finally:
        os.close(handle)


@contextmanager
def interruptions() -> Iterator[list[int]]:
    """What Ctrl-C adds to, for a loop to look at where it may end; a library would swallow an exception, or
    be left half done by it. Pressed three times, it interrupts at once."""
    pressed: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield pressed
        return

    def press(number: int, _: object) -> None:
        pressed.append(number)
        if len(pressed) > 2:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, press)
    try:
        yield pressed
    finally:
        signal.signal(signal.SIGINT, before)


def unfinished(folder: Path) -> Unfinished:
    """Read a run that has not ended. Raises Refused, OSError, and UsageError for one that has ended."""
    run = read_run(folder)
    if run.header.episode is not None:
        raise click.UsageError(f"{folder} has ended: {run.header.episode.reason}; start a new run instead")
    began = run.header.versions.get("cleancli")
    if began != __version__:
        raise click.UsageError(
            f"{folder} began with cleancli {began}, and this is {__version__}: use that one"
        )
    sources = tuple(_text(run, file) for file in run.header.files)
    if not sources:
        help = "only runs of this version and later ones can be gone on with"
        raise Refused(
            [Diagnostic("E705", f"`{folder}` does not hold the files that went in", None, help=help)]
        )
    texts = {source.path: source for source in sources}
    domain = checked_domain(sources[0], True, lambda path: texts[str(path)]).get()
    last = sources[-1]
    given = load_scene(last) if kind_of(last) == "scene" else load_problem(last, domain)
    raw = msgspec.json.decode((folder / "run.json").read_bytes(), type=dict[str, Any])
    _tell_versions(run.header)
    return Unfinished(
        Inputs(domain, given, sources, _options(run.header), Job(run.header.options["job"])),
        {name: value for name, value in raw.items() if name not in ("episode", "truth")},
        checkpoint.last(folder),
        (folder / "video.mp4").exists(),
    )


def _text(run: Run, file: InputFile) -> Source:
    """A text that went in, from its copy. Raises Refused (E705) where that has changed."""
    path = run.folder / file.copy
    text = path.read_bytes().decode("utf-8")
    if hashlib.sha256(text.encode()).hexdigest() != file.sha256:
        message = f"`{path}` is not the text any more that the run began with"
        raise Refused([Diagnostic("E705", message, None, help="put it back, or start a new run")])
    return Source(file.path, text)


def _options(header: Header) -> EpisodeOptions:
    given = header.options
    return EpisodeOptions(
        given["strategy"],
        given["planner"],
        given["samples"],
        given["max_actions"],
        given["max_seconds"],
        header.seed,
        given["objective"] == "time",
        given["known"],
    )


def _tell_versions(header: Header) -> None:
    """Say which libraries differ from those the run began with: it may go on differently then."""
    for name, old in header.versions.items():
        if name not in ("cleancli", "python") and version(name) != old:
            click.echo(f"note: the run began with {name} {old}, this is {version(name)}", err=True)
