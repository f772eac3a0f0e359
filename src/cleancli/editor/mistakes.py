"""Every mistake of a text as it stands in the editor, saved or not."""

from __future__ import annotations

import functools
import os
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from cleancli.editor.library import Document, Library
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import Checked, checked_domain, checked_problem, kind_of, read_source
from cleancli.language.model import Domain, Problem
from cleancli.language.refactoring.name_index import Kind, Occurrence
from cleancli.language.syntax import ProblemNode, SceneNode, StudyNode
from cleancli.scene.check import check_scene
from cleancli.study.check import check_study


def mistakes(asked: Document, library: Library) -> tuple[Diagnostic, ...]:
    """All diagnostics of a text, in its order. A problem is checked against its domain; where that is missing
    or has mistakes itself, the name of the domain says so. Those of an included file stand at its `include`.
    """
    if asked.parsed is None:
        return _not_one_block(asked.source)
    if asked.kind == "domain":
        found = _checked(asked, library).diagnostics
        return tuple(_shown_here(diagnostic, asked, library) for diagnostic in found)
    findings = Findings(asked.source, asked.parsed.diagnostics, asked.parsed.broken)
    if isinstance(asked.parsed.root, SceneNode):
        check_scene(asked.parsed.root, findings)
    elif isinstance(asked.parsed.root, StudyNode):
        check_study(asked.parsed.root, findings)
    elif isinstance(asked.parsed.root, ProblemNode):
        domain = library.domain_of(asked)
        model = None if domain is None else model_of(domain, library)
        if model is None:
            return (*findings.sorted, *_without_domain(asked, domain, library))
        return checked_problem(asked.source, model).diagnostics
    return findings.sorted


def model_of(domain: Document, library: Library) -> Domain | None:
    """The model of a domain; None where it has mistakes."""
    return _checked(domain, library).model


def model_of_problem(problem: Document, domain: Domain) -> Problem | None:
    """The model of a problem for a domain; None where it has mistakes."""
    return checked_problem(problem.source, domain).model if problem.kind == "problem" else None


def _checked(domain: Document, library: Library) -> Checked[Domain]:
    included = tuple(place.source for place in library.included(domain))
    return _checked_texts(domain.source, included, library.include_outside)


@functools.lru_cache(maxsize=32)
def _checked_texts(source: Source, included: tuple[Source, ...], allow_outside: bool) -> Checked[Domain]:
    """What a check of a domain finds. Kept, because each of its problems and every look at a rule asks for
    it; it depends on the texts of the included files, too."""
    texts = {each.path: each for each in included}

    def read(path: Path) -> Source:
        return texts.get(os.path.normpath(path)) or read_source(path)

    return checked_domain(source, allow_outside, read)


def _shown_here(found: Diagnostic, asked: Document, library: Library) -> Diagnostic:
    """A diagnostic at a place of the text: one of an included file at the `include` that leads there."""
    if found.span is None or found.span.path == asked.source.path:
        return found
    for item in asked.includes:
        inner = library.document(asked.path.parent / item.path)
        files = () if inner is None else (inner, *library.included(inner))
        if any(place.source.path == found.span.path for place in files):
            message = f"in `{Path(found.span.path).name}`: {found.message}"
            return replace(found, message=message, span=item.span, label="")
    return replace(found, span=None)


def _not_one_block(source: Source) -> tuple[Diagnostic, ...]:
    try:
        kind_of(source)
    except Refused as refused:
        return refused.diagnostics
    return ()


def _without_domain(asked: Document, domain: Document | None, library: Library) -> Iterable[Diagnostic]:
    """Why a problem cannot be checked against its domain."""
    named = next((o for o in asked.names if o.meaning.kind is Kind.DOMAIN and not o.declares), None)
    if named is not None and domain is None:
        yield _no_domain(asked, named, library)
    elif named is not None and domain is not None:
        yield _faulty_domain(domain, named, library)
    elif asked.parsed is not None and "domain" not in asked.parsed.broken:
        help = "add for example `domain = cleaning`"
        yield Diagnostic("E407", "the problem names no domain", asked.names[0].span, help=help)


def _no_domain(asked: Document, named: Occurrence, library: Library) -> Diagnostic:
    known = ", ".join(f"`{name}`" for name in library.domain_names(asked.path))
    message = f"no domain `{named.meaning.name}` beside this file, open or shipped"
    return Diagnostic("E001", message, named.span, help=f"known here: {known}")


def _faulty_domain(domain: Document, named: Occurrence, library: Library) -> Diagnostic:
    errors = [each for each in mistakes(domain, library) if each.level is Level.ERROR]
    message = f"the domain `{named.meaning.name}` has {plural(len(errors), 'mistake')}"
    help = f"the first: {errors[0].code} {errors[0].message}"
    return replace(errors[0], message=message, span=named.span, label="", help=help)
