"""Where a run takes place, and who may disturb it; a new one and one that goes on share this."""

from __future__ import annotations

import os
import shutil
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from cleancli.api.run_inputs import Inputs, refuse_impossible
from cleancli.execution.episode_state import World as SavedWorld
from cleancli.execution.session import Session, remote_session, robot_session, symbolic_session, table_session
from cleancli.files.interrupt import ENDING
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import located_in
from cleancli.planning.plan import BadOption
from cleancli.planning.refusal import planning_refused
from cleancli.recording.journal import Started, read_journal
from cleancli.scene.model import Scene
from cleancli.scene.robots import REMOTE


class OtherWorld(ValueError):
    """A checkpoint is not one of the world that the run's files describe; the message says why."""


def open_session(inputs: Inputs, saved: SavedWorld | None = None) -> Session:
    """The table of a scene, or the symbolic world of a problem, as it was at a checkpoint if one is given.

    Raises BadOption for what it has not, OtherWorld where the checkpoint is another one's.
    """
    given, options, job = inputs.given, inputs.options, inputs.job
    refuse_impossible(inputs)
    with located_in(*inputs.sources), planning_refused(inputs.sources):
        try:
            if isinstance(given, Scene) and inputs.robot is not None:
                session = robot_session(inputs.domain, given, inputs.robot, options, job)
            elif isinstance(given, Scene) and given.robot == REMOTE:
                session = remote_session(inputs.domain, given, options, job)
            elif isinstance(given, Scene):
                session = table_session(inputs.domain, given, options, job, saved)
            else:
                acting = inputs.domain if inputs.world is None else inputs.world.model
                session = symbolic_session(inputs.domain, given, options, saved, acting)
            setup = replace(session.setup, evidence=inputs.evidence, experience=inputs.experience)
            return replace(session, setup=setup)
        except (KeyError, TypeError, ValueError) as error:
            if saved is None:
                raise
            reason = f"it has no {error}" if isinstance(error, KeyError) else str(error)
            raise OtherWorld(f"it is not one of this world: {reason}") from None


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Keep other processes from working on the same run. Raises BadOption where one does already."""
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
        raise BadOption(f"another process works on {folder}") from None
    try:
        yield
    finally:
        os.close(handle)


@contextmanager
def none_left_where_refused(folder: Path) -> Iterator[None]:
    """Remove the folder of a run that is refused before its first action: it would tell nothing."""
    try:
        yield
    except (Refused, BadOption):
        if not any(isinstance(record, Started) for record in read_journal(folder).records):
            shutil.rmtree(folder)
        raise


@contextmanager
def interruptions() -> Iterator[list[int]]:
    """What Ctrl-C, TERM and HUP add to, for a loop to look at where it may end; a library would swallow an
    exception, or be left half done by it. The third interrupts at once."""
    pressed: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield pressed
        return

    def press(number: int, _: object) -> None:
        pressed.append(number)
        if len(pressed) > 2:
            raise KeyboardInterrupt

    before = {n: signal.signal(n, press) for n in ENDING if signal.getsignal(n) is not signal.SIG_IGN}
    try:
        yield pressed
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
