"""How many runs are enough, if a study is to know its means so well."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cleancli.experiment.schedule import Enough
from cleancli.statistics.stopping import enough
from cleancli.study.model import Study
from cleancli.study.row import MEASURES, Row


def known_to(share: float) -> Enough:
    """Whether of the study's measure the mean of each cell's runs is known to this share of it
    (`statistics.stopping`); of a series, a run is the mean of its episodes."""

    def decide(study: Study, blocks: Sequence[Sequence[Row]]) -> bool:
        of = MEASURES[study.measure].of
        by_cell: dict[tuple[object, ...], dict[int, list[float]]] = {}
        for row in (row for block in blocks for row in block):
            runs = by_cell.setdefault((row.part, *sorted(row.axes.items())), {})
            runs.setdefault(row.run, []).append(of(row))
        return all(
            enough(np.array([np.mean(run) for run in runs.values()]), share) for runs in by_cell.values()
        )

    return decide
