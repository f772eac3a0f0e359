"""A rehearsal of a run: look, decide, and move nothing."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import click

from cleancli.api.run_inputs import Inputs
from cleancli.api.run_session import open_session
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.views.motions import way_of
from cleancli.execution.loop import rehearsed
from cleancli.language.load import located_in
from cleancli.language.model import Problem
from cleancli.perception.frame_source import BadRecording
from cleancli.perception.surface import NoSurface
from cleancli.recording.pictures import step_picture, write_png


def rehearse(inputs: Inputs, file: Path) -> int:
    """The first stroke over the camera's picture, and nothing moves. Raises UsageError where there is no
    table, BadRecording where none is seen, and what opening a session does."""
    if isinstance(inputs.given, Problem):
        raise click.UsageError("--dry-run is for scenes: a list of facts has no table to look at")
    if not file.resolve().parent.is_dir():
        raise click.BadParameter(f"there is no folder `{file.parent}`", param_hint="--dry-run")
    with closing(open_session(inputs)) as session, located_in(*inputs.sources):
        try:
            sight, begun = rehearsed(session.setup, session.cell)
        except NoSurface as error:
            raise BadRecording(f"the camera: {error}") from error
    assert sight.frame is not None, "a table has a camera"
    write_png(file, step_picture(sight.frame, sight.situation, begun, None))
    if begun is None or begun.path is None:
        echo(f"nothing seems worth doing; {file} shows what is seen")
    else:
        echo(
            f"it would begin with {begun.move}: {way_of(begun.path)}; {file} shows it, and nothing has moved"
        )
    return ExitCode.DONE
