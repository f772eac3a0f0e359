"""Opens the files that commands name: shipped or by path, read, parsed and checked."""

from __future__ import annotations

from cleancli.language.diagnostics import Source
from cleancli.language.load import kind_of, load_domain, load_problem, read_source
from cleancli.language.model import Domain, Problem
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.shipped import find


def domain_source(name_or_path: str) -> Source:
    """The text of a domain; raises Refused if there is no such file."""
    return read_source(find("domains", name_or_path))


def problem_or_scene(name_or_path: str, domain: Domain) -> Problem | Scene:
    """A problem of the domain, or a scene; raises Refused with every mistake found."""
    source = read_source(find("problems", name_or_path))
    return load_scene(source) if kind_of(source) == "scene" else load_problem(source, domain)


__all__ = ["domain_source", "load_domain", "load_scene", "problem_or_scene"]
