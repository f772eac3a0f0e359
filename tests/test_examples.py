"""The examples do what their pages say."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path

import printing_robot
import pytest
from printing_driver import DESCRIPTION, PrintingDriver
from printing_robot import PrintingRobot

import cleancli
from cleancli.cli.main import run
from cleancli.geometry.rgbd import Camera
from cleancli.language.find import find
from cleancli.scene.model import Scene
from cleancli.world.camera import overhead
from cleancli.world.robot import Robot
from support.printed import agree
from support.scripted_robot import painted
from support.toy_driver import served

ROOT = Path(__file__).parent.parent
SPOTS = [(0.1 + 0.01 * column, 0.01 * row) for column in range(4) for row in range(4)]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def looks(*dirt: list[tuple[float, float]]) -> PrintingRobot:
    scene = cleancli.load_problem("two_groups", "sweeping").model
    assert isinstance(scene, Scene)
    camera: Camera = overhead(scene.camera)
    return PrintingRobot(
        [[painted(camera, scene.surface.width, scene.surface.depth, spots, None)] for spots in dirt]
    )


def test_a_robot_that_prints_does_what_the_page_shows(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs" / "your_own_robot.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```text\n(.*?)^```$", page, re.M | re.S)
    assert run(["perceive", "two_groups", "--save-frames", "look"]) == 0
    capsys.readouterr()
    printing_robot.main("two_groups", "look")
    printed = capsys.readouterr().out
    assert agree(shown, printed), printed


def test_a_run_ends_clean_where_the_camera_of_ones_own_robot_shows_no_dirt(folder: Path) -> None:
    robot: Robot = looks(SPOTS, [])
    run = cleancli.execute("sweeping", "two_groups", robot=robot)
    assert run.clean
    assert (run.actions, run.truth, run.video) == (1, {}, False)
    assert {path.name for path in run.folder.glob("step-*.png")} == {"step-000.png", "step-001.png"}
    assert (run.folder / "report.html").exists()
    assert run.seconds["transits"] > 0
    assert run.seconds["actions"] > 0


def test_a_run_of_ones_own_robot_is_begun_anew_where_it_was_cut_short(folder: Path) -> None:
    """What is to be gone on with is a table that nobody has saved."""
    told: list[str] = []

    def stop(event: object) -> None:
        told.append(type(event).__name__)
        if told.count("Acted") == 1:
            raise KeyboardInterrupt

    robot = looks(SPOTS, SPOTS)
    with pytest.raises(
        KeyboardInterrupt, match="with the tool up; a run with a robot of your own is begun anew"
    ):
        cleancli.execute("sweeping", "two_groups", robot=robot, on_event=stop)
    (cut_short,) = folder.glob("runs/*")
    with pytest.raises((cleancli.Refused, ValueError), match=r"E706|checkpoint"):
        cleancli.resume(cut_short)


def test_a_list_of_facts_has_no_place_for_a_robot() -> None:
    with pytest.raises(ValueError, match="`robot` is for scenes"):
        cleancli.execute("cleaning", "three_areas", robot=looks(SPOTS))


def test_a_driver_that_prints_is_the_robot_that_prints(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/protocol.md: behind the protocol it is told the same, and sees the same."""
    cleancli.execute("sweeping", "two_groups", robot=looks(SPOTS, []))
    alone = [line for line in capsys.readouterr().out.splitlines() if line.startswith(("at ", "  to "))]
    robot = looks(SPOTS, [])
    with served(PrintingDriver(robot.looks), DESCRIPTION) as server:
        text = find("two_groups", "problems").read_text(encoding="utf-8")
        remote = f'drive = remote  address = "{server.address}"'
        cleancli.execute("sweeping", text.replace("drive = gantry", remote))
    told = capsys.readouterr().out.splitlines()
    assert [line for line in told if line.startswith(("at ", "  to "))] == alone
    assert len(alone) > 5


def test_a_driver_that_prints_listens_until_it_is_ended(folder: Path) -> None:
    assert run(["perceive", "two_groups", "--save-frames", "look"]) == 0
    command = [sys.executable, str(ROOT / "examples" / "printing_driver.py"), "look", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        listens = re.match(r"listens at (\S+);", process.stdout.readline())
        assert listens is not None
        assert run(["robot", "check", listens[1], "--still"]) == 0
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=20) == 0
