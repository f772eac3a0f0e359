"""`cleancli simulate` as a user meets it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from support.commands import said

ROOT = Path(__file__).parent.parent.parent
CLEANING = (ROOT / "domains" / "cleaning.nid").read_text(encoding="utf-8")
QUICK = ("simulate", "cleaning", "three_areas", "--samples", "200", "--max-actions", "20")


@pytest.fixture
def changed(tmp_path: Path) -> Path:
    """A domain like the shipped one, with other chances."""
    text = CLEANING.replace("domain cleaning", "domain harder").replace(
        "0.80: not", "0.20: nothing 0.60: not"
    )
    path = tmp_path / "harder.nid"
    path.write_text(text, encoding="utf-8")
    return path


def without_clock(data: dict[str, list[dict[str, object]]]) -> object:
    """What is found but for what the clock says."""
    for planner in data["planners"]:
        for key in ("planning_median", "planning_95"):
            del planner[key]
        rows = planner["rows"]
        assert isinstance(rows, list)
        for row in rows:
            del row["planning"]
    return data["planners"]


def test_the_table_has_a_row_and_says_why_episodes_ended(capsys: pytest.CaptureFixture[str]) -> None:
    lines = said(capsys, *QUICK, "--episodes", "5").splitlines()
    assert lines[0].split()[:3] == ["planner", "return", "plain"]
    assert lines[1].startswith("prada+ ")
    assert "means of 5 episodes" in lines[2]
    assert lines[3] == "prada+ ended: nothing is left of the count 5"


def test_any_number_of_processes_finds_the_same(capsys: pytest.CaptureFixture[str], changed: Path) -> None:
    words = (*QUICK, "--episodes", "12", "--seed", "4", "--commit", "2", "--world", str(changed), "--json")
    alone = json.loads(said(capsys, *words))
    shared = json.loads(said(capsys, *words, "--jobs", "2"))
    assert (alone["domain"], alone["world"], alone["limits"]["commit"]) == ("cleaning", "harder", 2)
    assert [row["number"] for row in alone["planners"][0]["rows"]] == list(range(12))
    assert without_clock(alone) == without_clock(shared)
    row = alone["planners"][0]["rows"][0]
    assert row["seconds"] > 7 * len(row["actions"])


def test_time_may_discount(capsys: pytest.CaptureFixture[str]) -> None:
    words = (*QUICK, "--episodes", "3", "--json")
    steps, time = (
        json.loads(said(capsys, *words, "--objective", each))["planners"][0] for each in ("reward", "time")
    )
    assert 0 < abs(steps["discounted"]["mean"] - time["discounted"]["mean"]) < 0.5


def test_options_by_name_reach_each_planner_that_has_them(capsys: pytest.CaptureFixture[str]) -> None:
    both = ("--planner", "prada", "--planner", "uct", "--option", "margin=1.5", "--option", "exploration=2")
    found = json.loads(said(capsys, *QUICK, "--episodes", "2", *both, "--json"))
    reasons = [planner["reasons"] for planner in found["planners"]]
    assert reasons[0] == {"the planner finds nothing worth doing": 2}
    assert reasons[1] != reasons[0]
    assert {"margin": 1.5, "exploration": 2}.items() <= found["options"].items()


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("rule_treshold=0.1", "did you mean `rule_threshold`?"),
        ("margin=-1", "`margin` is at least 0"),
        ("margin", "`margin` wants a number, not ``"),
        ("depth=3", "`depth` is an option of sst, not of prada+"),
        ("time-limit=3", "--time-limit"),
    ],
)
def test_options_by_name_are_checked(capsys: pytest.CaptureFixture[str], option: str, message: str) -> None:
    assert message in said(capsys, *QUICK, "--option", option, code=2)


def test_thinking_takes_robot_time(capsys: pytest.CaptureFixture[str]) -> None:
    words = (*QUICK, "--episodes", "2", "--objective", "time", "--think")
    assert "robot time goes on while planners think" in said(capsys, *words)
    found = json.loads(said(capsys, *words, "--json"))
    assert found["limits"]["think"]
    declared = re.findall(r"(\w+)\(.*\[duration = ([\d.]+) s\]", CLEANING)
    durations = {name: float(seconds) for name, seconds in declared}
    for row in found["planners"][0]["rows"]:
        acted = sum(durations[action.split("(")[0]] for action in row["actions"])
        assert row["seconds"] == pytest.approx(acted + sum(row["planning"]))


DOORS = """
domain doors {
  types      { thing; door - thing; key - thing }
  constants  { master - key }
  predicates { open(?d - door)  linked(?d ?e - door) [symmetric, static]  has(?k - key) }
  functions  { force(?d - door): 1..3  kind(?d - door): wood < iron }
  derived    { shut := count ?d - door: not open(?d)  ajar(?d - door) := open(?d), force(?d) = 1 }
  actions    { push(?d - door) [duration = 4 s] }
  rule push_it: push(?d) {
    when not open(?d)
    then 0.6: open(?d)
         0.4: nothing
  }
  reward { decrease(shut) }
}
"""
DOOR = """
problem one_door {
  domain  = doors
  objects { a - door }
  init    { force(a) = 1, kind(a) = iron }
  goal    { exists ?d - door: ajar(?d) }
  horizon = 1 + shut
}
"""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("push(?d", "shove(?d", ["doors.nid:8:16: error[E901]: the world has no action `push`"]),
        ("wood < iron", "iron < wood", ["world.nid:6:40: error[E901]", "`kind(door): wood < iron`"]),
        ("1..3", "1..4", ["`force` of the world is not", "planner's is `force(door): 1..3`"]),
        ("master - key", "master - thing", ["planner's is `master - key`"]),
        ("key - thing", "key", ["planner's is `key - thing`"]),
        (
            "linked(?d ?e - door) [symmetric, static]",
            "linked(?d ?e - door)",
            ["`linked(door, door) [symmetric]`"],
        ),
        ("has(?k", "wet(?d - door) has(?k", ["only the world has the symbol `wet`"]),
        ("shut", "closed", ["doors.nid:7:16: error[E901]: the problem speaks of `shut`"]),
        ("ajar", "nearly", ["doors.nid:7:55: error[E901]: the problem speaks of `ajar`"]),
        ("[symmetric, static]", "[symmetric]", []),
        ("push(?d - door) ", "oil(?d - door) push(?d - door) ", []),
        ("0.6: open(?d)\n         0.4", "0.1: open(?d)\n         0.9", []),
        ("?d", "?x", []),
    ],
)
def test_another_world_must_mean_the_same(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    old: str,
    new: str,
    message: list[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "doors.nid").write_text(DOORS, encoding="utf-8")
    (tmp_path / "world.nid").write_text(DOORS.replace(old, new), encoding="utf-8")
    (tmp_path / "door.nid").write_text(DOOR, encoding="utf-8")
    words = ("simulate", "doors.nid", "door.nid", "--episodes", "2", "--world", "world.nid")
    found = said(capsys, *words, code=1 if message else 0)
    assert all(part in found for part in message), found


@pytest.mark.parametrize(
    ("wanted", "reason"),
    [(("--objective", "time"), "time is to discount"), (("--think",), "thinking takes robot time")],
)
def test_time_needs_durations_where_they_are_missing(
    capsys: pytest.CaptureFixture[str], changed: Path, wanted: tuple[str, ...], reason: str
) -> None:
    changed.write_text(changed.read_text(encoding="utf-8").replace("[duration = 9 s]", ""), encoding="utf-8")
    words = (*QUICK, "--episodes", "1", *wanted, "--world", str(changed))
    error = said(capsys, *words, code=1)
    assert f"harder.nid:20:5: error[E902]: {reason}, but `moveToContainerFast` has no duration" in error
    assert "cleaning.nid" not in error


def test_an_unknown_planner_of_the_problem(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = (ROOT / "problems" / "three_areas.nid").read_text(encoding="utf-8").rstrip().removesuffix("}")
    problem = tmp_path / "p.nid"
    problem.write_text(text + "planner { name = prado } }", encoding="utf-8")
    assert "planner `prado`" in said(capsys, "simulate", "cleaning", str(problem), code=2)
