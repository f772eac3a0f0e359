"""Every mistake of a text as it stands in the editor, saved or not."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import replace

from cleancli.editor.library import Document, Library, document
from cleancli.editor.names import Kind
from cleancli.language.check import check_domain
from cleancli.language.check_problem import check_problem
from cleancli.language.diagnostics import Diagnostic, Level, Refused, Source
from cleancli.language.findings import Findings
from cleancli.language.load import kind_of
from cleancli.language.model import Domain, Problem
from cleancli.language.syntax import DomainNode, ProblemNode, SceneNode
from cleancli.scene.check import check_scene


def mistakes(asked: Document, library: Library) -> tuple[Diagnostic, ...]:
    """All diagnostics of a text, in its order. A problem is checked against its domain; where that is missing
    or has mistakes itself, the name of the domain says so."""
    if asked.parsed is None:
        return _not_one_block(asked.source)
    if isinstance(asked.parsed.root, DomainNode):
        return _checked_domain(asked.source)[1]
    findings = Findings(asked.source, asked.parsed.diagnostics, asked.parsed.broken)
    if isinstance(asked.parsed.root, SceneNode):
        check_scene(asked.parsed.root, findings)
    elif isinstance(asked.parsed.root, ProblemNode):
        domain = library.domain_of(asked)
        model = None if domain is None else model_of(domain)
        if model is None:
            return (*findings.sorted, *_without_domain(asked, domain, library))
        check_problem(asked.parsed.root, model, findings)
    return findings.sorted


def model_of(domain: Document) -> Domain | None:
    """The model of a domain; None where it has mistakes."""
    return _checked_domain(domain.source)[0]


def model_of_problem(problem: Document, domain: Domain) -> Problem | None:
    """The model of a problem for a domain; None where it has mistakes."""
    if problem.parsed is None or not isinstance(problem.parsed.root, ProblemNode):
        return None
    findings = Findings(problem.source, problem.parsed.diagnostics, problem.parsed.broken)
    model = check_problem(problem.parsed.root, domain, findings)
    return None if _has_errors(findings) else model


@functools.lru_cache(maxsize=32)
def _checked_domain(source: Source) -> tuple[Domain | None, tuple[Diagnostic, ...]]:
    """A domain's model, None where it has mistakes, and all diagnostics. Kept, because each of its problems
    and every look at a rule asks for it."""
    parsed = document(source).parsed
    if parsed is None or not isinstance(parsed.root, DomainNode):
        return None, () if parsed is None else parsed.diagnostics
    findings = Findings(source, parsed.diagnostics, parsed.broken)
    model = check_domain(parsed.root, findings)
    return None if _has_errors(findings) else model, findings.sorted


def _has_errors(findings: Findings) -> bool:
    return any(found.level is Level.ERROR for found in findings.sorted)


def _not_one_block(source: Source) -> tuple[Diagnostic, ...]:
    try:
        kind_of(source)
    except Refused as refused:
        return refused.diagnostics
    return ()


def _without_domain(asked: Document, domain: Document | None, library: Library) -> Iterable[Diagnostic]:
    for occurrence in asked.names:
        if occurrence.meaning.kind is not Kind.DOMAIN or occurrence.declares:
            continue
        name = occurrence.meaning.name
        if domain is None:
            known = ", ".join(f"`{n}`" for n in library.domain_names(asked.path))
            message = f"no domain `{name}` beside this file, open or shipped"
            yield Diagnostic("E001", message, occurrence.span, help=f"known here: {known}")
        else:
            errors = [d for d in mistakes(domain, library) if d.level is Level.ERROR]
            message = f"the domain `{name}` has {len(errors)} mistake{'s' * (len(errors) != 1)}"
            help = f"the first: {errors[0].code} {errors[0].message}"
            yield replace(errors[0], message=message, span=occurrence.span, label="", help=help)
        return
    if asked.parsed is not None and "domain" not in asked.parsed.broken:
        help = "add for example `domain = cleaning`"
        yield Diagnostic("E407", "the problem names no domain", asked.names[0].span, help=help)
