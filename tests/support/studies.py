"""Small studies, opened."""

from __future__ import annotations

from cleancli.experiment.episode import Finished
from cleancli.experiment.schedule import here, rows, scheduled
from cleancli.experiment.series import OpenedStudy, open_studies
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.study.row import Row, comparable

SYMBOLIC = """
study symbolic {
  scene     = three_areas
  strategy  = plan_1, plan_2
  estimator = none, decreasing_m
  samples   = 200
  runs      = 2
  episodes  = 2
}
"""
"""Sixteen episodes in the symbolic world, half of which learn; each takes some hundredths of a second."""


def opened(text: str, quick: bool = False) -> tuple[OpenedStudy, ...]:
    """The studies of a text."""
    return open_studies(Source("study.nid", text), quick)


def rows_here(studies: tuple[OpenedStudy, ...], known: dict[str, Finished] | None = None) -> tuple[Row, ...]:
    """Their rows, carried out one after the other in this process, without real time."""
    known = {} if known is None else known
    for _ in scheduled(studies, known, here):
        pass
    return tuple(map(comparable, rows(studies, known)))
