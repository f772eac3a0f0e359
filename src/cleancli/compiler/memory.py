"""How much memory a task may take: half of what the machine has, or of what a container or a limit leaves."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

_OF_CONTAINERS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")
"""Where Linux says what a container may take, by its two versions of control groups."""

_UNSAID = 8 << 30
"""Bytes that are taken to be there where a system does not say (Windows). Chosen."""


def most_bytes() -> int:
    """Half of the memory: a task is followed by its arrays and by what a planner needs."""
    return min(_limits()) // 2


def _limits() -> Iterator[int]:
    yield os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else _UNSAID
    yield from _of_process()
    for place in _OF_CONTAINERS:
        try:
            said = Path(place).read_text(encoding="ascii").strip()
        except OSError:  # other systems, and Linux without that version
            continue
        if said.isdigit():  # or `max`
            yield int(said)


def _of_process() -> Iterator[int]:
    """What this process may have, where that is limited."""
    try:
        import resource  # not on Windows
    except ImportError:
        return
    soft, _ = resource.getrlimit(resource.RLIMIT_AS)
    if soft != resource.RLIM_INFINITY:
        yield soft
