"""How much memory an input of a benchmark may take: one that asks for more fails, and not the machine."""

from __future__ import annotations

import resource
from pathlib import Path

MEMORY = 1 << 30
"""Bytes that a process may take beside what it holds already. Chosen: several times what any input needs."""


def limit_memory() -> None:
    """From here on a process that asks for more than `MEMORY` has MemoryError."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    most = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def greatest_memory() -> int:
    """Bytes that this process has held at once, its program with them."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10
