"""An episode of a study: all that decides how it goes, its key, and carrying it out."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from types import MappingProxyType
from typing import Any

from cleancli.api.inputs import LoadedDomain, LoadedProblem
from cleancli.api.lessons import Counting
from cleancli.api.provenance import versions
from cleancli.api.run_inputs import Inputs, inputs_of
from cleancli.api.run_session import open_session
from cleancli.execution.episode_state import EpisodeState
from cleancli.execution.events import Checkpoint, Ended, Looked, Purpose
from cleancli.execution.loop import clean, saving
from cleancli.execution.session import Session, stand_in_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.execution.symbolic_cell import SymbolicCell
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, kind_of, load_problem
from cleancli.learning.evidence import NO_EVIDENCE, Evidence
from cleancli.planning.refusal import planning_refused
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.study.model import Limits, Value
from cleancli.study.row import REFUSED, Row
from cleancli.study.schema import NOTHING

DECIDING = ("cleancli", "pybullet")
"""Those whose versions are part of an episode's key."""

Axes = Mapping[str, Value]


@dataclass(frozen=True, slots=True)
class Texts:
    """The texts that go into an episode: of the domain, with those that it includes; of the scene or problem,
    with what was varied, and the calibration that it names; of the rules of the symbolic world, if others."""

    domain: tuple[Source, ...]
    given: Source
    calibration: Source | None = None
    world: tuple[Source, ...] = ()

    def hashes(self) -> tuple[str, ...]:
        """The SHA-256 of each."""
        return _hashes(self)


@dataclass(frozen=True)
class Episode:
    """One episode. `axes` of its cell; `run` and `number` in its series from 1. `before`: the key of the one
    before it in its series, from which it goes on. `versions`: of what may decide how it goes."""

    study: str
    part: str
    axes: Axes
    run: int
    number: int
    seed: int
    limits: Limits
    texts: Texts
    versions: Mapping[str, str]
    before: str = ""

    @cached_property
    def key(self) -> str:
        """The SHA-256 of all that decides how it goes, and of nothing else."""
        content = {
            "texts": self.texts.hashes(),
            "options": {axis: value for axis, value in self.axes.items() if is_option(axis)},
            "limits": (self.limits.max_actions, self.limits.max_seconds),
            "seed": self.seed,
            "versions": {name: self.versions.get(name) for name in DECIDING},
            "before": self.before,
        }
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class Finished:
    """What an episode came to, and what it and those before it in its series have seen."""

    row: Row
    evidence: Evidence = NO_EVIDENCE


class OtherVersion(Exception):
    """A worker has not the versions that a study was begun with; the message says which."""


def is_option(axis: str) -> bool:
    """Whether an axis says how an episode is carried out; of the others the texts tell."""
    return axis not in ("domain", "scene", "world") and "." not in axis


def carried_out(episode: Episode, evidence: Evidence = NO_EVIDENCE) -> Finished:
    """Carry an episode out, as `cleancli execute` does; the same each time, real time aside.

    A planner that refuses leaves the table as it is. Raises OtherVersion.
    """
    _refuse_other_versions(episode.versions)
    inputs = replace(inputs_for(episode), evidence=evidence)
    cpu, real = time.process_time(), time.perf_counter()
    with closing(opened(inputs, episode.axes)) as session:
        state, ended, unknown = EpisodeState(evidence=evidence), None, 0
        try:
            with planning_refused(inputs.sources):
                for event in saving(clean(session.setup, session.cell), session.save):
                    if isinstance(event, Checkpoint):
                        state = event.state
                    elif isinstance(event, Looked):
                        unknown += event.purpose is Purpose.LEARNING
                    elif isinstance(event, Ended):
                        ended = event
        except Refused as refused:  # by a planner: it has not cleaned the table
            reason = f"{REFUSED}{refused.diagnostics[0].message}"
            ended = Ended(reason, False, state.actions, state.spent, session.cell.clock, 0.0)
        truth, cell = session.truth(), session.cell
        paid = cell.discounted_return(episode.limits.max_actions) if isinstance(cell, SymbolicCell) else None
    assert ended is not None, "an episode's last event closes it"
    spent = time.process_time() - cpu, time.perf_counter() - real
    return Finished(_row(episode, ended, unknown, truth, paid, spent), state.evidence)


def opened(inputs: Inputs, axes: Axes) -> Session:
    """Where an episode takes place. Raises BadOption and ValueError for what there is not."""
    given = inputs.given
    if axes["simulator"] == "stand-in" and isinstance(given, Scene):
        return stand_in_session(inputs.domain, given, inputs.options, inputs.job)
    return open_session(inputs)


def inputs_for(episode: Episode) -> Inputs:
    """What goes into an episode. Raises Refused, BadOption."""
    axes, given = episode.axes, loaded(episode.texts)
    return inputs_of(
        given,
        _asked(axes, given, episode.limits),
        seed=episode.seed,
        objective=_word(axes, "objective"),
        job=_word(axes, "job"),
        known=_whole(axes, "known"),
        world=loaded_domain(episode.texts.world) if episode.texts.world else None,
    )


def _asked(axes: Axes, given: LoadedProblem, limits: Limits) -> EpisodeOptions:
    estimator = axes["estimator"]
    counting = None
    if estimator != NOTHING:
        m, forgetting = axes.get("m"), axes.get("forgetting")
        counting = Counting(
            str(estimator),
            None if m is None else float(m),
            _word(axes, "match"),
            None if forgetting is None else float(forgetting),
        )
    return EpisodeOptions(
        strategy=str(axes["strategy"]),
        planner=_word(axes, "planner") or None,
        samples=int(axes.get("samples") or EpisodeOptions().samples),
        max_actions=limits.max_actions,
        max_seconds=limits.max_seconds,
        learning=None if counting is None else counting.method(given.domain.model),
        optimism=str(axes.get("optimism", "prior")),
    )


def _word(axes: Axes, name: str) -> str | None:
    value = axes.get(name)
    return None if value is None else str(value)


def _whole(axes: Axes, name: str) -> int | None:
    value = axes.get(name)
    return None if value is None else int(value)


# ---- texts


@lru_cache(maxsize=1024)
def _hashes(texts: Texts) -> tuple[str, ...]:
    """Those of a cell are asked for once an episode."""
    calibration = () if texts.calibration is None else (texts.calibration,)
    sources = (*texts.domain, texts.given, *calibration, *texts.world)
    return tuple(hashlib.sha256(each.text.encode()).hexdigest() for each in sources)


@lru_cache(maxsize=64)
def loaded_domain(sources: tuple[Source, ...]) -> LoadedDomain:
    """The domain of some texts, the first of which includes the others. Kept: a worker meets it again."""
    texts = {source.path: source for source in sources}
    model = checked_domain(sources[0], True, lambda file: texts[str(file)]).get()
    return LoadedDomain(model.name, model, sources)


@lru_cache(maxsize=64)
def loaded(texts: Texts) -> LoadedProblem:
    """The scene or problem of some texts, with its domain. Raises Refused."""
    domain, given = loaded_domain(texts.domain), texts.given
    if kind_of(given) != "scene":
        problem = load_problem(given, domain.model)
        return LoadedProblem(problem.name, problem, domain, given)
    content = b"" if texts.calibration is None else texts.calibration.text.encode()
    scene = load_scene(given, lambda _: content)
    return LoadedProblem(scene.name, scene, domain, given)


@cache
def versions_here() -> Mapping[str, str]:
    """Looked up once a process, which takes a millisecond."""
    return MappingProxyType(versions())


def _refuse_other_versions(asked: Mapping[str, str]) -> None:
    found = versions_here()
    for name in DECIDING:
        if found.get(name) != asked.get(name):
            raise OtherVersion(f"the worker has {name} {found.get(name)}, the study {asked.get(name)}")


# ---- rows


def _row(
    episode: Episode,
    ended: Ended,
    unknown: int,
    truth: Mapping[str, Any],
    paid: float | None,
    spent: tuple[float, float],
) -> Row:
    pieces = truth.get("particles", 0)
    zone = truth.get("in_zone")
    away = truth.get("in_container", 0) + truth.get("in_dustpan", 0) if zone is None else zone
    ink = truth.get("ink_left")
    return Row(
        study=episode.study,
        part=episode.part,
        axes=dict(episode.axes),
        run=episode.run,
        episode=episode.number,
        seed=episode.seed,
        clean=ended.clean,
        reason=ended.reason,
        actions=ended.actions,
        unknown=unknown,
        seconds=ended.spent.by_kind(),
        total=ended.spent.total,
        pieces=pieces,
        left=truth.get("on_table", 0),
        on_floor=truth.get("on_floor", 0),
        ink_left=ink,
        score=away / pieces if pieces else None if ink is None else 1 - ink,
        cpu=spent[0],
        real=spent[1],
        versions=dict(versions_here()),
        files=episode.texts.hashes(),
        key=episode.key,
        paid=paid,
    )
