"""Motions of a robot as a person is told of them, and asked about."""

from __future__ import annotations

import click

from cleancli.cli.questions import answer
from cleancli.motion.path import ToolPath


def way_of(path: ToolPath) -> str:
    """Where a path leads, in centimetres."""
    first, last, fastest = path.waypoints[0], path.waypoints[-1], max(w.speed for w in path.waypoints)
    ends = [f"({100 * w.x:z.1f}, {100 * w.y:z.1f})" for w in (first, last)]
    return f"from {ends[0]} cm to {ends[1]} cm at up to {fastest:g} m/s"


def ask_before(what: str, path: ToolPath | None) -> None:
    """Whether a motion may begin. A no ends the command as Ctrl-C does."""
    where = "" if path is None else f": {way_of(path)}"
    if not answer(lambda: click.confirm(f"{what}{where}; may it?", default=False, err=True)):
        raise KeyboardInterrupt
