"""The problem that is meant, or what one look at a scene shows of it."""

from __future__ import annotations

from cleancli.api.inputs import LoadedProblem
from cleancli.api.timing import timed
from cleancli.execution.observed import ObservedProblem, look
from cleancli.language.load import located_in
from cleancli.language.model import Problem


def seen(
    given: LoadedProblem, seed: int | None, seconds: dict[str, float]
) -> tuple[ObservedProblem, int | None]:
    """The problem, or what one look at the scene says; then with the scene's seed where none is asked for."""
    model = given.domain.model
    if isinstance(given.model, Problem):
        return ObservedProblem(model, given.model, ()), seed
    seed = given.model.seed if seed is None else seed
    with timed(seconds, "look"), located_in(*given.sources):
        return look(model, given.model, seed), seed
