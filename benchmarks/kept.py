"""Results of a long benchmark, a JSON object a line, so that one that was stopped goes on where it was."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cleancli.files.replace import replace_file

Row = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Kept:
    """The lines of a file; of none, nothing is kept."""

    path: Path | None

    def rows(self) -> list[Row]:
        """All rows. A last line without its end was cut short: it is taken out, so that the next one begins a
        line of its own."""
        if self.path is None or not self.path.exists():
            return []
        lines = self.path.read_text(encoding="utf-8").splitlines(keepends=True)
        whole = [line for line in lines if line.endswith("\n")]
        if whole != lines:
            replace_file(self.path, "".join(whole))
        return [json.loads(line) for line in whole]

    def add(self, row: Row) -> None:
        """One more row, on the disk when this returns; in one step, since several processes may write."""
        if self.path is not None:
            with self.path.open("ab", buffering=0) as file:
                file.write(f"{json.dumps(row)}\n".encode())
