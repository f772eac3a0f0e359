"""How many runs are enough, if a study is to know its means so well."""

from __future__ import annotations

from collections.abc import Sequence

from cleancli.experiment.schedule import Enough
from cleancli.results.cells import means_of_runs
from cleancli.statistics.stopping import enough
from cleancli.study.model import Study
from cleancli.study.row import Row


def known_to(share: float) -> Enough:
    """Whether of the study's measure the mean of each cell's runs is known to this share of it
    (`statistics.stopping`); of a series, a run is the mean of its episodes. What did not end clean is in no
    mean, so that a cell of which too little does goes on to the last run."""

    def decide(study: Study, blocks: Sequence[Sequence[Row]]) -> bool:
        cells: dict[tuple[object, ...], list[Row]] = {}
        for row in (row for block in blocks for row in block):
            cells.setdefault((row.part, *sorted(row.axes.items())), []).append(row)
        return all(enough(means_of_runs(rows, study.measure), share) for rows in cells.values())

    return decide
