"""Rows as tables: written as Parquet and as CSV, and read again, typed.

A column an axis, by its name; `seconds.planning` and the like for what a row has several of.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import msgspec

from cleancli.files.plain import read_plain
from cleancli.files.replace import replace_file
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.study.row import Row
from cleancli.study.schema import AXES, VARIED

PARQUET, CSV = "rows.parquet", "rows.csv"

LARGEST = 1 << 28
"""Bytes of the table that is read."""

_SEVERAL = ("seconds", "versions")
"""Fields of which each part has a column."""


def write_rows(folder: Path, rows: Sequence[Row]) -> None:
    """Write both tables in a folder, the same bytes for the same rows. Raises OSError, ImportError without
    pyarrow."""
    import pyarrow
    from pyarrow import parquet

    flat = [_flat(row) for row in rows]
    names = _columns(flat)
    table = pyarrow.Table.from_pydict({name: [each.get(name) for each in flat] for name in names})
    written = io.BytesIO()
    parquet.write_table(table, written, compression="zstd")
    replace_file(folder / PARQUET, written.getvalue())
    text = io.StringIO()
    writer = csv.DictWriter(text, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(flat)
    replace_file(folder / CSV, text.getvalue())


def read_rows(path: Path) -> tuple[Row, ...]:
    """The rows of a Parquet file. Raises Refused (E702) for one that holds others, OSError, ImportError."""
    import pyarrow
    from pyarrow import parquet

    content = io.BytesIO(read_plain(path, LARGEST))
    try:
        read = parquet.read_table(content).to_pylist()
        return tuple(msgspec.convert(_nested(each), Row) for each in read)
    except (pyarrow.ArrowException, msgspec.MsgspecError, OSError) as error:  # of what is in memory
        reason = str(error).partition("\n")[0]
        raise Refused([Diagnostic("E702", f"`{path}` holds no rows of a study: {reason}", None)]) from None


def is_axis(column: str) -> bool:
    """Whether a column is that of an axis."""
    return column in AXES or column.partition(".")[0] in VARIED


def _columns(flat: Iterable[Mapping[str, Any]]) -> list[str]:
    """All columns: first what tells rows apart, then what they came to."""
    found = list(dict.fromkeys(name for each in flat for name in each))
    axes = [name for name in found if is_axis(name)]
    return ["study", "part", *axes, *(n for n in found if n not in (*axes, "study", "part"))]


def _flat(row: Row) -> dict[str, Any]:
    own = {each.name: getattr(row, each.name) for each in fields(row)}
    several = {f"{name}.{part}": value for name in _SEVERAL for part, value in own.pop(name).items()}
    return {**own.pop("axes"), **own, "files": " ".join(row.files), **several}


def _nested(flat: Mapping[str, Any]) -> dict[str, Any]:
    given = {name: value for name, value in flat.items() if value is not None}
    row: dict[str, Any] = {name: {} for name in ("axes", *_SEVERAL)} | {"ink_left": None, "score": None}
    for name, value in given.items():
        first, _, part = name.partition(".")
        if is_axis(name):
            row["axes"][name] = value
        elif first in _SEVERAL and part:
            row[first][part] = value
        else:
            row[name] = value.split() if name == "files" and isinstance(value, str) else value
    return row
