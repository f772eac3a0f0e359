"""Turns what a planner refuses into mistakes at the places that they come from."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress

from cleancli.compiler.semantics import SupportTooLargeError
from cleancli.compiler.task import NoDurationError
from cleancli.conversion.pddl.places import place_of_problem
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.refactoring.name_index import Kind, Occurrence, names_in
from cleancli.language.syntax import ActionNode
from cleancli.planning.plan import PlanningRefused

_HELP = "plan with another planner, such as prada, or for fewer objects"
_HELP_PDDL = "declare one, `[duration = 8 s]`, in the .nid file that `cleancli convert` writes"


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
    """A mistake for each of the actions, wherever it is declared without a duration; one that no .nid text
    declares is from PPDDL."""
    lacking = set(error.actions)
    for place in _declared(sources):
        node, name = place.node, place.meaning.name
        marks = [mark.name.text for mark in node.attributes] if isinstance(node, ActionNode) else ["duration"]
        if name in error.actions and "duration" not in marks:
            lacking.discard(name)
            message = f"{error.wanted}, but `{name}` has no duration"
            yield Diagnostic("E902", message, place.span, help="declare one: `[duration = 8 s]`")
    for name in sorted(lacking):
        message = f"{error.wanted}, but `{name}` has no duration"
        yield Diagnostic("E902", message, None, help=_HELP_PDDL)


def _refused(error: ValueError, sources: Sequence[Source]) -> Diagnostic:
    kinds = (Kind.PROBLEM, Kind.SCENE)
    span = next((place.span for place in _declared(sources) if place.meaning.kind in kinds), None)
    help = error.help if isinstance(error, PlanningRefused) else ""
    message = f"this cannot be planned: {error}"
    span = span or next(filter(None, map(place_of_problem, sources)), None)
    return Diagnostic("E903", message, span, help=help or _HELP)


def _declared(sources: Sequence[Source]) -> Iterator[Occurrence]:
    """What the .nid texts declare; those in PPDDL are passed over."""
    for source in dict.fromkeys(sources):
        with suppress(Refused):
            yield from (name for name in names_in(source) if name.declares)
