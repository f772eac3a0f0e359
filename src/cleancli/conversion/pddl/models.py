"""PPDDL files as checked models, so that commands take them as they are; mistakes have their places there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from cleancli.conversion.pddl.draft import DraftProblem, Wishes, draft_of
from cleancli.conversion.pddl.read import read
from cleancli.conversion.pddl.recognized import is_pddl
from cleancli.conversion.pddl.syntax import ProblemNode
from cleancli.conversion.pddl.trees import domain_tree, problem_tree
from cleancli.language.checking.domain import check_domain
from cleancli.language.checking.problem import check_aims
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Domain, Horizon, Problem, Rule


def defines_domain(source: Source) -> bool:
    """Whether a PDDL text defines a domain."""
    return bool(read(source, Findings(source))[0])


def defines_problem(source: Source) -> bool:
    """Whether a PDDL text defines a problem."""
    return bool(read(source, Findings(source))[1])


def refuse_unreadable(source: Source) -> None:
    """Raises Refused for a PDDL text that cannot be read as a whole."""
    findings = Findings(source)
    read(source, findings)
    findings.refuse_errors()


def domain_for(problem: Source, others: Iterable[Source]) -> Source:
    """The first of some texts that defines the domain which a problem names. Raises Refused where none does:
    E915 for a problem that names no domain, E916 for one that is not found."""
    findings = Findings(problem)
    wanted = [each.domain for each in read(problem, findings)[1]]
    found = list[str]()
    for other in filter(is_pddl, others):
        names = [domain.name for domain in read(other, Findings(other))[0]]
        if any(name in wanted for name in names):
            return other
        found += [name.text for name in names]
    named = [name for name in wanted if name is not None]
    if named:
        findings.unknown("E916", "domain", named[0].text, named[0].span, found)
    else:
        help = "write `(:domain NAME)`, or give the domain's file as well"
        findings.error("E915", "this problem names no domain", Span(problem.path, 0, 0), help=help)
    raise Refused(findings.sorted, findings.sources)


@dataclass(frozen=True, slots=True)
class Models:
    """A domain and the problems of a file, with what was found in them, and the texts that this points into.
    What a mistake is about is the place of the action in PPDDL."""

    domain: Domain
    problems: tuple[Problem, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


def models_of(domain: Source, problem: Source | None = None, *, is_open: bool = False) -> Models:
    """The models of a domain, and of the problems that another file (or the same) defines for it.

    `is_open`: for a domain that is only checked, and may leave to problems what these say. Raises Refused
    with every mistake.
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
    draft = draft_of(domains, problems, findings, Wishes(is_open=is_open, joins=False))
    looked = Findings(domain)
    looked.include(findings.sources[-1], (), frozenset())
    checked = check_domain(domain_tree(draft), looked)
    models = [_problem(each, checked, looked) for each in draft.problems] if not looked.errors else []
    found = [each for each in looked.sorted if each.code != "W201" or problem is None]
    told = (*findings.sorted, *found)
    if looked.errors:
        raise Refused(told, findings.sources)
    return Models(_placed(checked), tuple(models), told, tuple(findings.sources))


def _problem(draft: DraftProblem, domain: Domain, findings: Findings) -> Problem:
    made = draft.problem
    checked = check_aims(problem_tree(draft), domain, made.objects, made.state, findings)
    if isinstance(checked.horizon, Horizon):
        return replace(checked, horizon=replace(checked.horizon, is_guess=True))
    return checked


def _refuse_none(source: Source, problems: Sequence[ProblemNode], findings: Findings) -> None:
    if not problems and not findings.errors:
        help = "write `(define (problem NAME) (:domain ...) ...)`"
        findings.error("E915", "no problem is defined", Span(source.path, 0, 0), help=help)


def _placed(domain: Domain) -> Domain:
    """The domain without the places of numbers that a learner would write to: of probabilities, since no
    action of PPDDL has a duration."""
    return replace(domain, rules=tuple(map(_rule, domain.rules)), end=None)


def _rule(rule: Rule) -> Rule:
    outcomes = tuple(replace(each, probability_span=None, weight_span=None) for each in rule.outcomes)
    return replace(rule, outcomes=outcomes)
