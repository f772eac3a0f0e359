"""The garbage collector, kept out of the way where much is built and nothing of it is garbage."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def paused_collector() -> Iterator[None]:
    """Python's cyclic collector does not run inside, and afterwards does what it did before.

    It goes through all objects again and again while their number grows, and what grounding builds has no
    cycles. One pause may lie in another: the outermost ends it. It is a decorator too.
    """
    running = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if running:
            gc.enable()
