"""PPDDL files as checked models, so that commands take them as they are; mistakes have their places there."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from cleancli.conversion.pddl.draft import Draft, Wishes, draft_of
from cleancli.conversion.pddl.read import read
from cleancli.conversion.pddl.recognized import is_pddl
from cleancli.conversion.pddl.syntax import ProblemNode
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import checked_domain, checked_problem
from cleancli.language.model import Action, Domain, Problem, Rule
from cleancli.language.printing.printer import print_domain, print_problem

_RULE = re.compile(r"^  rule \w+: (\w+)\(", re.M)


def defines_domain(source: Source) -> bool:
    """Whether a PDDL text defines a domain."""
    return bool(read(source, Findings(source))[0])


def defines_problem(source: Source) -> bool:
    """Whether a PDDL text defines a problem."""
    return bool(read(source, Findings(source))[1])


def domain_for(problem: Source, others: Iterable[Source]) -> Source | None:
    """The first of some texts that defines the domain which a problem names."""
    _, problems = read(problem, Findings(problem))
    wanted = {each.domain for each in problems}
    for other in others:
        if is_pddl(other) and any(domain.name in wanted for domain in read(other, Findings(other))[0]):
            return other
    return None


@dataclass(frozen=True, slots=True)
class Models:
    """A domain and the problems of a file, with what was found in them, and the texts that this points into.
    What a mistake is about is the place of the action in PPDDL."""

    domain: Domain
    problems: tuple[Problem, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


def models_of(domain: Source, problem: Source | None = None) -> Models:
    """The models of a domain, and of the problems that another file (or the same) defines for it.

    Raises Refused with every mistake.
    """
    findings = Findings(domain)
    domains, problems = read(domain, findings)
    if problem is None:
        problems = ()
    elif problem.path != domain.path:
        findings.include(problem, (), frozenset())
        problems = read(problem, findings)[1]
    if problem is not None:
        _refuse_none(problem, problems, findings)
    draft = draft_of(domains, problems, findings, Wishes())
    text = Source(f"{draft.domain.name}.nid", print_domain(draft.domain))
    others = [
        Source(f"{each.problem.name}.nid", print_problem(each.problem, draft.domain))
        for each in draft.problems
    ]
    places = {text.path: draft.place}
    places |= {other.path: each.place for other, each in zip(others, draft.problems, strict=True)}
    checked = checked_domain(text)
    looked = [checked_problem(other, checked.model) for other in others] if checked.model is not None else []
    found = [each for each in checked.diagnostics if each.code != "W201" or problem is None]
    found += [each for other in looked for each in other.diagnostics]
    told = (*findings.sorted, *(_in_pddl(each, text, draft, places) for each in found))
    if checked.model is None or any(other.model is None for other in looked):
        raise Refused(told, findings.sources)
    return Models(
        _placed(checked.model, draft), tuple(other.get() for other in looked), told, tuple(findings.sources)
    )


def _refuse_none(source: Source, problems: Sequence[ProblemNode], findings: Findings) -> None:
    if not problems and not findings.errors:
        help = "write `(define (problem NAME) (:domain ...) ...)`"
        findings.error("E915", "no problem is defined", Span(source.path, 0, 0), help=help)


def _placed(domain: Domain, draft: Draft) -> Domain:
    """The domain with the places of PPDDL in place of those in its text."""
    rules = tuple(_rule(rule, draft.actions.get(rule.action, draft.place)) for rule in domain.rules)
    return replace(domain, rules=rules, actions=tuple(map(_action, domain.actions)), end=None)


def _rule(rule: Rule, place: Span) -> Rule:
    outcomes = tuple(replace(each, probability_span=None, weight_span=None) for each in rule.outcomes)
    return replace(rule, outcomes=outcomes, span=place)


def _action(action: Action) -> Action:
    return replace(action, duration_span=None, noted_span=None)


def _in_pddl(diagnostic: Diagnostic, domain: Source, draft: Draft, places: Mapping[str, Span]) -> Diagnostic:
    """The diagnostic at the action that it is about, or where the domain or problem is named."""
    span = diagnostic.span
    if span is None or span.path not in places:
        return diagnostic
    place = places[span.path]
    if span.path == domain.path:
        before = [rule for rule in _RULE.finditer(domain.text) if rule.start() <= span.start]
        place = draft.actions.get(before[-1][1], place) if before else place
    return replace(diagnostic, span=place)
