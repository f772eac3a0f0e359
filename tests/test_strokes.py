"""Pictures of strokes: benchmarks/strokes.py, and what its table counts."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path
from typing import Any

import pytest

import cleancli

ROOT = Path(__file__).parent.parent


@pytest.fixture
def benchmark(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Imports a module of the benchmarks by its name."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module


def stroke(benchmark: Any, corners: Any, before: Any, after: Any, **others: Any) -> Any:
    """A stroke among these particles; how many came into the container follows from them."""
    known = {
        "move": "push(a1)",
        "corners": corners,
        "came": None,
        "areas": (),
        "aims": (),
        "before": before,
        "after": after,
        "transit": 1.0,
        "seconds": 2.0,
        "into": sum(place is None for place in after),
        "lost": 0,
    }
    return benchmark("stroke_record").Stroke(**known | others)


def episode(benchmark: Any, *strokes: Any) -> Any:
    """An episode of these strokes."""
    job = ("sweeping", "two_groups", "plan-2", 1)
    spent = {"transits": 1.0, "actions": 2.0}
    return benchmark("stroke_record").Episode(job, True, strokes, "clean", 0, 0, spent)


def test_what_a_stroke_did_to_each_particle(benchmark: Any) -> None:
    """A rag of 12 cm goes 40 cm to the east: it goes over what is up to 6 cm beside its way, and by what is
    up to 6 cm farther, or lies behind where it began."""
    before = ((0.0, 0.0), (0.1, 0.02), (0.1, -0.055), (0.1, 0.11), (0.1, 0.13), (-0.08, 0.0))
    after = (None, (0.1, 0.04), (0.1, -0.055), (0.1, 0.11), (0.1, 0.13), (-0.08, 0.0))
    pushed = stroke(benchmark, ((-0.02, 0.0), (0.38, 0.0)), before, after)
    assert pushed.gone.tolist() == [True, False, False, False, False, False]
    assert pushed.moved.tolist() == [False, True, False, False, False, False]
    over, beside = pushed.passed(0.12)
    assert over.tolist() == [False, False, True, False, False, False]
    assert beside.tolist() == [False, False, False, True, False, True]
    assert not pushed.in_vain


def test_strokes_in_vain_and_for_few_are_counted(benchmark: Any) -> None:
    way, aside = ((0.0, 0.0), (0.4, 0.0)), ((0.0, 0.03), (0.4, 0.03))
    places = ((0.1, 0.0), (0.1, 0.1))
    vain = stroke(benchmark, way, places, places)
    again = stroke(benchmark, ((0.0, 0.004), (0.4, 0.0)), places, places)
    moved_aside = stroke(benchmark, aside, places, (None, (0.1, 0.1)))
    last = stroke(benchmark, way, ((0.1, 0.1),), (None,), transit=0.5)
    found = benchmark("stroke_record").silliness(
        episode(benchmark, vain, again, moved_aside, last), width=0.12
    )
    assert (found.vain, found.vain_seconds) == (2, 6.0)
    assert (found.few, found.few_seconds) == (2, 5.5)
    assert found.repeated == 1, "the second went the same way within what a camera tells, the third aside"
    assert (found.over, found.beside) == (2, 3)


def test_a_command_draws_every_episode_and_runs_none_twice(
    benchmark: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib")
    folder, kept = tmp_path / "pictures", tmp_path / "kept.jsonl"
    words = ["strokes.py", "--quick", "--out", str(folder), "--keep", str(kept)]
    monkeypatch.setattr(sys, "argv", words)
    strokes = benchmark("strokes")
    assert strokes.main() == 0
    told = capsys.readouterr().out
    rows = [[cell.strip() for cell in row.split("|")[1:-1]] for row in told.splitlines()[2:]]
    assert [row[0] for row in rows] == ["two_groups 1 plan-2 sweeping", "two_groups 1 reactive cleaning"]
    drawn = sorted(path.name for path in folder.glob("*.png"))
    assert drawn == ["two_groups-1-plan-2-sweeping.png", "two_groups-1-reactive-cleaning.png"]
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert page.count("<tr>") == 1, "side by side"
    assert all(f'src="{name}"' in page for name in drawn)
    lines = kept.read_text(encoding="utf-8").splitlines()
    for kept_row, row in zip(map(json.loads, lines), rows, strict=True):
        into = sum(stroke["into"] for stroke in kept_row["strokes"])
        assert into + kept_row["left"] + kept_row["lost"] == len(kept_row["strokes"][0]["before"])
        assert int(row[2]) == len(kept_row["strokes"])
    assert strokes.main() == 0
    assert capsys.readouterr().out == told
    assert kept.read_text(encoding="utf-8").splitlines() == lines


def test_without_matplotlib_it_says_what_is_missing(
    benchmark: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    monkeypatch.setattr(sys, "argv", ["strokes.py", "--quick", "--out", str(tmp_path / "pictures")])
    assert benchmark("strokes").main() == 1
    assert "pip install 'matplotlib>=3.8'" in capsys.readouterr().err
    assert not (tmp_path / "pictures").exists()


def test_an_episode_of_strokes_is_the_one_that_execute_carries_out(
    benchmark: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Executing saves the table after each action, which then goes on built anew: so must whoever watches."""
    monkeypatch.chdir(tmp_path)
    recorded = benchmark("stroke_record").recorded(("cleaning", "two_groups", "wipe", 3), False)
    run = cleancli.execute("cleaning", "two_groups", strategy="wipe", seed=3, video=False)
    assert len(recorded.strokes) == run.actions
    assert (recorded.spent["transits"], recorded.spent["actions"]) == (
        run.seconds["transits"],
        run.seconds["actions"],
    )
