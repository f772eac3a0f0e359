"""Pages of the symbolic world, in which nothing is dirty and nothing lies anywhere (docs/report.md)."""

from __future__ import annotations

from pathlib import Path

import cleancli
from cleancli.cli.main import run


def test_they_have_no_job_and_nothing_that_is_truly_left(tmp_path: Path) -> None:
    done = cleancli.execute_series(
        "cleaning", "three_areas", episodes=2, samples=50, seed=1, runs=tmp_path / "runs", video=False
    )
    folders = [result.folder for result in done.runs]
    assert run(["report", *map(str, folders), "--html", str(tmp_path / "compared.html")]) == 0
    pages = [folders[0] / "report.html", folders[0].parent / "report.html", tmp_path / "compared.html"]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert "<td>strategy</td>" in text or page.name == "compared.html"
        assert "<td>job</td>" not in text
        assert "truly left" not in text
        assert "not clean" not in text
