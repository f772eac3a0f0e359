"""The layout of a .nid text: trailing blanks removed, one line end after the last line. No token changes."""

from __future__ import annotations

import re


def layout(text: str) -> str:
    """The text in its canonical layout; doing it twice changes nothing."""
    ends = re.findall(r"\r\n|\n|\r", text)
    stripped = re.sub(r"[ \t\f]+(?=\r|\n|\Z)", "", text)
    content = stripped.rstrip("\r\n")
    return content + (ends[0] if ends else "\n") if content else ""
