"""The texts of a converted domain and its problems, with comments that say what is from where."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from cleancli.conversion.comments import commented
from cleancli.conversion.pddl.draft import Draft, DraftProblem
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.source_lines import Lines
from cleancli.language.model import Domain
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.printer import print_domain, print_problem


def domain_text(draft: Draft, sources: Mapping[str, Source]) -> str:
    """The domain, laid out; `sources` are the PPDDL texts."""
    head = [f"Converted from {_file(draft.place)} by `cleancli convert`.", *draft.notes]
    lines = {path: Lines(source.text) for path, source in sources.items()}
    above: dict[str, tuple[str, ...]] = {}
    for action, place in draft.actions.items():
        first = next((rule for rule in draft.domain.rules if rule.action == action), None)
        if first is not None:
            line = lines[place.path].place(place.start)[0]
            above[f"  rule {first.name}:"] = (f"{_file(place)}, line {line}",)
    return layout(commented(print_domain(draft.domain), head, above))


def problem_text(draft: DraftProblem, domain: Domain) -> str:
    """A problem, laid out."""
    head = [f"Converted from {_file(draft.place)} by `cleancli convert`.", *draft.notes]
    return layout(commented(print_problem(draft.problem, domain), head, {}))


def _file(place: Span) -> str:
    return Path(place.path).name
