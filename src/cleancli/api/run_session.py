"""What a new run and one that goes on share: what goes in, where it takes place, and who may disturb it."""

from __future__ import annotations

import os
import platform
import shutil
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from cleancli import __version__
from cleancli.execution.episode_state import World as SavedWorld
from cleancli.execution.session import Session, remote_session, robot_session, symbolic_session, table_session
from cleancli.execution.setup import EpisodeOptions, Job
from cleancli.execution.strategies import STRATEGIES
from cleancli.files.interrupt import ENDING
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import located_in
from cleancli.language.model import Domain, Problem
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.learning.experience import Transition
from cleancli.motion.actions import PICK_UP, can_execute
from cleancli.planning.plan import BadOption
from cleancli.planning.refusal import planning_refused
from cleancli.recording.journal import Started, read_journal
from cleancli.scene.model import Scene
from cleancli.scene.robots import REMOTE
from cleancli.simulation.compatibility import refuse_unlike
from cleancli.world.robot import Robot

LIBRARIES = ("numpy", "opencv-python-headless", "numba", "pybullet")
"""Those that results depend on."""


@dataclass(frozen=True, slots=True)
class World:
    """Rules of a symbolic world, and their texts."""

    domain: Domain
    sources: tuple[Source, ...]


@dataclass(frozen=True, slots=True)
class Inputs:
    """What goes into a run; `sources` are the texts of the domain and of what is `given`, which come last.
    `evidence`: what earlier runs have seen, to learn from. `world` has the rules by which the symbolic world
    acts, where they are not those of the domain. `robot` works on the table in place of the simulated one.
    `experience`: the transitions of earlier runs, where whole rules are learned. `teacher` has the rules of a
    teacher, where a file is one."""

    domain: Domain
    given: Problem | Scene
    sources: tuple[Source, ...]
    options: EpisodeOptions
    job: Job | None
    evidence: Evidence = NO_EVIDENCE
    world: World | None = None
    robot: Robot | None = None
    experience: tuple[Transition, ...] = ()
    teacher: World | None = None


class OtherWorld(ValueError):
    """A checkpoint is not one of the world that the run's files describe; the message says why."""


def versions() -> dict[str, str]:
    """What a run may depend on, with its version; a library that is not installed is not among it."""
    found = {"cleancli": __version__, "python": platform.python_version()}
    for library in LIBRARIES:
        with suppress(PackageNotFoundError):
            found[library] = version(library)
    return found


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
                acting = inputs.domain if inputs.world is None else inputs.world.domain
                session = symbolic_session(inputs.domain, given, options, saved, acting)
            setup = replace(session.setup, evidence=inputs.evidence, experience=inputs.experience)
            return replace(session, setup=setup)
        except (KeyError, TypeError, ValueError) as error:
            if saved is None:
                raise
            reason = f"it has no {error}" if isinstance(error, KeyError) else str(error)
            raise OtherWorld(f"it is not one of this world: {reason}") from None


def refuse_impossible(inputs: Inputs) -> None:
    """Raises BadOption for what a scene or a problem has not, Refused for a world of other things."""
    given, options, job = inputs.given, inputs.options, inputs.job
    if isinstance(given, Problem) and STRATEGIES[options.strategy].needs_places:
        raise BadOption(f"--strategy {options.strategy} goes by places, which only a scene has")
    if inputs.world is not None:
        _check_world(inputs, inputs.world)
    if inputs.teacher is not None and isinstance(given, Problem):
        refuse_unlike(inputs.domain, inputs.teacher.domain, given, inputs.sources, inputs.teacher.sources)
    if isinstance(given, Scene) and options.is_taught:
        raise BadOption("a teacher is for problems: nobody shows a robot at a table what to do yet")
    if isinstance(given, Problem) and inputs.robot is not None:
        raise BadOption("`robot` is for scenes: a list of facts is carried out in the symbolic world")
    if isinstance(given, Scene) and job is Job.DUSTPAN and not can_execute(PICK_UP, 1, given.arms):
        raise BadOption(f"--job dustpan takes a second arm, which {given.robot} has not")


def _check_world(inputs: Inputs, world: World) -> None:
    """Raises BadOption where a table is the world, and Refused (E901) where the rules are of other things."""
    if isinstance(inputs.given, Scene):
        raise BadOption("--world is for problems: what happens on the table of a scene is physics")
    refuse_unlike(inputs.domain, world.domain, inputs.given, inputs.sources, world.sources)


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
