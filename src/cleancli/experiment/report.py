"""The page of results from the rows of experiments, and from nothing else but the texts of their studies."""

from __future__ import annotations

import re
from collections.abc import Iterable, Set
from pathlib import Path

from cleancli.experiment.rows import PARQUET, read_rows
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find_beside
from cleancli.language.load import read_source
from cleancli.results.page import Results, results_of, write_results
from cleancli.study.check import load_study
from cleancli.study.model import Study

_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)


def write_report(rows: Iterable[Path], folder: Path) -> Path:
    """Write the page and its figures into a folder, and tell where the page is. `rows`: folders of
    experiments, or files of rows.

    Raises Refused for what holds no rows or no study, and where rows of one study are in two of them (E702),
    ImportError without pyarrow or matplotlib, OSError.
    """
    found: dict[str, Results] = {}
    for each in rows:
        path = each / PARQUET if each.is_dir() else each
        read = read_rows(path)
        for name in dict.fromkeys(row.study for row in read):
            if name in found:
                message = f"`{path}` holds rows of the study `{name}`, and so does a file before it"
                raise Refused([Diagnostic("E702", message, None, help="name one of them")])
            own = [row for row in read if row.study == name]
            found[name] = results_of(_study(name, path, {row.part for row in own}), own)
    return write_results(tuple(found.values()), folder)


def _study(name: str, path: Path, parts: Set[str]) -> Study:
    """The study that rows name, of which they have these parts: from the text beside them, else the shipped
    one. Raises Refused, also for rows that can be of none, since anybody may have written them."""
    if not _NAME.fullmatch(name):
        raise _refused(path, f"`{name}` is no name of a study")
    source = read_source(find_beside(path, name, "studies"))
    study = load_study(source)
    others = sorted(parts - {part.name for part in study.parts})
    if study.name != name or others:
        what = f"no part `{others[0]}`" if others else f"the name `{study.name}`"
        raise _refused(path, f"the study `{name}` of `{source.path}` has {what}")
    return study


def _refused(path: Path, reason: str) -> Refused:
    return Refused([Diagnostic("E702", f"`{path}` holds no rows of a study: {reason}", None)])
