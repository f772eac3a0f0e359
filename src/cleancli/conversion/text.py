"""The texts of a converted domain and problem, with comments that say where each part is from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cleancli.conversion.comments import commented
from cleancli.conversion.rules import Translated
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.model import Domain, Problem
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.printer import print_domain, print_problem


@dataclass(frozen=True, slots=True)
class Remarks:
    """What comments tell: the files, the predicates that functions stand for, the rules, and notes."""

    rules: Source
    state: Source
    symbols: Source
    functions: Mapping[str, tuple[str, ...]]
    translated: tuple[Translated, ...]
    notes: tuple[str, ...]


def domain_text(domain: Domain, remarks: Remarks) -> str:
    """The domain, laid out."""
    rules, symbols = Path(remarks.rules.path).name, Path(remarks.symbols.path).name
    head = [f"Converted from libPRADA's {rules} and {symbols} by `cleancli convert`.", *remarks.notes]
    above: dict[str, tuple[str, ...]] = {
        f"    {name}(": (f"at most one held at a time: {', '.join(members)}",)
        for name, members in remarks.functions.items()
    }
    for each in remarks.translated:
        if each.rule is not None:
            above[f"  rule {each.rule.name}:"] = (f"{rules}, line {each.line}", *each.remarks)
    return layout(commented(print_domain(domain), head, above))


def problem_text(problem: Problem, domain: Domain, remarks: Remarks) -> str:
    """The problem, laid out."""
    head = [f"Converted from libPRADA's {Path(remarks.state.path).name} by `cleancli convert`."]
    return layout(commented(print_problem(problem, domain), head, {}))
