"""What a person sees while an episode runs: a line per look, plan and action, and what is going on now."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import Protocol

from rich.console import Console, RenderableType
from rich.live import Live

from cleancli.api.symbolic import Told
from cleancli.cli.kernels import how_loaded
from cleancli.cli.progress import SLOW, told_late
from cleancli.cli.views.dashboard import Shown, came_of, dashboard, names_of, updated
from cleancli.cli.views.table_map import Place
from cleancli.execution.episode_state import Situation
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
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.diagnostics.plural import plural
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
    told: Told | None = None,
    plain: bool = False,
) -> Iterator[View]:
    """A view on standard error: live in a terminal, lines elsewhere or if `plain`, silent if `quiet`.

    `scene` is drawn as a map, with the tool where `tool()` says that it is; `limit`: the most actions.
    In the symbolic world `told` says what there is to say of a situation.
    """
    if quiet:
        yield _Silent()
        return
    console = Console(stderr=True, highlight=False) if console is None else console
    if plain:
        yield _Lines(console, told)
        return
    if not console.is_terminal:
        with ExitStack() as waiting:
            yield _Waiting(console, told, waiting)
        return
    view = _Live(console, scene, tool, limit, told)
    with Live(console=console, get_renderable=view.render, refresh_per_second=8, transient=True):
        yield view


def _seen(situation: Situation) -> str:
    """The areas seen, those hidden in brackets."""
    if situation.areas:
        names = (a.name if a.name not in situation.unseen else f"({a.name})" for a in situation.areas)
        later = f"; left out of plans: {', '.join(situation.left_out)}" if situation.left_out else ""
        return ", ".join(names) + later
    return "no dirt"


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

    def __init__(self, console: Console, told: Told | None = None) -> None:
        self._console, self._told, self._last = console, told, ""
        self._before: frozenset[str] = frozenset()
        self._seen: frozenset[str] = frozenset()
        self._gave_up = False

    def write(self, event: Event) -> None:
        """Show one event."""
        match event:
            case Looked():
                self._looked(event)
            case Decided():
                self._decided(event)
            case Started():
                self._before = self._seen
                self._gave_up = False
            case Failed(number, move, reason):
                self._line(f"  {number}. {move} failed: {reason}")
            case StrokeEnded():
                self._carried_out(event)
            case Acted():
                self._line(f"  {came_of(self._before, event)}")
            case Ended(reason):
                self._line(f"ended: {reason}")
            case _:
                pass

    def _looked(self, event: Looked) -> None:
        if self._told is not None:
            self._tell(self._told(event.situation))
        else:
            look = f"looked{_LOOKS[event.purpose]}"
            self._line(f"{look}: {_seen(event.situation)} ({event.seconds:z.2f} s)")
        self._seen = names_of(event.situation)

    def _carried_out(self, event: StrokeEnded) -> None:
        if self._told is None:
            self._line(f"  {event.number}. carried out at {event.clock:z.1f} s of robot time")
        elif event.clock:  # the domain has durations
            self._line(f"  {event.number}. carried out at {event.clock:z.1f} s of the domain's time")

    def _decided(self, event: Decided) -> None:
        """What is to be done now. A second look shows nothing new in the symbolic world, so that a second
        decision for nothing is no news there."""
        if self._told is not None and self._gave_up:
            return
        plan = event.plan
        self._gave_up = not event.moves
        chosen = ", ".join(map(str, event.moves)) or "nothing"
        value = "" if plan is None else f"; value {plan.value:z.2f}, {plural(len(plan.actions), 'action')}"
        how = "shown" if event.is_taught else "decided"
        self._line(f"{how}: {chosen}{value} ({event.seconds:z.2f} s)")
        if plan is not None and (loading := plan.seconds.get("compile", 0.0)) > SLOW:
            self._line(f"(and {loading:z.0f} s for {how_loaded()})")

    def _tell(self, text: str) -> None:
        """What the symbolic world is like now, where that is news."""
        if text != self._last:
            self._line(f"now: {text}")
        self._last = text

    def _line(self, text: str) -> None:
        self._console.print(printable(text), markup=False, soft_wrap=True)


class _Waiting(_Lines):
    """The lines, and one where a decision takes long: a planner may have to be compiled first."""

    def __init__(self, console: Console, told: Told | None, waiting: ExitStack) -> None:
        super().__init__(console, told)
        self._waiting = waiting

    def write(self, event: Event) -> None:
        """Show one event."""
        self._waiting.close()
        super().write(event)
        if isinstance(event, Looked):
            self._waiting.enter_context(told_late("deciding"))


class _Live(_Lines):
    """The lines, and below them the table, the plan and the account as they are now."""

    def __init__(
        self,
        console: Console,
        scene: Scene | None,
        tool: Callable[[], Place | None],
        limit: int,
        told: Told | None = None,
    ) -> None:
        super().__init__(console, told)
        self._scene, self._tool, self._limit = scene, tool, limit
        self._shown = Shown()

    def write(self, event: Event) -> None:
        """Show one event."""
        super().write(event)
        self._shown = updated(self._shown, event, self._told)
        if isinstance(event, Moved | StrokeEnded):
            self._shown = replace(self._shown, tool=self._tool())

    def render(self) -> RenderableType:
        """What Live asks for, in a thread of its own: only what `write` has put there is read."""
        ascii_only = self._console.options.ascii_only
        size = self._console.width, self._console.height
        return dashboard(self._shown, self._scene, self._limit, size, ascii_only)
