"""The texts of a converted domain and its problems, with comments that say what is from where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from cleancli.conversion.comments import commented
from cleancli.conversion.pddl.schemas import Schema
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.source_lines import Lines
from cleancli.language.model import Domain, Problem
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.printer import print_domain, print_problem


def domain_text(
    domain: Domain,
    schemas: Sequence[Schema],
    place: Span,
    sources: Mapping[str, Source],
    notes: Sequence[str],
) -> str:
    """The domain, laid out; `place` is where PDDL names it."""
    head = [f"Converted from {_file(place)} by `cleancli convert`.", *notes]
    lines = {path: Lines(source.text) for path, source in sources.items()}
    above: dict[str, tuple[str, ...]] = {}
    for schema in schemas:
        line = lines[schema.place.path].place(schema.place.start)[0]
        first = next((rule for rule in domain.rules if rule.action == schema.action.name), None)
        if first is not None:
            above[f"  rule {first.name}:"] = (f"{_file(schema.place)}, line {line}",)
    return layout(commented(print_domain(domain), head, above))


def problem_text(problem: Problem, domain: Domain, place: Span, notes: Sequence[str]) -> str:
    """A problem, laid out."""
    head = [f"Converted from {_file(place)} by `cleancli convert`.", *notes]
    return layout(commented(print_problem(problem, domain), head, {}))


def _file(place: Span) -> str:
    return Path(place.path).name
