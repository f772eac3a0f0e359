"""Functions and commands: the same data for the same seed, and the same text."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import cleancli
from cleancli.cli.main import run
from cleancli.execution.events import Ended, Event

ROOT = Path(__file__).parents[2]
TIMES = {"seconds", "planning", "planning_median", "planning_95", "loading", "robot_clock"}
"""What depends on the clock of this machine."""


def told(capsys: pytest.CaptureFixture[str], *words: object) -> Any:
    capsys.readouterr()
    assert run([*map(str, words), "--json"]) in (0, 3)
    return json.loads(capsys.readouterr().out)


def printed(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    capsys.readouterr()
    assert run([*map(str, words)]) in (0, 3)
    return capsys.readouterr().out


def untimed(data: Any) -> Any:
    if isinstance(data, dict):
        return {name: untimed(part) for name, part in data.items() if name not in TIMES}
    return [untimed(part) for part in data] if isinstance(data, list) else data


def same(result: Any, data: Any) -> None:
    assert untimed(result) == untimed(data)
    assert list(result) == list(data), "in the same order"


@pytest.mark.parametrize(("planner", "explain"), [("prada+", True), ("prada", False), ("uct", False)])
def test_plan(planner: str, explain: bool, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["plan", "cleaning", "three_areas", "--planner", planner, "--seed", 3, "--samples", 200]
    words += ["--explain"] if explain else []
    result = cleancli.plan("cleaning", "three_areas", planner=planner, seed=3, samples=200, explain=explain)
    same(result.to_dict(), told(capsys, *words))
    text = printed(capsys, *words)
    assert text.startswith(f"{result}\nseconds: ")


def test_plan_with_options_of_planners(capsys: pytest.CaptureFixture[str]) -> None:
    options = {"margin": 5.0, "rule_threshold": 0.1}
    result = cleancli.plan("cleaning", "three_areas", planner="prada", options=options, objective="time")
    words = ["plan", "cleaning", "three_areas", "--planner", "prada", "--objective", "time"]
    words += ["--option", "margin=5", "--option", "rule_threshold=0.1"]
    same(result.to_dict(), told(capsys, *words))
    assert result.plan == ()
    assert "was found that is worth over 5 more than doing nothing" in str(result)
    assert printed(capsys, *words).startswith(str(result))


def test_evaluate(capsys: pytest.CaptureFixture[str]) -> None:
    actions = ["moveToContainerFast(a1)"] * 5
    words = ["plan", "cleaning", "three_areas", "--evaluate", " ".join(actions), "--seed", 2]
    result = cleancli.evaluate("cleaning", "three_areas", actions, seed=2)
    same(result.to_dict(), told(capsys, *words))
    assert printed(capsys, *words).rstrip() == str(result)
    assert len(result.beyond_horizon) == 1


def test_simulate(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["simulate", "cleaning", "three_areas", "--episodes", 4, "--seed", 2, "--samples", 50]
    words += ["--planner", "prada", "--planner", "prada+", "--commit", 2, "--max-actions", 3]
    words += ["--option", "margin=0.2", "--option", "solve=0"]
    result = cleancli.simulate(
        "cleaning",
        "three_areas",
        planner=("prada", "prada+"),
        episodes=4,
        seed=2,
        samples=50,
        commit=2,
        max_actions=3,
        options={"margin": 0.2, "solve": 0},
    )
    same(result.to_dict(), told(capsys, *words))
    # The columns of the planning time differ from run to run.
    shown = [re.split(r"\s{2,}", line)[:7] for line in printed(capsys, *words).splitlines()]
    assert shown == [re.split(r"\s{2,}", line)[:7] for line in str(result).splitlines()]


@pytest.mark.parametrize("action", ["join2(a1, a2)", "moveToContainerFast(a1)"])
def test_explain(action: str, capsys: pytest.CaptureFixture[str]) -> None:
    result = cleancli.explain("cleaning", "three_areas", action)
    same(result.to_dict(), told(capsys, "explain", "cleaning", "three_areas", action))
    assert printed(capsys, "explain", "cleaning", "three_areas", action) == f"{result}\n"


def test_execute_and_learn(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    capsys.readouterr()
    result = cleancli.execute("cleaning", "three_areas", seed=5, samples=50)
    assert capsys.readouterr() == ("", ""), "nothing is printed"
    data = told(capsys, "execute", "cleaning", "three_areas", "--seed", 5, "--samples", 50)
    same(result.to_dict(), data)
    assert result.to_dict() == json.loads((result.folder / "run.json").read_text(encoding="utf-8"))
    assert (result.clean, result.actions) == (data["episode"]["clean"], data["episode"]["actions"])
    assert {path.name for path in result.folder.iterdir()} == {
        path.name for path in Path("runs/three_areas-seed5-002").iterdir()
    }
    learned = cleancli.learn("cleaning", result.folder, m=5)
    assert learned.to_dict() == told(capsys, "learn", "cleaning", result.folder, "--m", 5)
    assert printed(capsys, "learn", "cleaning", result.folder, "--m", 5) == f"{learned}\n"


def test_a_series(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also what it writes, and what it prints in the end."""
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "domains" / "cleaning.nid").read_text(encoding="utf-8")
    for name in ("one.nid", "other.nid"):
        Path(name).write_text(text, encoding="utf-8")
    asked: dict[str, Any] = {"episodes": 2, "seed": 5, "samples": 50, "learn": True, "m": 5, "write": True}
    capsys.readouterr()
    followed: list[Event] = []
    result = cleancli.execute_series("one.nid", "three_areas", runs="one", on_event=followed.append, **asked)
    assert capsys.readouterr() == ("", ""), "nothing is printed"
    assert sum(isinstance(event, Ended) for event in followed) == len(result.runs) == 2
    words = ["three_areas", "--episodes", 2, "--seed", 5, "--samples", 50, "--learn", "--m", 5, "--write"]
    same(
        unplaced(result.to_dict()), unplaced(told(capsys, "execute", "other.nid", *words, "--runs", "other"))
    )
    written = [Path(name).read_text(encoding="utf-8").replace(name, "") for name in ("one.nid", "other.nid")]
    hashes = re.compile(r"[0-9a-f]{16}|one|other")
    assert hashes.sub("", written[0]) == hashes.sub("", written[1]) != text
    assert result.learned is not None
    assert result.learned.text == Path("one.nid").read_text(encoding="utf-8")
    assert str(result).endswith(str(result.learned))
    again = cleancli.execute_series("one.nid", "three_areas", episodes=1, seed=5, samples=50)
    assert again.learned is None
    assert [known_of(each) for each in (again, result)] == [0, 12]


def known_of(result: Any) -> Any:
    """After how many examples a rule was known."""
    return result.runs[0].to_dict()["options"]["known"]


def unplaced(data: Any) -> Any:
    """Without the files that went in."""
    episodes = [{name: part for name, part in each.items() if name != "files"} for each in data["episodes"]]
    return {**data, "episodes": episodes}


def test_what_is_learned_is_written_as_the_command_writes_it(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run_folder = cleancli.execute("cleaning", "three_areas", seed=5, samples=50).folder
    text = (ROOT / "domains" / "cleaning.nid").read_text(encoding="utf-8")
    for name in ("one.nid", "other.nid", "third.nid"):
        Path(name).write_text(text, encoding="utf-8")
    printed(capsys, "learn", "one.nid", run_folder, "--write")
    learned = cleancli.learn("other.nid", run_folder)
    assert Path("other.nid").read_text(encoding="utf-8") == text, "nothing is written unasked"
    assert learned.write() == ("other.nid",)
    cleancli.learn(Path("third.nid"), run_folder, write=True)
    written = [Path(name).read_text(encoding="utf-8") for name in ("one.nid", "other.nid", "third.nid")]
    assert written == [learned.text] * 3 != [text] * 3
    with pytest.raises(cleancli.Refused, match="E006"):
        learned.write()  # the file has changed since


def test_perceive(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("pybullet")
    picture = tmp_path / "seen.png"
    result = cleancli.perceive("two_groups", seed=2)
    same(result.to_dict(), told(capsys, "perceive", "two_groups", "--seed", 2, "--drawn", picture))
    assert result.png == picture.read_bytes() == result._repr_png_()
    frames = tmp_path / "frames"
    assert printed(capsys, "perceive", "two_groups", "--seed", 2, "--save-frames", frames) == f"{result}\n"
    from_frames = cleancli.perceive(frames)
    assert printed(capsys, "perceive", frames) == f"{from_frames}\n"


def test_plan_for_what_is_seen(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pybullet")
    result = cleancli.plan("cleaning", "two_groups", seed=2, samples=100)
    same(result.to_dict(), told(capsys, "plan", "cleaning", "two_groups", "--seed", 2, "--samples", 100))
    assert "look" in result.seconds


def test_execute_on_a_table(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pybullet")
    monkeypatch.chdir(tmp_path)
    asked: dict[str, Any] = {"seed": 2, "samples": 50, "max_actions": 0, "video": False}
    result = cleancli.execute("cleaning", "two_groups", **asked)
    words = ["execute", "cleaning", "two_groups", "--seed", 2, "--samples", 50, "--max-actions", 0]
    same(result.to_dict(), told(capsys, *words, "--no-video"))
    assert result.truth == result.to_dict()["truth"]
    text = printed(capsys, *words, "--no-video")
    untold = re.compile(r"^(seconds|record): .*\n?", re.M)
    assert untold.sub("", text) == untold.sub("", f"{result}\n")
    record, same_record = (re.sub(r"-00\d/", "/", each).splitlines()[-1] for each in (text, str(result)))
    assert record == same_record
