"""Domains, problems and tasks from texts."""

from __future__ import annotations

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain, Problem


def domain(text: str) -> Domain:
    """The checked domain of a text."""
    return load_domain(Source("domain.nid", text))


def problem(of: Domain, inside: str) -> Problem:
    """A checked problem of a domain, from what stands within its braces."""
    return load_problem(Source("problem.nid", f"problem p {{ domain = {of.name} {inside} }}"), of)


def checked(text: str, inside: str) -> tuple[Domain, Problem]:
    """A domain, and a problem of it."""
    found = domain(text)
    return found, problem(found, inside)


def task(text: str, inside: str) -> Task:
    """The task of a domain and a problem of it."""
    return ground(*checked(text, inside))
