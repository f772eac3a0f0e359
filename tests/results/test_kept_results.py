"""docs/measurements/results.md is what the rows that are kept make."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run

ROOT = Path(__file__).parents[2]
PAGES = ROOT / "docs" / "measurements"
KEPT = ROOT / "benchmarks" / "results" / "studies"


@pytest.mark.skipif(not KEPT.is_dir(), reason="no rows of studies are kept yet")
def test_the_page_in_the_docs_is_that_of_the_rows_that_are_kept(tmp_path: Path) -> None:
    """`cleancli experiment --report benchmarks/results/studies --output docs/measurements`; figures depend on
    the version of matplotlib too, and so are only there."""
    assert run(["experiment", "--report", str(KEPT), "--output", str(tmp_path)]) == ExitCode.DONE
    assert (tmp_path / "results.md").read_bytes() == (PAGES / "results.md").read_bytes()
    names = {path.name for path in (tmp_path / "results").iterdir()}
    assert names == {path.name for path in (PAGES / "results").iterdir()}
