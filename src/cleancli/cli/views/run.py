"""A run while it lasts: shown, asked about, streamed to the Rerun viewer, and its frames kept."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.run_result import RunResult
from cleancli.api.runs import OpenedRun, RunStopped, carry_out
from cleancli.api.symbolic import told_of
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import Stopped
from cleancli.cli.progress import working
from cleancli.cli.views.live import show
from cleancli.cli.views.motions import ask_before
from cleancli.cli.views.teacher import ask
from cleancli.execution.events import Event, Leaving, Looked, Started
from cleancli.execution.loop import seconds_reached
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Problem
from cleancli.perception.recorded import free_look, save_frames
from cleancli.recording.folder import PAGE
from cleancli.recording.rerun_run import RunStream
from cleancli.report.page import write_page


@dataclass(frozen=True, slots=True)
class Telling:
    """How the run is told: as data, or not at all; in which file for the Rerun viewer, if in any; into which
    folder frames are `saved`, if they are; and whether a person is asked before each motion, who then needs
    the terminal."""

    as_data: bool
    quiet: bool
    rrd: Path | None
    saved: Path | None
    asks: bool

    @property
    def silently(self) -> bool:
        """Whether nothing is shown while it lasts."""
        return self.as_data or self.quiet


def echo_note(text: str) -> None:
    """What a person may want to know, and need not act upon."""
    echo(f"note: {text}", err=True)


def followed(opened: OpenedRun, telling: Telling) -> RunResult:
    """The run to its end, shown while it lasts."""
    if opened.resumed is not None and not telling.silently:
        echo(f"going on after {plural(opened.resumed.after, 'action')}", err=True)
    setup, cell, given = opened.session.setup, opened.session.cell, opened.inputs.given
    told = told_of(opened.inputs.domain, given) if isinstance(given, Problem) else None
    limit = setup.options.max_actions
    asks = setup.options.is_taught and opened.inputs.teacher is None
    try:
        with (
            show(
                telling.silently or telling.asks, setup.scene, lambda: cell.tool, limit, told=told, plain=asks
            ) as view,
            nullcontext() if telling.rrd is None else _streamed(telling.rrd, opened) as stream,
        ):

            def follow(event: Event) -> None:
                view.write(event)
                if telling.asks:
                    _ask(event)
                if stream is not None:
                    stream.write(event)
                if telling.saved is not None and isinstance(event, Looked) and event.frame is not None:
                    save_frames((event.frame,), free_look(telling.saved))

            result = carry_out(opened, follow, None if telling.silently else ask)
    except RunStopped as stopped:
        raise Stopped(str(stopped)) from None
    except OSError as error:
        for note in getattr(error, "__notes__", ()):
            echo(note, err=True)
        raise
    if result.reason == seconds_reached(setup.options.max_seconds) and not telling.silently:
        echo_note("--max-seconds raises the limit of seconds, which are of the account and no real time")
    with working(f"writing {PAGE}", telling.silently):
        write_page(opened.folder)
    return result


def _ask(event: Event) -> None:
    """Before a motion whether it may begin."""
    match event:
        case Leaving():
            ask_before("the arm leaves the camera's view", None)
        case Started(number, move, path) if path is not None:
            ask_before(f"{number}. {move}", path)


def _streamed(path: Path, opened: OpenedRun) -> RunStream:
    cell = opened.session.cell
    scene = opened.session.setup.scene
    return RunStream(path, opened.folder.name, scene, lambda: cell.clock, lambda: cell.tool)
