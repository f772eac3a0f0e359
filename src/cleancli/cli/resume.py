"""What `cleancli execute --resume` goes on from: a run's folder holds all that it takes (docs/runs.md)."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
import msgspec

from cleancli import __version__
from cleancli.cli.running import Inputs, versions
from cleancli.execution import checkpoint
from cleancli.execution.checkpoint import Saved
from cleancli.execution.setup import EpisodeOptions, Job
from cleancli.language.diagnostics import Diagnostic, Refused, Source
from cleancli.language.load import checked_domain, kind_of, load_problem
from cleancli.report.run import Header, InputFile, Run, read_run
from cleancli.scene.check import load_scene


@dataclass(frozen=True, slots=True)
class Unfinished:
    """A run to go on with, and its last checkpoint, if it came so far. `header` is its run.json."""

    inputs: Inputs
    header: Mapping[str, Any]
    saved: Saved | None
    video: bool


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
    now = versions()
    for name, old in header.versions.items():
        if name not in ("cleancli", "python") and now.get(name) != old:
            there = f"this is {now[name]}" if name in now else "which is not installed here"
            click.echo(f"note: the run began with {name} {old}, {there}", err=True)
