"""Transitions as arrays mean what the language says: the score of rules against a slow reference."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from cleancli.compiler.fluents import Values, values_of
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.model import Domain, Object, OutcomeKind
from cleancli.learning.experience import Transition
from cleancli.learning.explained import RESULTS_OF_NOISE
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.score import IMPOSSIBLE, PER_LITERAL, Score, literals_of, scored, together
from cleancli.learning.variation import foretold
from support.hidden_rules import TEXTS, domain_of, starts
from support.random_domains import Generator
from support.walks import Start, walks


def reference(domain: Domain, transition: Transition) -> tuple[float, float]:
    """How likely rules make a transition, noise with it, and how likely they foretell it."""
    rules = LiftedRules(domain)
    state = rules.state(transition.objects, transition.before)
    found = rules.covering(state, transition.action, transition.arguments)
    outcomes = domain.default if found is None else domain.rules[found[0]].outcomes
    noise = sum(float(o.probability) for o in outcomes if o.kind is OutcomeKind.NOISE)
    happened = frozenset((key, transition.after.get(key, False)) for key in transition.changed)
    said = foretold(rules, transition).get(happened, 0.0)
    modelled = said - (noise if not happened else 0.0)
    by_noise = RESULTS_OF_NOISE ** -max(len(happened), 1)
    likely = modelled + noise * by_noise
    return likely if likely > 1e-12 else IMPOSSIBLE * by_noise, said


def drawn(domain: Domain, seed: int, number: int) -> list[Transition]:
    if domain.name == "random":
        problems = [Generator(1000 * seed + each).problem() for each in range(5)]
        first: list[Start] = [(problem.objects, values_of(problem.state)) for problem in problems]
    else:
        first = starts(domain.name, np.random.default_rng(seed), 5)
    return list(itertools.islice(walks(domain, first, np.random.default_rng(seed), covered=0.9), number))


def of_seed(seed: int) -> Domain:
    return Generator(seed).domain()


@pytest.mark.parametrize("domain", [*map(domain_of, TEXTS), *map(of_seed, range(12))], ids=lambda d: d.name)
def test_scores_are_what_the_definitions_say(domain: Domain) -> None:
    """Also of rules that did not make the transitions: those of another random domain."""
    transitions = drawn(domain, 7, 120)
    other = of_seed(99) if domain.name == "random" else domain
    for rules in (domain, other):
        for name, given in compiled(rules, transitions).items():
            own = [each for each in transitions if each.action == name]
            slow = [reference(rules, each) for each in own]
            found = scored(rules, name, given)
            assert found.transitions == len(own)
            assert found.log_likelihood == pytest.approx(sum(math.log(likely) for likely, _ in slow))
            assert found.unforetold == sum(said == 0 for _, said in slow)
            assert found.variation == pytest.approx(sum(1 - said for _, said in slow) / len(own))


def test_literals_are_those_of_conditions_references_and_effects() -> None:
    numbers = {rule.name: literals_of(rule) for rule in domain_of("locks").rules}
    assert numbers == {"unlock": 2 + 2 + 1 + 2, "grab": 2 + 1, "slam_open": 2 + 1 + 2, "slam_jammed": 1 + 1}
    gust = domain_of("weather").rules[0]
    assert literals_of(gust) == 1 + (2 + 2) + 1 + (1 + 1)


def test_scores_of_actions_together() -> None:
    both = together([Score(30, -10.0, 4, 0.5, 3), Score(10, -2.0, 2, 0.1, 1)])
    assert both == Score(40, -12.0, 6, 0.4, 4)
    assert both.score == -12 - PER_LITERAL * 6
    assert together([]) == Score()


def test_a_transition_in_which_very_many_facts_changed_has_a_score() -> None:
    """Each makes it less likely, together beyond the least number that is not 0."""
    domain = domain_of("locks")
    doors = tuple(Object(f"d{number}", "door") for number in range(200))
    after: Values = {("open", (each.name,)): True for each in doors}
    transition = Transition("slam", ("d0",), doors, {}, after)
    score = scored(domain, "slam", compiled(domain, [transition])["slam"])
    expected = math.log(IMPOSSIBLE) - 200 * math.log(RESULTS_OF_NOISE)
    assert score.log_likelihood == pytest.approx(expected)
