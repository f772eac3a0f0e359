"""What goes on in an episode, at a glance: the table, what is planned, what happened, where the time went.

`Shown` is all that is told, made anew by each event; `dashboard` lays it out for a terminal of any size.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from cleancli.api.symbolic import Told
from cleancli.cli.views.table_map import rows_for, table_map
from cleancli.execution.episode_state import Account, Move, Situation
from cleancli.execution.events import (
    Acted,
    Checkpoint,
    Decided,
    Ended,
    Event,
    Failed,
    Looked,
    Moved,
    Started,
    StrokeEnded,
)
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.model import Fact, Value
from cleancli.language.printing.printer import print_fact
from cleancli.motion.path import ToolPath
from cleancli.scene.model import Scene

SMALLEST_MAP, LARGEST_MAP = 20, 44
"""Columns of the map."""

SIDE = 40
"""Columns that must be left beside the map."""

NEXT = 4
"""Planned actions that are shown."""

BAR = 8
SPINNER = "|/-\\"


@dataclass(frozen=True, slots=True)
class Shown:
    """What is told. `most`: dirty areas at the worst; `before`: those that there were when the action
    began that is under way, or was last; `moves` are still to be done; `path` is the
    way of the tool now, `tool` where it is. `told`: of the symbolic world, where there are no areas."""

    doing: str = "looking"
    situation: Situation | None = None
    most: int = 0
    before: frozenset[str] = frozenset()
    moves: tuple[Move, ...] = ()
    value: float | None = None
    path: ToolPath | None = None
    tool: tuple[float, float] | None = None
    happened: str = ""
    told: str = ""
    actions: int = 0
    clock: float = 0.0
    spent: Account = field(default_factory=Account)


def updated(shown: Shown, event: Event, told: Told | None = None) -> Shown:
    """What is to be told after an event; `told` says it of a situation in the symbolic world."""
    match event:
        case Looked(situation):
            return _looked(shown, situation, told)
        case Decided():
            doing = "moving the arm out of view" if told is None else "acting"
            return replace(_decided(shown, event), doing=doing)
        case Started():
            return _started(shown, event)
        case Moved(clock):
            return replace(shown, clock=clock)
        case StrokeEnded(_, clock):
            return replace(shown, doing="looking" if told is None else "acting", clock=clock)
        case Failed(number, move, reason):
            return replace(shown, happened=f"{number}. {move} failed: {reason}", doing="looking", moves=())
        case Acted():
            return replace(shown, happened=came_of(shown.before, event), situation=event.situation)
        case Checkpoint(state):
            return replace(shown, spent=state.spent)
        case Ended(reason, _, actions, spent):
            return replace(shown, doing=reason, spent=spent, actions=actions, path=None)
    return shown


def _looked(shown: Shown, situation: Situation, told: Told | None) -> Shown:
    most = max(shown.most, len(situation.areas))
    words = "" if told is None else told(situation)
    return replace(shown, situation=situation, most=most, doing="thinking", path=None, told=words)


def _decided(shown: Shown, event: Decided) -> Shown:
    """The whole plan is to be shown, where there is one: not only what is to be done before the next look."""
    if event.plan is None:
        return replace(shown, moves=event.moves, value=None)
    moves = tuple(Move(action.name, action.objects) for action in event.plan.actions)
    return replace(shown, moves=moves, value=event.plan.value)


def _started(shown: Shown, event: Started) -> Shown:
    left = shown.moves[1:] if shown.moves[:1] == (event.move,) else shown.moves
    return replace(
        shown,
        doing=f"{event.number}. {event.move}",
        moves=left,
        path=event.path,
        actions=event.number,
        before=names_of(shown.situation),
    )


def came_of(before: frozenset[str], event: Acted) -> str:
    """What became of an action, in a line: which areas are gone, and which are new since `before`; in the
    symbolic world, which facts are others, and what they are now."""
    after = names_of(event.situation)
    gone, new = sorted(before - after, key=_number), sorted(after - before, key=_number)
    parts = [f"{_listed(gone)} gone"] * bool(gone) + [f"{_listed(new)} new"] * bool(new)
    if not before and not after and event.transition is not None:
        values = event.transition.after
        changed = [_fact(*fluent, values.get(fluent, False)) for fluent in sorted(event.transition.changed)]
        return f"{event.number}. {event.move}: {_listed(changed) or 'nothing changed'}"
    return f"{event.number}. {event.move}: {', '.join(parts) or 'no area came or went'}"


def _fact(symbol: str, objects: tuple[str, ...], value: Value) -> str:
    """What holds now: `pot() = 3`, `not dirt(a1)`."""
    told = print_fact(Fact(symbol, objects, value))
    return f"not {told}" if value is False else told


def names_of(situation: Situation | None) -> frozenset[str]:
    """The names of the areas."""
    return frozenset(area.name for area in (situation.areas if situation is not None else ()))


def _number(name: str) -> tuple[int, str]:
    return (int(name[1:]) if name[1:].isdigit() else 0), name


def _listed(names: list[str]) -> str:
    return ", ".join(names) if len(names) <= 4 else f"{', '.join(names[:3])} and {len(names) - 3} more"


def dashboard(
    shown: Shown, scene: Scene | None, limit: int, size: tuple[int, int], ascii_only: bool
) -> RenderableType:
    """For a terminal of `size` columns and rows; `limit` is the most actions. Lines never wrap: in a small
    terminal there is less, in a very small one a single line."""
    columns, rows = size
    status = _line(f"{SPINNER[int(4 * time.monotonic()) % 4]} {shown.doing}", "bold")
    side = [status] if rows < 14 or columns < 24 else [status, *_side(shown, limit, ascii_only)]
    for line in side:
        line.overflow = "crop" if ascii_only else "ellipsis"
    if len(side) == 1:
        return Group(status)
    wide = _map_columns(scene, columns, rows) if scene is not None else 0
    if scene is None or wide < SMALLEST_MAP:
        return Group(*side)
    grid = Table.grid(padding=(0, 2, 0, 0), expand=True)
    grid.add_column(width=wide + 2, no_wrap=True)
    grid.add_column(ratio=1, no_wrap=True, overflow="crop")
    picture = table_map(scene, shown.situation, shown.path, shown.tool, wide, ascii_only)
    grid.add_row(picture, Group(*side))
    return grid


def _map_columns(scene: Scene, columns: int, rows: int) -> int:
    """The widest map that leaves room beside it, and a few lines above it."""
    wide = min(LARGEST_MAP, columns - SIDE - 4)
    while wide >= SMALLEST_MAP and rows_for(scene, wide) + 2 > rows - 6:
        wide -= 1
    return wide


def _side(shown: Shown, limit: int, ascii_only: bool) -> list[Text]:
    return [
        *_clock(shown),
        _line(f"actions {shown.actions} of at most {limit}"),
        *_state(shown, ascii_only),
        *_last_action(shown),
        *_planned(shown),
        *_account(shown.spent, ascii_only),
    ]


def _clock(shown: Shown) -> Iterator[Text]:
    if shown.clock or not shown.told:  # a domain may have no durations
        clock = "time of the domain" if shown.told else "robot time"
        yield _line(f"{clock} {shown.clock:z.1f} s")


def _state(shown: Shown, ascii_only: bool) -> Iterator[Text]:
    """What is told of the symbolic world, or how many areas there are on the table."""
    if shown.told:
        yield from map(_line, shown.told.split("; "))
    if shown.most:
        now = 0 if shown.situation is None else len(shown.situation.areas)
        yield _line(f"dirty areas {now} {_bar(now / shown.most, ascii_only)} of {shown.most}")


def _last_action(shown: Shown) -> Iterator[Text]:
    if shown.happened:
        what, _, came = shown.happened.partition(": ")
        yield _line("what happened", "dim")
        yield from (_line(f"  {what}"), _line(f"  {came}"))


def _planned(shown: Shown) -> Iterator[Text]:
    if not shown.moves:
        return
    value = "" if shown.value is None else f", value {shown.value:z.2f}"
    yield _line(f"still planned{value}", "dim")
    yield from (_line(f"  {move}") for move in shown.moves[:NEXT])
    if len(shown.moves) > NEXT:
        yield _line(f"  and {len(shown.moves) - NEXT} more")


def _account(spent: Account, ascii_only: bool) -> Iterator[Text]:
    """Where the time went: what took so much of it that it is told."""
    if not spent.total:
        return
    yield _line(f"time {spent.total:z.1f} s", "dim")
    for kind, seconds in spent.by_kind().items():
        if seconds >= 0.05:
            bar = _bar(seconds / spent.total, ascii_only)
            yield _line(f"  {kind.replace('_', ' '):<17} {seconds:6.1f} {bar}")


def _bar(share: float, ascii_only: bool) -> str:
    full = round(BAR * min(1.0, max(0.0, share)))
    return ("#" * full + "." * (BAR - full)) if ascii_only else ("█" * full + "░" * (BAR - full))


def _line(text: str, style: str = "") -> Text:
    return Text(printable(text), style=style, no_wrap=True)
