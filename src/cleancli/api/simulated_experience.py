"""Simulated episodes as experience to learn from."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from cleancli.api.simulation_result import SimulationResult
from cleancli.compiler.fluents import values_of
from cleancli.files.plain import naming
from cleancli.learning.experience import Transition, encode
from cleancli.simulation.batch import Batch
from cleancli.simulation.episode import Episode, replayed
from cleancli.simulation.symbolic_world import world_of


def experience_of(setup: Batch, planner: str, played: Iterable[Episode]) -> Iterator[str]:
    """The lines of an experience file that tells what a planner did in some episodes, without line ends."""
    world, seed = world_of(setup.world, setup.problem, setup.timed), setup.options.seed
    for episode in played:
        origin = {"seed": seed, "planner": planner, "episode": episode.number}
        for number, (before, step, after) in enumerate(replayed(world, episode, seed), start=1):
            action = step.action
            states = [values_of(world.facts(state)) for state in (before, after)]
            transition = Transition(action.name, action.objects, setup.problem.objects, states[0], states[1])
            lasted = {} if step.seconds is None else {"transit": 0.0, "seconds": round(step.seconds, 3)}
            yield encode(transition, {**origin, "number": number, **lasted})


def write_experience(setup: Batch, result: SimulationResult, path: Path) -> None:
    """Write what was done in all episodes into a new experience file, for `learn`. Raises OSError, where the
    file exists too."""
    with path.open("x", encoding="utf-8") as file, naming(path):
        for summary, played in zip(result.planners, result.episodes, strict=True):
            for line in experience_of(setup, summary.planner, played):
                file.write(line + "\n")
