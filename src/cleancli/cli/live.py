"""What a person sees while an episode runs: a line per look, plan and action, and what is going on now."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Protocol

from rich.console import Console, RenderableType
from rich.live import Live

from cleancli.cli.dashboard import Shown, came_of, dashboard, names_of, updated
from cleancli.cli.progress import SLOW
from cleancli.cli.table_map import Place
from cleancli.execution.events import (
    Acted,
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
from cleancli.language.diagnostics import printable
from cleancli.scene.model import Scene


class View(Protocol):
    """Something that is told every event."""

    def write(self, event: Event) -> None:
        """Show one event."""


@contextmanager
def show(
    quiet: bool,
    scene: Scene | None = None,
    tool: Callable[[], Place | None] = lambda: None,
    limit: int = 0,
    console: Console | None = None,
) -> Iterator[View]:
    """A view on standard error: live in a terminal, plain lines elsewhere, silent if `quiet`.

    `scene` is drawn as a map, with the tool where `tool()` says that it is; `limit`: the most actions.
    """
    if quiet:
        yield _Silent()
        return
    console = Console(stderr=True, highlight=False) if console is None else console
    if not console.is_terminal:
        yield _Lines(console)
        return
    view = _Live(console, scene, tool, limit)
    with Live(console=console, get_renderable=view.render, refresh_per_second=8, transient=True):
        yield view


def _seen(situation: Situation) -> str:
    """The areas seen, those hidden in brackets; in the symbolic world, how many facts hold."""
    if situation.areas:
        names = (a.name if a.name not in situation.unseen else f"({a.name})" for a in situation.areas)
        later = f"; left out of plans: {', '.join(situation.left_out)}" if situation.left_out else ""
        return ", ".join(names) + later
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
    """Prints what has happened, a line each."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._before: frozenset[str] = frozenset()
        self._seen: frozenset[str] = frozenset()

    def write(self, event: Event) -> None:
        """Show one event."""
        match event:
            case Looked(situation, _, seconds, purpose):
                self._line(f"looked{_LOOKS[purpose]}: {_seen(situation)} ({seconds:.2f} s)")
                self._seen = names_of(situation)
            case Decided(_, moves, plan, seconds):
                chosen = ", ".join(str(move) for move in moves) or "nothing"
                value = "" if plan is None else f"; value {plan.value:.2f}, {len(plan.actions)} actions"
                self._line(f"decided: {chosen}{value} ({seconds:.2f} s)")
                if plan is not None and (compiling := plan.seconds.get("compile", 0.0)) > SLOW:
                    self._line(
                        f"(and {compiling:.0f} s for compiling the planner, which only the first run does)"
                    )
            case Started():
                self._before = self._seen
            case Failed(number, move, reason):
                self._line(f"  {number}. {move} failed: {reason}")
            case StrokeEnded(number, clock):
                self._line(f"  {number}. carried out at {clock:.1f} s of robot time")
            case Acted():
                self._line(f"  {came_of(self._before, event)}")
            case Ended(reason):
                self._line(f"ended: {reason}")
            case _:
                pass

    def _line(self, text: str) -> None:
        self._console.print(printable(text), markup=False, soft_wrap=True)


class _Live(_Lines):
    """The lines, and below them the table, the plan and the account as they are now."""

    def __init__(
        self, console: Console, scene: Scene | None, tool: Callable[[], Place | None], limit: int
    ) -> None:
        super().__init__(console)
        self._scene, self._tool, self._limit = scene, tool, limit
        self._shown = Shown()

    def write(self, event: Event) -> None:
        """Show one event."""
        super().write(event)
        self._shown = updated(self._shown, event)
        if isinstance(event, Moved | StrokeEnded):
            self._shown = replace(self._shown, tool=self._tool())

    def render(self) -> RenderableType:
        """What Live asks for, in a thread of its own: only what `write` has put there is read."""
        ascii_only = self._console.options.ascii_only
        size = self._console.width, self._console.height
        return dashboard(self._shown, self._scene, self._limit, size, ascii_only)
