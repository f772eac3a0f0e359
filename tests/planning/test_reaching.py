"""Goals without a horizon (docs/planning.md), against linear programs over the states of the tests' own
interpreter."""

from __future__ import annotations

import tempfile
from collections import Counter
from dataclasses import dataclass
from functools import cache
from itertools import count, islice
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import reaches_goal, successors
from cleancli.compiler.task import GroundState
from cleancli.planning.compiled_task import prepare
from cleancli.planning.objective import aimed
from cleancli.planning.plan import Options, Plan, PlanningRefused, Reached, TooManyStatesError
from cleancli.planning.registry import PLANNERS
from cleancli.simulation.agent import Agent
from cleancli.simulation.episode import EpisodeLimits, episode
from cleancli.simulation.symbolic_world import world_of
from support import from_text
from support.differential import product
from support.differential.abstract import Domain, Problem
from support.differential.interpreter import Call, Meaning
from support.differential.reaching import (
    Reachable,
    Values,
    costs,
    drawn,
    end_components,
    lossless,
    machine,
    probabilities,
    reachable,
)
from support.differential.worth import Worth
from support.shipped import shipped_domain

MOST = 120
"""States of a random problem."""
NUMBER = ((machine, 175), (drawn, 25))
"""Problems of each kind; drawn ones take longer."""


@dataclass(frozen=True)
class Case:
    """A random problem as the product reads it, and what the linear programs say of it."""

    seed: int
    objective: str
    grounded: product.Grounded
    model: Reachable
    probability: Values
    cost: Values


def cost_of(meaning: Meaning, objective: str) -> dict[Call, float]:
    """What each action costs by an objective; functions that cost are static."""
    match objective:
        case "time":
            worth = Worth(meaning)
            return {call: worth.duration(call[0]) for call in meaning.calls()}
        case "cost":
            return {call: float(meaning.cost(call, meaning.initial())) for call in meaning.calls()}
        case _:
            return dict.fromkeys(meaning.calls(), 1.0)


def objective_of(seed: int, meaning: Meaning) -> str:
    """Each in turn, where the domain has what it is about."""
    actions = meaning.actions.values()
    if seed % 4 == 1 and all(action.duration is not None for action in actions):
        return "time"
    return "cost" if seed % 4 > 1 and any(cost_of(meaning, "cost").values()) else "probability"


def case(seed: int, found: tuple[Domain, Problem] | None, folder: Path) -> Case | None:
    """The problem of a seed; None where it is refused, or has too few states or too many."""
    if found is None:
        return None
    meaning = Meaning(*found)
    objective = objective_of(seed, meaning)
    model = reachable(meaning, cost_of(meaning, objective), MOST, objective == "cost")
    if model is None or len(model.states) < 3 or not any(choice.cost for choice in model.choices):
        return None
    product.write(folder, *found, seed)
    loaded, _ = product.load(folder, meaning)
    grounded = None if loaded is None else product.grounded(loaded)
    if not isinstance(grounded, product.Grounded):
        return None
    probability = probabilities(model)
    return Case(seed, objective, grounded, model, probability, costs(model, probability))


@cache
def cases() -> tuple[Case, ...]:
    """So many of each kind, by ascending seeds."""
    found: list[Case] = []
    with tempfile.TemporaryDirectory() as folder:
        for kind, number in NUMBER:
            made = (case(seed, kind(seed), Path(folder)) for seed in count())
            found += islice((each for each in made if each is not None), number)
    return tuple(found)


def planned(each: Case, planner: str = "exact", **own: str) -> Plan:
    return PLANNERS[planner].having(**own)(prepare(aimed(each.grounded.task, each.objective)), Options())


@pytest.mark.parametrize("arithmetic", ["float", "rational"])
def test_probabilities_and_costs_are_those_of_linear_programs(arithmetic: str) -> None:
    assert len(cases()) == 200
    for each in cases():
        reached = planned(each, arithmetic=arithmetic).reached
        assert reached is not None
        assert reached.probability == pytest.approx(each.probability[0], abs=1e-9), each.seed
        assert reached.cost == pytest.approx(each.cost[0], abs=1e-9, rel=1e-9), each.seed
        assert max(reached.probability_error, reached.cost_error / max(1, reached.cost)) <= 1e-10


def test_random_problems_have_dead_ends_and_end_components() -> None:
    found = Counter[str]()
    for each in cases():
        chances, free = each.probability, lossless(each.model, each.probability)
        dead = [s for s, goal in enumerate(each.model.goal) if not goal and chances[s] < 1e-9]
        hopeful = [choice for choice in each.model.choices if chances[choice.state] > 1e-9]
        ends = end_components(hopeful)
        found["dead ends"] += bool(dead) and chances[0] > 1e-9
        found["only chance decides"] += 1e-9 < chances[0] < 1 - 1e-9
        found["some choices lose"] += len(free) < len(hopeful)
        found["end components"] += bool(ends)
        found["larger end components"] += any(len(part) > 1 for part in ends)
        found["end components without costs"] += any(
            len(part) > 1 for part in end_components([choice for choice in free if choice.cost == 0.0])
        )
        found[each.objective] += 1
    assert min(found.values()) >= 15, found


def test_what_is_printed_is_what_the_closed_loop_earns() -> None:
    """Each state that the first actions of plans lead to is planned for anew, and the chain is solved."""
    met = 0
    for each in cases():
        first = planned(each, "prada+").reached
        assert first is not None
        probability, cost = _earned(each)
        assert probability == pytest.approx(first.probability, abs=1e-9), each.seed
        assert cost == pytest.approx(first.cost, abs=1e-9, rel=1e-9), each.seed
        met += 1e-9 < probability < 1 - 1e-9 and cost > 1
    assert met >= 15


def _earned(each: Case) -> tuple[float, float]:
    """With which probability plans lead to the goal, and what that costs, by the interpreter's rules."""
    loaded, model = each.grounded.loaded, each.model
    agent = Agent(PLANNERS["prada+"], loaded.domain, loaded.problem, each.objective)
    choices = {(choice.state, choice.call): choice for choice in model.choices}
    number = len(model.states)
    leads, cost, left, known = np.eye(number), np.zeros(number), [0], {0}
    while left:
        state = left.pop()
        actions = agent.plan(loaded.facts(model.states[state]), Options())[0].actions
        assert bool(actions) == (not model.goal[state] and each.probability[state] > 1e-9)
        if actions:
            choice = choices[state, actions[0].key]
            cost[state] = choice.cost
            for after, chance in choice.after.items():
                leads[state, after] -= chance
            left += choice.after.keys() - known
            known |= choice.after.keys()
    there = np.linalg.solve(leads, np.column_stack([np.array(model.goal, dtype=float), cost]))
    return float(there[0, 0]), float(there[0, 1])


def test_a_plan_is_a_way_to_the_goal() -> None:
    ways = 0
    for each in cases():
        plan, model = planned(each), each.model
        at = {0: 1.0}
        for action in plan.actions:
            at = _after(model, at, action.key)
        reaches = any(model.goal[state] for state in at)
        assert reaches == (each.probability[0] > 1e-9)
        ways += len(plan.actions) > 1
    assert ways >= 40


def _after(model: Reachable, before: dict[int, float], call: Call) -> dict[int, float]:
    """The probability of each state after an action; where the goal holds the episode has ended."""
    choices = {choice.state: choice for choice in model.choices if choice.call == call}
    after: dict[int, float] = {}
    for state, mass in before.items():
        chances = choices[state].after if state in choices else {state: 1.0}
        for there, chance in chances.items():
            after[there] = after.get(there, 0.0) + mass * chance
    return after


RAG = """
domain wipes {
  types { area }
  predicates { dirt(?a - area)  torn() }
  derived { left := count ?a - area: dirt(?a) }
  actions { wipe(?a - area) [cost = 2, duration = 3 s]  rub(?a - area) [cost = 1, duration = 9 s] }
  rule wipe_it: wipe(?a) { when dirt(?a), not torn() then 0.4: not dirt(?a) 0.1: torn() 0.5: nothing }
  rule rub_it: rub(?a) { when dirt(?a), not torn() then 0.2: not dirt(?a) 0.05: torn() 0.75: nothing }
  reward { decrease(left) }
}
"""
TWO = "objects { a b - area } init { dirt(a), dirt(b) } goal { forall ?a - area: not dirt(?a) }"


@pytest.mark.parametrize(
    ("objective", "cost", "first"),
    # Either action cleans an area with a probability of 4/5 before it tears the rag, after 2 or 4 tries; 1.8
    # areas are begun.
    [("cost", 7.2, "rub"), ("time", 10.8, "wipe"), ("probability", 3.6, "wipe"), (None, 7.2, "rub")],
)
def test_an_example_by_hand(objective: str | None, cost: float, first: str) -> None:
    cheaper = RAG.replace("cost = 2", "cost = 2.5")
    task = aimed(from_text.task(cheaper, f"{TWO} horizon = unlimited"), objective)
    for planner in ("exact", "prada+"):
        plan = PLANNERS[planner](prepare(task), Options())
        assert [action.name for action in plan.actions] == [first, first]
        assert plan.horizon is None
        assert plan.reached is not None
        assert (plan.value, plan.reached.cost) == pytest.approx((0.64, cost), abs=1e-12)


def test_simulated_episodes_earn_it() -> None:
    domain, problem = from_text.checked(RAG, f"{TWO} horizon = unlimited")
    world = world_of(domain, problem)
    agent = Agent(PLANNERS["prada+"], domain, problem, "cost")
    limits = EpisodeLimits(max_actions=10_000)
    found = [episode(world, agent, number, Options(), limits) for number in range(500)]
    successes, paid = sum(each.success or False for each in found), [each.cost for each in found]
    assert stats.binomtest(successes, len(found), 0.64).pvalue > 1e-5
    assert abs(np.mean(paid) - 7.2) < stats.norm.isf(1e-5) * stats.sem(paid)


@pytest.mark.parametrize("planner", [name for name in PLANNERS if name not in ("exact", "prada+")])
def test_planners_that_need_a_horizon_name_those_that_do_not(planner: str) -> None:
    task = from_text.task(RAG, f"{TWO} horizon = unlimited")
    with pytest.raises(PlanningRefused) as refused:
        PLANNERS[planner](prepare(task), Options())
    assert f"`{planner}` plans up to a horizon" in str(refused.value)
    assert "`prada+` or `exact`" in refused.value.help


@pytest.mark.parametrize(
    ("horizon", "objective", "says"),
    [
        ("unlimited", "reward", "no end up to which a reward"),
        ("5", "cost", "not for cost alone"),
        ("5", "probability", "not for probability alone"),
    ],
)
def test_objectives_without_a_meaning_are_refused(horizon: str, objective: str, says: str) -> None:
    task = from_text.task(RAG, f"{TWO} horizon = {horizon}")
    with pytest.raises(PlanningRefused, match=says):
        aimed(task, objective)


def test_costs_are_refused_where_there_are_none() -> None:
    free = RAG.replace("cost = 2, ", "").replace("cost = 1, ", "")
    task = from_text.task(free, f"{TWO} horizon = unlimited")
    with pytest.raises(PlanningRefused, match="has a cost"):
        aimed(task, "cost")
    assert task.reaching is not None
    assert task.reaching.objective.value == "probability", "the usual one, then"


def test_a_goal_that_holds_or_is_out_of_reach_needs_no_action() -> None:
    for inside, probability in (
        ("init { torn() } goal { not dirt(a) }", 1.0),
        ("init { torn() dirt(a) } goal { not dirt(a) }", 0.0),
        ("init { dirt(a) } goal { dirt(a), not dirt(a) }", 0.0),
    ):
        task = from_text.task(RAG, f"objects {{ a - area }} {inside} horizon = unlimited")
        plan = PLANNERS["exact"](prepare(task), Options())
        assert (plan.actions, plan.value) == ((), probability)
        assert plan.reached is not None
        assert plan.reached.cost == 0


def test_too_many_states_are_refused() -> None:
    task = from_text.task(RAG, f"{TWO} horizon = unlimited")
    with pytest.raises(TooManyStatesError, match="the limit is 3"):
        PLANNERS["exact"].having(states=3)(prepare(task), Options())


def test_the_papers_areas_by_plain_iteration() -> None:
    """The shipped three areas as §4 has them, two near each other and one scattered, as long as it takes: all
    are clean in the end, so that value iteration has nothing to lose."""
    domain = shipped_domain("cleaning")
    inside = """
      objects { a1 a2 a3 - area }
      init { dirt(a1), size(a1) = small, dirt(a2), size(a2) = medium, scattered(a2)
             dirt(a3), size(a3) = small, near(a1, a3), traversal(a1, bin, a3) }
      goal { forall ?a - area: not dirt(?a) }
      horizon = unlimited
    """
    task = ground(domain, from_text.problem(domain, inside))
    actions = range(len(task.actions))
    states = [task.initial]
    choices: dict[GroundState, list[tuple[tuple[float, GroundState], ...]]] = {}
    for state in states:  # which grows
        open_ones = () if reaches_goal(task, state) else actions
        choices[state] = [successors(task, state, each) for each in open_ones]
        states += dict.fromkeys(s for each in choices[state] for _, s in each if s not in {*states})
    left = dict.fromkeys(states, 0.0)
    for _ in range(400):
        for state in states:
            left[state] = min((1 + sum(p * left[s] for p, s in each) for each in choices[state]), default=0.0)
    plan = PLANNERS["prada+"](prepare(task), Options())
    assert plan.reached is not None
    assert plan.value == 1.0
    assert plan.reached.cost == pytest.approx(left[task.initial], abs=1e-9)
    assert 2 < plan.reached.cost < 3


UPHILL = """
domain uphill {
  predicates { low()  high() }
  actions { go() [cost = 3] }
  rule from_low: go() { when low(), not high() then 0.001: high() rest: low() }
  rule from_high: go() { when high() then 0.001: not low(), not high() rest: not high(), low() }
  reward { goal }
}
"""


def test_what_nearly_always_starts_again_is_known_as_well() -> None:
    """A million times on average; steps that change little do not mean that values are near."""
    task = from_text.task(UPHILL, "init { low() } goal { not low() } horizon = unlimited")
    plan = PLANNERS["exact"].having(error=1e-6)(prepare(task), Options())
    assert plan.reached is not None
    assert plan.value == 1.0
    assert plan.reached.cost == pytest.approx(3 * (1000 + 1) * 1000, rel=1e-6)
    assert plan.reached.cost_error <= 1e-6 * plan.reached.cost


def bounds(reached: Reached | None) -> tuple[float, float]:
    assert reached is not None
    return reached.cost - reached.cost_error, reached.cost + reached.cost_error


def test_bounds_hold_what_floats_lose() -> None:
    """By fractions, which lose nothing; where success takes very many tries, each loses its share."""
    for chance in ("0.01", "0.001", "0.0001", "0.00001", "0.000001"):
        steep = from_text.task(
            UPHILL.replace("0.001", chance), "init { low() } goal { not low() } horizon = unlimited"
        )
        tries = round(1 / float(chance))
        exact = PLANNERS["exact"].having(arithmetic="rational")(prepare(steep), Options()).reached
        assert exact is not None
        assert (exact.probability, exact.cost) == (1.0, 3 * (tries + 1) * tries)
        low, high = bounds(PLANNERS["exact"].having(error=1e-6)(prepare(steep), Options()).reached)
        assert low <= exact.cost <= high
    for each in cases():
        exact, told = (planned(each, arithmetic=arithmetic).reached for arithmetic in ("rational", "float"))
        assert exact is not None
        assert told is not None
        assert abs(exact.probability - told.probability) <= told.probability_error
        assert abs(exact.cost - told.cost) <= told.cost_error
    with pytest.raises(PlanningRefused, match="not of 1e-10"):
        PLANNERS["exact"](prepare(steep), Options())


def test_fractions_by_hand() -> None:
    task = aimed(from_text.task(RAG, f"{TWO} horizon = unlimited"), "cost")
    reached = PLANNERS["exact"].having(arithmetic="rational")(prepare(task), Options()).reached
    assert reached is not None
    assert (reached.probability, reached.cost) == (0.64, 7.2)
