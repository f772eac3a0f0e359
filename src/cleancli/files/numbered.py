"""The order of folders whose names have numbers."""

from __future__ import annotations

import re
from pathlib import Path


def by_numbers(folder: Path) -> list[str | int]:
    """Sorts `look-9` before `look-10`; words and numbers take turns, so that like meets like."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", folder.name)]
