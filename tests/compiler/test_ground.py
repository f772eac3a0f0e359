"""Grounding: what is pruned, kept and refused; and the exact meaning of the task that comes out."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.dump import as_data, dump
from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import covering_rule, exact_value, reward, sample, successors
from cleancli.compiler.task import RewardCondition, StateVariable, Task, held, literal_text, without
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import OutcomeKind
from support import from_text
from support.shipped import shipped_domain

DECLARED = """
domain d {
  types      { area }
  predicates { dirt(?a - area) wet(?a - area) near(?a ?b - area) [symmetric] }
  functions  { size(?a - area): small < medium < big }
  derived    { dirty := count ?a - area: dirt(?a) }
  actions    { wipe(?a - area) join(?a ?b - area) dry(?a - area) }
  %s
  default { 1: nothing }
  reward { decrease(dirty) }
}
"""

RULES = """
  rule wipe: wipe(?a) {
    when dirt(?a), size(?a) < big then 0.6: not dirt(?a) 0.3: size(?a) := small 0.1: noise
  }
  rule join: join(?a, ?b) { when near(?a, ?b), dirt(?a), dirt(?b), ?a != ?b then 1: not dirt(?a) }
  rule dry: dry(?a) { when wet(?a) then 1: not wet(?a) }
"""

THREE = """objects { a b c - area }
  init { dirt(a), dirt(b), near(a, b), size(a) = small, size(b) = medium, size(c) = big }"""


def task(rules: str, problem: str) -> Task:
    return from_text.task(DECLARED % rules, problem)


def test_excluded_actions_are_left_out_with_their_rules() -> None:
    whole = task(RULES, THREE)
    left = without(whole, {("wipe", ("a",)), ("join", ("b", "a")), ("dry", ("elsewhere",))})
    names = [(action.name, action.objects) for action in whole.actions]
    kept = [(action.name, action.objects) for action in left.actions]
    assert kept == [name for name in names if name not in {("wipe", ("a",)), ("join", ("b", "a"))}]
    assert len(left.discounts) == len(kept) == len(names) - 2
    rules = {(rule.rule, names[rule.action]) for rule in whole.rules if names[rule.action] in kept}
    assert {(rule.rule, kept[rule.action]) for rule in left.rules} == rules
    assert without(whole, ()) is whole


def refused(rules: str, problem: str) -> list[str]:
    with pytest.raises(Refused) as error:
        task(rules, problem)
    return [f"{d.code} {d.message}" for d in error.value.diagnostics]


def test_only_what_can_change_becomes_a_variable() -> None:
    found = task(RULES, THREE)
    assert [(v.symbol, v.objects, v.values) for v in found.variables] == [
        ("dirt", ("a",), (False, True)),
        ("dirt", ("b",), (False, True)),
        ("size", ("b",), ("small", "medium")),
    ]
    assert [str(action) for action in found.actions] == ["join(a, b)", "join(b, a)", "wipe(a)", "wipe(b)"]
    assert found.horizon == 3
    dirty = [((0, frozenset({1})),), ((1, frozenset({1})),)]
    assert found.rewards == tuple(RewardCondition(condition, Fraction(1), Fraction(0)) for condition in dirty)
    assert held(found.counted or (), found.initial) == 2


def test_outcomes_keep_their_places_when_their_effects_vanish() -> None:
    found = task(RULES, THREE)
    wipe_a = next(rule for rule in found.rules if str(found.actions[rule.action]) == "wipe(a)")
    assert [(o.kind, len(o.effects)) for o in wipe_a.outcomes] == [
        (OutcomeKind.CHANGE, 1),
        (OutcomeKind.NOTHING, 0),
        (OutcomeKind.NOISE, 0),
    ]


def test_zero_objects_and_zero_probabilities() -> None:
    assert task(RULES, "objects { } init { }").actions == ()
    never = "rule wipe: wipe(?a) { when dirt(?a) then 0: not dirt(?a) 1: nothing }"
    assert task(never, "objects { a - area } init { dirt(a), size(a) = big }").actions == ()


def test_parameters_may_coincide_unless_the_rule_says_otherwise() -> None:
    problem = "objects { a - area } init { dirt(a), near(a, a), size(a) = big }"
    assert [str(a) for a in task(RULES.replace(", ?a != ?b", ""), problem).actions] == ["join(a, a)"]
    assert task(RULES, problem).actions == ()


def test_a_condition_that_always_holds_pays_nothing_for_its_end() -> None:
    found = task(RULES, "objects { a - area } init { dirt(a), size(a) = big } horizon = 1 + dirty")
    assert (found.rewards, held(found.counted or (), found.initial), found.horizon) == ((), 1, 2)


def test_conflicting_effects_are_refused_once_per_outcome() -> None:
    rule = "rule join: join(?a, ?b) { when dirt(?a) then 1: size(?a) := small, size(?b) := big }"
    assert refused(rule, THREE) == ["E602 for join(a, a), one outcome gives size(a) two values"]


def test_a_forall_over_what_can_change_has_a_case_for_each_answer() -> None:
    rule = "rule wipe: wipe(?a) { when dirt(?a) then 1: wet(?a), forall ?b - area: wet(?b) => not dirt(?b) }"
    two = "objects { a b - area } init { dirt(a), dirt(b), size(a) = small, size(b) = small }"
    found = task(rule, two)
    conditions = [{v: set(values) for v, values in r.condition} for r in found.rules if r.action == 0]
    assert [str(v.symbol) for v in found.variables] == ["dirt", "dirt", "wet", "wet"]
    assert sorted(conditions, key=str) == sorted(
        ({0: {1}, 2: {i}, 3: {j}} for i in range(2) for j in range(2)), key=str
    )


def test_a_forall_that_asks_for_what_it_ends_needs_no_cases() -> None:
    rule = "rule wipe: wipe(?a) { when dirt(?a) then 1: forall ?b - area: dirt(?b) => not dirt(?b) }"
    found = task(rule, THREE)
    assert [(r.condition, r.outcomes[0].effects) for r in found.rules] == [
        (((0, frozenset({1})),), ((0, 0), (1, 0))),
        (((1, frozenset({1})),), ((0, 0), (1, 0))),
    ]


def test_rules_that_cover_one_state_are_refused_with_that_state() -> None:
    domain = load_domain(Source("domain.nid", DECLARED % RULES))
    wipe = domain.rules[0]
    again = replace(wipe, name="again", condition=wipe.condition[:1])
    source = Source("p.nid", f"problem p {{ domain = d {THREE} }}")
    with pytest.raises(Refused) as error:
        ground(replace(domain, rules=(*domain.rules, again)), load_problem(source, domain))
    assert [f"{d.code} {d.message}" for d in error.value.diagnostics] == [
        "E603 rules `wipe` and `again` both cover wipe(a) where dirt(a) holds"
    ]


def test_forall_reaches_every_binding_of_its_condition() -> None:
    rule = "rule wipe: wipe(?a) { when dirt(?a) then 1: forall ?b - area: near(?a, ?b) => not dirt(?b) }"
    found = task(rule, "objects { a b c - area } init { dirt(a), dirt(b), dirt(c), near(a, b), near(c, a),"
                 " size(a) = big, size(b) = big, size(c) = big }")  # fmt: skip
    wipe_a = covering_rule(found, found.initial, 0)
    assert wipe_a is not None
    assert wipe_a.outcomes[0].effects == ((1, 0), (2, 0))


def test_successors_are_a_distribution_and_rewards_count_the_decrease() -> None:
    found = task(RULES, THREE)
    for action in range(len(found.actions)):
        assert sum(p for p, _ in successors(found, found.initial, action)) == pytest.approx(1)
    wipe_b = [str(a) for a in found.actions].index("wipe(b)")
    assert successors(found, found.initial, wipe_b) == ((0.6, (1, 0, 1)), (0.3, (1, 1, 0)), (0.1, (1, 1, 1)))
    assert reward(found, found.initial, wipe_b, (1, 0, 1)) == 1.0
    assert reward(found, found.initial, None, found.initial) == 0.0
    assert covering_rule(found, (1, 0, 1), wipe_b) is None
    assert successors(found, (1, 0, 1), wipe_b) == ((1.0, (1, 0, 1)),)
    assert exact_value(found, [wipe_b, wipe_b]) == pytest.approx(0.6 + 0.95 * 0.24)


def test_outcomes_are_drawn_as_often_as_declared() -> None:
    found = task(RULES, THREE)
    rng = np.random.default_rng(1)
    wipe_b = [str(a) for a in found.actions].index("wipe(b)")
    drawn = [sample(found, found.initial, wipe_b, rng)[0] for _ in range(5000)]
    assert stats.chisquare(np.bincount(np.array(drawn), minlength=3), [3000, 1500, 500]).pvalue > 0.01
    assert sample(found, (1, 0, 1), wipe_b, rng) == (None, (1, 0, 1))


def test_a_join_over_static_facts_does_not_try_all_tuples() -> None:
    domain = shipped_domain("cleaning")
    names = [f"a{i:03d}" for i in range(120)]
    facts = ", ".join(f"dirt({n}), size({n}) = small" for n in names) + ", near(a000, a001)"
    text = f"problem p {{ domain = cleaning objects {{ {' '.join(names)} - area }} init {{ {facts} }} }}"
    found = ground(domain, load_problem(Source("p.nid", text), domain))
    assert [str(a) for a in found.actions if a.name == "join2"] == ["join2(a000, a001)", "join2(a001, a000)"]


def test_rules_that_speak_of_different_things_overlap() -> None:
    rules = """
      rule a: wipe(?a) { when dirt(?a) then 1: not dirt(?a) }
      rule b: wipe(?a) { when not dirt(?a), wet(?a) then 1: not wet(?a) }
    """
    domain = load_domain(Source("domain.nid", DECLARED % rules))
    second = replace(domain.rules[1], condition=domain.rules[1].condition[1:])
    facts = "init { dirt(x), wet(x), size(x) = big }"
    source = Source("p.nid", f"problem p {{ domain = d objects {{ x - area }} {facts} }}")
    with pytest.raises(Refused, match="both cover wipe"):
        ground(replace(domain, rules=(domain.rules[0], second)), load_problem(source, domain))


def test_a_task_as_data_is_json_and_complete() -> None:
    data = as_data(task(RULES, THREE))
    assert json.loads(json.dumps(data)) == data
    assert data["variables"][2] == {  # type: ignore[index]
        "symbol": "size", "objects": ["b"], "values": ["small", "medium"], "initial": "medium",
    }  # fmt: skip
    assert data["rules"][0] == {  # type: ignore[index]
        "rule": 1, "action": 0, "when": ["dirt(a)", "dirt(b)"],
        "outcomes": [
            {"probability": 1.0, "kind": "change", "effects": ["not dirt(a)"], "cost": 0.0},
        ],
    }  # fmt: skip
    assert data["rewards"] == [
        {"when": [f"dirt({name})"], "decrease": 1.0, "state": 0.0} for name in ("a", "b")
    ]


def test_dump_of_a_small_task() -> None:
    assert (
        dump(task(RULES, THREE))
        == """\
horizon 3
discount 0.95
variable dirt(a): false | true = true
variable dirt(b): false | true = true
variable size(b): small | medium = medium
action join(a, b)
  rule 1 when dirt(a), dirt(b)
    1: not dirt(a)
action join(b, a)
  rule 1 when dirt(a), dirt(b)
    1: not dirt(b)
action wipe(a)
  rule 0 when dirt(a)
    0.6: not dirt(a)
    0.3: nothing
    0.1: noise
action wipe(b)
  rule 0 when dirt(b)
    0.6: not dirt(b)
    0.3: size(b) := small
    0.1: noise
reward 1 when dirt(a) ends
reward 1 when dirt(b) ends
"""
    )


def test_values_of_a_literal_stand_in_their_declared_order() -> None:
    level = StateVariable("level", ("a",), tuple(f"v{number}" for number in range(12)))
    assert literal_text(level, [9, 0, 8]) == "level(a) = v0 | v8 | v9"
    assert literal_text(level, frozenset({8, 1})) == "level(a) = v1 | v8"


def test_literals_of_numbers_are_no_truth_values() -> None:
    """0 and 1 are equal to False and True in Python, and no literals of predicates."""
    load = StateVariable("load", ("a",), (0, 1, 2))
    assert [literal_text(load, [index]) for index in range(3)] == [
        "load(a) = 0",
        "load(a) = 1",
        "load(a) = 2",
    ]
    dirt = StateVariable("dirt", ("a",), (False, True))
    assert [literal_text(dirt, [index]) for index in range(2)] == ["not dirt(a)", "dirt(a)"]
