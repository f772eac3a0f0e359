"""Compiles functions with numba: cached on disk, without the interpreter's lock, and counting no references.

numba counts references wherever an array of a named tuple is read, which here costs many times the
arithmetic. Nothing is allocated and no array outlives its caller's, so nothing needs to be counted (`_nrt`,
numba's own switch for code without its run-time memory). What breaks that is a compile-time error.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.runtime.nrt import rtsys

from cleancli.compiler.semantics import idle_earliness
from cleancli.planning.preference import preferred

F = TypeVar("F", bound=Callable[..., object])

_numba_njit: Any = numba.njit  # its annotations know nothing of `_nrt`
_made: list[Any] = []
"""The compiled functions of this process."""


def njit(*, cache: bool = True, **options: Any) -> Callable[[F], F]:
    """numba's `njit`, with a cache where one can be kept: neither a read-only installation, a user without a
    home, a full disk nor a damaged cache keeps anything from being compiled."""

    def compiled(function: F) -> F:
        result: F
        try:
            result = _forgiving(_numba_njit(cache=cache and not _is_homeless(), **options)(function))
        except RuntimeError:  # there is no folder for the cache
            result = _numba_njit(**options)(function)
        _made.append(result)
        return result

    return compiled


def has_compiled() -> bool:
    """Whether this process has compiled something; else all that it ran was loaded from disk."""
    return any(function.stats.cache_misses for function in _made)


def _is_homeless() -> bool:
    """Whether numba would take `~` for the name of a folder below the current one."""
    named = os.environ.get("NUMBA_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME")
    in_tree = os.access(Path(__file__).parent, os.W_OK)
    return not (named or in_tree or os.path.isabs(os.path.expanduser("~")))


def _forgiving(dispatcher: Any) -> Any:
    """Let a cache that cannot be read or written be as good as none, and load from it nothing but code."""
    cache = dispatcher._cache
    cache.load_overload = _or_nothing(_loading(cache))
    cache.save_overload = _or_nothing(cache.save_overload)
    return dispatcher


def _loading(cache: Any) -> Callable[..., Any]:
    """What loads compiled code from a cache.

    numba's own `load_overload` first imports all that it may need to compile, scipy's linear algebra with it:
    that takes as long as `import numba` again. What was compiled needs numba's run-time memory alone, and
    where nothing is found the compiler imports the rest by itself.
    """
    if not hasattr(cache, "_load_overload"):  # there is no cache, or numba has changed
        return cache.load_overload  # type: ignore[no-any-return]

    def load(signature: Any, target: Any) -> Any:
        rtsys.initialize(target)
        return cache._load_overload(signature, target)

    return load


def _or_nothing(step: Callable[..., Any]) -> Callable[..., Any]:
    def tried(*arguments: Any) -> Any:
        try:
            return step(*arguments)
        except Exception:  # reading what was pickled may raise anything
            return None

    return tried


def compiled(function: F) -> F:
    """Compiles a function that allocates nothing, when it is first called."""
    return njit(nogil=True, _nrt=False, error_model="numpy")(function)


def inner(function: F) -> F:
    """The same for a function that only compiled code calls, which saves compiling it for Python.

    A call from Python would crash.
    """
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return njit(nogil=True, _nrt=False, error_model="numpy", **options)(function)


def inlined(function: F) -> F:
    """The same for a small function, which becomes a part of its callers."""
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "forceinline": True}
    return njit(nogil=True, _nrt=False, error_model="numpy", **options)(function)


better = inlined(preferred)
"""planning/preference.py for compiled code."""

standing_earliness = inlined(idle_earliness)
"""compiler/semantics.py's `idle_earliness` for compiled code."""
