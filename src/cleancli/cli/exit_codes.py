"""Every exit code of every command (docs/exit-codes.md)."""

from __future__ import annotations

import enum


class ExitCode(enum.IntEnum):
    """What a program that calls `cleancli` can tell from the exit status."""

    DONE = 0
    REFUSED = 1
    USAGE = 2
    NOT_CLEAN = 3
    MISSING_PART = 4
    FILES = 5
    ROBOT = 6
    INTERRUPTED = 130


class MissingPart(Exception):
    """A command needs a part that is not here; the message says how to get it, or how to do without."""


class Stopped(Exception):
    """Ctrl-C has ended a run in good order; the message says what is left to do."""
