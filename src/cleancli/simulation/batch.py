"""Many episodes of several planners on the same draws, on one process or several."""

from __future__ import annotations

import math
import multiprocessing
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Any

from cleancli.compiler.task import NoDurationError, Objective
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Problem
from cleancli.planning.plan import Options
from cleancli.planning.planner import Planner
from cleancli.simulation.agent import Agent
from cleancli.simulation.episode import Episode, EpisodeLimits, episode
from cleancli.simulation.symbolic_world import world_of

CHUNKS = 8
"""Pieces that each process gets, so that none waits long for the last. Chosen."""


@dataclass(frozen=True, slots=True)
class Batch:
    """What is simulated: `domain` is what the planners know, `world` what holds; `objective` as
    planning/objective.py has them, None for the usual one."""

    domain: Domain
    world: Domain
    problem: Problem
    planners: tuple[Planner[Any], ...]
    options: Options
    limits: EpisodeLimits
    objective: str | None = None

    @property
    def timed(self) -> bool:
        """Whether time discounts rewards, and not the number of actions."""
        return self.objective == Objective.TIME.value


Round = tuple[Episode, ...]
"""The same numbered episode by each planner of the setup, in its order."""


def rounds(setup: Batch, numbers: Sequence[int]) -> Iterator[Round]:
    """The numbered episodes of each planner. Raises `Refused`, `NoDurationError` and what planners raise."""
    world = world_of(setup.world, setup.problem, setup.timed)
    if setup.limits.think and world.task.untimed:
        raise NoDurationError(world.task.untimed, "thinking takes robot time")
    agents = [Agent(planner, setup.domain, setup.problem, setup.objective) for planner in setup.planners]
    for number in numbers:
        yield tuple(episode(world, agent, number, setup.options, setup.limits) for agent in agents)


def spread(setup: Batch, episodes: int, jobs: int) -> Iterator[Round]:
    """Episodes 0 to `episodes` - 1, as they come to an end, by so many processes: for any number of them the
    same, but for the order and for what depends on the clock.

    The first is run here: it shows mistakes, and compiles what the others load. Raises as `rounds` does.
    """
    if jobs == 1:
        yield from rounds(setup, range(episodes))
        return
    yield from rounds(setup, range(1))
    chunk = max(math.ceil((episodes - 1) / (jobs * CHUNKS)), 1)
    chunks = [range(start, min(start + chunk, episodes)) for start in range(1, episodes, chunk)]
    executor = ProcessPoolExecutor(min(jobs, max(len(chunks), 1)), multiprocessing.get_context("spawn"))
    try:
        futures = {executor.submit(_chunk, setup, numbers): numbers for numbers in chunks}
        for future in as_completed(futures):
            found = future.result()
            yield from rounds(setup, futures[future]) if found is None else found
    finally:
        executor.shutdown(cancel_futures=True)


def _chunk(setup: Batch, numbers: range) -> list[Round] | None:
    """None where something is refused: the errors' own data does not travel between processes, so the caller
    has to meet them itself."""
    try:
        return list(rounds(setup, numbers))
    except (Refused, ValueError):
        return None
