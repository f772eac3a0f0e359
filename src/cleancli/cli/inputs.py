"""Opens the files that commands name, shipped or by path: reads, parses and checks them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from cleancli.api.inputs import LoadedDomain, LoadedProblem, load_problem, opened_domain
from cleancli.cli.files import STDIN, read
from cleancli.conversion.pddl.recognized import SUFFIXES, is_pddl
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import (
    checked_despite,
    checked_domain,
    checked_problem,
    domain_named,
    kind_of,
    read_source,
)

if TYPE_CHECKING:
    from cleancli.language.model import Domain, Problem
    from cleancli.scene.model import Scene

CHECKED = (".nid", *SUFFIXES)
"""What the names of files that can be checked end with."""

_MOST_PARTS = 100_000
"""Groundings of a problem in PDDL, with their literals and effects, up to which a check grounds it. Chosen: a
second."""


def open_loaded(domain: str, *, compat: bool = False) -> LoadedDomain:
    """A domain with all texts; raises Refused. `compat`: for planning as libPRADA does."""
    return opened_domain(read_source(find(domain, "domains")), may_include_outside(), compat=compat)


def open_given(domain: str, problem: str, *, compat: bool = False) -> LoadedProblem:
    """A problem of a domain, or a scene, with all texts; raises Refused, and UsageError where both are named
    in the other order."""
    try:
        return _open_given(domain, problem, compat)
    except Refused:
        if _is("domain", problem) and not _is("domain", domain) and _is("problem", domain):
            message = f"`{domain}` is a problem, and `{problem}` its domain: name the domain first"
            raise click.UsageError(message) from None
        raise


def _is(kind: str, name_or_path: str) -> bool:
    """Whether a file is a domain, or a problem or scene; not where it cannot be read."""
    try:
        source = read_source(find(name_or_path, "domains", "problems"))
        if is_pddl(source):
            from cleancli.conversion.pddl.models import defines_domain, defines_problem

            return (defines_domain if kind == "domain" else defines_problem)(source)
        return (kind_of(source) == "domain") == (kind == "domain")
    except Refused:
        return False


def _open_given(domain: str, problem: str, compat: bool) -> LoadedProblem:
    text, path = read_source(find(domain, "domains")), find(problem, "problems")
    if is_pddl(text):
        return load_problem(path, Path(text.path))
    return load_problem(path, opened_domain(text, may_include_outside(), compat=compat))


def ships_with(domain: str, loaded: LoadedDomain) -> click.UsageError:
    """That a domain is no file of the user's own, where learning is to write."""
    path = loaded.sources[0].path
    return click.UsageError(f"`{domain}` ships with cleancli: copy {path}, and learn into your copy")


def may_include_outside() -> bool:
    """Whether the user has allowed domains to include files from outside their own folder."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.find_root().params.get("include_outside"))


def open_scene(name_or_path: str) -> tuple[Source, Scene]:
    """A scene with its text; raises Refused with every mistake found."""
    source = read_source(find(name_or_path, "problems"))
    return source, _load_scene(source)


def _load_scene(source: Source) -> Scene:
    """Imported here because most files are no scenes, and what scenes are made of takes time to load."""
    from cleancli.scene.check import load_scene

    return load_scene(source)


def open_simulated(name: str, robot: str | None) -> Scene:
    """A scene whose table can be simulated, with this robot or else its own. Raises Refused, and UsageError
    for a robot at the end of a socket, of whose table nobody knows the truth."""
    scene = open_with(name, robot)
    if scene.address is not None:
        raise click.UsageError(
            f"the robot of `{scene.name}` is at {scene.address}, and only simulated tables tell where their "
            "dirt truly is: --robot names a robot to simulate"
        )
    return scene


def open_with(name: str, robot: str | None) -> Scene:
    """A scene with this simulated robot, or else its own. Raises Refused."""
    _, scene = open_scene(name)
    return scene if robot is None else replace(scene, robot=robot, address=None)


def check_file(
    name_or_path: str, others: Iterable[str] = ()
) -> tuple[tuple[Diagnostic, ...], tuple[Source, ...]]:
    """All mistakes and warnings of a file of any kind (`-`: standard input), with the texts they point into.

    A problem's domain is sought beside the problem before it is sought among the shipped ones; that of a
    problem in PPDDL among `others`, files that are checked as well, and then beside it. Raises Refused
    where the file, or the domain of a problem, cannot be read at all.
    """
    is_named = name_or_path != STDIN and not Path(name_or_path).is_dir()
    path = find(name_or_path, "domains", "problems", "studies") if is_named else Path(name_or_path)
    source = read(str(path))
    if is_pddl(source):
        return _check_pddl(source, others)
    match kind_of(source):
        case "domain":
            checked = checked_domain(source, may_include_outside())
            return checked.diagnostics, checked.sources
        case "scene":
            _load_scene(source)
            return (), (source,)
        case "study":
            return _check_study(source)
        case _:
            return _check_problem(source, _domain_of(source, path))


def _domain_of(source: Source, path: Path) -> Source:
    """The text of the domain that a problem names: the file beside it, or the shipped one. Raises Refused,
    with the place of the name where there is neither."""
    named = domain_named(source)
    beside = path.parent / f"{named.text}.nid"
    if beside.exists():
        return read_source(beside)
    try:
        return read_source(find(named.text, "domains"))
    except Refused as refused:
        found = [replace(each, span=each.span or named.span) for each in refused.diagnostics]
        raise Refused(found, (source,)) from None


def _check_pddl(source: Source, others: Iterable[str]) -> tuple[tuple[Diagnostic, ...], tuple[Source, ...]]:
    """What is found in a PPDDL file. The domain of one that defines none is sought in `others`, first in
    those beside it, and then in all files beside it; those that cannot be read are passed over where another
    is it. A domain may leave to problems what these say: who checks a problem reads it again with it. Large
    problems are not grounded: their rules were made so that nothing conflicts."""
    from cleancli.conversion.pddl.models import defines_domain, defines_problem, domain_for, models_of

    if defines_problem(source) and not defines_domain(source):
        beside, given = sorted(Path(source.path).parent.glob("*")), [*map(Path, others)]
        paths = [*(path for path in beside if path in given), *given, *beside]
        pddl = [str(path) for path in paths if path.suffix.lower() in SUFFIXES and path.is_file()]
        unread: list[Refused] = []
        try:
            domain = domain_for(source, _readable((path for path in pddl if path != source.path), unread))
        except Refused as refused:
            others_told = [each for other in unread for each in other.diagnostics]
            raise Refused([*refused.diagnostics, *others_told], refused.sources) from None
        made = models_of(domain, source)
    else:
        made = models_of(source, source if defines_problem(source) else None, is_open=True)
    from cleancli.compiler.grounding_size import most_parts

    grounded = [
        each
        for number, problem in enumerate(made.problems)
        if most_parts(made.domain, problem) <= _MOST_PARTS
        for each in _grounded(source, made.domain, problem, number)
    ]
    return (*made.diagnostics, *grounded), made.sources


def _readable(paths: Iterable[str], unread: list[Refused]) -> Iterator[Source]:
    """The texts of files; of those that cannot be read why, in `unread`."""
    for path in paths:
        try:
            yield read_source(path)
        except Refused as refused:
            unread.append(refused)


def _check_study(source: Source) -> tuple[tuple[Diagnostic, ...], tuple[Source, ...]]:
    """Nothing, where a study and all files that it names hold no mistake; raises Refused else.

    Imported here because most files are no studies.
    """
    from cleancli.experiment.series import open_studies

    open_studies(source)
    open_studies(source, quick=True)
    return (), (source,)


def _check_problem(source: Source, text: Source) -> tuple[tuple[Diagnostic, ...], tuple[Source, ...]]:
    """The mistakes and warnings of a problem, with those of its domain's text if that has mistakes; where
    neither has one also what grounding tells."""
    try:
        domain = opened_domain(text, may_include_outside())
    except Refused as refused:
        if is_pddl(text) or kind_of(text) != "domain":
            raise
        found = checked_despite(source, text, may_include_outside())
        return (*refused.diagnostics, *found.diagnostics), (*refused.sources, *found.sources)
    found = checked_problem(source, domain.model)
    if found.model is None:
        return found.diagnostics, found.sources
    grounded = _grounded(source, domain.model, found.model)
    is_told = any(each.code == "E602" for each in grounded)
    return (*found.diagnostics, *grounded), (*domain.sources, *found.sources) if is_told else found.sources


def _grounded(source: Source, domain: Domain, problem: Problem, number: int = 0) -> tuple[Diagnostic, ...]:
    """What conflicts for a problem's objects (E602), or else what it wants in vain (W403) and whether its
    plans are too short (W404); `number` of the problems before it that its text defines.

    Grounding is imported here: other files are checked without it.
    """
    from cleancli.cli.unreached import warnings_of, warnings_of_states
    from cleancli.compiler.ground import ground

    searched: tuple[Diagnostic, ...] = ()
    try:
        searched = warnings_of_states(source, problem, ground(domain, problem), number)
    except Refused as refused:
        if conflicts := tuple(each for each in refused.diagnostics if each.code == "E602"):
            return conflicts
    return warnings_of(source, domain, problem, number) or searched
