"""Every exit code of every command (docs/exit-codes.md)."""

from __future__ import annotations

import enum


class ExitCode(enum.IntEnum):
    """What a program that calls `cleancli` can tell from the exit status."""

    DONE = 0
    REFUSED = 1
    USAGE = 2
    NOT_CLEAN = 3
    NO_PHYSICS = 4
    FILES = 5
    INTERRUPTED = 130
