"""What `cleancli execute --resume` goes on from: a run's folder holds all that it takes (docs/runs.md)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import msgspec

from cleancli.api.provenance import inputs_of_run, other_versions
from cleancli.api.run_inputs import Inputs
from cleancli.api.run_session import open_session
from cleancli.execution.episode_state import EpisodeState
from cleancli.execution.session import Session
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Object, Problem
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.experience import Transition
from cleancli.planning.plan import BadOption
from cleancli.recording import checkpoint
from cleancli.recording.checkpoint import Saved
from cleancli.recording.fitting import check_fits
from cleancli.recording.folder import RUN, checkpoints, read_text, refuse_other_names
from cleancli.recording.journal import Started
from cleancli.report.run import LARGEST_HEADER, read_run


@dataclass(frozen=True, slots=True)
class Unfinished:
    """A run to go on with. `header` is its run.json; `video`: whether it was filmed; `begun`: how many
    actions were begun."""

    inputs: Inputs
    header: Mapping[str, Any]
    video: bool
    begun: int


Note = Callable[[str], None]
"""Told what a person may want to know and need not act upon."""


def _untold(_: str) -> None:
    """Tell nobody."""


def unfinished(
    folder: Path,
    evidence: Evidence = NO_EVIDENCE,
    experience: tuple[Transition, ...] = (),
    note: Note = _untold,
) -> Unfinished:
    """Read a run that has not ended; nothing is changed. Raises Refused, OSError, and BadOption for one that
    has ended."""
    run = read_run(folder)
    if run.header.episode is not None:
        raise BadOption(f"{folder} has ended: {run.header.episode.reason}; start a new run instead")
    refuse_other_names(folder)
    inputs = replace(inputs_of_run(run), evidence=evidence, experience=experience)
    raw = msgspec.json.decode(read_text(folder, RUN, LARGEST_HEADER).text, type=dict[str, Any])
    for difference in other_versions(run.header):
        note(difference)
    return Unfinished(
        inputs,
        {name: value for name, value in raw.items() if name not in ("episode", "truth")},
        (folder / "video.mp4").exists(),
        sum(isinstance(record, Started) for record in run.records),
    )


def reopened(folder: Path, begun: Unfinished, note: Note = _untold) -> tuple[Saved | None, Session]:
    """The last checkpoint from which the run can go on, which is told if it is not the newest, and the place
    as it was then; the place as in the beginning, where the run came to no checkpoint.

    Raises Refused (E706) where none of them fits.
    """
    failed: list[Diagnostic] = []
    for path in reversed(checkpoints(folder)):
        try:
            saved = checkpoint.read(folder, path)
            try:
                check_fits(saved.episode, begun.inputs.domain, _objects(begun.inputs))
                session = open_session(begun.inputs, saved.world)
            except ValueError as error:
                raise checkpoint.refused(path, str(error)) from None
        except Refused as refusal:
            if any(found.code != "E706" for found in refusal.diagnostics):
                raise
            failed += refusal.diagnostics
            continue
        for found in failed:
            note(f"{found.message}; going on from the one before")
        return saved, session
    if failed:
        raise Refused(failed)
    if begun.begun:
        message = f"`{folder}` has no checkpoint, though it had begun {plural(begun.begun, 'action')}"
        raise Refused([Diagnostic("E706", message, None, help="start a new run")])
    return None, open_session(begun.inputs)


def last_checkpoint(folder: Path, inputs: Inputs) -> EpisodeState:
    """What was known at the end of a run that has ended. Raises Refused (E706) where that is not there, or
    does not fit the run."""
    paths = checkpoints(folder)
    if not paths:
        message = f"`{folder}` has no checkpoint of its end"
        raise Refused([Diagnostic("E706", message, None, help="start a new series")])
    saved = checkpoint.read(folder, paths[-1]).episode
    try:
        check_fits(saved, inputs.domain, _objects(inputs))
    except ValueError as error:
        raise checkpoint.refused(paths[-1], str(error)) from None
    return saved


def _objects(inputs: Inputs) -> tuple[Object, ...] | None:
    """Those of a problem; a table has none of its own."""
    return inputs.given.objects if isinstance(inputs.given, Problem) else None
