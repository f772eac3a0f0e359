"""How likely the goal is reached (docs/planning.md): `plan`, Python, drawn runs and episodes agree."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from scipy import stats

import cleancli
from cleancli.cli.main import run
from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.evaluation import goal_chance as module
from cleancli.planning.plan import Options
from cleancli.planning.policy import sequence
from cleancli.planning.registry import PLANNERS
from cleancli.simulation.batch import Batch, rounds
from cleancli.simulation.episode import EpisodeLimits
from support import from_text

VAULT = """
domain vault {
  predicates { open() jammed() lit() }
  actions { unlock() light() }
  rule unlocking: unlock() { when not open(), not jammed() then 0.3: open() 0.1: jammed() rest: nothing }
  rule lighting: light() { when not lit() then 0.5: lit() rest: nothing }
  reward { 1 * goal }
}
"""
"""A lock that opens in three of four cases, if there is time enough."""


def vault(horizon: int) -> Task:
    return from_text.task(VAULT, f"goal {{ open() }} horizon = {horizon}")


def opened(tries: int) -> float:
    """The probability that so many tries open the lock."""
    return sum(0.3 * 0.6**tried for tried in range(tries))


@pytest.mark.parametrize("planner", ["exact", "prada+", "uct", "sst"])
@pytest.mark.parametrize("horizon", [1, 2, 6])
def test_a_policy_is_followed_exactly(planner: str, horizon: int) -> None:
    """Sparse sampling looks two actions ahead, and then has no plan."""
    task = vault(horizon)
    plan = PLANNERS[planner](prepare(task), Options(samples=500, seed=1))
    assert plan.policy is not None
    found = module.goal_chance(task, plan.policy, 1)
    assert found.runs is None
    assert found.probability == pytest.approx(opened(min(horizon, 2) if planner == "sst" else horizon))


def test_a_sequence_is_carried_out_whatever_happens() -> None:
    """The goal need hold at one time only, where an episode ends: a light that is on by chance."""
    task = from_text.task(VAULT, "goal { lit(), not open() } horizon = 9")
    names = {str(action): number for number, action in enumerate(task.actions)}
    actions = tuple(names[f"{name}()"] for name in ("light", "unlock", "unlock"))
    assert module.goal_chance(task, sequence(task.initial, actions), 1).probability == pytest.approx(0.5)


def test_where_places_are_many_runs_are_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PLACES", 3)
    task = vault(6)
    policy = PLANNERS["exact"](prepare(task), Options()).policy
    assert policy is not None
    found, again = (module.goal_chance(task, policy, 4) for _ in range(2))
    assert found == again
    assert found.runs == 2_000
    reached = round(found.probability * found.runs)
    assert stats.binomtest(reached, found.runs, opened(6)).pvalue > 1e-4
    assert found.error == pytest.approx((found.probability * (1 - found.probability) / found.runs) ** 0.5)


@pytest.mark.parametrize("planner", ["exact", "prada+"])
def test_episodes_reach_the_goal_as_often(planner: str) -> None:
    """Where each plan has one step less than the one before, as the policy has."""
    domain, problem = from_text.checked(VAULT, "goal { open(), lit() } horizon = 5")
    task = ground(domain, problem)
    plan = PLANNERS[planner](prepare(task), Options(samples=500, seed=2))
    assert plan.policy is not None
    chance = module.goal_chance(task, plan.policy, 1).probability
    limits = EpisodeLimits(max_actions=9, horizon=5)
    options = Options(samples=500, seed=2)
    setup = Batch(domain, domain, problem, (PLANNERS[planner],), options, limits)
    successes = [bool(each.success) for (each,) in rounds(setup, range(300))]
    assert stats.binomtest(sum(successes), len(successes), chance).pvalue > 1e-4


def test_the_command_python_and_simulate_agree(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With a horizon that is long enough: `simulate` looks as far ahead again after each action."""
    (tmp_path / "vault.nid").write_text(VAULT, encoding="utf-8")
    problem = "problem p { domain = vault goal { open() } horizon = 40 }"
    (tmp_path / "p.nid").write_text(problem, encoding="utf-8")
    files = [str(tmp_path / "vault.nid"), str(tmp_path / "p.nid")]
    plan = cleancli.plan(*files)
    assert plan.goal_chance is not None
    assert plan.goal_chance.probability == pytest.approx(opened(40))
    line = "reaches the goal with probability 0.75 within 40 actions"
    assert line in str(plan)
    assert run(["plan", *files]) == 0
    assert line in capsys.readouterr().out
    for more in ([], ["--explain"]):
        assert run(["plan", *files, "--json", *more]) == 0
        told = json.loads(capsys.readouterr().out)["goal_chance"]
        assert told == {"probability": plan.goal_chance.probability, "error": 0.0, "runs": None}
    found = cleancli.simulate(*files, episodes=400, seed=3)
    successes = sum(bool(each.success) for each in found.episodes[0])
    assert stats.binomtest(successes, 400, opened(40)).pvalue > 1e-4
    assert run(["plan", *files, "--evaluate", "unlock() light() unlock()"]) == 0
    assert f"reaches the goal with probability {opened(2):.6g} within 40 actions" in capsys.readouterr().out


def test_without_a_horizon_it_is_what_is_reached() -> None:
    plan = cleancli.plan(VAULT, "problem p { domain = vault goal { open() } horizon = unlimited }")
    assert plan.reached is not None
    assert plan.goal_chance is not None
    assert plan.goal_chance.probability == plan.reached.probability == pytest.approx(0.75)
    assert [(branch.step, branch.effects) for branch in plan.branches] == [(1, ("jammed()",))]
    assert plan.branches[0].probability == pytest.approx(0.25)


def test_without_a_goal_there_is_no_chance() -> None:
    assert cleancli.plan("cleaning", "three_areas").goal_chance is None
