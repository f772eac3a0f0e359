"""Domains that were written as PPDDL, or for libPRADA, and converted back do what they did.

`python benchmarks/languages.py` tries all that are shipped and hundreds that are drawn.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import cleancli
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.find import find
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Price
from support import libprada_round_trips
from support.export_texts import DRIVEN, FISHING, POND, TOLL, TOUR
from support.random_domains import Generator
from support.round_trips import disagreements, drawn_problem, through_ppddl

BENCHMARKS = Path(__file__).parents[2] / "benchmarks" / "domains"


def test_the_shipped_domain_comes_back_but_for_its_reward() -> None:
    """Fewer dirty areas are paid for one by one, which a .nid cost has no form for."""
    domain = load_domain(read_source(find("cleaning", "domains")))
    problem = load_problem(read_source(find("three_areas", "problems")), domain)
    back = through_ppddl(domain, problem)
    assert back.lost == ("the reward (E917)",)
    assert len(back.domain.rules) == len(domain.rules)
    assert list(disagreements(domain, problem, back, 40, np.random.default_rng(0))) == []


@pytest.mark.parametrize("name", ["exploding", "tireworld"])
def test_domains_with_references_come_back(name: str) -> None:
    rng = np.random.default_rng(5)
    domain = load_domain(read_source(BENCHMARKS / f"{name}.nid"))
    problem = drawn_problem(domain, rng, each=3)
    back = through_ppddl(domain, problem)
    assert back.lost == ()
    assert list(disagreements(domain, problem, back, 40, rng)) == []


@pytest.mark.parametrize("seed", range(6))
def test_drawn_domains_come_back(seed: int) -> None:
    generator = Generator(seed)
    domain, problem = generator.domain(), generator.problem()
    back = through_ppddl(domain, problem)
    assert list(disagreements(domain, problem, back, 10, np.random.default_rng(seed))) == []


LAMPS = """
domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp)  broken(?l - lamp)  hot(?l - lamp) }
  actions    { press(?l - lamp) [cost = 2]  mend(?l - lamp) [cost = 5]  and(?l - lamp) }
  rule cold: press(?l) { when not lit(?l), not hot(?l)  then 0.9: lit(?l)  0.1: broken(?l), cost += 1 }
  rule hot:  press(?m) { when not lit(?m), hot(?m)
                         then 0.5: lit(?m), cost += 3  0.5: broken(?m), cost += 1 }
  rule mend: mend(?l)  { when broken(?l)  then 1: not broken(?l) }
  rule heat: and(?l)   { when lit(?l)  then 1: hot(?l) }
  rule cool: and(?l)   { when not lit(?l), hot(?l)  then 1: not hot(?l) }
  reward     { goal - cost }
}
"""
TWO_LAMPS = """
problem two { domain = lamps objects { a b - lamp } goal { lit(a), hot(b) } horizon = unlimited }
"""


def test_rules_of_an_action_are_one_action_again() -> None:
    """docs/commands.md: the way out writes above each schema what rule it is; costs and names stay."""
    made = cleancli.convert(LAMPS, TWO_LAMPS, to="ppddl")
    domain_text, problem_text = made.texts.values()
    back = cleancli.convert(domain_text, problem_text)
    assert not any("left out" in note for note in back.notes)
    given, found = (cleancli.load_domain(text).model for text in (LAMPS, back.domain))
    assert found.actions == given.actions
    assert {rule.name: (rule.action, rule.outcomes) for rule in found.rules} == {
        rule.name: (rule.action, rule.outcomes) for rule in given.rules
    }
    problem = load_problem(Source("two.nid", TWO_LAMPS), given)
    returned = through_ppddl(given, problem)
    assert list(disagreements(given, problem, returned, 40, np.random.default_rng(1))) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(not (hot ?l))", "(not (broken ?l))"),  # both rules may apply
        ("; rule hot of press", "; by hand"),
        ("; rule hot of press\n  (:action press--hot\n    :parameters (?m", "; rule hot of press\n"
         "  (:action press--hot\n    :parameters (?n ?m"),
    ],
)  # fmt: skip
def test_schemas_that_somebody_has_changed_stay_actions_of_their_own(old: str, new: str) -> None:
    domain_text, problem_text = cleancli.convert(LAMPS, TWO_LAMPS, to="ppddl").texts.values()
    assert old in domain_text
    back = cleancli.convert(domain_text.replace(old, new), problem_text)
    assert back.diagnostics == ()
    names = [action.name for action in cleancli.load_domain(back.domain).model.actions]
    assert names == ["press_cold", "press_hot", "mend", "and"]


def test_commands_call_actions_as_the_file_does(tmp_path: Path) -> None:
    domain_text, _ = cleancli.convert(LAMPS, TWO_LAMPS, to="ppddl").texts.values()
    names = [action.name for action in cleancli.load_domain(domain_text).model.actions]
    assert names == ["press_cold", "press_hot", "mend", "and_heat", "and_cool"]


TOLL_TWICE = "problem twice { domain = toll goal { there() } horizon = 2 }"


PAID = [(TOLL, TOLL_TWICE), (DRIVEN, TOUR + "horizon = 3 }"), (FISHING, POND)]


@pytest.mark.parametrize(("text", "goal"), PAID)
def test_what_outcomes_and_objects_cost_comes_back(text: str, goal: str) -> None:
    domain = load_domain(Source("domain.nid", text))
    problem = load_problem(Source("problem.nid", goal), domain)
    back = through_ppddl(domain, problem)
    assert back.lost == ()
    assert list(disagreements(domain, problem, back, 150, np.random.default_rng(1))) == []
    dearer = replace(
        domain, actions=tuple(replace(each, cost=each.cost + Price(Fraction(1))) for each in domain.actions)
    )
    assert "pays" in next(disagreements(dearer, problem, back, 40, np.random.default_rng(1)))


def test_who_pays_as_much_in_the_mean_for_other_outcomes_is_noticed() -> None:
    domain = load_domain(Source("domain.nid", FISHING))
    problem = load_problem(Source("problem.nid", POND), domain)
    back = through_ppddl(domain, problem)
    first, second, *others = domain.rules[0].outcomes  # of 0.5 and 0.2
    first = replace(first, reward=first.reward + Price(Fraction(1)))
    second = replace(second, reward=second.reward + Price(Fraction(-5, 2)))
    rule = replace(domain.rules[0], outcomes=(first, second, *others))
    other = replace(domain, rules=(rule, *domain.rules[1:]))
    assert "pays" in next(disagreements(other, problem, back, 300, np.random.default_rng(1)))


# ---- for libPRADA


@pytest.mark.parametrize("name", ["cleaning", "machines", "river", "tireworld"])
def test_domains_come_back_from_libprada(name: str) -> None:
    """Functions of numbers, also without arguments; objects of which nothing holds at first."""
    rng = np.random.default_rng(5)
    path = find(name, "domains") if name == "cleaning" else str(BENCHMARKS / f"{name}.nid")
    domain = load_domain(read_source(path))
    problem = drawn_problem(domain, rng)
    back = libprada_round_trips.through_libprada(domain, problem)
    assert list(libprada_round_trips.disagreements(domain, problem, back, 100, rng)) == []


def test_what_comes_back_from_libprada_otherwise_is_noticed() -> None:
    domain = load_domain(read_source(str(BENCHMARKS / "machines.nid")))
    rng = np.random.default_rng(6)
    problem = drawn_problem(domain, rng)
    back = libprada_round_trips.through_libprada(domain, problem)
    rules = [replace(rule, outcomes=rule.outcomes[::-1][:1]) for rule in domain.rules]
    ends = [replace(rule, outcomes=(replace(rule.outcomes[0], probability=Fraction(1)),)) for rule in rules]
    other = replace(domain, rules=tuple(ends))
    assert next(libprada_round_trips.disagreements(other, problem, back, 100, rng), "")
