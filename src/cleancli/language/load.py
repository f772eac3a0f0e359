"""Files to models, in one call each: read, parse, check, or refuse with every mistake found."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Generic, TypeVar

from cleancli.language.checking.declarations import sections_of
from cleancli.language.checking.domain import check_domain
from cleancli.language.checking.include import Read, with_includes
from cleancli.language.checking.problem import check_despite, check_problem
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Domain, Problem
from cleancli.language.parsing.parse import kind_of
from cleancli.language.parsing.read import parse_as, read_source, read_stream
from cleancli.language.syntax import DomainName, DomainNode, Name, ProblemNode

__all__ = [
    "Checked",
    "checked_domain",
    "checked_problem",
    "domain_named",
    "kind_of",
    "load_domain",
    "load_problem",
    "located_in",
    "parse_as",
    "read_source",
    "read_stream",
]

_Model = TypeVar("_Model", Domain, Problem)


@dataclass(frozen=True, slots=True)
class Checked(Generic[_Model]):
    """All that a check found: `diagnostics` holds warnings too, `sources` the texts that they point into,
    the one that was asked for first. `model` is None where an error is among them."""

    model: _Model | None
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]

    def get(self) -> _Model:
        """The model; raises Refused with every mistake if there is none."""
        if self.model is None:
            raise Refused(self.diagnostics, self.sources)
        return self.model


def checked_domain(
    source: Source, allow_outside: bool = False, read: Read = read_source, *, compat: bool = False
) -> Checked[Domain]:
    """Check a domain with the files it includes; `allow_outside` lets these stand outside its folder.

    `read` gets an included file's text, where it is not the one on disk. With `compat`, rules mean what
    libPRADA takes them for (see `Scope`): only grounding as it does takes such a domain.
    """
    try:
        root, findings = parse_as(source, "domain")
    except Refused as refused:
        return Checked(None, refused.diagnostics, refused.sources)
    domain = None
    if isinstance(root, DomainNode):
        whole = with_includes(root, findings, allow_outside, read)
        domain = check_domain(whole, findings, compat)
    return _checked(domain, findings)


def checked_problem(source: Source, domain: Domain) -> Checked[Problem]:
    """Check a problem for a domain."""
    try:
        root, findings = parse_as(source, "problem")
    except Refused as refused:
        return Checked(None, refused.diagnostics, refused.sources)
    problem = check_problem(root, domain, findings) if isinstance(root, ProblemNode) else None
    return _checked(problem, findings)


def checked_despite(source: Source, domain: Source, allow_outside: bool = False) -> Checked[Problem]:
    """Check a problem whose domain has mistakes. Only mistakes are told, and none that may follow from those
    of the domain; there is no model. Raises Refused where one of them is something else."""
    root, of_domain = parse_as(domain, "domain")
    node, findings = parse_as(source, "problem")
    if isinstance(root, DomainNode) and isinstance(node, ProblemNode):
        whole = with_includes(root, of_domain, allow_outside, read_source)
        check_despite(node, whole, check_domain(whole, of_domain), of_domain, findings)
    mistakes = tuple(each for each in findings.sorted if each.level is Level.ERROR)
    return Checked(None, mistakes, tuple(findings.sources))


def _checked(model: _Model | None, findings: Findings) -> Checked[_Model]:
    usable = None if findings.errors else model
    return Checked(usable, findings.sorted, tuple(findings.sources))


def load_domain(source: Source, allow_outside: bool = False) -> Domain:
    """The checked domain; raises Refused with every mistake."""
    return checked_domain(source, allow_outside).get()


def load_problem(source: Source, domain: Domain) -> Problem:
    """The checked problem for a domain; raises Refused with every mistake."""
    return checked_problem(source, domain).get()


def domain_named(source: Source) -> Name:
    """The name of the domain that a problem is for, with its place; raises Refused (E407 for none)."""
    root, findings = parse_as(source, "problem")
    if isinstance(root, ProblemNode):
        for section in sections_of(root.sections, DomainName):
            return section.name
        if "domain" not in findings.broken:
            help = "add for example `domain = cleaning`"
            findings.error(
                "E407", f"the problem `{root.name.text}` names no domain", root.name.span, help=help
            )
    raise Refused(findings.sorted, [source])


@contextmanager
def located_in(*sources: Source) -> Iterator[None]:
    """Show the lines of these texts with mistakes that later stages find in them."""
    try:
        yield
    except Refused as refused:
        raise Refused(refused.diagnostics, (*refused.sources, *sources)) from None
