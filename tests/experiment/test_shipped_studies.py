"""The shipped studies are carried out, made small: each combination that they list has its row."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.cli.main import run
from cleancli.experiment.rows import PARQUET, read_rows
from cleancli.experiment.series import open_studies
from cleancli.language.load import read_source
from cleancli.resources import shipped, shipped_names
from cleancli.study.row import MEASURES

SINGLE = tuple(name for name in shipped_names("studies") if name != "all")


def test_all_is_all_of_them() -> None:
    studies = open_studies(read_source(shipped("studies") / "all.nid"))
    assert {each.study.name for each in studies} == set(SINGLE)


def test_each_claim_of_the_paper_is_tested_by_a_comparison() -> None:
    studies = [
        each.study
        for name in SINGLE
        for each in open_studies(read_source(shipped("studies") / f"{name}.nid"))
    ]
    claims = {comparison.claim for study in studies for comparison in study.comparisons}
    assert claims - {None} == set(range(1, 10))
    assert all(comparison.says for study in studies for comparison in study.comparisons)
    assert all(study.about for study in studies)


@pytest.mark.needs_pybullet
def test_quick_ones_have_a_row_for_each_cell_run_and_episode(tmp_path: Path) -> None:
    assert run(["experiment", "all", "--quick", "--jobs", "1", "--output", str(tmp_path)]) == 0
    rows = read_rows(tmp_path / PARQUET)
    for study in open_studies(read_source(shipped("studies") / "all.nid"), quick=True):
        own = [row for row in rows if row.study == study.study.name]
        assert len(own) == len(study.cells) * study.study.runs * study.study.episodes
        assert {row.axes["simulator"] for row in own} <= {"stand-in", "symbolic", "physics"}
        for row in own:
            assert row.real >= 0
            assert all(measure.of(row) >= 0 for measure in MEASURES.values())
    piles = [row for row in rows if row.study == "piles"]
    assert [(row.pieces, row.axes["simulator"], row.actions) for row in piles] == [(50, "physics", 2)]
    assert all(row.score == (row.pieces - row.left - row.on_floor) / row.pieces for row in piles)
