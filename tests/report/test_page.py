"""The page as text, and the command that writes it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from run_folders import RECORDS, SECONDS, write_run

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.report.page import run_page, ticks
from cleancli.report.pictures import data_uri
from cleancli.report.run import read_run


def test_what_files_say_is_escaped(tmp_path: Path) -> None:
    episode = {"reason": "<script>alert(1)</script>", "clean": False, "actions": 0, "seconds": {"total": 0.0}}
    page = run_page(read_run(write_run(tmp_path / "x<b>", episode=episode)))
    assert "<script" not in page
    assert "&lt;script&gt;alert(1)" in page
    assert "it can&#39;t reach &lt;there&gt; &amp; back" in page


def test_the_page_asks_for_nothing_outside_itself(run_folder: Path) -> None:
    page = run_page(read_run(run_folder))
    assert "http://" not in page
    assert "https://" not in page
    assert page.count('src="data:image/webp;base64,') == 4 == page.count("src=")


def test_pictures_that_are_missing_or_torn_are_left_out(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "run", pictures=2)
    whole = (folder / "step-001.png").read_bytes()
    (folder / "step-001.png").write_bytes(b"")
    (folder / "step-002.png").write_bytes(b"not a picture")
    page = run_page(read_run(folder))
    assert page.count("<img") == 1
    assert len(whole) > len(data_uri(folder / "step-000.png") or "")


@pytest.mark.parametrize("longest", [0.0, 1e-4, 0.9, 7.0, 36.45, 3600.0, 1e9])
def test_ticks_are_few_and_within(longest: float) -> None:
    found = ticks(longest)
    assert 1 <= len(found) <= 9
    assert found[0] == 0
    assert found[-1] <= longest


def test_one_run_is_written_into_its_folder(run_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["report", str(run_folder)]) == ExitCode.DONE
    assert (run_folder / "report.html").read_text(encoding="utf-8") == run_page(read_run(run_folder))
    out = capsys.readouterr().out
    assert "two_groups-seed1-001" in out
    assert "36.5" in out
    assert "report.html" in out


def test_several_runs_are_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one = write_run(tmp_path / "one", pictures=0)
    two = write_run(tmp_path / "two", RECORDS[:8], 0, episode=None, truth=None)
    assert run(["report", str(one), str(two), "--html", str(tmp_path / "both.html")]) == ExitCode.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:5] == ["run", "strategy", "seed", "ended", "actions"]
    assert lines[1].split()[:5] == ["one", "prada+", "1", "clean", "3"]
    assert "100 %" in lines[1]
    assert "cut short" in lines[2]
    assert "27 %" in lines[2]
    assert (tmp_path / "both.html").read_text(encoding="utf-8").count("<tr data-run") == 2
    assert not (one / "report.html").exists()


def test_json_is_the_figures_alone(run_folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["report", str(run_folder), "--json"]) == ExitCode.DONE
    (row,) = json.loads(capsys.readouterr().out)["runs"]
    assert row["seconds"] == SECONDS
    assert row["total"] == pytest.approx(sum(SECONDS.values()))
    assert not (run_folder / "report.html").exists()


def test_mistakes_are_told_and_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["report", str(tmp_path)]) == ExitCode.REFUSED
    assert "E705" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
    assert run(["report"]) == ExitCode.USAGE
    whole = write_run(tmp_path / "run", pictures=0)
    assert run(["report", str(whole), "--html", str(tmp_path / "no" / "where.html")]) == ExitCode.FILES
