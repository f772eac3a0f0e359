"""What a conversion comes to: texts, and what has to be told about them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.plain import fields_of
from cleancli.files.replace import Replacement, write_all
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.load import read_source


@dataclass(frozen=True, slots=True)
class ConversionResult:
    """The texts of a domain and its problems, by their names, and what has to be told about them.

    `functions` has the predicates of libPRADA that a function stands for; `sources` has the texts that
    `diagnostics` point into; `texts` has all texts by the names of their files, the domain's first where it
    is made; `names` tells what became of names that could not stay. Prints as the domain's text.
    """

    name: str
    domain: str
    problems: Mapping[str, str]
    functions: Mapping[str, tuple[str, ...]]
    notes: tuple[str, ...]
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]
    texts: Mapping[str, str]
    names: Mapping[str, str]

    def __str__(self) -> str:
        return self.domain

    def files(self, folder: str | Path) -> dict[Path, str]:
        """The texts by the paths that they have in a folder, the domain's first."""
        return {Path(folder) / name: text for name, text in self.texts.items()}

    def write(self, folder: str | Path, *, force: bool = False) -> tuple[Path, ...]:
        """Writes all files or none into a folder, and says which; `force` replaces those that exist. Raises
        Refused."""
        files = self.files(folder)
        before = [read_source(str(path)).text if force and path.exists() else None for path in files]
        for path in files:
            path.parent.mkdir(parents=True, exist_ok=True)
        pairs = zip(files.items(), before, strict=True)
        write_all(Replacement(path, text, old) for (path, text), old in pairs)
        return tuple(files)

    def to_dict(self) -> dict[str, object]:
        """Everything but the diagnostics and what they point into; no text twice."""
        return fields_of(self, ("diagnostics", "sources", "texts"))
