"""What a PPDDL domain and its problems become, before it is text that the checker has looked at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial

from cleancli.conversion.pddl.beginning import begun
from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.domain import USUAL_HORIZON, declarations_of, domain_of, problem_of
from cleancli.conversion.pddl.effects import (
    Effects,
)
from cleancli.conversion.pddl.ending import ended
from cleancli.conversion.pddl.functions import Function, Functions
from cleancli.conversion.pddl.naming import Naming, readable
from cleancli.conversion.pddl.problem import Start, metric_of, names_of, starts_of
from cleancli.conversion.pddl.rejoined import rejoined
from cleancli.conversion.pddl.resolve import Words
from cleancli.conversion.pddl.schemas import Schema, schemas_of
from cleancli.conversion.pddl.stated import refuse_unstated
from cleancli.conversion.pddl.statics import Statics
from cleancli.conversion.pddl.syntax import DomainNode, ProblemNode
from cleancli.language.diagnostics.diagnostic import Level, Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Domain, Horizon, Problem
from cleancli.language.printing.printer import print_fraction

_HIDE_NOTHING = frozenset({"E917", "E918"})
"""Mistakes of reading from which no other follows: what cannot be said is left out, and probabilities are in
bounds by now. After others something is missing that was meant to be there."""


@dataclass(frozen=True, slots=True)
class Wishes:
    """What PPDDL leaves open: the domain's name (None: its own) and the horizon of problems (None: a guess
    for those that are to earn rewards, and for others as many actions as it takes). `is_open`: a domain
    without problems is only looked at, so that what these alone say, the objects and the values of functions,
    is no mistake of it. `joins`: schemas that were written for the rules of one .nid action become that
    action, so that actions are not called as in the file."""

    name: str | None = None
    horizon: int | None = None
    is_open: bool = False
    joins: bool = True


@dataclass(frozen=True, slots=True)
class DraftProblem:
    """A problem, what has to be told about it, and where PPDDL names it."""

    problem: Problem
    notes: tuple[str, ...]
    place: Span


@dataclass(frozen=True, slots=True)
class Draft:
    """A domain and its problems, what has to be told about the domain, and where it and its actions (by their
    names) are from."""

    domain: Domain
    problems: tuple[DraftProblem, ...]
    notes: tuple[str, ...]
    place: Span
    actions: Mapping[str, Span]


def draft_of(
    domains: Sequence[DomainNode], problems: Sequence[ProblemNode], findings: Findings, wishes: Wishes
) -> Draft:
    """What one domain and its problems become; `findings` holds what was found when they were read, and the
    texts that they were read from. Raises Refused with every mistake (E915 to E918)."""
    texts = {source.path: source for source in findings.sources}
    _refuse_misfits(domains, problems, findings)
    if any(each.level is Level.ERROR and each.code not in _HIDE_NOTHING for each in findings.sorted):
        findings.refuse_errors()
    domain = domains[0]
    words = Words(domain, problems, findings, texts, is_open=wishes.is_open and not problems)
    metric = metric_of(domain, problems, findings)
    definitions = Definitions(words.symbols)
    functions = Functions(domain, problems, words, metric.earned)
    effects = Effects(words, metric.counted, functions, Statics(domain, problems), metric.earned)
    schemas = schemas_of(domain.actions, words, effects, definitions)
    _warn_of_objects(words)
    starts = starts_of(problems, words, definitions)
    before = schemas
    schemas = ended(schemas, starts, metric, words, definitions)
    first = begun(schemas, starts, words, effects, definitions)
    findings.refuse_errors()
    if wishes.joins:
        declared = partial(declarations_of, first.schemas, words, definitions)
        first = replace(first, schemas=rejoined(first.schemas, texts, declared, words.actions))
    name = wishes.name or readable(Naming(texts).written(domain.name), "d")
    said = tuple(
        replace(start, facts=start.facts | frozenset(functions.facts(place)))
        for place, start in enumerate(first.starts)
    )
    used = [each.symbol for each in functions.used]
    made = domain_of(name, first.schemas, said, metric, words, definitions, used, Naming(texts))
    places = {schema.action.name: schema.place for schema in first.schemas}
    refuse_unstated(made, places, domain.name.span, findings)
    findings.refuse_errors()
    begins = int(first.action is not None)
    drawn = f"chance decides of what holds at first: `{first.action}()` draws it"
    drafts = []
    for title, start in zip(names_of(problems, name, Naming(texts)), said, strict=True):
        usual = USUAL_HORIZON if metric.earned or not start.goal else None
        steps = wishes.horizon or usual
        problem = problem_of(title, start, made, words, None if steps is None else steps + begins)
        told = (*_guesses(start, problem, wishes), *([drawn] if first.action is not None else []))
        drafts.append(DraftProblem(problem, told, start.node.name.span))
    counted = {*effects.counted, *functions.names}
    notes = (*_notes(domain, made, first.schemas, words, counted), *effects.notes)
    notes += tuple(
        _about(each) for each in functions.used if each.parts > 1 or each.least or each.known is not None
    )
    if schemas != before:
        notes += ("nothing is done where the goal holds, which ends what can be earned",)
    return Draft(made, tuple(drafts), notes, domain.name.span, places)


def _refuse_misfits(
    domains: Sequence[DomainNode], problems: Sequence[ProblemNode], findings: Findings
) -> None:
    """E915 for no domain and for several, W911 for a problem of another."""
    if not domains and not findings.errors:
        start = Span(findings.source.path, 0, 0)
        findings.error("E915", "no domain is defined", start, help="give the domain's file as well")
    for domain in domains[1:]:
        findings.error("E915", "a second domain is defined", domain.name.span, help="convert one at a time")
    for problem in problems:
        if domains and problem.domain is not None and problem.domain != domains[0].name:
            message = f"the problem is for `{problem.domain.text}`, not for `{domains[0].name.text}`"
            findings.warning("W911", message, problem.domain.span, "taken to be for it")


def _warn_of_objects(words: Words) -> None:
    """W911 for what actions name and a problem alone declares."""
    constants = set(words.constants.values())
    for thing, span in words.named.items():
        if thing not in constants:
            message = f"the domain names `{thing.name}`, and only a problem declares it"
            words.findings.warning("W911", message, span, "taken as a constant")


def _notes(
    node: DomainNode,
    domain: Domain,
    schemas: Sequence[Schema],
    words: Words,
    counted: Set[str],
) -> tuple[str, ...]:
    """What the texts do not say as the files do; `counted` are the functions that they say."""
    declared = {symbol.name for symbol in domain.symbols}
    unused = [each.name for each in words.predicates.values() if each.name not in declared]
    acting = {rule.action for rule in domain.rules}
    kept = [schema for schema in schemas if schema.action.name in acting]
    placed = {place for schema in kept for place in (schema.place, *schema.joined)}
    idle = [action.name.text for action in node.actions if action.name.span not in placed]
    functions = [each.name.text for each in node.functions if each.name.text not in counted]
    parts = (
        ("predicates that nothing asks for and nothing changes", unused),
        ("actions that change nothing", idle),
        ("functions that count for nothing", functions),
    )
    return tuple(f"left out: {what}: {', '.join(names)}" for what, names in parts if names)


def _about(function: Function) -> str:
    """How a function says what PDDL says."""
    name, parts = function.symbol.name, f"parts of 1/{function.parts}"
    counts = [f"counts {parts}"] if function.parts > 1 else []
    counts += [f"counts from {print_fraction(function.least)} on"] if function.least else []
    known = [] if function.known is None else [f"has a value in PDDL where `{function.known}` holds"]
    return f"`{name}` {' and '.join([*counts, *known])}"


def _guesses(start: Start, problem: Problem, wishes: Wishes) -> tuple[str, ...]:
    """What was left open, and what has no word in .nid files."""
    found = []
    if isinstance(problem.horizon, Horizon) and wishes.horizon is None:
        found.append("the horizon is a guess: PPDDL has none")
    if start.node.goal_probability is not None:
        found.append("the goal is to be reached as surely as can be, whatever :goal-probability asks")
    return tuple(found)
