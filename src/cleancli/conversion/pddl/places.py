"""Where a PDDL text says what messages are about that have no place of their own: what plans are refused for,
and goals that are out of reach.

What stands in comments is passed over. A text that cannot be read has no places.
"""

from __future__ import annotations

from itertools import islice

from cleancli.conversion.pddl.recognized import is_pddl
from cleancli.conversion.pddl.words import Group, Node, Word, groups_of
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.sink import Findings


def place_of_problem(source: Source) -> Span | None:
    """The name of the first problem that a text defines; None where it defines none, or is no PDDL."""
    problem = _problem(source, 0)
    head = None if problem is None else problem.items[1]
    return _span(head.items[1], source) if isinstance(head, Group) and len(head.items) > 1 else None


def place_of_goal(source: Source, number: int) -> Span | None:
    """The word `:goal` of a problem that a text defines, behind a `number` of others; None where there is
    none."""
    problem = _problem(source, number)
    sections = () if problem is None else problem.items[2:]
    goals = (each.items[0] for each in sections if isinstance(each, Group) and each.head == ":goal")
    return next((_span(goal, source) for goal in goals), None)


def _problem(source: Source, number: int) -> Group | None:
    groups = groups_of(source.text, source.path, Findings(source)) if is_pddl(source) else ()
    found = (group for group in groups if group.head == "define" and _names_problem(group))
    return next(islice(found, number, None), None)


def _names_problem(group: Group) -> bool:
    head = group.items[1] if len(group.items) > 1 else None
    return isinstance(head, Group) and head.head == "problem"


def _span(node: Node, source: Source) -> Span | None:
    return Span(source.path, node.start, node.end) if isinstance(node, Word) else None
