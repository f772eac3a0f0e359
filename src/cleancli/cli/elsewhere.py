"""What one file declares and another uses, where one run checks both: no warning says to leave it out."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import domain_named, kind_of
from cleancli.language.parsing.parse import parse
from cleancli.language.refactoring.name_index import Occurrence, names_in
from cleancli.language.syntax import Init, ProblemNode

_CODE = "W201"
_Declared = tuple[str, str]
"""The file that declares a name, and the name."""


def without_used_elsewhere(
    diagnostics: Sequence[Diagnostic], checked: Iterable[Sequence[Source]]
) -> tuple[Diagnostic, ...]:
    """The diagnostics without W201 for what another text uses; `checked` holds, for each file that was
    checked, its text and then those that it includes."""
    if not any(each.code == _CODE for each in diagnostics):
        return tuple(diagnostics)
    checked = tuple(checked)
    texts = {source.path: source.text for sources in checked for source in sources}
    used = {declared for sources in checked for declared in _used(sources)}
    return tuple(each for each in diagnostics if each.code != _CODE or _declared(each, texts) not in used)


def _declared(warning: Diagnostic, texts: dict[str, str]) -> _Declared:
    assert warning.span is not None, "a name stands somewhere"
    name = texts[warning.span.path][warning.span.start : warning.span.end]
    return os.path.realpath(warning.span.path), name


def _used(sources: Sequence[Source]) -> Iterator[_Declared]:
    """What a file uses of others: a problem of its domain, a domain of what it includes."""
    if not sources:
        return
    try:
        if kind_of(sources[0]) == "problem":
            domain = Path(sources[0].path).parent / f"{domain_named(sources[0]).text}.nid"
            yield from ((os.path.realpath(domain), name) for name in _wanted_by(sources[0]))
            return
        for source in sources if len(sources) > 1 else ():
            others = [os.path.realpath(other.path) for other in sources if other is not source]
            yield from ((other, name) for name in _names(names_in(source)) for other in others)
    except Refused:
        return  # it has mistakes, which are told


def _wanted_by(problem: Source) -> Iterator[str]:
    """The names in a problem but for its `init`: facts that nothing asks for are no use."""
    root = parse(problem).root
    sections = root.sections if isinstance(root, ProblemNode) else ()
    idle = {section.span for section in sections if isinstance(section, Init)}
    return _names(each for each in names_in(problem) if each.section not in idle)


def _names(found: Iterable[Occurrence]) -> Iterator[str]:
    return (each.meaning.name for each in found if not each.declares)
