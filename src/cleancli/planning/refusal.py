"""Turns what a planner refuses into mistakes at the places that they come from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from cleancli.compiler.semantics import SupportTooLargeError
from cleancli.compiler.task import NoDurationError
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.refactoring.name_index import Kind, names_in
from cleancli.language.syntax import ActionNode
from cleancli.planning.plan import PlanningRefused

_HELP = "plan with another planner, such as prada, or for fewer objects"


@contextmanager
def planning_refused(sources: Sequence[Source]) -> Iterator[None]:
    """Raise Refused for what planners raise: E902 at each action that lacks a duration, E903 at the name of
    the problem, in whichever of the texts it stands."""
    try:
        yield
    except NoDurationError as error:
        raise Refused(_without_duration(error, sources), sources) from None
    except (PlanningRefused, SupportTooLargeError) as error:
        raise Refused([_refused(error, sources)], sources) from None


def _without_duration(error: NoDurationError, sources: Sequence[Source]) -> Iterator[Diagnostic]:
    """A mistake for each of the actions, wherever it is declared without a duration."""
    for place in (name for source in dict.fromkeys(sources) for name in names_in(source) if name.declares):
        node, name = place.node, place.meaning.name
        marks = [mark.name.text for mark in node.attributes] if isinstance(node, ActionNode) else ["duration"]
        if name in error.actions and "duration" not in marks:
            message = f"{error.wanted}, but `{name}` has no duration"
            yield Diagnostic("E902", message, place.span, help="declare one: `[duration = 8 s]`")


def _refused(error: ValueError, sources: Sequence[Source]) -> Diagnostic:
    places = (name for source in sources for name in names_in(source) if name.declares)
    span = next((p.span for p in places if p.meaning.kind in (Kind.PROBLEM, Kind.SCENE)), None)
    help = error.help if isinstance(error, PlanningRefused) else ""
    return Diagnostic("E903", f"this cannot be planned: {error}", span, help=help or _HELP)
