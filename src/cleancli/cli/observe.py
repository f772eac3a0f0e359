"""A problem as a file states it, or as one look at a scene's table shows it."""

from __future__ import annotations

from cleancli.cli.inputs import open_domain, open_problem
from cleancli.cli.progress import working
from cleancli.execution.observed import look
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import located_in
from cleancli.language.model import Domain, Problem
from cleancli.scene.model import Scene


def open_both(domain: str, problem: str) -> tuple[tuple[Source, ...], Domain, Problem]:
    """A domain with its texts, and a problem of it; a scene is looked at once, with its own seed.

    Of a scene's domain, the actions stay that the robot has skills for. Raises Refused.
    """
    _, sources, model = open_domain(domain)
    given = open_problem(problem, model)
    if isinstance(given, Scene):
        with located_in(*sources), working("looking at the table"):
            seen = look(model, given, given.seed)
        return sources, seen.domain, seen.problem
    return sources, model, given
