"""What a run came to: in words, and read from its folder."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from cleancli.api.goals import first_and_longer, is_hopeless, unreached_lines
from cleancli.api.plain import plain
from cleancli.api.resuming import last_checkpoint
from cleancli.api.run_inputs import Inputs
from cleancli.api.symbolic import told_of
from cleancli.api.tables import TextTable, shown
from cleancli.execution.episode_state import Situation
from cleancli.execution.loop import IDLE
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Domain, Problem
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.planning.plan import BadOption, Options
from cleancli.recording.folder import PAGE, RUN, read_text
from cleancli.report.run import LARGEST_HEADER, Run

_SHORT = 0.05
"""Seconds that are shown as 0.0."""


@dataclass(frozen=True, slots=True)
class RunResult:
    """What a run came to, as docs/python.md lists it. `told`: what holds in the end in the symbolic world.
    `evidence`: what it and the runs before it have seen, to learn from. `short_horizon`: that of the first
    plan and a longer one to try, where the problem states none and no plan was believed to reach its goal.
    `hopeless`: no action of the symbolic world can lead to the goal; `dead_end`: none can any more."""

    folder: Path
    clean: bool
    reason: str
    actions: int
    seconds: Mapping[str, float]
    truth: Mapping[str, object]
    told: str
    video: bool
    record: Mapping[str, object]
    evidence: Evidence = field(default=NO_EVIDENCE, repr=False)
    short_horizon: tuple[int, int] | None = None
    hopeless: bool = False
    dead_end: bool = False

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli execute --json` prints: the folder's run.json."""
        return {name: plain(value) for name, value in self.record.items()}

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _repr_html_(self) -> str:
        rows = tuple((kind.replace("_", " "), f"{spent:z.1f}") for kind, spent in self.seconds.items())
        told = "".join(f"<p>{shown(line)}</p>" for line in self._lines())
        return f"<div>{told}{TextTable(('seconds of', 's'), rows).html()}</div>"

    def _lines(self) -> Iterator[str]:
        """The symbolic world is not called clean, and has no looks that would take time."""
        kinds = {kind: s for kind, s in self.seconds.items() if s >= _SHORT or not self.told}
        done = "done" if self.told else "clean"
        yield (f"{'' if self.clean else 'not '}{done}: {self.reason}, after {plural(self.actions, 'action')}")
        if self.told:
            yield f"in the end: {self.told}"
        yield from unreached_lines(self.hopeless, self.short_horizon, self.dead_end)
        if kinds:
            spent = ", ".join(f"{kind.replace('_', ' ')} {s:z.1f}" for kind, s in kinds.items())
            yield f"seconds: {sum(self.seconds.values()):z.1f} ({spent})"
        if "particles" in self.truth:
            yield from _left(self.truth)
        yield f"record: {self.folder}/  page: {PAGE}" + ("  video: video.mp4" if self.video else "")


def _left(truth: Mapping[str, object]) -> Iterator[str]:
    """Where the dirt truly is: particles, ink, or both."""
    if truth["ink_left"] is not None:
        yield f"truly: {truth['ink_left']:z.1%} of the ink left"
    if not truth["particles"] and truth["ink_left"] is not None:
        return
    total, zone = truth["particles"], truth.get("in_zone")
    arrived = (
        f"{truth['in_container']} of {total} particles in the container"
        if zone is None
        else f"{zone} of {total} particles in the zone, {truth['in_container']} in the container"
    )
    yield (
        f"truly: {arrived}, {truth['on_table']} {'' if zone is None else 'elsewhere '}on the table,"
        f" {truth['on_floor']} on the floor"
        + (f", {truth['in_dustpan']} in the dustpan" if truth["in_dustpan"] else "")
    )
    if truth["on_table"]:
        yield f"left on the table at (m): {truth['left_on_table_at']}"


def ended_result(run: Run, inputs: Inputs) -> RunResult:
    """What a run that has ended came to, from its folder. Raises Refused, OSError, and BadOption for one that
    has not ended."""
    folder, ended = run.folder, run.header.episode
    if ended is None:
        raise BadOption(f"{folder} has not ended")
    saved = last_checkpoint(folder, inputs)
    record: dict[str, Any] = json.loads(read_text(folder, RUN, LARGEST_HEADER).text)
    seconds = {kind: spent for kind, spent in ended.seconds.items() if kind != "total"}
    truth = record.get("truth") or {}
    return RunResult(
        folder,
        ended.clean,
        ended.reason,
        ended.actions,
        seconds,
        truth,
        told_in_the_end(inputs, saved.situation),
        bool(run.videos),
        record,
        saved.evidence,
        short_horizon(inputs, ended.clean, ended.reason),
        hopeless(inputs, ended.clean),
        is_dead_end(inputs, ended.clean, saved.situation),
    )


def told_in_the_end(inputs: Inputs, situation: Situation | None) -> str:
    """What holds in the symbolic world after the last look; nothing is told so of a table."""
    given = inputs.given
    if situation is None or not isinstance(given, Problem):
        return ""
    return told_of(inputs.domain, given)(situation)


def hopeless(inputs: Inputs, done: bool) -> bool:
    """Whether it is certain that no action of the symbolic world leads to the goal, which was not reached."""
    given = inputs.given
    if done or not isinstance(given, Problem):
        return False
    return is_hopeless(_rules(inputs), given)


def is_dead_end(inputs: Inputs, done: bool, situation: Situation | None) -> bool:
    """Whether it is certain that no action of the symbolic world leads from the last situation to the goal,
    which was not reached."""
    given = inputs.given
    if done or not isinstance(given, Problem) or situation is None:
        return False
    return is_hopeless(_rules(inputs), replace(given, state=situation.state))


def _rules(inputs: Inputs) -> Domain:
    """The domain whose rules hold in the symbolic world."""
    return inputs.domain if inputs.world is None else inputs.world.model


def short_horizon(inputs: Inputs, done: bool, reason: str) -> tuple[int, int] | None:
    """The horizon of the first plan and a longer one to try, where the run gave up and its problem states
    none."""
    given = inputs.given
    if done or not isinstance(given, Problem) or given.horizon is not None or not given.goal:
        return None
    if not reason.startswith(IDLE):
        return None
    return first_and_longer(inputs.domain, given, Options().counted)
