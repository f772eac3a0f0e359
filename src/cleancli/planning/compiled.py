"""How compiled code is compiled: cached on disk, without the interpreter's lock, and counting no references.

numba counts references wherever an array of a named tuple is read, which here costs many times the
arithmetic. Nothing is allocated and no array outlives its caller's, so nothing needs to be counted (`_nrt`,
numba's own switch for code without its run-time memory). What breaks that is a compile-time error.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

from cleancli.planning.preference import preferred

F = TypeVar("F", bound=Callable[..., object])

_njit: Any = njit  # its annotations know nothing of `_nrt`


def compiled(function: F) -> F:
    """Compiles a function that allocates nothing, when it is first called."""
    result: F = _njit(cache=True, nogil=True, _nrt=False, error_model="numpy")(function)
    return result


def inner(function: F) -> F:
    """The same for a function that only compiled code calls, which saves compiling it for Python.

    A call from Python would crash.
    """
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    result: F = _njit(cache=True, nogil=True, _nrt=False, error_model="numpy", **options)(function)
    return result


def inlined(function: F) -> F:
    """The same for a small function, which becomes a part of its callers."""
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "forceinline": True}
    result: F = _njit(cache=True, nogil=True, _nrt=False, error_model="numpy", **options)(function)
    return result


better = inlined(preferred)
"""planning/preference.py for compiled code."""
