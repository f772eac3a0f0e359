"""Domains and problems from texts."""

from __future__ import annotations

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain, Problem


def checked(text: str, problem: str) -> tuple[Domain, Problem]:
    """A domain, and a problem of which the inside is given."""
    domain = load_domain(Source("domain.nid", text))
    source = Source("problem.nid", f"problem p {{ domain = {domain.name} {problem} }}")
    return domain, load_problem(source, domain)
