"""A run as a Rerun recording: what is in it, read by Rerun's own reader, and that it grows with the run."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cleancli.cli.main import run
from cleancli.execution.episode_state import Account, EpisodeState, Move, Situation
from cleancli.execution.events import (
    Acted,
    Checkpoint,
    Decided,
    Ended,
    Event,
    Looked,
    Moved,
    Purpose,
    Started,
)
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.model import Fact, Object
from cleancli.motion.path import Interpolation, along
from cleancli.perception.area import Area
from cleancli.recording.rerun_run import EVERY, RunStream
from support import synthetic
from support.doors import DOORS

PROBLEM = "problem p { domain = doors objects { a b - door } init { force(a) = 1  force(b) = 1 } }"
PATH = along(((-0.1, 0.0, 0.0), (0.3, 0.1, 0.0)), 0.2, Interpolation.STRAIGHT)
AREA = Area(Ellipse((0.1, 0.05), (0.03, 0.02), 0.4), 1e-4, "a1")
SEEN = Situation((AREA,), (Object("a1", "area"),), frozenset({Fact("dirt", ("a1",))}))
MOVE = Move("moveToContainerFast", ("a1",), PATH)


def events() -> list[tuple[float, Event]]:
    """Each with the robot's clock: a look, a plan, a stroke of two seconds, and what came of it."""
    frame = synthetic.frame(np.zeros((0, 2)), 1)
    gone = Situation((), (), frozenset())
    moved = [(clock, Moved(clock)) for clock in np.arange(0, 2, EVERY / 4).tolist()]
    return [
        (0.0, Looked(SEEN, frame, 0.1, Purpose.FIRST)),
        (0.0, Checkpoint(EpisodeState(spent=Account(perceiving=0.1)))),
        (0.0, Decided(SEEN, (MOVE,), None, 0.2)),
        (0.0, Checkpoint(EpisodeState(spent=Account(perceiving=0.1, planning=0.2)))),
        (0.0, Started(1, MOVE, PATH)),
        *moved,
        (2.0, Looked(gone, frame, 0.1, Purpose.AFTER)),
        (2.0, Acted(1, MOVE, None, True, 0.5, 1.5, gone)),
        (2.0, Checkpoint(EpisodeState(spent=Account(0.2, 0.1, 0.0, 0.5, 1.5)))),
        (2.0, Ended("nothing is left to do", True, 1, Account(0.2, 0.1, 0.0, 0.5, 1.5), 2.0, 0.0)),
    ]


def written(path: Path, told: list[tuple[float, Event]], stop: int | None = None) -> RunStream:
    now = [0.0]
    tool = lambda: (0.1 * now[0], 0.0)  # noqa: E731
    stream = RunStream(path, "x", synthetic.scene(), lambda: now[0], tool)
    for clock, event in told[:stop]:
        now[0] = clock
        stream.write(event)
    return stream


@pytest.fixture
def reader() -> Any:
    return pytest.importorskip("rerun.chunk", reason="170 MB, and so no part of the test extra").RrdReader


def rows(reader: Any, path: Path, entity: str, column: str) -> list[Any]:
    """What is logged for an entity, in the order of the file."""
    found = []
    for chunk in reader(path).stream():
        if chunk.entity_path.strip("/") == entity:
            found += chunk.to_record_batch().column(column).to_pylist()
    return found


def test_table_camera_areas_plan_way_and_account_are_in_it(reader: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.rrd"
    with written(path, events()):
        pass
    assert list(tmp_path.iterdir()) == [path]
    (half,) = rows(reader, path, "table/surface", "Boxes3D:half_sizes")
    surface = synthetic.scene().surface
    assert np.allclose(half, [(surface.width / 2, surface.depth / 2, 0.01)])
    assert len(rows(reader, path, "camera/colour", "EncodedImage:blob")) == 2
    first, second = rows(reader, path, "table/areas", "LineStrips3D:strips")
    assert np.allclose(np.mean(first[0][:-1], axis=0)[:2], (0.1, 0.05), atol=1e-6)
    assert second == []
    assert rows(reader, path, "plan", "TextDocument:text") == [["1. moveToContainerFast(a1)"]]
    ((stroke,),) = rows(reader, path, "table/stroke", "LineStrips3D:strips")
    assert np.allclose(stroke, [(w.x, w.y, w.z) for w in PATH.waypoints])
    ways = rows(reader, path, "table/way", "LineStrips3D:strips")
    assert len(ways) == pytest.approx(2 / EVERY, abs=1)
    assert np.allclose(np.diff(np.array(ways[-1][0])[:, 0]), 0.1 * EVERY, atol=0.1 * EVERY / 4 + 1e-6)
    assert rows(reader, path, "account/planning", "Scalars:scalars") == [[0.0], [0.2], [0.2]]
    assert rows(reader, path, "account/actions", "Scalars:scalars") == [[0.0], [0.0], [1.5]]
    told = [text for (text,) in rows(reader, path, "events", "TextLog:text")]
    assert told[-2:] == ["1. moveToContainerFast(a1) is over", "clean: nothing is left to do"]


def test_all_but_what_stands_still_has_its_time_on_the_robots_clock(reader: Any, tmp_path: Path) -> None:
    with written(tmp_path / "run.rrd", events()):
        pass
    for chunk in reader(tmp_path / "run.rrd").stream():
        still = chunk.entity_path.strip("/") in ("table/surface", "table/container")
        assert still or "robot" in chunk.timeline_names


@pytest.mark.filterwarnings("ignore:RRD file has no footer")
def test_what_came_before_a_checkpoint_is_in_the_file_of_a_run_that_goes_on(
    reader: Any, tmp_path: Path
) -> None:
    path = tmp_path / "run.rrd"
    stream = written(path, events(), stop=4)
    kept = tmp_path / "kept.rrd"
    kept.write_bytes(path.read_bytes())  # as a kill would leave it
    assert rows(reader, kept, "account/planning", "Scalars:scalars") == [[0.0], [0.2]]
    assert rows(reader, kept, "plan", "TextDocument:text") == [["1. moveToContainerFast(a1)"]]
    stream.__exit__(None, None, None)


@pytest.fixture
def doors(tmp_path: Path) -> list[str]:
    (tmp_path / "doors.nid").write_text(DOORS, encoding="utf-8")
    (tmp_path / "p.nid").write_text(PROBLEM, encoding="utf-8")
    runs = ["--runs", str(tmp_path / "runs"), "--seed", "1", "--samples", "50", "--quiet"]
    return ["execute", str(tmp_path / "doors.nid"), str(tmp_path / "p.nid"), *runs]


def test_execute_writes_one(reader: Any, doors: list[str], tmp_path: Path) -> None:
    path = tmp_path / "run.rrd"
    assert run([*doors, "--rrd", str(path)]) == 0
    told = [text for (text,) in rows(reader, path, "events", "TextLog:text")]
    assert told[-1].startswith("clean: ")
    assert rows(reader, path, "account/actions", "Scalars:scalars")[-1][0] > 0


def test_one_run_is_written_and_a_folder_that_is_not_there_is_told(
    reader: Any, doors: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run([*doors, "--rrd", str(tmp_path / "x.rrd"), "--episodes", "2"]) == 2
    assert "--rrd writes one run" in capsys.readouterr().err
    assert run([*doors, "--rrd", str(tmp_path / "none" / "x.rrd")]) == 2
    assert "there is no folder" in capsys.readouterr().err
    assert not (tmp_path / "runs").exists()


def test_without_rerun_the_part_is_named_and_nothing_moves(
    doors: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    assert run([*doors, "--rrd", str(tmp_path / "x.rrd")]) == 4
    assert "pip install 'rerun-sdk>=0.24'" in capsys.readouterr().err
    assert not (tmp_path / "x.rrd").exists()
    assert not (tmp_path / "runs").exists()
