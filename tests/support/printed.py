"""What pages show of what commands print, compared line by line."""

from __future__ import annotations

import re

_TIMES = (
    (r"^seconds: .*", "seconds: TIMES"),
    (r"\(\d+\.\d\d s\)", "(TIME s)"),
    (r"^(\S.* \(\S+ to \S+\)) \S+ \S+$", r"\1 TIMES"),  # a planner's row: the last two columns
    (r"^(\d+ (?:yes|no) \d+) .*", r"\1 TIMES"),  # an episode's row
)
"""What differs from run to run."""


def without_times(text: str) -> list[str]:
    """Its lines, with single blanks and without what differs from run to run."""
    lines = []
    for line in text.splitlines():
        told = re.sub(r"\s+", " ", line).strip()
        for pattern, instead in _TIMES:
            told = re.sub(pattern, instead, told)
        lines.append(told)
    return lines


def agree(shown: str, printed: str) -> bool:
    """Whether a page shows what was printed; `...` stands for any lines."""
    pattern = "".join(
        r"(?:.*\n)*?" if line == "..." else re.escape(line) + r"\n" for line in without_times(shown)
    )
    return re.fullmatch(pattern, "".join(f"{line}\n" for line in without_times(printed))) is not None
