"""Determinized tasks and their best sequences, against trying every sequence; and where they mislead."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from cleancli.compiler.lowering.state_tables import lower_process
from cleancli.compiler.semantics import covering_rule, exact_value, reward, standing, successors
from cleancli.compiler.task import Task
from cleancli.planning.kernels import state_graph
from cleancli.planning.plan import Plan
from cleancli.planning.planners.beam import best_sequence
from cleancli.planning.reductions.determinization import all_outcomes, by_chance, likeliest_outcomes
from support import from_text, small_tasks
from support.planned import planned

SWEEP = """
domain d {
  types      { area }
  predicates { dirt(?a - area) }
  derived    { dirty := count ?a - area: dirt(?a) }
  actions    { sweep() wipe(?a - area) }
  rule sweep: sweep() { when exists ?a - area: dirt(?a) then %s }
  rule wipe: wipe(?a) { when dirt(?a) then 0.9: not dirt(?a) rest: nothing }
  default { 1: nothing }
  reward  { decrease(dirty) }
}
"""


def plan(name: str, task: Task, **options: int) -> Plan:
    return planned(name, task, **options)


def sweeping(outcomes: str) -> Task:
    return from_text.task(SWEEP % outcomes, "objects { a b - area } init { dirt(a), dirt(b) } horizon = 1")


def worth(task: Task, steps: int, width: int) -> float:
    """The exact value of the sequence found for a task without chance."""
    found = best_sequence(lower_process(task), task.initial, task.discount, steps=steps, width=width)
    return exact_value(task, found)


@pytest.mark.parametrize("determinize", [likeliest_outcomes, all_outcomes])
@pytest.mark.parametrize("seed", range(8))
def test_the_best_of_all_sequences_is_found(
    seed: int, determinize: Callable[[Task], tuple[Task, tuple[int, ...]]]
) -> None:
    task = replace(small_tasks.costly_task(seed), horizon=2)
    if seed % 2:
        task = small_tasks.timed(task)
    certain, origins = determinize(task)
    assert all(o.probability == 1 for rule in certain.rules for o in rule.outcomes)
    assert [certain.discounts[i] for i in range(len(origins))] == [task.discounts[o] for o in origins]
    actions_of = range(len(certain.actions))
    every = (s for n in range(3) for s in itertools.product(actions_of, repeat=n))
    assert worth(certain, 2, 1000) == pytest.approx(max(exact_value(certain, s) for s in every))


@pytest.mark.parametrize("seed", range(8))
def test_a_narrow_beam_finds_no_more_than_a_wide_one(seed: int) -> None:
    task = replace(all_outcomes(small_tasks.costly_task(seed))[0], horizon=4)
    values = [worth(task, 4, width) for width in (1, 5, 10_000)]
    assert max(values) == values[-1]
    assert values[0] >= -1e-12


@pytest.mark.parametrize("seed", range(8))
def test_what_is_left_of_a_layer_is_as_it_was(seed: int) -> None:
    """States, what they are paid, and where choices lead, against compiler/semantics.py."""
    task = replace(all_outcomes(small_tasks.costly_task(seed))[0], horizon=4)
    process = lower_process(task)
    graph = state_graph.Enumeration(process, task.initial, 10_000)
    for _ in range(3):
        layer = graph.frontier
        assert graph.expand()
        new = np.asarray(graph.frontier)
        before, kept = graph.graph().states.copy(), new[1::2]
        graph.keep(layer, kept)
        found = graph.graph()
        assert found.states.tolist() == [*before[: layer.stop].tolist(), *before[kept].tolist()]
        for number in layer:
            state = tuple(found.states[number].tolist())
            for choice in range(found.choice_start[number], found.choice_start[number + 1]):
                after = tuple(found.states[found.edge_successor[choice]].tolist())
                assert (1.0, after) in successors(task, state, int(found.choice_action[choice]))
        for state, paid in zip(found.states, found.standing, strict=True):
            assert paid == pytest.approx(standing(task, tuple(state.tolist())))


def test_a_search_without_room_ends_with_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    task = replace(all_outcomes(small_tasks.costly_task(2))[0], horizon=4)
    whole = worth(task, 4, 10_000)
    monkeypatch.setattr(state_graph, "EDGE_LIMIT", 40)
    assert 0.0 < worth(task, 4, 10_000) <= whole


def test_the_likeliest_outcome_misleads() -> None:
    task = sweeping("0.4: forall ?m - area: dirt(?m) => not dirt(?m)  0.3: nothing  rest: noise")
    misled = plan("likeliest", task)
    assert [str(a) for a in misled.actions] == ["sweep()"]
    assert misled.value == pytest.approx(0.8, abs=0.05)
    assert misled.measure == "sampled"
    assert [str(a) for a in plan("exact", task).actions] == ["wipe(a)"]
    stuck = sweeping("0.4: forall ?m - area: dirt(?m) => not dirt(?m)  rest: nothing")
    assert [str(a) for a in plan("likeliest", stuck).actions] == ["wipe(a)"]


def test_outcomes_that_may_be_chosen_make_bold() -> None:
    task = sweeping("0.1: forall ?m - area: dirt(?m) => not dirt(?m)  rest: nothing")
    assert [str(a) for a in plan("likeliest", task).actions] == ["wipe(a)"]
    bold = plan("all-outcomes", task)
    assert [str(a) for a in bold.actions] == ["sweep()"]
    assert bold.value == pytest.approx(0.2, abs=0.03)


def test_of_equally_likely_outcomes_the_first_that_changes_something_counts() -> None:
    task = sweeping("0.5: nothing  0.5: forall ?m - area: dirt(?m) => not dirt(?m)")
    rule = task.rules[0]
    assert [o.probability for o in rule.outcomes] == [Fraction(1, 2)] * 2
    certain, _ = likeliest_outcomes(task)
    assert certain.rules[0].outcomes[0].effects == rule.outcomes[1].effects


@pytest.mark.parametrize("seed", range(8))
def test_a_sequence_that_hopes_by_chance_is_worth_what_goes_as_it_hopes(seed: int) -> None:
    """What comes after an outcome is discounted by its share of those that change something."""
    task = replace(small_tasks.costly_task(seed), horizon=3)
    certain, origins = by_chance(task)
    steps = len(certain.actions)
    assert (
        len(origins)
        == steps
        == sum(bool(o.effects and o.probability) for r in task.rules for o in r.outcomes)
    )

    def best(state: tuple[int, ...], left: int) -> float:
        found = [0.0]
        for action in range(len(task.actions) if left else 0):
            rule = covering_rule(task, state, action)
            changing = [o for o in rule.outcomes if o.effects and o.probability] if rule else []
            for outcome in changing:
                after = tuple((dict(enumerate(state)) | dict(outcome.effects)).values())
                share = float(outcome.probability / sum(o.probability for o in changing))
                found.append(share * (reward(task, state, action, after) + 0.9 * best(after, left - 1)))
        return max(found)

    assert worth(certain, 3, 1000) == pytest.approx(best(task.initial, 3))
