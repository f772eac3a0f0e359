"""The domains, problems and scenes that come with the tool, by their names."""

from __future__ import annotations

from cleancli.language.find import find
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Domain, Problem
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene


def shipped_domain(name: str) -> Domain:
    """A shipped domain, checked."""
    return load_domain(read_source(find(name, "domains")))


def shipped_problem(name: str, domain: Domain) -> Problem:
    """A shipped problem without a table, checked for a domain."""
    return load_problem(read_source(find(name, "problems")), domain)


def shipped_scene(name: str) -> Scene:
    """A shipped problem with a table."""
    return load_scene(read_source(find(name, "problems")))
