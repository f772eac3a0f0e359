"""`cleancli plan` as a user meets it, beyond the plan itself."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest

from cleancli.cli.main import run
from cleancli.cli.views.plan_picture import FACTORED
from cleancli.planning.registry import PLANNERS
from support import commands

DOORS = """
domain doors {
  types      { door }
  predicates { open(?d - door)  locked(?d - door) }
  derived    { shut := count ?d - door: not open(?d) }
  actions    { push(?d - door)  knock(?d - door) [duration = 8 s, cost = 0.25] }
  rule pushed: push(?d)  { when not open(?d), not locked(?d) then 0.6: open(?d) 0.4: nothing }
  rule hinge:  push(?d)  { when not open(?d), locked(?d) then 0.1: open(?d) rest: noise }
  default { 1: nothing }
  reward  { decrease(shut) - cost }
}
"""
PROBLEM = """
problem two {
  domain  = doors
  objects { d1 d2 - door }
  init    { locked(d2) %s }
  goal    { open(d1) }
  horizon = %s
}
"""


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "doors.nid").write_text(DOORS, encoding="utf-8")
    (tmp_path / "two.nid").write_text(PROBLEM % ("", 3), encoding="utf-8")
    return tmp_path


def said(capsys: pytest.CaptureFixture[str], *words: str, problem: str = "two.nid", code: int = 0) -> str:
    return commands.said(capsys, "plan", "doors.nid", problem, *words, code=code)


def data(capsys: pytest.CaptureFixture[str], *words: str, problem: str = "two.nid") -> dict[str, Any]:
    found: dict[str, Any] = commands.data(capsys, "plan", "doors.nid", problem, *words)
    return found


def test_a_given_sequence_is_valued_in_three_ways(capsys: pytest.CaptureFixture[str]) -> None:
    found = data(capsys, "--evaluate", " push(d1),push( d1 ) knock(d2);", "--samples", "1")
    assert found["plan"] == ["push(d1)", "push(d1)", "knock(d2)"]
    worth = 0.6 + 0.95 * 0.4 * 0.6 - 0.95**2 * 0.25  # knocking changes nothing, and costs
    assert found["exact"] == pytest.approx(worth)
    assert found["factored"] == pytest.approx(worth)
    assert abs(found["sampled"]["value"] - worth) < 5 * found["sampled"]["error"]
    text = said(capsys, "--evaluate", "push(d1) push(d1) knock(d2)", "--explain").splitlines()
    assert text[0].split("  ")[0] == "step"
    rows = [line.split() for line in text]
    assert ["exact", f"{worth:.4f}"] in [row[:2] for row in rows]
    sampled = found["sampled"]
    shown = ["sampled", f"{sampled['value']:.4f}", "±", f"{sampled['error']:.4f}"]
    assert shown in [row[:4] for row in rows]


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ("push(d1) pusch(d2)", "ACTIONS:1:10: error[E206]: unknown action `pusch`"),
        ("push(d1)\npush(d3)", "ACTIONS:2:6: error[E205]: unknown object `d3`"),
        ("push(d1) knock", "ACTIONS:1:10: error[E208]: `knock` takes 1 object, not 0"),
        ("push(d1) ?", "ACTIONS:1:10: error[E104]"),
    ],
)
def test_mistakes_in_a_sequence_are_located(
    capsys: pytest.CaptureFixture[str], actions: str, message: str
) -> None:
    text = said(capsys, "--evaluate", actions, code=1)
    assert text.startswith(message)
    assert ("did you mean" in text) == ("usch" in actions) or "d3" in actions


def test_steps_say_by_which_rule_they_do_what(capsys: pytest.CaptureFixture[str]) -> None:
    found = data(capsys, "--evaluate", "push(d1) push(d1) push(d2)", "--explain")["explained"]
    assert (found["measure"], found["runs"], found["remaining"]) == ("exact", None, 2.0)
    first, second, third = found["steps"]
    assert first["rules"] == [{"rule": "pushed", "probability": 1.0}]
    assert first["outcomes"][0] == {"probability": 0.6, "kind": "change", "effects": ["open(d1)"]}
    assert second["covered"] == pytest.approx(0.4)
    assert (second["reward"], second["remaining"]) == pytest.approx((0.24, 1.16))
    assert [rule["rule"] for rule in third["rules"]] == ["hinge"]
    text = said(capsys, "--evaluate", "push(d1) push(d1) push(d2)", "--explain")
    rows = [line.split() for line in text.splitlines()]
    assert ["2.", "push(d1)", "0.400", "pushed", "0.240", "1.160", "0.240", "open(d1)"] in rows
    assert ["0.600", "no", "rule", "covers", "it"] in rows
    assert ["3.", "push(d2)", "1.000", "hinge", "0.100", "1.060", "0.900", "noise"] in rows


def test_planners_side_by_side(capsys: pytest.CaptureFixture[str]) -> None:
    found = data(capsys, "--compare", "prada, exact", "--option", "states=2", "--samples", "50")["planners"]
    assert [row["planner"] for row in found] == ["prada", "exact"]
    assert found[0]["true"]["error"] == 0.0
    assert "the limit is 2" in found[1]["refused"]
    table = said(capsys, "--compare", "prada,exact", "--samples", "50").splitlines()
    assert [line.split()[0] for line in table[:3]] == ["planner", "prada", "exact"]
    assert "push(d1)" in table[1]
    wrong = said(capsys, "--compare", "prada,parda", code=2)
    assert "`parda`" in wrong
    assert all(name in wrong for name in PLANNERS)


def test_a_planner_that_refuses_does_so_at_the_problem(capsys: pytest.CaptureFixture[str]) -> None:
    text = said(capsys, "--planner", "exact", "--option", "states=2", code=1)
    assert text.startswith("two.nid:2:9: error[E903]: this cannot be planned: ")
    assert "--option states" in text


def test_time_discounts_only_with_durations(capsys: pytest.CaptureFixture[str]) -> None:
    text = said(capsys, "--objective", "time", code=1)
    assert text.startswith("doors.nid:6:16: error[E902]: time is to discount, but `push` has no duration")
    Path("doors.nid").write_text(
        DOORS.replace("push(?d - door)  knock", "push(?d - door) [duration = 4 s] knock")
    )
    found = data(capsys, "--evaluate", "push(d1) push(d2)", "--objective", "time")
    assert found["exact"] == pytest.approx(0.6 + 0.95 * 0.1)
    knocked = data(capsys, "--evaluate", "knock(d1) push(d1)", "--objective", "time")
    mean = 4  # seconds, of pushing alone: knocking has no effect anywhere
    worth = -0.25 * 0.95 ** (8 / mean - 1) + 0.95 ** (8 / mean) * 0.95 ** (4 / mean - 1) * 0.6
    assert knocked["exact"] == pytest.approx(worth)


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("rule_treshold=0.1", "did you mean `rule_threshold`?"),
        ("rule_threshold=1.5", "`rule_threshold` lies between 0 and 1"),
        ("rule_threshold=nan", "`rule_threshold` lies between 0 and 1"),
        ("margin=-1", "`margin` is at least 0"),
        ("margin=", "`margin` wants a number, not ``"),
        ("runs=2.5", "`runs` wants a whole number, not `2.5`"),
        ("arithmetic=rational", "`arithmetic` is an option of exact, not of prada+"),
        ("depth=3", "`depth` is an option of sst, not of prada+"),
        ("time-limit=3", "--time-limit"),
        ("previous=x", "unknown option `previous`"),
    ],
)
def test_options_of_planners_are_checked(
    capsys: pytest.CaptureFixture[str], option: str, message: str
) -> None:
    assert message in said(capsys, "--option", option, code=2)


def test_options_reach_the_planner(capsys: pytest.CaptureFixture[str]) -> None:
    assert data(capsys)["plan"]
    prada = ("--planner", "prada")
    found = data(capsys, *prada, "--option", "margin=0.1", "--option", "margin=1.5")
    assert found["empty_because"] == "margin"
    told = said(capsys, *prada, "--option", "margin=1.5")
    assert "was found that is worth over 1.5 more than doing nothing" in told
    limited = data(capsys, *prada, "--time-limit", "0.5", "--threads", "1", "--samples", "100")
    assert limited["samples"] == 100


@pytest.mark.parametrize(
    ("facts", "horizon", "why", "words"),
    [
        (", open(d1), open(d2)", "3", "goal", "the goal holds already"),
        (", open(d1), open(d2)", "shut", "horizon", "the horizon is 0"),
        (
            ", open(d1)",
            "3",
            "margin",
            "no plan within 3 actions was found that is worth over 0.5 more than doing nothing",
        ),
    ],
)
def test_an_empty_plan_says_why(
    capsys: pytest.CaptureFixture[str], facts: str, horizon: str, why: str, words: str
) -> None:
    Path("other.nid").write_text(
        PROBLEM.replace("goal    { open(d1) }", "goal { open(d1) }" if why == "goal" else "")
        % (facts, horizon)
    )
    found = data(capsys, "--planner", "prada", "--option", "margin=0.5", problem="other.nid")
    assert (found["plan"], found["empty_because"]) == ([], why)
    assert found["goal_reached"] == (why == "goal")
    assert words in said(
        capsys, "--planner", "prada", "--option", "margin=0.5", "--explain", problem="other.nid"
    )


FERRY = """
domain ferry {
  types      { parcel }
  predicates { across()  aboard(?p - parcel)  delivered(?p - parcel) }
  derived    { waiting := count ?p - parcel: not delivered(?p) }
  actions    { load(?p - parcel)  cross()  unload(?p - parcel) }
  rule load:   load(?p)   { when not aboard(?p), not delivered(?p), not across() then 1: aboard(?p) }
  rule cross:  cross()    { when not across() then 1: across() }
  rule unload: unload(?p) { when across(), aboard(?p) then 1: not aboard(?p), delivered(?p) }
  reward { decrease(waiting) }
}
"""
"""A parcel takes three actions, and the usual horizon is two."""


def test_an_empty_plan_says_within_how_many_actions_and_that_a_longer_horizon_may_help(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("ferry.nid").write_text(FERRY)

    def ferried(horizon: str) -> str:
        Path("p.nid").write_text(f"problem p {{ domain = ferry objects {{ p1 - parcel }} {horizon} }}")
        return commands.said(capsys, "plan", "ferry.nid", "p.nid")

    usual, stated = ferried(""), ferried("horizon = 2")
    assert "no plan within 2 actions was found that is worth more than doing nothing" in usual
    assert "no plan within 2 actions was found that is worth more than doing nothing" in stated
    assert "the problem states no horizon" not in stated
    advised = re.search(r"the problem states no horizon, .* for example `(horizon = \d+)`", usual)
    assert advised
    assert [line.split()[1] for line in ferried(advised[1]).splitlines()[:3]] == [
        "load(p1)",
        "cross()",
        "unload(p1)",
    ]


def test_a_state_that_no_rule_covers_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    text = PROBLEM.replace("goal    { open(d1) }", "") % (", open(d1), open(d2)", 3)
    Path("other.nid").write_text(text)
    assert data(capsys, problem="other.nid")["empty_because"] == "no rule"
    assert "no rule of any action covers this state; `cleancli explain`" in said(capsys, problem="other.nid")


def test_a_goal_that_holds_is_said_before_what_pays_all_the_same(capsys: pytest.CaptureFixture[str]) -> None:
    Path("other.nid").write_text(PROBLEM % (", open(d1)", 3))
    lines = said(capsys, problem="other.nid").splitlines()
    assert lines[:2] == ["the goal holds already; this is worth doing all the same:", "  1. push(d2)"]


def test_what_does_not_go_together(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (
        ("--compare", "prada", "--explain"),
        ("--compare", "prada", "--plot", "x.png"),
        ("--evaluate", "push(d1)", "--planner", "prada"),
        ("--compat", "libprada", "--explain"),
    ):
        assert "do not go together" in said(capsys, *words, code=2)


def test_plans_as_libprada_does(capsys: pytest.CaptureFixture[str]) -> None:
    ours, theirs = data(capsys, "--planner", "prada"), data(capsys, "--compat", "libprada")
    assert ours["plan"] == ["push(d1)", "push(d1)", "push(d2)"]
    assert ours["value"] == pytest.approx(0.6 + 0.95 * 0.4 * 0.6 + 0.95**2 * 0.1)
    again = 0.4 - (
        0.6 * 0.4 + 0.4 * 0.4 * 0.4
    )  # whether it is shut and the rule applies is independent there
    assert theirs["plan"] == ["push(d1)", "push(d2)", "push(d1)"]
    assert theirs["value"] == pytest.approx(0.6 + 0.95 * 0.1 + 0.95**2 * again)
    assert "not with exact" in said(capsys, "--compat", "libprada", "--planner", "exact", code=2)


def test_the_problem_may_ask_for_any_planner(capsys: pytest.CaptureFixture[str]) -> None:
    text = (PROBLEM % ("", 3)).replace("horizon", 'planner { name = "all-outcomes" } horizon')
    Path("other.nid").write_text(text)
    assert data(capsys, problem="other.nid")["planner"] == "all-outcomes"


def test_without_matplotlib_only_the_picture_is_missing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    assert "pip install 'matplotlib>=3.8'" in said(capsys, "--plot", "belief.png", code=4)
    assert not Path("belief.png").exists()


def test_the_picture_names_steps_and_what_they_change(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    monkeypatch.setitem(matplotlib.rcParams, "svg.fonttype", "none")  # text stays text
    said(capsys, "--evaluate", "push(d1) push(d1)", "--plot", "belief.svg")
    picture = Path("belief.svg").read_text(encoding="utf-8")
    assert all(f">{text}</text>" in picture for text in ("open(d1)", "2. push(d1)", "0.84", "1.16"))
    assert ">open(d2)</text>" not in picture
    for told in ("exact belief", FACTORED, "the darker, the likelier;"):
        assert picture.count(f">{told}</text>") == 1
    assert picture.count("stroke-dasharray") >= 2, "in the picture and in the legend"
    said(capsys, "--evaluate", "", "--plot", "nothing.png")
    assert Path("nothing.png").read_bytes().startswith(b"\x89PNG")
    assert ".png or .svg" in said(capsys, "--plot", "belief.pdf", code=2)


def test_too_much_to_plan_for_is_partly_ignored_and_said(capsys: pytest.CaptureFixture[str]) -> None:
    few = ("--option", "counted=1", "--planner", "exact")
    found = data(capsys, *few)
    assert found["ignored"] == ["d2"]  # the goal names d1
    assert set(found["plan"]) == {"push(d1)"}
    assert "planned without d2: more than 1 are too many" in said(capsys, *few)
    assert "planned without" not in said(capsys)
    assert data(capsys, "--option", "counted=1", "--evaluate", "push(d2)")["plan"] == ["push(d2)"]


def test_areas_beyond_the_cap_of_a_scene_are_named(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pybullet")
    places = "at = (20 cm, 0 cm)", "at = (-20 cm, -20 cm)"
    dirt = " ".join(f"group {{ count = 6 of = lentils {place} radius = 1 cm }}" for place in places)
    Path("two_groups.nid").write_text(f"scene two_groups {{ dirt {{ {dirt} }} symbols {{ most = 1 }} }}")
    words = ["plan", "cleaning", "two_groups.nid", "--samples", "10", "--threads", "1"]
    assert run([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    names = found["left_out"]
    assert names
    assert found["ignored"] == []
    assert found["plan"]
    assert not any(name in action for name in names for action in found["plan"])
    assert run(words) == 0
    assert f"planned without {', '.join(names)}: beyond `most` of the scene's" in capsys.readouterr().out
    assert data(capsys)["left_out"] == []


def test_values_as_libprada_computes_them(capsys: pytest.CaptureFixture[str]) -> None:
    found = data(capsys, "--compat", "libprada", "--evaluate", "push(d1) push(d1)")
    # The second push is worth 0.6 * 0.4 of its probability 0.4: what applies and what is set are independent.
    assert found["factored"] == pytest.approx(0.6 + 0.95 * 0.4 * 0.6 * 0.4)
    assert (found["exact"], found["sampled"]) == (None, None)


def test_overlapping_rules_are_planned_with_as_libprada_does(
    capsys: pytest.CaptureFixture[str], files: Path
) -> None:
    both = DOORS.replace("when not open(?d), locked(?d)", "when not open(?d)")
    (files / "doors.nid").write_text(both, encoding="utf-8")
    assert "E307" in said(capsys, code=1)
    assert data(capsys, "--compat", "libprada")["measure"] == "factored"
