"""PPDDL files to the texts of a domain and its problems, which the checker has looked at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cleancli.conversion.pddl.draft import Wishes, draft_of
from cleancli.conversion.pddl.read import read
from cleancli.conversion.pddl.text import domain_text, problem_text
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import checked_domain, checked_problem

__all__ = ["Converted", "Wishes", "convert"]


@dataclass(frozen=True, slots=True)
class Converted:
    """The names and texts of a domain and its problems, and what has to be told about them. `diagnostics` are
    warnings about the PPDDL files, then what the checker finds in the texts; `sources` has both."""

    name: str
    domain: str
    problems: Mapping[str, str]
    notes: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


def convert(sources: Sequence[Source], wishes: Wishes) -> Converted:
    """The texts of the domain, and of all problems, that some files define together.

    Raises Refused with every mistake (E915 to E918).
    """
    findings = Findings(sources[0])
    for source in sources[1:]:
        findings.include(source, (), frozenset())
    found = [read(source, findings) for source in sources]
    domains = [domain for some, _ in found for domain in some]
    draft = draft_of(domains, [problem for _, some in found for problem in some], findings, wishes)
    text = domain_text(draft, {source.path: source for source in sources})
    problems = {each.problem.name: problem_text(each, draft.domain) for each in draft.problems}
    name = draft.domain.name
    looked, outputs = _looked_at(name, text, problems)
    told = (*findings.sorted, *looked)
    return Converted(name, text, problems, draft.notes, told, (*findings.sources, *outputs))


def _looked_at(
    name: str, domain: str, problems: Mapping[str, str]
) -> tuple[tuple[Diagnostic, ...], tuple[Source, ...]]:
    """What the checker finds in the texts, but that something is declared for a problem alone, and they."""
    source = Source(f"{name}.nid", domain)
    checked = checked_domain(source)
    found = [each for each in checked.diagnostics if not (problems and each.code == "W201")]
    others = [Source(f"{title}.nid", text) for title, text in problems.items()]
    if checked.model is not None:
        found += [each for other in others for each in checked_problem(other, checked.model).diagnostics]
    return tuple(found), (source, *others)
