"""The page of results from the rows of experiments, and from nothing else but the texts of their studies."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from cleancli.experiment.rows import PARQUET, read_rows
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.results.page import Results, results_of, write_results
from cleancli.study.check import load_study


def write_report(rows: Iterable[Path], folder: Path) -> Path:
    """Write the page and its figures into a folder, and tell where the page is. `rows`: folders of
    experiments, or files of rows.

    Raises Refused for what holds no rows or no study, and where rows of one study are in two of them (E702),
    MissingMatplotlib, OSError.
    """
    found: dict[str, Results] = {}
    for each in rows:
        path = each / PARQUET if each.is_dir() else each
        read = read_rows(path)
        for name in dict.fromkeys(row.study for row in read):
            if name in found:
                message = f"`{path}` holds rows of the study `{name}`, and so does a file before it"
                raise Refused([Diagnostic("E702", message, None, help="name one of them")])
            beside = path.parent / f"{name}.nid"
            study = load_study(read_source(beside if beside.is_file() else find(name, "studies")))
            found[name] = results_of(study, read)
    return write_results(tuple(found.values()), folder)
