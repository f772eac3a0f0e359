"""What a person sees while an episode runs: a line per look, plan and action, and what is going on now."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Protocol, TypeVar

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.status import Status

from cleancli.execution.events import (
    Decided,
    Ended,
    Event,
    Failed,
    Looked,
    Moved,
    Purpose,
    Started,
    StrokeEnded,
)
from cleancli.execution.state import Situation

SLOW = 2.0
"""Seconds after which a person wonders what is going on."""

_Item = TypeVar("_Item")


class View(Protocol):
    """Something that is told every event."""

    def write(self, event: Event) -> None:
        """Show one event."""


@contextmanager
def show(quiet: bool) -> Iterator[View]:
    """A view on standard error: live in a terminal, plain lines elsewhere, silent if `quiet`."""
    if quiet:
        yield _Silent()
        return
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        yield _Lines(console, None)
        return
    with console.status("looking") as status:
        yield _Lines(console, status)


def _seen(situation: Situation) -> str:
    """The areas seen, those hidden in brackets; in the symbolic world, how many facts hold."""
    if situation.areas:
        names = (a.name if a.name not in situation.unseen else f"({a.name})" for a in situation.areas)
        return ", ".join(names)
    return f"{len(situation.state)} facts" if situation.state else "no dirt"


_LOOKS = {
    Purpose.FIRST: "",
    Purpose.AFTER: "",
    Purpose.EXTRA: " with the arm out of view",
    Purpose.LEARNING: " with the arm out of view, to learn",
}


class _Silent:
    def write(self, event: Event) -> None:
        """Show nothing."""


class _Lines:
    """Prints what has happened; in a terminal, `status` says what is happening."""

    def __init__(self, console: Console, status: Status | None) -> None:
        self._console, self._status = console, status
        self._doing = "looking"

    def write(self, event: Event) -> None:
        """Show one event."""
        match event:
            case Looked(situation, _, seconds, purpose):
                self._line(f"looked{_LOOKS[purpose]}: {_seen(situation)} ({seconds:.2f} s)")
                self._now("planning")
            case Decided(_, moves, plan, seconds):
                chosen = ", ".join(str(move) for move in moves) or "nothing"
                value = "" if plan is None else f"; value {plan.value:.2f}, {len(plan.actions)} actions"
                self._line(f"decided: {chosen}{value} ({seconds:.2f} s)")
                if plan is not None and (compiling := plan.seconds.get("compile", 0.0)) > SLOW:
                    self._line(
                        f"(and {compiling:.0f} s for compiling the planner, which only the first run does)"
                    )
            case Started(number, move):
                self._now(f"{number}. {move}")
            case Failed(number, move, reason):
                self._line(f"  {number}. {move} failed: {reason}")
            case Moved(clock):
                if self._status is not None:
                    self._status.update(f"{self._doing}, {clock:.1f} s of robot time")
            case StrokeEnded(_, clock):
                self._line(f"  {self._doing}, done at {clock:.1f} s of robot time")
                self._now("looking")
            case Ended(reason):
                self._line(f"ended: {reason}")
            case _:
                pass

    def _line(self, text: str) -> None:
        self._console.print(text, markup=False, soft_wrap=True)

    def _now(self, doing: str) -> None:
        self._doing = doing
        if self._status is not None:
            self._status.update(doing)


@contextmanager
def working(what: str) -> Iterator[None]:
    """Show in a terminal that something takes its time; elsewhere nothing."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield
        return
    with console.status(what):
        yield


def counted(what: str, items: Iterable[_Item], number: int) -> Iterator[_Item]:
    """The items as they come, of which there are so many; where they take long, a terminal shows how far."""
    console = Console(stderr=True)
    columns = (TextColumn(what), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    task, started = bar.add_task(what, total=number), time.monotonic()
    try:
        for item in items:
            bar.advance(task)
            if not bar.live.is_started and time.monotonic() - started > SLOW:
                bar.start()
            yield item
    finally:
        bar.stop()


@contextmanager
def counting(what: str, quiet: bool) -> Iterator[Callable[[], None]]:
    """Something to call after each step of a long work; a terminal shows `what` with the number of steps."""
    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda: None
        return
    done = 0
    with console.status(what.format(done)) as status:

        def count() -> None:
            nonlocal done
            done += 1
            status.update(what.format(done))

        yield count
