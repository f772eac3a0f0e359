"""`cleancli experiment --report`: a page and figures from rows alone."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.experiment.rows import read_rows, write_rows
from support.study_rows import drawn

STUDY = """study made_up {
  about    = "How strategies compare"
  scene    = two_groups, scattered_40
  strategy = plan_2, reactive
  compare planning {
    claim  = 2  says = "planning is quicker"
    scene  = scattered_40
    first  { strategy = plan_2 }
    second { strategy = reactive }
  }
}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    axes = {"scene": ("two_groups", "scattered_40"), "strategy": ("plan-2", "reactive")}
    rows = list(drawn(axes, {"plan-2": 50.0, "reactive": 90.0}, 6))
    (tmp_path / "made").mkdir()
    (tmp_path / "made" / "made_up.nid").write_text(STUDY, encoding="utf-8")
    write_rows(tmp_path / "made", rows)
    return tmp_path / "made"


def written(folder: Path) -> dict[str, bytes]:
    names = ("results.md", "results/made_up.svg", "results/made_up.png", "results/made_up_times.svg")
    return {name: (folder / name).read_bytes() for name in names}


def test_the_page_is_written_beside_the_rows_or_where_it_is_wanted(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["experiment", "--report", str(folder)]) == ExitCode.DONE
    assert capsys.readouterr().out == f"page: {folder / 'results.md'}\n"
    assert "| 2 | In difficult layouts" in written(folder)["results.md"].decode()
    other = tmp_path / "docs"
    words = ["experiment", "--report", str(folder / "rows.parquet"), "--output", str(other), "--json"]
    assert run(words) == ExitCode.DONE
    assert json.loads(capsys.readouterr().out) == {"page": str(other / "results.md")}
    assert written(folder) == written(other)


def test_studies_of_one_file_are_told_apart(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each has parts of its own."""
    (folder / "other.nid").write_text(
        "study other { strategy = plan_2  part p { scene = two_groups } }", encoding="utf-8"
    )
    axes = {"scene": ("two_groups",), "strategy": ("plan-2",)}
    others = [replace(row, study="other") for row in drawn(axes, {}, 6, part="p")]
    write_rows(folder, [*read_rows(folder / "rows.parquet"), *others])
    assert run(["experiment", "--report", str(folder)]) == ExitCode.DONE
    page = (folder / "results.md").read_text(encoding="utf-8")
    assert re.findall(r"^##+ .*", page, re.M) == [
        "## The paper's claims",
        "## made_up",
        "### Comparisons of made_up",
        "## other",
        "### other, p",
    ]


def test_of_a_study_without_a_text_beside_the_rows_the_shipped_one_is_taken(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "made_up.nid").unlink()
    assert run(["experiment", "--report", str(folder)]) == ExitCode.REFUSED
    assert "made_up" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"study": "../made_up"}, "`../made_up` is no name of a study"),
        ({"part": "../../etc"}, "has no part `../../etc`"),
        ({"study": "other"}, "has the name `made_up`"),
    ],
)
def test_rows_may_be_anybodys(
    changes: dict[str, str], message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """No name in them leads out of the folder."""
    (folder / "other.nid").write_text(STUDY, encoding="utf-8")
    rows = drawn({"scene": ("two_groups",), "strategy": ("plan-2",)}, {}, 2)
    write_rows(folder, [replace(row, **changes) for row in rows])  # type: ignore[arg-type]
    assert run(["experiment", "--report", str(folder)]) == ExitCode.REFUSED
    assert message in capsys.readouterr().err
    assert not (folder / "results.md").exists()


def test_odd_names_break_neither_tables_nor_figures(folder: Path) -> None:
    odd = {"scene": ("a|b$x^{", "\x1b[31m"), "strategy": ("plan-2", "reactive")}
    write_rows(folder, list(drawn(odd, {}, 2)))
    assert run(["experiment", "--report", str(folder)]) == ExitCode.DONE
    page = (folder / "results.md").read_text(encoding="utf-8")
    assert "\x1b" not in page
    assert "| a/b$x^{ | plan-2 |" in page


def test_mistakes_are_told(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        run(["experiment", "--report", str(folder), "--report", str(folder / "rows.parquet")])
        == ExitCode.REFUSED
    )
    assert "so does a file before it" in capsys.readouterr().err
    assert run(["experiment", "made_up", "--report", str(folder)]) == ExitCode.USAGE
    assert run(["experiment"]) == ExitCode.USAGE
    assert run(["experiment", "--report", str(tmp_path / "nowhere")]) == ExitCode.USAGE
    assert run(["experiment", "--report", str(tmp_path)]) == ExitCode.FILES
    (tmp_path / "no.parquet").write_bytes(b"PAR1 but not so")
    assert run(["experiment", "--report", str(tmp_path / "no.parquet")]) == ExitCode.REFUSED
    assert "holds no rows of a study" in capsys.readouterr().err
