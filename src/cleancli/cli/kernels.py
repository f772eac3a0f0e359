"""What became of the planners' compiled code, without loading numba where no planner has."""

from __future__ import annotations

import sys


def has_compiled() -> bool:
    """Whether this process had to compile; else what it ran was loaded from disk."""
    if "numba" not in sys.modules:
        return False
    from cleancli.planning.kernels.jit import has_compiled as found

    return found()


def how_loaded() -> str:
    """What was done to have the planner ready."""
    return "compiling the planner, once after installation" if has_compiled() else "loading the planner"
