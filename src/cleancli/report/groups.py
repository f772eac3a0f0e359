"""Runs that differ in nothing but their seeds: their means, with intervals, and how these compare."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cleancli.report.account import RunRow, row_of
from cleancli.report.run import Run
from cleancli.report.timeline import in_order
from cleancli.statistics.bootstrap import Estimate, mean_of, ratio_of
from cleancli.statistics.paired import by_run, counted


@dataclass(frozen=True, slots=True)
class Group:
    """Runs of one problem, by one strategy with the same options.

    `name`: the strategy, and all in which it differs from other groups of the problem. Means are of runs that
    ended clean; `failed` did not, and `unended` were cut short. `ratio`: of the mean of all seconds to that
    of the problem's first group, over seeds that both have; no number for the first.
    """

    problem: str
    name: str
    runs: int
    failed: int
    unended: int
    actions: Estimate
    total: Estimate
    seconds: Mapping[str, Estimate]
    ratio: Estimate


def groups_of(runs: Sequence[Run]) -> tuple[Group, ...]:
    """The groups, in the order of their first runs; a run that is named twice counts once."""
    runs = tuple({run.folder.resolve(): run for run in runs}.values())
    found: dict[tuple[str, frozenset[tuple[str, str]]], list[Run]] = {}
    for run in runs:
        found.setdefault((run.problem, frozenset(_settings(run).items())), []).append(run)
    first: dict[str, list[RunRow]] = {}
    groups = []
    for (problem, _), own in found.items():
        rows = [row_of(run) for run in own]
        others = [run for run in runs if run.problem == problem]
        groups.append(_group(_name(own[0], others), rows, first.setdefault(problem, rows)))
    return tuple(groups)


def kinds_of(groups: Sequence[Group]) -> tuple[str, ...]:
    """The kinds of time that some group spent any on."""
    return tuple(
        in_order({kind: 0.0 for group in groups for kind, mean in group.seconds.items() if mean.value})
    )


def _settings(run: Run) -> dict[str, str]:
    """What runs of one group have in common, in words."""
    header = run.header
    files = {"domain": header.files[:1], "world": header.world[:1]}
    named = {key: Path(file.path).stem for key, files in files.items() for file in files}
    told = {key: str(value) for key, value in header.options.items() if value is not None}
    return {**named, **told, "strategy": run.strategy}


def _name(run: Run, others: Sequence[Run]) -> str:
    """The strategy, and each other setting that some of the others have otherwise."""
    own = _settings(run)
    settings = [_settings(other) for other in others]
    keys = dict.fromkeys(key for each in (own, *settings) for key in each if key != "strategy")
    apart = [key for key in keys if len({each.get(key) for each in settings}) > 1 and key in own]
    return ", ".join([own["strategy"], *(f"{key.replace('_', ' ')} {own[key]}" for key in apart)])


def _group(name: str, rows: Sequence[RunRow], first: Sequence[RunRow]) -> Group:
    clean = [row for row in rows if row.clean]
    kinds = in_order({kind: 0.0 for row in clean for kind in row.seconds})
    return Group(
        problem=rows[0].problem,
        name=name,
        runs=len(rows),
        failed=sum(row.clean is False for row in rows),
        unended=sum(row.clean is None for row in rows),
        actions=_mean([row.actions for row in clean]),
        total=_mean([row.total for row in clean]),
        seconds={kind: _mean([row.seconds.get(kind, 0.0) for row in clean]) for kind in kinds},
        ratio=mean_of(np.array([])) if rows is first else _ratio(rows, first),
    )


def _mean(values: Sequence[float]) -> Estimate:
    return mean_of(np.array(values, dtype=np.float64))


def _ratio(rows: Sequence[RunRow], first: Sequence[RunRow]) -> Estimate:
    """Over seeds that both have; a run that did not end clean counts as in comparisons of studies."""
    ended = [[row for row in side if row.clean is not None] for side in (rows, first)]
    shared = {row.seed for row in ended[0]} & {row.seed for row in ended[1]}
    own, others = ([row for row in side if row.seed in shared] for side in ended)
    both = [*own, *others]
    seeds = np.array([row.seed for row in both], dtype=np.int64)
    clean = np.array([bool(row.clean) for row in both], dtype=np.bool_)
    seconds = counted(np.array([row.total for row in both], dtype=np.float64), clean)
    cut = len(own)
    return ratio_of(by_run(seeds[:cut], seconds[:cut]), by_run(seeds[cut:], seconds[cut:]))
