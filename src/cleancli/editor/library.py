"""The files an editor works on: open texts before what is on disk, problems together with their domains."""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cleancli.language.checking.declarations import sections_of
from cleancli.language.checking.include import is_outside
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.source_lines import line_start
from cleancli.language.load import kind_of, read_source
from cleancli.language.parsing.lexemes import WORD
from cleancli.language.parsing.parse import Parsed, parse
from cleancli.language.parsing.recovery import blank, outline
from cleancli.language.refactoring.name_index import Kind, Meaning, Occurrence, occurrences
from cleancli.language.syntax import DomainNode, Include, Root
from cleancli.resources import shipped, shipped_names

_NAMED_DOMAIN = re.compile(rf"\bdomain\s*=\s*{WORD}")

_MOST_FOLDERS = 2000
"""Searched for problems below the folders an editor has open; beyond it, a search would be felt."""


@dataclass(frozen=True, slots=True)
class Document:
    """A text with what could be read of it. Where not even its kind can be told, `kind` is empty and `parsed`
    None. `root` and `names` may hold sections that the parser, stopped between them, left out."""

    source: Source
    kind: str
    parsed: Parsed | None
    root: Root | None
    names: tuple[Occurrence, ...]

    @property
    def path(self) -> Path:
        return Path(self.source.path)

    def at(self, offset: int) -> Occurrence | None:
        """The name at an offset; one that begins there is preferred to one that ends there."""
        touching = [o for o in self.names if o.span.start <= offset <= o.span.end]
        return touching[-1] if touching else None

    def declared(self) -> Iterator[Occurrence]:
        """The names that this file declares."""
        return (occurrence for occurrence in self.names if occurrence.declares)

    def domain_name(self) -> str | None:
        """The domain that a problem or scene names."""
        uses = (o for o in self.names if o.meaning.kind is Kind.DOMAIN and not o.declares)
        return next((o.meaning.name for o in uses), None)

    @property
    def includes(self) -> tuple[Include, ...]:
        """The places where a domain includes others."""
        return tuple(sections_of(self.root.sections, Include)) if isinstance(self.root, DomainNode) else ()

    def include_at(self, offset: int) -> Include | None:
        """The place around an offset where another domain is included."""
        return next((item for item in self.includes if item.span.start <= offset <= item.span.end), None)


@functools.lru_cache(maxsize=256)
def document(source: Source) -> Document:
    """Read a text; never fails, whatever it holds."""
    try:
        kind = kind_of(source)
        parsed = parse(source)
    except Refused:
        return Document(source, "", None, None, ())
    root = parsed.root or _root_of_sections(source)
    return Document(source, kind, parsed, root, () if root is None else occurrences(root))


def _root_of_sections(source: Source) -> Root | None:
    """The tree of the sections of a text and of the domain that it names, without what else stands between
    them: half-typed, that hides them."""
    try:
        return parse(_sections_alone(source)).root
    except Refused:
        return None


def _sections_alone(source: Source) -> Source:
    """The text with all blanked that stands between its sections, but for the domain; no offset moves."""
    shape = outline(source)
    text = shape.body
    begin = text.find("{") + 1
    for block in sorted(shape.blocks, key=lambda block: block.start):
        text = _blank_between(text, begin, block.start)
        begin = max(begin, block.end)
    return Source(source.path, _blank_between(text, begin, len(text) - text.endswith("}")))


def _blank_between(text: str, start: int, end: int) -> str:
    if start >= end:
        return text  # sections that are not closed may lie one in another
    for named in _NAMED_DOMAIN.finditer(text, start, end):
        if "#" not in text[line_start(text, named.start()) : named.start()]:
            return blank(blank(text, start, named.start()), named.end(), end)
    return blank(text, start, end)


@dataclass(frozen=True, slots=True)
class Library:
    """Texts that are `open` in the editor by their path, and the folders (`roots`) it works in; with
    `include_outside`, domains may include files from outside their folder."""

    open: Mapping[str, str] = field(default_factory=dict)
    roots: tuple[Path, ...] = ()
    include_outside: bool = False

    def document(self, path: Path | str) -> Document | None:
        """A file as the editor sees it; None where it cannot be read."""
        try:
            return document(self.read(path))
        except Refused:
            return None

    def read(self, path: Path | str) -> Source:
        """A text as the editor sees it; raises Refused where it cannot be read."""
        name = os.path.normpath(path) if isinstance(path, Path) else path
        return Source(name, self.open[name]) if name in self.open else read_source(name)

    def included(self, domain: Document) -> tuple[Document, ...]:
        """The files that a domain includes, and those that they include, each once."""
        found: dict[str, Document] = {domain.source.path: domain}
        waiting = [domain]
        while waiting:
            place = waiting.pop()
            for item in place.includes:
                path = place.path.parent / item.path
                inner = self.document(path) if self._may_include(path, (domain,)) else None
                if inner is not None and inner.kind == "domain" and inner.source.path not in found:
                    found[inner.source.path] = inner
                    waiting.append(inner)
        return tuple(found.values())[1:]

    def _may_include(self, path: Path, tops: Iterable[Document]) -> bool:
        """Whether one of some domains may include a file, itself or through others."""
        return self.include_outside or not all(is_outside(path, top.path) for top in tops)

    def includable(self, asked: Document, start: str) -> tuple[str, ...]:
        """How the path of an include may go on behind `start`, a folder that ends with `/` or nothing: with
        domains, and with folders, which have a `/`. Nothing where the check would refuse it."""
        folder = Path(os.path.normpath(asked.path.parent / start))
        tops = (asked, *self.includers(asked, only_open=True))
        opened = {path for path in map(Path, self.open) if path.parent == folder}
        try:
            files = sorted(path for path in {*folder.iterdir(), *opened} if self._may_include(path, tops))
            folders = frozenset(path for path in files if path.is_dir())
        except (OSError, ValueError):
            return ()
        shown = (path for path in files if not path.name.startswith("."))
        return tuple(
            f"{path.name}/" if path in folders else path.name
            for path in shown
            if path in folders or self._is_other_domain(path, asked)
        )

    def _is_other_domain(self, path: Path, asked: Document) -> bool:
        """Whether a file is a domain, or nothing yet, and not the one that was asked about."""
        found = self.document(path) if path.suffix == ".nid" else None
        return found is not None and found.kind in ("domain", "") and found.source.path != asked.source.path

    def includers(self, domain: Document, only_open: bool = False) -> tuple[Document, ...]:
        """The domains that include a file, open or, unless `only_open`, beside it or below a root."""
        files = self.open.keys() if only_open else self._files(domain.path.parent, *_folders(self.roots))
        found = (self.document(path) for path in sorted(files))
        return tuple(d for d in found if d is not None and d.includes and domain in self.included(d))

    def domain_named(self, name: str, near: Path) -> Document | None:
        """The domain `name.nid` beside a file, else one that is open, else the shipped one."""
        beside = near.parent / f"{name}.nid"
        elsewhere = sorted(path for path in self.open if Path(path).name == beside.name)
        candidates: list[Path | str] = [beside, *elsewhere]
        if name in shipped_names("domains"):
            candidates.append(shipped("domains") / beside.name)
        for path in candidates:
            found = self.document(path)
            if found is not None and found.kind == "domain":
                return found
        return None

    def domain_of(self, asked: Document) -> Document | None:
        """The domain that a file is for: itself, or the one it names."""
        if asked.kind == "domain":
            return asked
        name = asked.domain_name()
        return None if name is None else self.domain_named(name, asked.path)

    def users_of(self, domain: Document, roots: Iterable[Path]) -> tuple[Document, ...]:
        """What is for a domain: problems and scenes that are open, beside it, or below one of `roots`."""
        files = self._files(domain.path.parent, *_folders(roots))
        found = (self.document(path) for path in sorted(files))
        return tuple(
            user for user in found if user is not None and user.kind != "domain" and self._uses(user, domain)
        )

    def family(self, asked: Document) -> tuple[Document, ...]:
        """All files in which a name that a file declares may stand: its domain, those that include it, what
        any of these includes, and their problems; the file itself where it has no domain."""
        domain = self.domain_of(asked)
        if domain is None:
            return (asked,)
        tops = (domain, *self.includers(domain))
        domains = [place for top in tops for place in (top, *self.included(top))]
        users = [user for top in tops for user in self.users_of(top, self.roots)]
        return tuple({place.source.path: place for place in (*domains, *users)}.values())

    def declaration(self, asked: Document, meaning: Meaning) -> Occurrence | None:
        """Where a name of a file is declared: there, in its domain or in a file included together with it."""
        return next((o for o in self.visible(asked) if o.meaning == meaning), None)

    def visible(self, asked: Document) -> tuple[Occurrence, ...]:
        """Everything declared in a file, its domain, and the files included together with that."""
        domain = self.domain_of(asked)
        places = [asked]
        if domain is not None:
            tops = (domain, *(self.includers(domain, only_open=True) if asked is domain else ()))
            places += [place for top in tops for place in (top, *self.included(top))]
        files = {place.source.path: place for place in places}
        return tuple(occurrence for place in files.values() for occurrence in place.declared())

    def domain_names(self, near: Path) -> tuple[str, ...]:
        """What a problem may name as its domain."""
        return self._names(near, ("domain",), "domains")

    def names_of(self, asked: Document, key: str) -> tuple[str, ...]:
        """What a study may name under a key: files beside it and shipped ones, or its own parts."""
        match key:
            case "world":
                return self.domain_names(asked.path)
            case "scene":
                return self._names(asked.path, ("scene", "problem"), "problems")
            case "studies":
                return self._names(asked.path, ("study",), "studies")
        return tuple(o.meaning.name for o in asked.declared() if o.meaning.home == key)

    def _names(self, near: Path, kinds: tuple[str, ...], shipped_as: str) -> tuple[str, ...]:
        """The names of files of some kinds that stand beside one or ship."""
        beside = (self.document(path) for path in self._files(near.parent))
        found = {each.path.stem for each in beside if each is not None and each.kind in kinds}
        return tuple(sorted(found | set(shipped_names(shipped_as))))

    def _files(self, *folders: Path) -> set[str]:
        """The files in some folders and those that are open."""
        return {str(path) for folder in folders for path in folder.glob("*.nid")} | self.open.keys()

    def _uses(self, user: Document, domain: Document) -> bool:
        found = self.domain_of(user)
        return found is not None and found.source.path == domain.source.path


def _folders(roots: Iterable[Path]) -> list[Path]:
    """The folders below some others, those that a version control or package tool keeps left out."""
    found = []
    for root in roots:
        for name, inner, _ in os.walk(root):
            inner[:] = sorted(n for n in inner if not n.startswith((".", "_")) and n != "node_modules")
            found.append(Path(name))
            if len(found) >= _MOST_FOLDERS:
                return found
    return found
