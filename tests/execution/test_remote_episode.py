"""Episodes whose robot is at the end of a socket: the same as in process, and stopped when something is
wrong."""

from __future__ import annotations

import io
import signal
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import cv2
import pytest

import cleancli
from cleancli.cli.main import run
from cleancli.execution.events import Event, Moved, Started
from cleancli.execution.loop import clean
from cleancli.execution.seeds import Stream, derived
from cleancli.execution.session import Session, remote_session, robot_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path
from cleancli.remote.client import Client
from cleancli.remote.robot import RemoteRobot
from cleancli.remote.server import Server
from cleancli.remote.simulated import SimulatedDriver, description
from cleancli.world.errors import RobotError
from cleancli.world.robot import Robot, Status, polled
from cleancli.world.table import PybulletTable
from support.remote_scripted import WIDE, ScriptedDriver
from support.scripted_robot import STROKE, Scripted
from support.shipped import shipped_domain, shipped_scene
from support.toy_driver import TOY, Toy, served

OPTIONS = EpisodeOptions(strategy="reactive", max_actions=1, seed=4)


def told(event: Event) -> dict[str, Any]:
    """An event without the real time that it took, and without pictures, which are compared by what is
    seen."""
    kept = {field.name: getattr(event, field.name) for field in fields(event)}
    real = {"frame", "loading", "spent", "state"}
    if type(event).__name__ in ("Looked", "Decided"):
        real.add("seconds")
    return {"event": type(event).__name__} | {name: kept[name] for name in kept.keys() - real}


def traced(session: Session) -> list[Any]:
    """All events, and where the tool was at each moment of a motion."""
    found: list[Any] = []
    for event in clean(session.setup, session.cell):
        found.append(told(event))
        if isinstance(event, Moved):
            found.append(session.cell._robot.tool)  # type: ignore[attr-defined]
    return found


@pytest.mark.parametrize("name", ["two_groups", "wam_groups"])
def test_in_lockstep_an_episode_is_the_same_as_in_process(name: str) -> None:
    domain, scene = shipped_domain("cleaning"), shipped_scene(name)
    seed = derived(OPTIONS.seed, Stream.WORLD)
    with closing(PybulletTable(scene, seed)) as table:
        alone = traced(robot_session(domain, scene, table, OPTIONS))
    with closing(PybulletTable(scene, seed)) as table:
        driver = SimulatedDriver(table, real_time=False)
        with served(driver, description(scene, lease=30.0)) as server:
            remote = replace(scene, robot="remote", address=server.address, remote_arms=scene.arms)
            with closing(remote_session(domain, remote, OPTIONS)) as session:
                far = traced(session)
    assert len(alone) > 200
    assert far == alone


def test_in_lockstep_a_dustpan_takes_up_the_same_as_in_process() -> None:
    scene = shipped_scene("reem_pick_up")
    path = tool_path("pickUp", (Ellipse((-0.01, 0.06), (0.02, 0.02), 0.0),), scene)
    assert path.dustpan is not None

    def taken_up(robot: Robot) -> list[tuple[float, ...]]:
        robot.start(path)
        return [(robot.clock, *robot.tool) for _ in polled(robot)]

    with closing(PybulletTable(scene, 1)) as table:
        alone, truth = taken_up(table), table.truth()
    with closing(PybulletTable(scene, 1)) as table:
        driver = SimulatedDriver(table, real_time=False)
        with (
            served(driver, description(scene, lease=30.0)) as server,
            RemoteRobot(server.address) as robot,
        ):
            assert taken_up(robot) == alone
            assert robot.poll() is Status.DONE
        assert table.truth().in_container == truth.in_container > 0


def test_a_robot_that_lacks_the_second_arm_of_its_scene_is_told() -> None:
    domain, scene = shipped_domain("cleaning"), shipped_scene("two_groups")
    with served(Toy()) as server:
        remote = replace(scene, robot="remote", address=server.address, remote_arms=2)
        with pytest.raises(RobotError, match="has no skill `dustpan`, and its scene says `arms = 2`"):
            remote_session(domain, remote, OPTIONS)
        with Client(server.address):
            pass  # it has let go of the control


@pytest.fixture
def driver() -> ScriptedDriver:
    return ScriptedDriver(
        shipped_scene("two_groups"), lambda done: ((-0.2, 0.1), (0.1, -0.15)) if done < 2 else ()
    )


@contextmanager
def scene_of(driver: Any, folder: Path) -> Iterator[tuple[Path, Server]]:
    """The file of a scene whose robot this is."""
    with served(driver, WIDE) as server:
        file = folder / "lab.nid"
        file.write_text(f'scene lab {{ robot {{ drive = remote  address = "{server.address}" }} }}')
        yield file, server


def test_a_table_is_cleaned_by_a_robot_elsewhere(driver: ScriptedDriver, tmp_path: Path) -> None:
    with scene_of(driver, tmp_path) as (scene, _):
        done = cleancli.execute("cleaning", scene, strategy="reactive", runs=tmp_path / "runs")
    assert done.clean
    assert done.actions == driver.strokes == 2
    assert not done.truth, "nobody knows it"
    assert not done.video
    assert done.seconds["actions"] + done.seconds["transits"] == pytest.approx(2 * STROKE)


def test_a_run_whose_robot_trips_goes_on_once_it_is_re_armed(
    driver: ScriptedDriver, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with scene_of(driver, tmp_path) as (scene, server):
        runs = tmp_path / "runs"
        words = ["execute", "cleaning", str(scene), "--strategy", "reactive", "--runs", str(runs)]

        def trips(path: object) -> None:
            Scripted.start(driver, path)  # type: ignore[arg-type]
            if driver.strokes == 2:
                raise RuntimeError("a door was opened")

        driver.start = trips  # type: ignore[method-assign]
        assert run([*words, "--quiet"]) == 6
        told = capsys.readouterr().err
        assert "a door was opened" in told
        assert f"cleancli robot rearm {server.address}" in told
        (folder,) = runs.iterdir()
        assert f"--resume {folder}" in told
        assert run(["execute", "--resume", str(folder), "--quiet"]) == 6, "still tripped"
        assert run(["robot", "rearm", str(server.address)]) == 0
        driver.strokes = 1
        del driver.start
        assert run(["execute", "--resume", str(folder), "--quiet"]) == 0
    assert driver.stops >= 1


def test_without_a_driver_nothing_begins(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "lab.nid"
    scene.write_text('scene lab { robot { drive = remote  address = "127.0.0.1:1" } }')
    assert run(["execute", "cleaning", str(scene), "--runs", str(tmp_path / "runs")]) == 6
    assert "no driver answers at 127.0.0.1:1" in capsys.readouterr().err
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize("error", [RuntimeError("a mistake"), AssertionError("one more"), MemoryError()])
def test_whatever_ends_the_loop_stops_the_robot(
    driver: ScriptedDriver, tmp_path: Path, error: Exception
) -> None:
    def fails(event: Event) -> None:
        if isinstance(event, Started):
            raise error

    with scene_of(driver, tmp_path) as (scene, _), pytest.raises(type(error)):
        cleancli.execute("cleaning", scene, strategy="reactive", runs=tmp_path / "runs", on_event=fails)
    assert driver.stops >= 1


def test_a_client_that_hangs_in_a_motion_trips_the_robot(driver: ScriptedDriver, tmp_path: Path) -> None:
    def polls() -> Status:
        driver.clock += 0.01
        return Status.RUNNING

    def hangs(event: Event) -> None:
        if isinstance(event, Moved):
            time.sleep(TOY.lease + 0.1)

    driver.poll = polls  # type: ignore[method-assign]
    with scene_of(driver, tmp_path) as (scene, _), pytest.raises(OSError, match="nobody has asked for 0"):
        cleancli.execute("cleaning", scene, strategy="reactive", runs=tmp_path / "runs", on_event=hangs)
    assert driver.stops >= 1


def test_commands_that_look_use_the_drivers_camera(
    driver: ScriptedDriver, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with scene_of(driver, tmp_path) as (scene, _):
        assert run(["perceive", str(scene)]) == 0
        assert "lab: 2 areas" in capsys.readouterr().out
        assert run(["plan", "cleaning", str(scene), "--samples", "100"]) == 0
        driver.strokes = 2
        assert run(["calibrate", str(scene), "--out", str(tmp_path / "lab.json"), "--count", "3"]) == 0
        assert "the surface is clean in 3 frames" in capsys.readouterr().out
    assert driver.strokes == 2, "nothing was cleaned"


@pytest.mark.parametrize("words", [["scene", "SCENE"]])
def test_what_asks_for_the_truth_is_for_simulated_tables(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "lab.nid"
    scene.write_text('scene lab { robot { drive = remote  address = "127.0.0.1:7420" } }')
    assert run([str(scene) if word == "SCENE" else word for word in words]) == 2
    assert "--robot names a robot to simulate" in capsys.readouterr().err


def test_studies_are_of_simulated_robots(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("lab.nid").write_text('scene lab { robot { drive = remote  address = "127.0.0.1:7420" } }')
    Path("s.nid").write_text("study s { scene = lab  runs = 1 }")
    assert run(["experiment", "s.nid"]) == 1
    assert "the robot of this one is elsewhere" in capsys.readouterr().err


def test_a_dry_run_draws_the_first_stroke_and_moves_nothing(
    driver: ScriptedDriver, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    begun: list[str] = []
    driver.start = lambda path: begun.append("start")  # type: ignore[method-assign]
    driver.withdraw = lambda: begun.append("withdraw")  # type: ignore[method-assign]
    picture = tmp_path / "stroke.png"
    with scene_of(driver, tmp_path) as (scene, _):
        words = ["execute", "cleaning", str(scene), "--strategy", "reactive", "--dry-run", str(picture)]
        assert run([*words, "--runs", str(tmp_path / "runs")]) == 0
        told = capsys.readouterr().out
        assert told.startswith("it would begin with moveToContainerFast(a1): from (-2")
        assert not begun
        assert not (tmp_path / "runs").exists()
        bare = cv2.cvtColor(Scripted.observe(driver).colour, cv2.COLOR_RGB2BGR)
        drawn = cv2.imread(str(picture))
        assert drawn is not None
        assert (drawn[-len(bare) :] != bare).any(axis=2).sum() > 500, "ellipses, names and a way"
        driver.strokes = 2
        assert run(words) == 0
    assert "nothing seems worth doing" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("answers", "strokes", "code"), [("", 0, 130), ("n\n", 0, 130), ("y\ny\nn\n", 1, 130), ("y\n" * 9, 2, 0)]
)
def test_a_person_is_asked_before_each_motion(
    driver: ScriptedDriver,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    answers: str,
    strokes: int,
    code: int,
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(answers))
    with scene_of(driver, tmp_path) as (scene, _):
        words = ["execute", "cleaning", str(scene), "--strategy", "reactive", "--confirm"]
        assert run([*words, "--runs", str(tmp_path / "runs")]) == code
    asked = capsys.readouterr().err
    assert driver.strokes == strokes
    assert "the arm leaves the camera's view; may it? [y/N]" in asked
    assert ("1. moveToContainerFast(a1): from (" in asked) == (answers[:2] == "y\n")
    assert ("go on with: cleancli execute --resume" in asked) == (code == 130)


class Interrupted(io.StringIO):
    """Input in whose first line somebody presses Ctrl-C; what would come after it is a no."""

    went_on = False

    def readline(self, size: int | None = -1, /) -> str:  # type: ignore[override]
        signal.raise_signal(signal.SIGINT)
        self.went_on = True
        return "n\n"


def test_ctrl_c_is_heard_before_the_line_ends(
    driver: ScriptedDriver,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("sys.stdin", answers := Interrupted())
    with scene_of(driver, tmp_path) as (scene, _):
        words = ["execute", "cleaning", str(scene), "--strategy", "reactive", "--confirm"]
        assert run([*words, "--runs", str(tmp_path / "runs")]) == 130
    assert not answers.went_on
    assert "stopped with the tool up" in capsys.readouterr().err
