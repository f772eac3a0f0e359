"""A problem as a file states it, or as one look at a scene's table shows it."""

from __future__ import annotations

from cleancli.api.seen import seen
from cleancli.cli.inputs import open_given
from cleancli.cli.progress import working
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.model import Domain, Problem


def open_both(domain: str, problem: str) -> tuple[tuple[Source, ...], Domain, Problem]:
    """A domain with its texts, and a problem of it; a scene is looked at once, with its own seed.

    Of a scene's domain, the actions stay that the robot has skills for. Raises Refused.
    """
    given = open_given(domain, problem)
    with working("looking at the table", quiet=not given.is_scene):
        looked, _ = seen(given, None, {})
    return given.domain.sources, looked.domain, looked.problem
