"""What goes on in an episode, at a glance: the table, what is planned, what happened, where the time went.

`Shown` is all that is told, made anew by each event; `dashboard` lays it out for a terminal of any size.
"""

from __future__ import annotations

import time
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
from cleancli.language.diagnostics.plural import plural
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
            most = max(shown.most, len(situation.areas))
            words = "" if told is None else told(situation)
            return replace(shown, situation=situation, most=most, doing="thinking", path=None, told=words)
        case Decided(_, moves, plan):
            value = None if plan is None else plan.value
            whole = moves if plan is None else tuple(Move(a.name, a.objects) for a in plan.actions)
            doing = "moving the arm out of view" if told is None else "acting"
            return replace(shown, moves=whole, value=value, doing=doing)
        case Started(number, move, path):
            left = shown.moves[1:] if shown.moves[:1] == (move,) else shown.moves
            before = names_of(shown.situation)
            doing = f"{number}. {move}"
            return replace(shown, doing=doing, moves=left, path=path, actions=number, before=before)
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


def came_of(before: frozenset[str], event: Acted) -> str:
    """What became of an action, in a line: which areas are gone, and which are new since `before`; in the
    symbolic world, how many facts are others."""
    after = names_of(event.situation)
    gone, new = sorted(before - after, key=_number), sorted(after - before, key=_number)
    parts = [f"{_listed(gone)} gone"] * bool(gone) + [f"{_listed(new)} new"] * bool(new)
    if not before and not after and event.transition is not None:
        changed = len(event.transition.before ^ event.transition.after)
        return f"{event.number}. {event.move}: {plural(changed, 'fact') if changed else 'no fact'} changed"
    return f"{event.number}. {event.move}: {', '.join(parts) or 'no area came or went'}"


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
    situation = shown.situation
    now = 0 if situation is None else len(situation.areas)
    clock = "time of the domain" if shown.told else "robot time"
    lines = [_line(f"actions {shown.actions} of at most {limit}")]
    if shown.clock or not shown.told:  # a domain may have no durations
        lines.insert(0, _line(f"{clock} {shown.clock:.1f} s"))
    if shown.told:
        lines += [_line(part) for part in shown.told.split("; ")]
    if shown.most:
        lines.append(_line(f"dirty areas {now} {_bar(now / shown.most, ascii_only)} of {shown.most}"))
    if shown.happened:
        what, _, came = shown.happened.partition(": ")
        lines += [_line("what happened", "dim"), _line(f"  {what}"), _line(f"  {came}")]
    if shown.moves:
        value = "" if shown.value is None else f", value {shown.value:.2f}"
        lines.append(_line(f"still planned{value}", "dim"))
        lines += [_line(f"  {move}") for move in shown.moves[:NEXT]]
        if len(shown.moves) > NEXT:
            lines.append(_line(f"  and {len(shown.moves) - NEXT} more"))
    total = shown.spent.total
    if total:
        lines.append(_line(f"time {total:.1f} s", "dim"))
        for kind, seconds in shown.spent.by_kind().items():
            if seconds >= 0.05:
                name = kind.replace("_", " ")
                lines.append(_line(f"  {name:<17} {seconds:6.1f} {_bar(seconds / total, ascii_only)}"))
    return lines


def _bar(share: float, ascii_only: bool) -> str:
    full = round(BAR * min(1.0, max(0.0, share)))
    return ("#" * full + "." * (BAR - full)) if ascii_only else ("█" * full + "░" * (BAR - full))


def _line(text: str, style: str = "") -> Text:
    return Text(printable(text), style=style, no_wrap=True)
