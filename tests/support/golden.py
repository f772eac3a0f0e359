"""Texts that are compared word for word with those of tests/golden."""

from __future__ import annotations

import os
from pathlib import Path

GOLDEN = Path(__file__).parents[1] / "golden"


def check_golden(name: str, text: str) -> None:
    """The text is the one in the file; CLEANCLI_REGENERATE=1 writes it anew: read the difference."""
    path = GOLDEN / name
    if os.environ.get("CLEANCLI_REGENERATE"):
        path.write_text(text, encoding="utf-8")
    assert text.splitlines() == path.read_text(encoding="utf-8").splitlines()
