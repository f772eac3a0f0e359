"""A study from Python, and from the command line: the same rows and the same words."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import pytest

import cleancli
from cleancli.cli.main import run
from cleancli.experiment.rows import PARQUET, read_rows
from cleancli.planning.plan import BadOption
from cleancli.study.row import comparable
from support.studies import SYMBOLIC, opened, rows_here

SMALL = SYMBOLIC.replace("runs      = 2", "runs = 1").replace("episodes  = 2", "episodes = 1")
"""Four episodes."""


def test_rows_are_those_of_one_episode_after_the_other(tmp_path: Path) -> None:
    result = cleancli.run_study(SMALL, output=tmp_path / "out")
    assert tuple(map(comparable, result.rows)) == rows_here(opened(SMALL))
    assert result.rows == read_rows(tmp_path / "out" / PARQUET)
    assert (result.carried_out, result.kept, result.given_up) == (4, 0, ())
    assert pickle.loads(pickle.dumps(result)) == result


def test_the_command_says_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("small.nid").write_text(SMALL, encoding="utf-8")
    assert run(["experiment", "small.nid", "--jobs", "1", "--output", "out"]) == 0
    printed = capsys.readouterr().out
    again = cleancli.run_study("small.nid", resume=True, output="out")
    assert printed == f"{again}\n".replace("0 episodes carried out", "4 episodes carried out")
    assert run(["experiment", "small.nid", "--jobs", "1", "--output", "out", "--resume", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == again.to_dict()


def test_runs_seed_quick_and_until_mean_what_they_mean_to_the_command(tmp_path: Path) -> None:
    seeded = cleancli.run_study(SMALL, runs=2, seed=7, output=tmp_path / "seeded")
    assert sorted({row.seed for row in seeded.rows}) == [7, 8]
    long = "study s { scene = three_areas strategy = plan_1, plan_2 samples = 50 measure = actions runs = 20}"
    assert len(cleancli.run_study(long, until=0.4, output=tmp_path / "until").rows) == 2 * 10
    quick = "study s { scene = three_areas samples = 50 runs = 3 quick { runs = 1 } }"
    assert len(cleancli.run_study(quick, quick=True, output=tmp_path / "quick").rows) == 1


def test_a_study_without_a_file_goes_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = cleancli.run_study(SMALL)
    assert result.folder == Path("experiments/symbolic")
    page = result.write_report("page")
    assert "## symbolic" in page.read_text(encoding="utf-8")


def test_what_makes_no_sense_is_refused_before_an_episode(tmp_path: Path) -> None:
    for wrong in ({"runs": 0}, {"seed": -1}, {"jobs": 0}, {"until": 10.0}, {"until": 0.0}):
        with pytest.raises(BadOption, match=f"`{next(iter(wrong))}`"):
            cleancli.run_study(SMALL, output=tmp_path / "wrong", **wrong)
    assert not (tmp_path / "wrong").exists()
    cleancli.run_study(SMALL, output=tmp_path / "held")
    with pytest.raises(ValueError, match="4 finished episodes"):
        cleancli.run_study(SMALL, output=tmp_path / "held")
    with pytest.raises(cleancli.Refused):
        cleancli.run_study("study s { scene = nowhere }", output=tmp_path / "wrong")
