"""What converted problems are to be best by is what PPDDL says (Younes, Littman, Weissman and Asmuth 2005,
JAIR 24, "Plan Objectives"): rewards where there are some, and up to the goal, which ends them."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

import cleancli
from cleancli.language.diagnostics.refused import Refused
from support.pddl_compared import meaning_of
from support.pddl_meaning import Meaning, World

CORPUS = Path(__file__).parent.parent / "corpus"
EARNING = sorted(path.stem for path in CORPUS.glob("reward*.pddl"))
STEPS = 3


def best(meaning: Meaning, steps: int) -> Fraction:
    """The greatest expected reward of so many steps, by induction over all worlds that they lead to: nothing
    is earned after the goal, and doing nothing earns nothing."""
    goal, reached = meaning.problem.goal, meaning.problem.goal_reward or Fraction(0)

    def over(world: World) -> bool:
        return goal is not None and meaning.holds(goal, world, {})

    @cache
    def value(world: World, left: int) -> Fraction:
        found = Fraction(0)
        for _, action, binding in meaning.actions() if left and not over(world) else ():
            if meaning.holds(action.precondition, world, binding) and meaning.is_known(
                action.effect, world, binding
            ):
                results = meaning.results(world, action, binding).items()
                worths = (
                    p * (value(after, left - 1) - cost + (reached if over(after) else 0))
                    for (after, cost), p in results
                )
                found = max(found, sum(worths, Fraction(0)))
        return found

    return value(meaning.initial(), steps)


MINE = """
(define (domain mine)
  (:requirements :strips :probabilistic-effects :rewards)
  (:predicates (out) (tired) (rich))
  (:action dig :precondition (not (tired))
    :effect (and (tired) (probabilistic 0.5 (and (rich) (increase (reward) 50)))))
  (:action rest :precondition (tired) :effect (not (tired)))
  (:action leave :effect (and (out) (decrease (reward) 3)))
  (:action celebrate :precondition (out) :effect (increase (reward) 7)))
(define (problem shift) (:domain mine) (:init) (:goal (out)) {rest})
"""
ENDS = {
    "metric": "(:goal-reward 10) (:metric maximize (reward))",
    "no metric": "(:goal-reward 10)",
    "no goal reward": "",
}


def _planned(text: str, steps: int) -> float:
    made = cleancli.convert(text, horizon=steps)
    (problem,) = made.problems.values()
    found = cleancli.plan(made.domain, problem, planner="exact").value
    assert found is not None
    return found


@pytest.mark.parametrize("feature", EARNING)
def test_a_plan_earns_what_can_be_had_up_to_the_goal(feature: str) -> None:
    text = (CORPUS / f"{feature}.pddl").read_text(encoding="utf-8")
    assert _planned(text, STEPS) == pytest.approx(float(best(meaning_of(text), STEPS)), abs=1e-9)


@pytest.mark.parametrize("rest", ENDS)
def test_the_goal_ends_what_is_earned(rest: str) -> None:
    """To leave first and to celebrate then would be worth 10 - 3 + 6 * 7; without a metric rewards count as
    well, since actions change them."""
    said = ENDS[rest] if "maximize" in ENDS[rest] else f"{ENDS[rest]} (:metric maximize (reward))"
    wanted = best(meaning_of(MINE.replace("{rest}", said)), 8)
    assert _planned(MINE.replace("{rest}", ENDS[rest]), 8) == pytest.approx(float(wanted), abs=1e-9)


def test_episodes_earn_what_the_plan_says() -> None:
    """Who cannot rest digs once and leaves: 50 in half of all episodes, and 7 in each."""
    text = MINE.replace("{rest}", ENDS["metric"]).replace(":effect (not (tired))", ":effect (tired)")
    assert cleancli.plan(text, text, planner="exact").value == pytest.approx(32, abs=1e-9)
    episodes = cleancli.simulate(text, text, planner="exact", episodes=400, seed=2).episodes[0]
    assert {episode.plain for episode in episodes} == {7.0, 57.0}
    assert sum(episode.plain for episode in episodes) / 400 == pytest.approx(32, abs=4 * 25 / 20)


def test_problems_with_different_goals_are_converted_one_at_a_time() -> None:
    text = MINE.replace("{rest}", ENDS["metric"])
    other = f"(define (problem long) (:domain mine) (:init) (:goal (tired)) {ENDS['metric']})"
    with pytest.raises(Refused, match="not all problems have the same"):
        cleancli.convert(text + other)
    same = cleancli.convert(text + other.replace("(tired)", "(out)"))
    assert set(same.problems) == {"shift", "long"}
    assert "# nothing is done where the goal holds, which ends what can be earned" in same.domain
