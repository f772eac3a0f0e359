"""Says of a problem what it wants in vain, before time goes into it: W403 and W404."""

from __future__ import annotations

from collections.abc import Sequence

from cleancli.cli.echo import echo_refused
from cleancli.compiler.short_horizon import ShortHorizon, longer_horizon, out_of_reach, short_horizon
from cleancli.compiler.task import Task
from cleancli.compiler.unreached import Unreached, unreached
from cleancli.conversion.pddl.places import place_of_goal
from cleancli.conversion.pddl.recognized import is_pddl
from cleancli.language.checking.declarations import sections_of
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source, Span
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Horizon, Problem
from cleancli.language.parsing.parse import kind_of
from cleancli.language.parsing.read import parse_as
from cleancli.language.syntax import Goal, ProblemNode

_MOST_NAMED = 3


def warnings_of(source: Source, domain: Domain, problem: Problem, number: int = 0) -> tuple[Diagnostic, ...]:
    """W403 for what no action can bring about, at its place in the problem's text; `number` of the problems
    before it that a PDDL text defines."""
    return tuple(_warning(each, problem, _place(source, number)) for each in unreached(domain, problem))


def warnings_of_states(
    source: Source, problem: Problem, task: Task, number: int = 0
) -> tuple[Diagnostic, ...]:
    """W403 where the goal holds in no state of the grounded problem that may occur, and W404 where it takes
    more actions than plans have; `number` as in `warnings_of`."""
    if out_of_reach(task, problem):
        return (_never(problem, "it holds in no state that actions may lead to", _place(source, number)),)
    found = short_horizon(task)
    if found is None:
        return ()
    return (_too_short(found, longer_horizon(task), problem, _place(source, number)),)


def tell_unreached(sources: Sequence[Source], domain: Domain, problem: Problem) -> None:
    """Print the warnings of a problem, whose text is the last of `sources`; of a scene nothing is said."""
    if not is_pddl(sources[-1]) and kind_of(sources[-1]) != "problem":
        return
    found = warnings_of(sources[-1], domain, problem)
    if found:
        echo_refused(Refused(found, sources))


def _place(source: Source, number: int) -> Span:
    if is_pddl(source):
        return place_of_goal(source, number) or Span(source.path, 0, 0)
    root, _ = parse_as(source, "problem")
    assert isinstance(root, ProblemNode)
    for section in sections_of(root.sections, Goal):
        return Span(section.span.path, section.span.start, section.span.start + len("goal"))
    return root.name.span


def _warning(found: Unreached, problem: Problem, place: Span) -> Diagnostic:
    named = [f"`{literal}`" for literal in found.never[:_MOST_NAMED]]
    if len(found.never) > _MOST_NAMED:
        named.append(f"{len(found.never) - _MOST_NAMED} more")
    untrue = f"no action makes {' or '.join(named)} true" if named else None
    if found.count is None:
        return _never(problem, untrue or "its parts never hold together", place)
    message = f"`{found.count}` can never fall to 0 in `{problem.name}`"
    reason = untrue or "no action changes what it counts"
    help = "write a rule that brings it about, or take out of `init` what no action can end"
    return Diagnostic("W403", f"{message}: {reason}", place, help=help, level=Level.WARNING)


def _never(problem: Problem, reason: str, place: Span) -> Diagnostic:
    message = f"the goal of `{problem.name}` can never be reached: {reason}"
    help = "add what is missing to `init`, write a rule that brings it about, or correct the goal"
    return Diagnostic("W403", message, place, help=help, level=Level.WARNING)


def _too_short(found: ShortHorizon, longer: int, problem: Problem, place: Span) -> Diagnostic:
    takes = f"more than {found.horizon}" if found.least is None else f"at least {found.least}"
    is_guess = isinstance(problem.horizon, Horizon) and problem.horizon.is_guess
    unstated = ": the problem states no horizon" if problem.horizon is None or is_guess else ""
    message = (
        f"the goal of `{problem.name}` takes {takes} actions,"
        f" and plans have {plural(found.horizon, 'action')} at most{unstated}"
    )
    help = f"write for example `horizon = {longer}`, so that there is time for what fails and is tried again"
    if is_guess:
        help = f"PDDL has none, so this is a guess: `cleancli convert --horizon {longer}` states another"
    return Diagnostic("W404", message, place, help=help, level=Level.WARNING)
