"""Runs side by side, as one page of HTML: means of those that differ in their seeds alone, and each run."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from cleancli.recording.folder import PAGE
from cleancli.report.account import colour_of, name_of, row_of
from cleancli.report.groups import Group, groups_of, kinds_of
from cleancli.report.page import bars, templates
from cleancli.report.run import Run
from cleancli.report.timeline import in_order
from cleancli.statistics.bootstrap import Estimate


@dataclass(frozen=True, slots=True)
class MeanBar:
    """A group's mean; `share` and `interval` are parts of the axis, 0..1. None where it has no interval."""

    name: str
    mean: Estimate
    share: float
    interval: tuple[float, float] | None


@dataclass(frozen=True, slots=True)
class MeansView:
    """The means of groups for one kind of time: its name, the number of its colour, and a bar each."""

    name: str
    colour: int
    bars: tuple[MeanBar, ...]


def comparison_page(runs: Sequence[Run], beside: Path) -> str:
    """A page that sets runs side by side, with links to theirs from the folder `beside` which it will be in;
    all bars of runs have one scale."""
    rows = [row_of(run) for run in runs]
    longest = max((row.total for row in rows), default=0.0)
    kinds = in_order({kind: 0.0 for row in rows for kind in row.seconds})
    groups = groups_of(runs)
    return (
        templates()
        .get_template("compare.html")
        .render(
            rows=[
                (row, bars(row.seconds, longest), _link(run, beside))
                for run, row in zip(runs, rows, strict=True)
            ],
            kinds=[(kind, name_of(kind), colour_of(kind)) for kind in kinds],
            first=rows[0],
            groups=groups if len(groups) < len(runs) else (),
            means=list(_means(groups)),
        )
    )


def _link(run: Run, beside: Path) -> str | None:
    """Where the run's own page is, from another folder; None where it has none."""
    page = run.folder / PAGE
    return quote(os.path.relpath(page, beside)) if page.is_file() else None


def _means(groups: Sequence[Group]) -> Iterator[MeansView]:
    """The means of all seconds, and of each kind, one figure each with a scale of its own."""
    yield _means_of("in all", colour_of(""), [(group, group.total) for group in groups])
    for kind in kinds_of(groups):
        told = [(group, group.seconds[kind]) for group in groups if kind in group.seconds]
        yield _means_of(name_of(kind), colour_of(kind), told)


def _means_of(name: str, colour: int, told: Sequence[tuple[Group, Estimate]]) -> MeansView:
    ends = [mean.high if mean.known else mean.value for _, mean in told if mean.count]
    axis = max(ends, default=0.0) or 1.0
    return MeansView(
        name,
        colour,
        tuple(
            MeanBar(
                f"{group.problem}, {group.name}",
                mean,
                mean.value / axis if mean.count else 0.0,
                (mean.low / axis, mean.high / axis) if mean.known else None,
            )
            for group, mean in told
        ),
    )
