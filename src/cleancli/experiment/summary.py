"""What a study came to, in short: a line a cell."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import mean

from cleancli.api.tables import TextTable
from cleancli.execution.loop import seconds_reached
from cleancli.study.model import Study
from cleancli.study.row import MEASURES, Row, all_refused, endings, words_for


def cells_table(study: Study, rows: Sequence[Row]) -> TextTable:
    """Of each cell its part, the values that differ between cells, episodes, how many of them ended clean (of
    problems: finished), and the mean of the study's measure over those, or over all where it tells something
    of each; "refused" where a planner refused all."""
    by_cell: dict[tuple[str, ...], list[Row]] = {}
    axes = [axis for axis in dict.fromkeys(a for row in rows for a in row.axes) if _differs(axis, rows)]
    has_parts = any(row.part for row in rows)
    for row in rows:
        named = (row.part,) if has_parts else ()
        by_cell.setdefault((*named, *(_told(row, axis) for axis in axes)), []).append(row)
    measure, lines = MEASURES[study.measure], []
    for cell, own in by_cell.items():
        counts = [measure.of(row) for row in own if row.clean or measure.always]
        clean = str(sum(row.clean for row in own))
        shown = "refused" if all_refused(own) else f"{mean(counts):z.4g}" if counts else ""
        lines.append((*cell, str(len(own)), clean, shown))
    done = words_for(rows).done
    shown = f"share {done}" if study.measure == "clean" else study.measure
    heads = (*(("part",) if has_parts else ()), *axes, "episodes", done, shown)
    return TextTable(heads, tuple(lines), range(len(heads) - 3))


def ending(study: Study, rows: Sequence[Row]) -> Iterator[str]:
    """Why episodes did not end clean, and what raises the limit of seconds where it ended some; nothing where
    all ended clean."""
    reasons = endings(rows)
    if reasons:
        reached = seconds_reached(study.limits.max_seconds)
        raised = any(row.reason == reached for row in rows)
        yield f"{words_for(rows).other}: {reasons}" + (
            "; `max_seconds` of the study raises the limit" if raised else ""
        )


def _differs(axis: str, rows: Sequence[Row]) -> bool:
    return len({row.axes.get(axis) for row in rows}) > 1


def _told(row: Row, axis: str) -> str:
    value = row.axes.get(axis, "")
    return f"{value:g}" if isinstance(value, float) else str(value)
