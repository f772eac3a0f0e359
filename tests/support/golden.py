"""Texts that are compared word for word with those of tests/golden."""

from __future__ import annotations

import difflib
import os
from pathlib import Path

GOLDEN = Path(__file__).parents[1] / "golden"


def check_golden(name: str, text: str) -> None:
    """The text is the one in the file; CLEANCLI_REGENERATE=1 writes it anew: read the difference."""
    path = GOLDEN / name
    if os.environ.get("CLEANCLI_REGENERATE"):
        path.write_text(text, encoding="utf-8")
    expected = path.read_text(encoding="utf-8").splitlines()
    different = difflib.unified_diff(expected, text.splitlines(), "expected", "found", lineterm="")
    assert text.splitlines() == expected, "\n".join(different)
