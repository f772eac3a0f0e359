"""Domains that include others: one tree of the sections of all files, those of the included ones first.

Guaranteed by the parser: the structure of the first file. Included files are read and parsed here, never
executed. Spans keep the path of the file they lie in.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from cleancli.language import syntax
from cleancli.language.checking.declarations import SECTIONS, refuse_repeated, sections_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.parsing.read import LARGEST, parse_as

DEEPEST = 8
"""Files that may include one another in a row."""

_MANY = frozenset({"rule", "include"})
_OVERRIDDEN = (syntax.Default, syntax.Reward, syntax.Learned)
"""Sections that an included file gives up where the including one has them."""

_Sections = tuple[syntax.DomainSection, ...]


Read = Callable[[Path], Source]
"""How the text of an included file is got; raises Refused."""


def with_includes(
    node: syntax.DomainNode, findings: Findings, allow_outside: bool, read: Read
) -> syntax.DomainNode:
    """The domain with the sections of what it includes; mistakes are E108 to E110, E216 and those of reading.

    A file that is included twice counts once.
    """
    includer = _Includer(findings, allow_outside, read)
    return replace(node, sections=includer.expand(node, findings.source.path, ()))


def is_outside(path: Path, top: Path) -> bool:
    """Whether a file lies neither in the folder of the domain `top` nor below, or is no place at all."""
    try:
        return not path.resolve().is_relative_to(top.absolute().parent.resolve())
    except (OSError, RuntimeError, ValueError):
        return True


class _Includer:
    """Takes in the files below one domain."""

    def __init__(self, findings: Findings, allow_outside: bool, read: Read) -> None:
        self._findings = findings
        self._allow_outside = allow_outside
        self._read = read
        self._top = Path(findings.source.path)
        self._taken: set[Path] = set()
        self._size = len(findings.source.text.encode("utf-8", "surrogatepass"))

    def expand(self, node: syntax.DomainNode, path: str, chain: tuple[str, ...]) -> _Sections:
        """The sections of the file at `path`, which the files of `chain` include."""
        refuse_repeated(node.sections, SECTIONS, _MANY, self._findings)
        included: list[syntax.DomainSection] = []
        for item in sections_of(node.sections, syntax.Include):
            included += self._included(item, (*chain, path))
        own = tuple(s for s in node.sections if not isinstance(s, syntax.Include))
        for kind in _OVERRIDDEN:
            included = self._one_at_most(included, kind, bool(sections_of(own, kind)))
        return (*included, *own)

    def _one_at_most(
        self, included: list[syntax.DomainSection], kind: type[syntax.DomainSection], overridden: bool
    ) -> list[syntax.DomainSection]:
        found = sections_of(included, kind)
        if not overridden:
            for second in found[1:]:
                self._findings.error(
                    "E216",
                    f"a second `{SECTIONS[kind]}` is included",
                    second.span,
                    help=f"the first stands in {self._findings.line(found[0].span)}:"
                    " write one in the including file",
                )
            found = found[1:]
        return [section for section in included if section not in found]

    def _included(self, node: syntax.Include, chain: tuple[str, ...]) -> _Sections:
        path = Path(chain[-1]).parent / node.path
        try:
            resolved = path.resolve()
        except (OSError, RuntimeError, ValueError) as error:
            return self._refuse("E003", f"cannot read `{node.path}`: {error}", node)
        if not self._allow_outside and is_outside(path, self._top):
            help = "copy it into this folder or one below"
            return self._refuse("E109", f"`{node.path}` lies outside the folder of the domain", node, help)
        places = [Path(name).resolve() for name in chain]
        if resolved in places:
            circle = [*chain[places.index(resolved) :], os.path.normpath(path)]
            return self._refuse("E108", "this file includes itself", node, help=" -> ".join(circle))
        if len(chain) > DEEPEST:
            return self._refuse("E110", f"more than {DEEPEST} files include one another in a row", node)
        if resolved in self._taken:
            return ()
        self._taken.add(resolved)
        return self._take_in(path, node, chain)

    def _take_in(self, path: Path, node: syntax.Include, chain: tuple[str, ...]) -> _Sections:
        try:
            source = self._read(path)
        except Refused as refused:
            found = refused.diagnostics[0]
            return self._refuse(found.code, found.message, node, found.help)
        self._size += len(source.text.encode("utf-8"))
        if self._size > LARGEST:
            return self._refuse("E005", f"with this file the domain is larger than {LARGEST >> 20} MiB", node)
        root = self._parse(source)
        return self.expand(root, source.path, chain) if isinstance(root, syntax.DomainNode) else ()

    def _parse(self, source: Source) -> syntax.Root | None:
        missing = frozenset({"include"})
        try:
            root, found = parse_as(source, "domain")
        except Refused as refused:
            self._findings.include(source, refused.diagnostics, missing)
            return None
        self._findings.include(source, found.sorted, found.broken if root is not None else missing)
        return root

    def _refuse(self, code: str, message: str, node: syntax.Include, help: str = "") -> _Sections:
        self._findings.error(code, message, node.span, help=help)
        self._findings.broken |= {"include"}
        return ()
