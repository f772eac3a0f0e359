"""The weight of priors that is fitted to examples, beside its likelihood as it is written."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from cleancli.compiler.fluents import Values
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Object
from cleancli.learning.experience import Transition
from cleancli.learning.learn import Learned, learn
from cleancli.learning.method import Method
from cleancli.learning.prior_weight import SPREAD, Foretold, fitted

ASKED = 10.0
Rule = tuple[Sequence[int], Sequence[float]]
"""How often each outcome was seen, and its prior."""


def foretold(seen: Sequence[int], prior: Sequence[float]) -> Foretold:
    """Of examples of which it is known which outcome they were."""
    kinds = [index for index, number in enumerate(seen) if number]
    one = np.eye(len(seen))[kinds]
    return Foretold(np.array(seen, float)[kinds], one, np.array(seen) - one, np.array(prior))


def reference(rules: Sequence[Rule], m: float) -> float:
    """The logarithm of the leave-one-out likelihood and of the density of m, example by example."""
    total = -(((math.log(m) - math.log(ASKED)) / SPREAD) ** 2) / 2
    for seen, prior in rules:
        for index, number in enumerate(seen):
            for _ in range(number):
                total += math.log((seen[index] - 1 + m * prior[index]) / (sum(seen) - 1 + m))
    return total


def drawn(seed: int) -> list[Rule]:
    """Rules of two to five outcomes, each seen up to thirty times, with priors that are right or not."""
    rng = np.random.default_rng(seed)
    rules: list[Rule] = []
    for _ in range(int(rng.integers(1, 6))):
        prior = rng.dirichlet([1.0] * int(rng.integers(2, 6)))
        truth = rng.dirichlet(rng.choice([2.0, 50.0]) * prior)
        rules.append((rng.multinomial(int(rng.integers(1, 30)), truth).tolist(), prior.tolist()))
    return rules


@pytest.mark.parametrize("seed", range(20))
def test_no_other_weight_makes_the_examples_likelier(seed: int) -> None:
    rules = drawn(seed)
    found = fitted([foretold(*rule) for rule in rules], ASKED)
    best = max(reference(rules, ASKED * math.exp(step / 10)) for step in range(-80, 81))
    assert reference(rules, found) >= best - 1e-9


def test_a_wrong_prior_weighs_little_and_a_right_one_much() -> None:
    assert fitted([foretold([1, 9], [0.8, 0.2])], ASKED) < 5
    assert fitted([foretold([40, 10], [0.8, 0.2])], ASKED) > 1.5 * ASKED


def test_what_one_rule_says_of_priors_counts_for_all() -> None:
    wrong, few = foretold([1, 19], [0.8, 0.2]), foretold([2, 1], [0.7, 0.3])
    assert fitted([wrong, few], ASKED) < fitted([few], ASKED) / 2


@pytest.mark.parametrize(
    "example",
    [
        foretold([0, 1], [0.5, 0.5]),
        Foretold(np.array([30.0]), np.ones((1, 2)), np.array([[20.0, 9.0]]), np.array([0.7, 0.3])),
        Foretold(np.array([30.0]), np.eye(2)[:1], np.array([[29.0, 0.0]]), np.array([0.0, 1.0])),
        Foretold(np.array([0.0]), np.zeros((1, 2)), np.zeros((1, 2)), np.zeros(2)),
    ],
    ids=["the only one", "any outcome may have made it", "its prior is 0", "nothing to learn"],
)
def test_an_example_that_says_nothing_of_priors_changes_nothing(example: Foretold) -> None:
    assert fitted([example], ASKED) == pytest.approx(ASKED)


def test_nothing_is_fitted_without_examples_or_where_priors_shall_not_count() -> None:
    assert fitted([], ASKED) == ASKED
    assert fitted([foretold([3, 1], [0.5, 0.5])], 0.0) == 0.0


DOORS = """domain doors {
  types { door }
  predicates { open(?d - door)  stuck(?d - door) }
  actions { push(?d - door) }
  rule pushed: push(?d) { when not open(?d), not stuck(?d) then %s }
  reward { goal }
}"""
FREE = "0.7: open(?d) 0.2: stuck(?d) 0.1: nothing"


def doors(outcomes: str) -> Domain:
    return load_domain(Source("doors.nid", DOORS % outcomes))


def pushed(opened: int, stuck: int, nothing: int) -> list[Transition]:
    door = (Object("d", "door"),)
    ends: list[Values] = [{("open", ("d",)): True}, {("stuck", ("d",)): True}, {}]
    return [
        Transition("push", ("d",), door, {}, after)
        for after, number in zip(ends, (opened, stuck, nothing), strict=True)
        for _ in range(number)
    ]


def only(domain: Domain, seen: list[Transition], method: Method) -> Learned:
    (found,) = learn(domain, seen, method).rules
    return found


@pytest.mark.parametrize("match", ["shared", "strict"])
def test_what_is_learned_is_the_m_estimate_of_that_weight(match: str) -> None:
    seen = (2, 11, 7)
    m = fitted([foretold(seen, (0.7, 0.2, 0.1))], ASKED)
    expected = [(count + m * prior) / (20 + m) for count, prior in zip(seen, (0.7, 0.2, 0.1), strict=True)]
    learned = only(doors(FREE), pushed(*seen), Method("fitted-m", match=match))
    assert [float(each) for each in learned.probabilities] == pytest.approx(expected, abs=1e-4)


def test_what_is_fixed_says_nothing_of_priors() -> None:
    """However often it happened, the others keep what their own examples make of them."""
    domain = doors("0.6: open(?d) 0.2: stuck(?d) 0.2 [fixed]: nothing")
    m = fitted([foretold([3, 9], [0.6, 0.2])], ASKED)
    estimates = [3 + m * 0.6, 9 + m * 0.2]
    for nothing in (0, 40):
        learned = only(domain, pushed(3, 9, nothing), Method("fitted-m"))
        expected = [0.8 * each / sum(estimates) for each in estimates]
        assert [float(each) for each in learned.probabilities[:2]] == pytest.approx(expected, abs=1e-4)


def test_right_rules_are_spoiled_less_than_by_any_given_weight() -> None:
    """In the mean over draws of thirty examples from the prior itself."""
    prior, rng = (0.7, 0.2, 0.1), np.random.default_rng(1)
    off = dict.fromkeys(("fitted-m", "m", "decreasing-m"), 0.0)
    for _ in range(20):
        seen = pushed(*rng.multinomial(30, prior).tolist())
        for estimator in off:
            learned = only(doors(FREE), seen, Method(estimator)).probabilities
            off[estimator] += sum(abs(float(one) - other) for one, other in zip(learned, prior, strict=True))
    assert off["fitted-m"] < off["m"] < off["decreasing-m"]
