"""Every mistake of a text as it stands in the editor, saved or not."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from cleancli.editor.library import Document, Library
from cleancli.editor.names import Kind
from cleancli.language.check import check_domain
from cleancli.language.check_problem import check_problem
from cleancli.language.diagnostics import Diagnostic, Level, Refused
from cleancli.language.load import parse_as
from cleancli.language.model import Domain
from cleancli.language.syntax import DomainNode, ProblemNode, SceneNode
from cleancli.scene.check import check_scene


def mistakes(asked: Document, library: Library) -> tuple[Diagnostic, ...]:
    """All diagnostics of a text, in its order. A problem is checked against its domain; where that is missing
    or has mistakes itself, the name of the domain says so."""
    source = asked.source
    try:
        root, findings = parse_as(source, asked.kind or "domain")
        if isinstance(root, DomainNode):
            check_domain(root, findings)
        elif isinstance(root, SceneNode):
            check_scene(root, findings)
        elif isinstance(root, ProblemNode):
            domain = library.domain_of(asked)
            model = None if domain is None else model_of(domain)
            if model is None:
                return (*findings.sorted, *_without_domain(asked, domain, library, findings.broken))
            check_problem(root, model, findings)
    except Refused as refused:
        return refused.diagnostics
    return findings.sorted


def model_of(domain: Document) -> Domain | None:
    """The model of a domain; None where it has mistakes."""
    try:
        root, findings = parse_as(domain.source, "domain")
        if not isinstance(root, DomainNode):
            return None
        model = check_domain(root, findings)
        findings.refuse_errors()
    except Refused:
        return None
    return model


def _without_domain(
    asked: Document, domain: Document | None, library: Library, broken: frozenset[str]
) -> Iterable[Diagnostic]:
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
    if "domain" not in broken:
        help = "add for example `domain = cleaning`"
        yield Diagnostic("E407", "the problem names no domain", asked.names[0].span, help=help)
