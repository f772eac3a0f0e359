"""Pages of the symbolic world, in which nothing is dirty and nothing lies anywhere (docs/report.md)."""

from __future__ import annotations

import re
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


def test_they_are_in_words(tmp_path: Path) -> None:
    """docs/report.md: no table has a value as Python writes it, or an option that meant nothing."""
    done = cleancli.execute_series(
        "cleaning", "three_areas", episodes=2, samples=50, seed=1, runs=tmp_path / "runs", video=False
    )
    folder = done.runs[0].folder
    assert folder is not None
    assert run(["report", str(folder)]) == 0
    text = (folder / "report.html").read_text(encoding="utf-8")
    rows = dict(re.findall(r"<tr><td>([^<]*)</td><td>([^<]*)</td></tr>", text))
    assert rows["facts that hold"].isdigit()
    assert not {"None", "True", "False", "()"} & set(rows.values())
    assert not {"estimator", "m", "match", "forgetting"} & rows.keys()
    assert run(["report", str(folder.parent)]) == 0
    series = (folder.parent / "report.html").read_text(encoding="utf-8")
    rows = dict(re.findall(r"<tr><td>([^<]*)</td><td>([^<]*)</td></tr>", series))
    assert not {"None", "True", "False", "()"} & set(rows.values())
    heads = re.findall(r"<th[^>]*>([^<]*)</th>", series[series.index('id="figures"') :])
    assert len(heads) == len(set(heads))
    assert {"actions", "actions, s"} <= set(heads)
