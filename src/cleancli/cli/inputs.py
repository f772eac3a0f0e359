"""Opens the files that commands name, shipped or by path: reads, parses and checks them."""

from __future__ import annotations

from pathlib import Path

from cleancli.language.diagnostics import Source
from cleancli.language.load import kind_of, load_domain, load_problem, read_source
from cleancli.language.model import Domain, Problem
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.shipped import find


def open_domain(name_or_path: str) -> tuple[Path, Source, Domain]:
    """A domain with the file it came from; raises Refused."""
    path = find("domains", name_or_path)
    source = read_source(path)
    return path, source, load_domain(source)


def open_scene(name_or_path: str) -> tuple[Source, Scene]:
    """A scene with its text; raises Refused with every mistake found."""
    source = read_source(find("problems", name_or_path))
    return source, load_scene(source)


def open_problem(name_or_path: str, domain: Domain) -> Problem | Scene:
    """A problem of the domain, or a scene; raises Refused with every mistake found."""
    source = read_source(find("problems", name_or_path))
    return load_scene(source) if kind_of(source) == "scene" else load_problem(source, domain)
