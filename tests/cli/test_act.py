"""`cleancli act`, as a user runs it."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from scipy.stats import binomtest

from cleancli.cli.main import run
from cleancli.execution.trials import in_order
from cleancli.motion.path import ToolPath
from support.remote_scripted import WIDE, ScriptedDriver
from support.scripted_robot import Points
from support.shipped import shipped_scene
from support.toy_driver import served

SMALL = """scene small {
  camera { image = 320 x 240  focal = 262 }
  grasp own { flap = 3 cm }
  dirt { group { count = 6  at = (30 cm, 0 cm)  radius = 2 cm } }
}
"""


@pytest.fixture
def scene(tmp_path: Path) -> str:
    path = tmp_path / "small.nid"
    path.write_text(SMALL, encoding="utf-8")
    return str(path)


def test_outcomes_by_grasp_as_data_and_as_a_picture(
    scene: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "map.png"
    words = ["act", scene, "moveToContainerFast", "--repeat", "2", "--json", "--plot", str(picture)]
    assert run([*words, "--grasp", "folded", "--grasp", "own"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [grasp["grasp"] for grasp in found["grasps"]] == ["folded", "own"]
    assert [grasp["width"] for grasp in found["grasps"]] == [0.088, 0.12]
    for grasp in found["grasps"]:
        assert [trial["seed"] for trial in grasp["trials"]] == [1, 2]
        assert sum(outcome["trials"] for outcome in grasp["outcomes"].values()) == 2
        for outcome in grasp["outcomes"].values():
            expected = binomtest(outcome["trials"], 2).proportion_ci(0.95, method="wilson")
            assert outcome["share"] == outcome["trials"] / 2
            assert (outcome["low"], outcome["high"]) == pytest.approx((expected.low, expected.high), abs=1e-4)
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_outcomes_as_a_table(scene: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["act", scene, "groupScattered", "--repeat", "1", "--seed", "7"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "groupScattered, gantry, grasp wide of 12 cm"
    assert [line.split("  ")[0] for line in said[2:5]] == ["none left", "some left", "spread out"]


def test_why_a_motion_failed_is_told(scene: str, capsys: pytest.CaptureFixture[str]) -> None:
    far = Path(scene)
    far.write_text(SMALL.replace("(30 cm, 0 cm)", "(-30 cm, 0 cm)"), encoding="utf-8")
    words = ["act", scene, "moveToContainerFast", "--repeat", "2", "--robot", "reem"]
    assert run(words) == 0
    assert "cm too far" in capsys.readouterr().out
    assert run([*words, "--json"]) == 0
    (grasp,) = json.loads(capsys.readouterr().out)["grasps"]
    assert all("cm too far" in trial["failure"] for trial in grasp["trials"])


def test_several_jobs_keep_the_order() -> None:
    assert list(in_order(str, range(4), 2)) == list(in_order(str, range(4), 1)) == ["0", "1", "2", "3"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["moveToContainerFats"], "did you mean `moveToContainerFast`"),
        (["join2", "--areas", "a1"], "join2 takes 2 different areas"),
        (["join2", "--areas", "a1, a1"], "join2 takes 2 different areas"),
        (["join2", "--grasp", "foldet"], "did you mean `folded`"),
        (["join2", "--plot", "no/folder/map.png"], "there is no folder `no/folder`"),
        (["pickUp"], "`gantry` can't pickUp; it takes --robot reem"),
    ],
)
def test_what_cannot_be_tried_is_said_at_once(
    scene: str, words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["act", scene, *words]) == 2
    assert said in capsys.readouterr().err


@contextmanager
def elsewhere(folder: Path, dirt: Callable[[int], Points]) -> Iterator[tuple[str, ScriptedDriver]]:
    """The file of a scene whose robot is at the end of a socket, and sees dirt where it lies after so many
    strokes."""
    driver = ScriptedDriver(shipped_scene("two_groups"), dirt)
    with served(driver, WIDE) as server:
        file = folder / "lab.nid"
        file.write_text(f'scene lab {{ robot {{ drive = remote  address = "{server.address}" }} }}')
        yield str(file), driver


TWO: Points = ((-0.2, 0.1), (0.1, -0.15))


def test_a_remote_robot_tries_and_the_camera_judges(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first push cleans the first area, the second does nothing, and after the third nobody answers."""
    monkeypatch.setattr("sys.stdin", io.StringIO("y\n" * 3))
    after = {0: TWO, 1: TWO[1:], 2: TWO[1:], 3: (TWO[1], (0.1, 0.0))}
    with elsewhere(tmp_path, lambda strokes: after[strokes]) as (scene, driver):
        assert run(["act", scene, "moveToContainerFast", "--repeat", "5", "--json"]) == 0
    told = capsys.readouterr()
    (grasp,) = json.loads(told.out)["grasps"]
    trials = grasp["trials"]
    assert [trial["outcome"] for trial in trials] == ["none left", "some left", "spread out"]
    assert all(trial["on_floor"] is None for trial in trials), "nobody knows"
    assert trials[0]["targets"] > trials[0]["left"] == 0
    assert trials[1]["left"] == pytest.approx(trials[1]["targets"], rel=0.2)
    assert told.err.count("is the dirt laid out, and nobody in reach?") == 4
    assert driver.strokes == 3


@pytest.mark.parametrize(
    ("answers", "strokes"), [("n\n", 0), ("y\nn\n", 0), ("y\ny\nn\n", 0), ("y\n" * 4, 1)]
)
def test_each_motion_of_a_remote_robot_may_be_asked_for(
    answers: str,
    strokes: int,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(answers))
    with elsewhere(tmp_path, lambda strokes: TWO) as (scene, driver):
        code = run(["act", scene, "moveToContainerFast", "--repeat", "1", "--confirm"])
    assert code == (0 if answers in ("n\n", "y\n" * 4) else 130)
    assert driver.strokes == strokes
    assert ("moveToContainerFast(a1): from (" in capsys.readouterr().err) == (answers.count("y") > 1)


def test_what_was_tried_is_told_though_the_robot_trips(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("y\n" * 5))
    with elsewhere(tmp_path, lambda strokes: TWO) as (scene, driver):
        start = driver.start

        def fails_later(path: ToolPath) -> None:
            if driver.strokes:
                raise RuntimeError("no current")
            start(path)

        monkeypatch.setattr(driver, "start", fails_later)
        assert run(["act", scene, "moveToContainerFast"]) == 6
    told = capsys.readouterr()
    assert "some left         1   1.00" in told.out
    assert "has tripped: the driver failed: RuntimeError('no current')" in told.err


def test_a_rehearsal_draws_the_stroke_and_moves_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "stroke.png"
    with elsewhere(tmp_path, lambda strokes: TWO) as (scene, driver):
        assert run(["act", scene, "join2", "--dry-run", str(picture)]) == 0
        assert run(["act", scene, "join3", "--dry-run", str(picture)]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("it would carry out join2(a1, a2): from (")
    assert said[1] == f"join3 finds too few areas to act on; {picture} shows what is seen"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert (driver.strokes, driver.out) == (0, False)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["two_groups", "join2", "--confirm"], "--confirm is for a robot at the end of a socket"),
        (["two_groups", "join2", "--dry-run", "a.png"], "--dry-run is for a robot at the end of a socket"),
        (["LAB", "join2", "--jobs", "2"], "--jobs is for simulated tables"),
        (["LAB", "join2", "--grasp", "wide"], "--grasp is for simulated tables"),
        (["LAB", "pickUp"], "`remote` can't pickUp"),
    ],
)
def test_options_of_the_other_kind_of_robot_are_refused(
    words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lab = tmp_path / "lab.nid"
    lab.write_text('scene lab { robot { drive = remote  address = "127.0.0.1:1" } }')
    assert run(["act", *(str(lab) if word == "LAB" else word for word in words)]) == 2
    assert told in capsys.readouterr().err
