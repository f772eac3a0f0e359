"""`simulate --strategy explore` (docs/simulation.md, Exploring): rules are hidden, sought, and compared."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats

from cleancli.api.simulation_result import SimulationResult
from cleancli.api.simulations import simulate
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Domain, Problem
from cleancli.learning.experience import read_experience
from cleancli.learning.exploration.explored import explored
from cleancli.learning.exploration.simulated import COVERED, PAIRS, drawn, pairs
from cleancli.learning.variation import foretold, variation
from cleancli.simulation.symbolic_world import world_of
from support.commands import said
from support.locked_doors import PROBLEM, RULES, VOCABULARY


@pytest.fixture(autouse=True)
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The rules, the same without them, and a problem in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path("doors.nid").write_text(VOCABULARY % RULES, encoding="utf-8")
    Path("bare.nid").write_text(VOCABULARY % "", encoding="utf-8")
    Path("p.nid").write_text(PROBLEM, encoding="utf-8")


def doors() -> tuple[Domain, Problem]:
    domain = load_domain(read_source(Path("doors.nid")))
    return domain, load_problem(read_source(Path("p.nid")), domain)


def done(episodes: int = 4, seed: int = 3, **asked: Any) -> SimulationResult:
    first = asked.pop("domain", "doors.nid")
    given: dict[str, Any] = {"samples": 50, "known": 3, "strategy": "explore", "max_actions": 25, **asked}
    return simulate(str(first), "p.nid", episodes=episodes, seed=seed, **given)


def test_hidden_rules_are_learned_and_the_goal_is_reached() -> None:
    """Nothing is right at first but that most actions do nothing, in the end nearly all; and then the goal is
    reached as by who knows the rules."""
    found = done(episodes=6)
    (off,) = found.variations
    assert len(off) == 6
    assert off[-1] < 0.05
    assert off[-1] < off[0]
    assert found.episodes[0][-1].success


def test_what_is_told_is_the_variation_of_what_was_learned_from_what_was_recorded() -> None:
    found = done(record="e.jsonl")
    domain, problem = doors()
    bare = load_domain(read_source(Path("bare.nid")))
    learned = explored(bare, list(read_experience(Path("e.jsonl"), bare))).domain
    judged = pairs(world_of(domain, problem), domain, problem, np.random.default_rng(3))
    assert found.variations[0][-1] == pytest.approx(variation(learned, domain, judged))


def test_pairs_are_as_documented() -> None:
    """300 of them, in states that actions lead to; about three of four on objects that a rule covers, and of
    the others as many as happen to be."""
    domain, problem = doors()
    found = pairs(world_of(domain, problem), domain, problem, np.random.default_rng(1))
    rules = LiftedRules(domain)
    assert len(found) == PAIRS == 300
    assert COVERED == 0.75
    changing = sum(foretold(rules, each) != {frozenset(): 1.0} for each in found)
    assert 0.6 < changing / PAIRS < 0.95
    assert {each.action for each in found} == {"push", "unlock", "bolt"}
    assert all(
        each.before.get(("open", (d,))) is None or not each.before.get(("locked", (d,)))
        for each in found
        for d in "abc"
    )


def test_the_same_seed_explores_the_same_and_another_one_differs() -> None:
    one, same, other = (done(2, seed) for seed in (3, 3, 4))
    assert actions(one) == actions(same) != actions(other)
    assert one.variations == same.variations


def actions(found: SimulationResult) -> list[str]:
    return [str(action) for episode in found.episodes[0] for action in episode.actions]


def test_another_world_is_explored_from_the_rules_of_the_domain() -> None:
    """From none, it is as if the rules had been hidden; from the right ones, nothing is off at first."""
    hidden, bare = done(2), done(2, domain="bare.nid", world="doors.nid")
    assert actions(hidden) == actions(bare)
    right = done(1, world="doors.nid", max_actions=0)
    assert right.variations == ((0.0,),)


def test_wrong_probabilities_of_right_rules_are_learned_while_exploring() -> None:
    """The rules stay, and what they foretell comes near what is true, from one episode to the next."""
    Path("wrong.nid").write_text(VOCABULARY % RULES.replace("0.8: open(?d) 0.2", "0.3: open(?d) 0.7"))
    (off,) = done(10, domain="wrong.nid", world="doors.nid").variations
    wrong, problem = load_domain(read_source(Path("wrong.nid"))), doors()[1]
    true = doors()[0]
    before = variation(wrong, true, pairs(world_of(true, problem), true, problem, np.random.default_rng(3)))
    assert off[-1] < before / 3


def test_several_planners_explore_each_for_itself() -> None:
    both = done(2, planner=["prada+", "sst"])
    assert both.variations[0] == done(2).variations[0]
    assert len(both.variations) == 2
    assert [each.planner for each in both.planners] == ["explore, prada+", "explore, sst"]


def test_the_command_tells_it(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["simulate", "doors.nid", "p.nid", "--strategy", "explore", "--episodes", "3"]
    words += ["--samples", "50", "--known", "3", "--seed", "3"]
    told = said(capsys, *words)
    assert "\nexplore ended: " in told, "the row is called so"
    assert "\nexplore: what it foretells is off by 0." in told
    assert " after 1 episode, " in told
    assert " after 2, " in told
    assert " after 3\n" in told
    assert "W403" not in told
    found = json.loads(said(capsys, *words, "--json"))
    assert found["strategy"] == "explore"
    assert len(found["planners"][0]["variations"]) == 3


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"jobs": 2}, "one process"),
        ({"strategy": "plan"}, "matters to the strategy explore alone"),
        ({"domain": "bare.nid"}, "the domain has no rules"),
        ({"known": -1}, "known"),
    ],
)
def test_what_makes_no_sense_is_refused(asked: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        done(1, **asked)


def test_a_plan_knows_no_variations() -> None:
    assert done(1, strategy="plan", known=None).variations == ()


# ---- at random


def test_random_actions_are_drawn_as_documented() -> None:
    """Each action equally often; where a rule covers objects, these in three of four cases, or by chance
    among all three doors."""
    domain, problem = doors()
    world = world_of(domain, problem)
    rng, draws = np.random.default_rng(5), 3_000
    found = [drawn(world, domain, problem, world.task.initial, rng) for _ in range(draws)]
    counts = Counter(found)
    likely = {
        # Of the doors, which are shut, `a` is locked.
        ("push", ("a",)): 0.25 / 3,
        ("push", ("b",)): 0.75 / 2 + 0.25 / 3,
        ("push", ("c",)): 0.75 / 2 + 0.25 / 3,
        ("unlock", ("a",)): 0.75 + 0.25 / 3,
        ("unlock", ("b",)): 0.25 / 3,
        ("unlock", ("c",)): 0.25 / 3,
        ("bolt", ("a",)): 0.25 / 3,
        ("bolt", ("b",)): 0.75 / 2 + 0.25 / 3,
        ("bolt", ("c",)): 0.75 / 2 + 0.25 / 3,
    }
    assert sum(likely.values()) == pytest.approx(3)
    expected = [draws * share / 3 for share in likely.values()]
    assert stats.chisquare([counts[key] for key in likely], expected).pvalue > 1e-4


def test_random_actions_are_recorded_and_teach_the_rules(capsys: pytest.CaptureFixture[str]) -> None:
    """Their own rules come back, with conditions that no planner would have violated."""
    asked = [
        "simulate",
        "doors.nid",
        "p.nid",
        "--strategy",
        "random",
        "--episodes",
        "60",
        "--max-actions",
        "10",
        "--seed",
        "2",
    ]
    out = said(capsys, *asked, "--record", "random.jsonl")
    assert "random ended:" in out
    assert said(capsys, *asked, "--json") == said(capsys, *asked, "--json")
    data = json.loads(said(capsys, *asked, "--json"))
    assert (data["strategy"], data["planners"][0]["planner"]) == ("random", "random")
    lines = [json.loads(line) for line in Path("random.jsonl").read_text(encoding="utf-8").splitlines()]
    assert {line["planner"] for line in lines} == {"random"}
    assert len(lines) == sum(len(row["actions"]) for row in data["planners"][0]["rows"])
    assert {line["action"] for line in lines} == {"push", "unlock", "bolt"}
    said(
        capsys,
        *["learn", "--structure", "--vocabulary", "bare.nid", "random.jsonl", "--output", "learned.nid"],
    )
    learned, (true, problem) = load_domain(read_source(Path("learned.nid"))), doors()
    assert len(learned.rules) == 3
    judged = pairs(world_of(true, problem), true, problem, np.random.default_rng(1))
    assert variation(learned, true, judged) < 0.05


def test_who_acts_at_random_has_no_planner(capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["simulate", "doors.nid", "p.nid", "--strategy", "random"]
    assert "plans nothing" in said(capsys, *asked, "--planner", "exact", code=2)
    asked[1] = "bare.nid"
    assert "random ended" in said(capsys, *asked, "--world", "doors.nid", "--episodes", 3)
