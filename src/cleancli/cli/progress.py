"""Progress of what takes its time: shown in a terminal, elsewhere told in one line where it takes long."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

SLOW = 2.0
"""Seconds after which a person wonders what is going on."""

AFTER = "CLEANCLI_PROGRESS_AFTER"
"""The environment's variable that sets other seconds; `inf` for never."""

_Item = TypeVar("_Item")


@contextmanager
def working(what: str, quiet: bool = False) -> Iterator[None]:
    """Show in a terminal that something takes its time; elsewhere say so in a line of standard error once it
    has taken long. If `quiet`, nothing."""
    if quiet:
        yield
        return
    console = _terminal()
    with told_late(what) if console is None else console.status(what):
        yield


def slow() -> float:
    """The seconds after which progress is told."""
    try:
        return float(os.environ.get(AFTER, SLOW))
    except ValueError:
        return SLOW


@contextmanager
def told_late(what: str) -> Iterator[None]:
    """A line of standard error where what is done meanwhile takes long; then `what` may be anywhere in
    compiled code, so that another thread tells it."""
    errors, seconds = sys.stderr, slow()
    if not 0 <= seconds <= threading.TIMEOUT_MAX:
        yield
        return

    def tell() -> None:
        with suppress(OSError, ValueError):  # nobody reads it any more, or it is closed
            print(f"{what} ...", file=errors, flush=True)

    timer = threading.Timer(seconds, tell)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def counted(what: str, items: Iterable[_Item], number: int) -> Iterator[_Item]:
    """The items as they come, of which there are so many; where they take long, a terminal shows how far, and
    elsewhere a line of standard error says what is done."""
    console = _terminal()
    if console is None:
        with told_late(what):
            yield from items
        return
    bar, started = _bar(what, console), time.monotonic()
    task = bar.add_task(what, total=number)
    try:
        for item in items:
            bar.advance(task)
            if not bar.live.is_started and time.monotonic() - started > slow():
                bar.start()
            yield item
    finally:
        bar.stop()


@contextmanager
def counting(what: str, quiet: bool) -> Iterator[Callable[[], None]]:
    """Something to call after each step of a long work; a terminal shows `what` with the number of steps."""
    console = None if quiet else _terminal()
    if console is None:
        yield lambda: None
        return
    done = 0
    with console.status(what.format(done)) as status:

        def count() -> None:
            nonlocal done
            done += 1
            status.update(what.format(done))

        yield count


def _terminal() -> Console | None:
    """The terminal that standard error goes to. rich takes long to load, and is imported for one alone."""
    if not sys.stderr.isatty():
        return None
    from rich.console import Console

    console = Console(stderr=True)
    return console if console.is_terminal else None


def _bar(what: str, console: Console) -> Progress:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    return Progress(*columns, console=console, transient=True)
