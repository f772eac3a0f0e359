"""What plans, values and runs of small domains come to: each stands for a kind of mistake that was made
once."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from cleancli.cli.main import run
from cleancli.planning.registry import PLANNERS
from support import commands

NULLARY = """
domain nullary {
  types { area }
  predicates { dirt(?a - area) on() }
  derived { left := count ?a - area: dirt(?a) }
  actions { sweep_all() [cost = 0.1] wipe(?a - area) [cost = 0.1] }
  rule s: sweep_all() {
    when exists ?a - area: dirt(?a)
    then 0.9: forall ?a - area => not dirt(?a)
         0.1: nothing
  }
  rule w: wipe(?a) { when dirt(?a) then 0.5: not dirt(?a) 0.5: nothing }
  reward { decrease(left) - cost }
}
problem three { domain = nullary objects { a1 a2 a3 - area } init { dirt(a1), dirt(a2), dirt(a3) } }
"""
WAIT = """
domain wait {
  types { area }
  predicates { open(?a - area) }
  derived { opened := count ?a - area: open(?a) }
  actions { start(?a - area) }
  rule s: start(?a) { when not open(?a) then 1: open(?a) }
  reward { 5 * goal - 1 * opened }
}
problem one { domain = wait objects { a1 - area } goal { open(a1) } horizon = 4 discount = 1 }
"""
MIDWAY = """
domain midway {
  types { area }
  predicates { dirt(?a - area)  open(?a - area) }
  derived { left := count ?a - area: dirt(?a)  opened := count ?a - area: open(?a) }
  actions { wipe(?a - area) start(?a - area) }
  rule w: wipe(?a) { when dirt(?a) then 1: not dirt(?a) }
  rule s: start(?a) { when not open(?a) then 1: open(?a) }
  reward { decrease(left) + 5 * goal - opened }
}
problem one {
  domain = midway objects { a1 - area } init { dirt(a1) } goal { open(a1) } horizon = 4 discount = 0.9
}
"""
BY_TIME = """
domain by_time {
  types { area }
  predicates { dirt(?a - area) }
  derived { left := count ?a - area: dirt(?a) }
  actions { wipe(?a - area) [duration = 2 s] look() [duration = 20 s] scrub(?a - area) [duration = 4 s] }
  rule w: wipe(?a) { when dirt(?a) then 1: not dirt(?a) }
  rule s: scrub(?a) { when dirt(?a) then 1: not dirt(?a) }
  rule l: look() { then 1: nothing }
  reward { decrease(left) }
}
problem two {
  domain = by_time objects { a1 a2 - area } init { dirt(a1), dirt(a2) } horizon = 4 discount = 0.5
}
"""
HORIZON_TWO = """
domain horizon_two {
  types { area }
  predicates { clean(?a - area) }
  derived { good := count ?a - area: clean(?a) }
  actions { wipe(?a - area) }
  rule w: wipe(?a) { when not clean(?a) then 1: clean(?a) }
  reward { good }
}
problem two { domain = horizon_two objects { a1 a2 - area } horizon = 2 discount = 1 }
"""
IDLE = """
domain idle {
  types { area }
  predicates { dirt(?a - area) dry(?a - area) [static] seen(?a - area) }
  derived { left := count ?a - area: dirt(?a) }
  actions { wipe(?a - area) look(?a - area) try(?a - area) mark(?a - area) }
  rule w: wipe(?a) { when dirt(?a) then 1: not dirt(?a) }
  rule l: look(?a) { when dirt(?a) then 0.7: nothing 0.3: noise }
  rule t: try(?a) { when dry(?a) then 0.4: not dirt(?a) 0.6: nothing }
  rule m: mark(?a) { then 1: seen(?a) }
  reward { decrease(left) }
}
problem two {
  domain = idle objects { a1 a2 - area } init { dirt(a1), dirt(a2), dry(a1), seen(a1) } horizon = 5
}
"""


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def said(capsys: pytest.CaptureFixture[str], command: str, text: str, *words: str) -> str:
    domain, problem = text.split("problem ")
    Path("domain.nid").write_text(domain, encoding="utf-8")
    Path("problem.nid").write_text("problem " + problem, encoding="utf-8")
    return commands.said(capsys, command, "domain.nid", "problem.nid", *words)


def data(capsys: pytest.CaptureFixture[str], command: str, text: str, *words: str) -> dict[str, Any]:
    found = json.loads(said(capsys, command, text, *words, "--json"))
    assert isinstance(found, dict)
    return found


def test_an_action_without_parameters_acts_wherever_one_plans(capsys: pytest.CaptureFixture[str]) -> None:
    plan = data(capsys, "plan", NULLARY)
    assert (plan["plan"], round(plan["value"], 3)) == (["sweep_all()"], 2.873)
    (found,) = data(capsys, "simulate", NULLARY, "--episodes", "100", "--max-actions", "10")["planners"]
    low, high = found["discounted"]["low"], found["discounted"]["high"]
    assert low - (high - low) <= plan["value"] <= high + (high - low)
    assert found["success"]["mean"] == 1


def test_what_an_action_without_parameters_did_is_learned(capsys: pytest.CaptureFixture[str]) -> None:
    """By eq. 5 with m = 10: the last sweep of each run worked, those before were in vain."""
    seeds = ("1", "7")
    for seed in seeds:
        said(capsys, "execute", NULLARY, "--seed", seed, "--max-actions", "4", "--quiet", "--runs", "runs")
    files = sorted(Path("runs").glob("*/experience.jsonl"))
    tries = [len(path.read_text(encoding="utf-8").splitlines()) for path in files]
    assert len(tries) == 2
    assert all(1 <= number <= 2 for number in tries)
    assert run(["learn", "domain.nid", *map(str, files)]) == 0
    shown = capsys.readouterr().out
    tried = sum(tries)
    m = 10 / tried**0.5
    assert f"{(2 + 0.9 * m) / (tried + m):.4g} [prior 0.9, seen 2]" in shown
    assert f"[prior 0.1, seen {tried - 2}]" in shown


@pytest.mark.parametrize(
    ("text", "plan", "value"),
    [(WAIT, ["start(a1)"], 1.0), (MIDWAY, ["wipe(a1)", "start(a1)"], 3.061)],
)
@pytest.mark.parametrize("planner", ["prada+", "exact", "prada"])
def test_doing_nothing_is_stopping(
    capsys: pytest.CaptureFixture[str], text: str, plan: list[str], value: float, planner: str
) -> None:
    found = data(capsys, "plan", text, "--planner", planner)
    assert (found["plan"], round(found["value"], 6)) == (plan, value)
    evaluated = data(capsys, "plan", text, "--evaluate", " ".join(plan))
    assert evaluated["exact"] == pytest.approx(value)
    words = ("--episodes", "1", "--max-actions", "4", "--planner", planner)
    (simulated,) = data(capsys, "simulate", text, *words)["planners"]
    assert simulated["discounted"]["mean"] == pytest.approx(value)


def test_time_counts_the_same_whatever_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    """One scale: of the plan, of any sequence, and of the closed loop."""
    time, wipes = ("--objective", "time"), "wipe(a1) wipe(a2)"
    values = []
    for actions in (wipes, f"{wipes} look()", f"{wipes} look() look()"):
        found = data(capsys, "plan", BY_TIME, *time, "--evaluate", actions)
        values += [found["exact"], found["factored"], found["sampled"]["value"]]
    assert values == pytest.approx([2.0536] * 9, abs=1e-4)
    assert data(capsys, "plan", BY_TIME, *time)["value"] == pytest.approx(2.0536, abs=1e-4)
    (found,) = data(capsys, "simulate", BY_TIME, *time, "--episodes", "1", "--max-actions", "4")["planners"]
    assert found["discounted"]["mean"] == pytest.approx(2.0536, abs=1e-4)
    fewer = BY_TIME.replace("dirt(a1), dirt(a2)", "dirt(a1)").replace("horizon = 4", "horizon = 1")
    first = 0.5 ** (2 / 3) / 0.5
    assert data(capsys, "plan", fewer, *time)["value"] == pytest.approx(first)


def test_what_lies_beyond_the_horizon_is_said_and_not_counted(capsys: pytest.CaptureFixture[str]) -> None:
    actions = "wipe(a1) wipe(a2) wipe(a2) wipe(a2)"
    found = data(capsys, "plan", HORIZON_TWO, "--evaluate", actions, "--explain")
    assert (found["exact"], found["factored"], found["sampled"]["value"]) == pytest.approx((3, 3, 3))
    assert found["beyond_horizon"] == ["wipe(a2)", "wipe(a2)"]
    assert len(found["explained"]["steps"]) == 2
    shown = said(capsys, "plan", HORIZON_TWO, "--evaluate", actions)
    assert "2 actions lie beyond the horizon and are not counted:\n  wipe(a2) wipe(a2)\n" in shown
    assert "beyond" not in said(capsys, "plan", HORIZON_TWO, "--evaluate", "wipe(a1) wipe(a2)")
    assert data(capsys, "plan", HORIZON_TWO, "--evaluate", "wipe(a1)")["beyond_horizon"] == []


def test_each_rule_that_covers_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    """Also of actions that change nothing here, ever, or any more; as `explain` says it."""
    actions = "look(a1) mark(a1) try(a2) wipe(a1) look(a1)"
    steps = data(capsys, "plan", IDLE, "--evaluate", actions, "--explain")["explained"]["steps"]
    outcomes = [(o["probability"], o["kind"]) for o in steps[0]["outcomes"]]
    assert outcomes == [(0.7, "nothing"), (0.3, "noise")]
    rules = [[rule["rule"] for rule in step["rules"]] for step in steps]
    assert rules == [["l"], ["m"], [], ["w"], []]
    assert [step["covered"] for step in steps] == [1, 1, 0, 1, 0]
    shown = said(capsys, "plan", IDLE, "--evaluate", "look(a1)", "--explain")
    assert "0.700  nothing" in shown
    assert "0.300  noise" in shown
    assert "no rule" not in shown


@pytest.mark.parametrize("planner", PLANNERS)
def test_nothing_is_put_off_for_ever(capsys: pytest.CaptureFixture[str], here: Path, planner: str) -> None:
    """Three areas, as long a horizon as 12 steps, and nothing gained by hurry."""
    text = (Path(__file__).parent.parent.parent / "problems" / "three_areas.nid").read_text(encoding="utf-8")
    late = text.replace("horizon  = 1 + dirty_areas", "horizon = 12").replace("= 0.95", "= 1")
    assert late.count("= 12") == late.count("discount = 1") == 1
    (here / "late.nid").write_text(late, encoding="utf-8")
    words = ("--planner", planner, "--episodes", "20", "--samples", "500", "--json")
    assert run(["simulate", "cleaning", "late.nid", *words]) == 0
    (found,) = json.loads(capsys.readouterr().out)["planners"]
    assert found["success"]["mean"] == 1
