"""What a case says: the mistakes of one file, or of several that belong together, as a user reads them."""

from __future__ import annotations

import os
from contextlib import chdir
from pathlib import Path

from cleancli.cli.inputs import open_loaded
from cleancli.cli.unreached import warnings_of, warnings_of_states
from cleancli.compiler.ground import ground
from cleancli.experiment.series import open_studies
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import render
from cleancli.language.load import (
    checked_domain,
    checked_problem,
    kind_of,
    load_domain,
    load_problem,
    read_source,
)
from cleancli.language.model import Domain
from cleancli.learning.experience import read_experience
from cleancli.perception.symbols import symbolize
from cleancli.scene.check import load_scene

SMALL = Path(__file__).parents[1] / "language" / "small.nid"
"""The domain of every problem that stands alone and has none of its own name among the parts."""

PARTS = "parts"
"""The folder of what single-file cases include, and of the domains of problems that need another one."""


def cases(folder: Path) -> list[Path]:
    """The files and folders of mistakes; beside each file, and in each folder, is the text it should give."""
    return sorted(
        path for path in folder.iterdir() if path.suffix == ".nid" or (path.is_dir() and path.name != PARTS)
    )


def expected_path(case: Path) -> Path:
    """Where the text is that a case should give."""
    return case / "expected.txt" if case.is_dir() else case.with_suffix(".txt")


def refusal(case: Path) -> tuple[str, tuple[Diagnostic, ...]]:
    """What a case is refused with, as text and as data; places are shown relative to the case."""
    sources: list[Source] = []
    try:
        with chdir(case if case.is_dir() else case.parent):
            found = _folder(sources) if case.is_dir() else _file(case.name, sources)
    except Refused as refused:
        found = refused.diagnostics
        sources += [source for source in refused.sources if source not in sources]
    return render(found, sources), found


def _read(name: str, sources: list[Source]) -> Source:
    sources.append(read_source(name))
    return sources[-1]


def _file(name: str, sources: list[Source]) -> tuple[Diagnostic, ...]:
    source = _read(name, sources)
    match kind_of(source):
        case "domain":
            domain = checked_domain(source)
            sources += domain.sources[1:]
            return domain.diagnostics
        case "problem":
            own = Path(PARTS) / name
            return checked_problem(
                source, load_domain(read_source(own if own.exists() else SMALL))
            ).diagnostics
        case "scene":
            load_scene(source)
        case _:
            open_studies(source)
    return ()


def _folder(sources: list[Source]) -> tuple[Diagnostic, ...]:
    """Of the files below, those that the folder has, in the order in which a command would use them."""
    if os.path.exists("name.txt"):
        open_loaded(Path("name.txt").read_text(encoding="utf-8").strip())
        return ()
    domain = load_domain(_read("domain.nid", sources))
    return _with_domain(domain, sources)


def _with_domain(domain: Domain, sources: list[Source]) -> tuple[Diagnostic, ...]:
    """What is found; warnings of a problem are returned, mistakes raised."""
    found: tuple[Diagnostic, ...] = ()
    if os.path.exists("problem.nid"):
        problem = load_problem(_read("problem.nid", sources), domain)
        task = ground(domain, problem)
        found = warnings_of(sources[-1], domain, problem) or warnings_of_states(sources[-1], problem, task)
    if os.path.exists("scene.nid"):
        symbolize((), load_scene(_read("scene.nid", sources)), domain)
    if os.path.exists("experience.jsonl"):
        tuple(read_experience("experience.jsonl", domain))
    return found
