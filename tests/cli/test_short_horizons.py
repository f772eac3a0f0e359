"""docs/language.md: where a problem states no horizon, it is one more than the count, and what plans and
simulates says so where that is too few."""

from __future__ import annotations

from pathlib import Path

import pytest

from cleancli.cli.main import run

DOMAIN = """
domain ferry {
  types      { car boat }
  predicates { over(?c - car) on(?c - car) ready(?b - boat) }
  derived    { left := count ?c - car: not over(?c) }
  actions    { load(?c - car)  land(?c - car)  moor(?b - boat) }
  rule load_it: load(?c) { when not on(?c), not over(?c)  then 1: on(?c) }
  rule land_it: land(?c) { when on(?c)  then LANDS: not on(?c), over(?c) rest: nothing }
  rule moor_it: moor(?b) { when not ready(?b)  then 1: ready(?b) }
  reward { decrease(left) }
}
"""
HINT = "the problem states no horizon, and"


def told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, more: str, lands: str = "1"
) -> str:
    (tmp_path / "ferry.nid").write_text(DOMAIN.replace("LANDS", lands), encoding="utf-8")
    problem = f"problem cars {{ domain = ferry objects {{ a b - car s t - boat }} init {{ on(b) }} {more} }}"
    (tmp_path / "cars.nid").write_text(problem, encoding="utf-8")
    assert run([command, str(tmp_path / "ferry.nid"), str(tmp_path / "cars.nid"), "--planner", "exact"]) == 0
    return capsys.readouterr().out


GOAL = "goal { over(a), over(b) }"


@pytest.mark.parametrize(
    ("more", "lands", "short"),
    [
        (GOAL, "1", ""),  # load(a), land(a), land(b): three actions are enough
        (GOAL, "0.8", ""),  # with the probability 0.64
        (GOAL, "0.4", "3 actions reach the goal with probability 0.16"),
        ("goal { on(a), over(b), ready(s), ready(t) }", "1", "3 actions reach the goal with probability 0"),
        (f"{GOAL} horizon = 3", "0.4", ""),  # as the problem wants it
        ("", "0.4", ""),  # the count is what the horizon is for
    ],
)
def test_a_plan_says_where_the_usual_horizon_is_too_short_for_the_goal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: str, lands: str, short: str
) -> None:
    out = told(tmp_path, capsys, "plan", more, lands)
    assert (HINT in out) == bool(short)
    assert not short or f"{HINT} these {short}: write for example `horizon = 10`" in out


def test_a_simulation_says_so_where_planners_give_up(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Once both cars are over, one action is looked ahead, and the boats take two."""
    goal = "goal { over(a), over(b), ready(s), ready(t) }"
    out = told(tmp_path, capsys, "simulate", goal)
    assert f"{HINT} 3 actions may be too few: write for example `horizon = 10`" in out
    assert HINT not in told(tmp_path, capsys, "simulate", f"{goal} horizon = 9")
    assert HINT not in told(tmp_path, capsys, "simulate", GOAL)


def test_a_simulation_says_where_episodes_are_longer_than_a_plan(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/simulation.md: then the mean return may be more than the value of a plan."""
    fixed = "the horizon is fixed: each plan looks 3 actions ahead again"
    assert fixed in told(tmp_path, capsys, "simulate", f"{GOAL} horizon = 3", "0.3")
    assert fixed not in told(tmp_path, capsys, "simulate", f"{GOAL} horizon = 3", "1")
    assert fixed not in told(tmp_path, capsys, "simulate", f"{GOAL} horizon = 1 + left", "0.3")


COOKING = """
domain kitchen {
  types      { dish }
  predicates { done(?d - dish) }
  derived    { raw := count ?d - dish: not done(?d) }
  actions    { cook(?d - dish) }
  rule cooking: cook(?d) { when not done(?d)  then CHANCE: done(?d) rest: nothing }
  reward { decrease(raw) }
}
"""


def simulated(tmp_path: Path, capsys: pytest.CaptureFixture[str], horizon: str, *more: str) -> str:
    (tmp_path / "kitchen.nid").write_text(COOKING.replace("CHANCE", "0.2"), encoding="utf-8")
    problem = "problem meal { domain = kitchen objects { a b - dish } goal { done(a), done(b) } horizon = H }"
    (tmp_path / "meal.nid").write_text(problem.replace("H }", f"{horizon} }}"), encoding="utf-8")
    files = str(tmp_path / "kitchen.nid"), str(tmp_path / "meal.nid")
    assert run(["simulate", *files, "--episodes", "40", *more]) == 0
    return capsys.readouterr().out


def test_a_simulation_says_that_a_count_that_has_not_fallen_leaves_the_horizon_as_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/planning.md: episodes may be longer than one plan, and end with it by `--max-actions`."""
    note = "the horizon follows a count: the first plan looks 3 actions ahead"
    out = simulated(tmp_path, capsys, "1 + raw")
    assert note in out
    assert "return and the share of successes may be more" in out
    assert "`--max-actions 3` ends" in out
    assert note not in simulated(tmp_path, capsys, "1 + raw", "--max-actions", "3")


def test_a_simulation_says_where_the_limit_of_actions_ends_what_plans_would_go_on_with(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/planning.md: a plan has any number of actions, or up to its horizon, and an episode a limit."""
    note = "and `--max-actions 2` ended 3"
    limit = "--max-actions", "2", "--seed", "2"
    assert f"the horizon is unlimited, {note}" in simulated(tmp_path, capsys, "unlimited", *limit)
    assert f"the first plan looks 9 actions ahead, {note}" in simulated(tmp_path, capsys, "9", *limit)
    assert "early" not in simulated(tmp_path, capsys, "9")


def test_check_and_plan_advise_the_same_horizon(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """docs/diagnostics.md, W404: twice what the goal takes at least, and no less than 10."""
    told(tmp_path, capsys, "plan", GOAL)
    boats = "r s t u v w"
    goal = "over(a), over(b), " + ", ".join(f"ready({boat})" for boat in boats.split())
    problem = f"problem cars {{ domain = ferry objects {{ a b - car {boats} - boat }} goal {{ {goal} }} }}"
    (tmp_path / "cars.nid").write_text(problem, encoding="utf-8")
    for command in "check", "plan", "simulate":  # four actions for the cars and six for the boats
        assert run([command, str(tmp_path / "ferry.nid"), str(tmp_path / "cars.nid")]) == 0
        assert "write for example `horizon = 20`" in "".join(capsys.readouterr())


def test_a_policy_that_lacks_time_to_try_again_is_told_as_short(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two dishes fit into the usual three actions, and are seldom done in them: 0.104."""
    simulated(tmp_path, capsys, "9", "--max-actions", "1")
    (tmp_path / "meal.nid").write_text(
        "problem meal { domain = kitchen objects { a b - dish } goal { done(a), done(b) } }", encoding="utf-8"
    )
    assert run(["plan", str(tmp_path / "kitchen.nid"), str(tmp_path / "meal.nid")]) == 0
    short = "these 2 actions reach the goal with probability 0.1: write for example `horizon = 10`"
    assert f"{HINT} {short}" in capsys.readouterr().out


@pytest.mark.parametrize("horizon", ["horizon = 5", "horizon = unlimited", ""])
def test_a_goal_whose_parts_exclude_each_other_is_said_to_be_out_of_reach(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], horizon: str
) -> None:
    """docs/diagnostics.md, W403: each part can be had alone, and landing takes the car from the boat."""
    more = f"goal {{ over(a), on(a), over(b) }} {horizon}"
    beyond = "the goal is out of reach, whatever is done"
    out = told(tmp_path, capsys, "plan", more)
    assert beyond in out
    assert HINT not in out
    assert beyond in told(tmp_path, capsys, "simulate", more)
    assert run(["check", str(tmp_path / "ferry.nid"), str(tmp_path / "cars.nid")]) == 0
    assert "W403" in "".join(capsys.readouterr())
    monkeypatch.chdir(tmp_path)
    assert run(["execute", "ferry.nid", "cars.nid", "--planner", "exact", "--max-actions", "3"]) == 3
    assert beyond in capsys.readouterr().out
    assert beyond not in told(tmp_path, capsys, "plan", f"goal {{ over(a), over(b) }} {horizon}", "0.1")


BREAKING = """
domain kiln {
  predicates { fired() cracked() sold() }
  actions    { fire() sell() }
  rule firing:  fire() { when not fired(), not cracked()  then 0.3: fired() rest: cracked() }
  rule selling: sell() { when fired()  then 1: sold() }
  reward { 1 * goal }
}
"""


def test_a_course_that_does_not_reach_the_goal_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/planning.md: the likeliest course follows a crack, and nothing is sold on it."""
    problem = "problem pot { domain = kiln goal { sold() } horizon = 4 }"
    (tmp_path / "pot.nid").write_text(problem, encoding="utf-8")
    for chance, astray in (("0.3", True), ("0.7", False)):
        (tmp_path / "kiln.nid").write_text(BREAKING.replace("0.3", chance), encoding="utf-8")
        assert run(["plan", str(tmp_path / "kiln.nid"), str(tmp_path / "pot.nid"), "--planner", "exact"]) == 0
        out = capsys.readouterr().out
        assert ("this course does not reach the goal; `--explain` says" in out) == astray
        assert f"reaches the goal with probability {chance} " in out


def test_what_a_course_does_not_reach_is_told_of_policies_that_reach_it_otherwise(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/planning.md: not of those that never do, and who explains the plan need not be told how."""
    paid = BREAKING.replace("0.3: fired()", "0.3: fired(), reward += 1")
    (tmp_path / "kiln.nid").write_text(paid, encoding="utf-8")
    plan = ["plan", str(tmp_path / "kiln.nid"), str(tmp_path / "pot.nid"), "--planner", "exact"]
    for horizon, chance in ((4, "0.3"), (1, "0")):
        problem = f"problem pot {{ domain = kiln goal {{ sold() }} horizon = {horizon} }}"
        (tmp_path / "pot.nid").write_text(problem, encoding="utf-8")
        for explained in ([], ["--explain"]):
            assert run([*plan, *explained]) == 0
            out = capsys.readouterr().out
            assert "1. fire()" in out
            assert f"reaches the goal with probability {chance} " in out
            assert ("this course does not reach the goal" in out) == (horizon == 4)
            assert ("`--explain` says" in out) == (horizon == 4 and not explained)


def test_a_run_says_so_where_nothing_seems_worth_doing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ferry.nid").write_text(DOMAIN.replace("LANDS", "1"), encoding="utf-8")
    goal = "goal { over(a), over(b), ready(s), ready(t) }"
    for more, hinted in (("", True), ("horizon = 9", False)):
        problem = (
            f"problem cars {{ domain = ferry objects {{ a b - car s t - boat }} init {{ }} {goal} {more} }}"
        )
        (tmp_path / "cars.nid").write_text(problem, encoding="utf-8")
        code = run(["execute", "ferry.nid", "cars.nid", "--planner", "exact"])
        assert code == (3 if hinted else 0)
        out = capsys.readouterr().out
        assert (f"{HINT} 3 actions may be too few: write for example `horizon = 12`" in out) == hinted


def test_a_run_warns_of_a_goal_that_nothing_reaches(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """W403, as `check`, `plan` and `simulate` say it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ferry.nid").write_text(DOMAIN.replace("LANDS", "1"), encoding="utf-8")
    goal = "goal { over(a), not on(a), not over(a) } horizon = 9"
    problem = f"problem cars {{ domain = ferry objects {{ a - car s - boat }} init {{ on(a) }} {goal} }}"
    (tmp_path / "cars.nid").write_text(problem, encoding="utf-8")
    said = {}
    for command in (["plan"], ["execute", "--quiet"]):
        run([command[0], "ferry.nid", "cars.nid", *command[1:]])
        said[command[0]] = capsys.readouterr().err
    assert "W403" in said["execute"]
    assert said["execute"] == said["plan"]


def test_what_a_problem_says_is_no_option(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", "cleaning", "three_areas", "--horizon", "5"]) == 2
    assert "'--horizon'. The problem's file says it: `horizon = 10`." in capsys.readouterr().err
    assert run(["plan", "cleaning", "three_areas", "--sampels", "5"]) == 2
    assert "Did you mean '--samples'?" in capsys.readouterr().err


def test_steps_towards_a_goal_without_a_horizon_say_how_likely_it_holds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/planning.md: no reward counts there; a pot is fired with 0.7, and only then sold."""
    (tmp_path / "kiln.nid").write_text(BREAKING.replace("0.3", "0.7"), encoding="utf-8")
    plan = ["plan", str(tmp_path / "kiln.nid"), str(tmp_path / "pot.nid"), "--planner", "exact", "--explain"]
    for horizon, column, last in (("unlimited", "goal", "0.700"), ("4", "reward", "0.700")):
        problem = f"problem pot {{ domain = kiln goal {{ sold() }} horizon = {horizon} }}"
        (tmp_path / "pot.nid").write_text(problem, encoding="utf-8")
        assert run(plan) == 0
        out = capsys.readouterr().out
        assert out.split()[:8] == ["step", "covered", "by", column, "chance", "what", "may", "happen"]
        assert ["2.", "sell()", "0.700", "selling", last, "0.700", "sold()"] in map(
            str.split, out.splitlines()
        )
        assert ("reward" in out) == (horizon == "4")
        assert ("goal: that it holds after the step" in out) == (horizon == "unlimited")
