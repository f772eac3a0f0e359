"""What weights of priors are fitted to examples, beside sums worked out slowly, and what comes of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.compiler.fluents import Values
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Object
from cleancli.learning.experience import Transition, encode
from cleancli.learning.learn import Learned, learn
from cleancli.learning.method import Method
from cleancli.learning.prior_weight import AROUND, FACTORS, SPREADS, Foretold, chances_of_weights

ASKED = 10.0
Rule = tuple[Sequence[int], Sequence[float]]
"""How often each outcome was seen, and its prior."""


def foretold(seen: Sequence[int], prior: Sequence[float]) -> Foretold:
    """Of examples of which it is known which outcome they were."""
    one = np.eye(len(seen))
    return Foretold(np.array(seen, dtype=float), one, np.maximum(np.array(seen) - one, 0), np.array(prior))


def chances(*rules: Rule) -> list[list[float]]:
    """How likely each weight is, for each rule."""
    found: list[list[float]] = chances_of_weights([foretold(*rule) for rule in rules], ASKED).tolist()
    return found


def likelihood(rule: Rule, m: float) -> float:
    """Of all examples, each foretold from the others by the m-estimate (eq. 4)."""
    (seen, prior), found = rule, 1.0
    for outcome, number in enumerate(seen):
        for _ in range(number):
            found *= (seen[outcome] - 1 + m * prior[outcome]) / (sum(seen) - 1 + m)
    return found


def reference(rules: Sequence[Rule]) -> list[list[float]]:
    """The same, summed over all that the weights of all rules are drawn from, one after the other."""
    places = [math.log(factor) for factor in FACTORS.tolist()]
    found = [[0.0] * len(places) for _ in rules]
    for mean in places:
        for spread in SPREADS:
            given = [math.exp(-(((place - mean) / spread) ** 2) / 2) for place in places]
            given = [each / sum(given) for each in given]
            joint = [
                [
                    chance * likelihood(rule, ASKED * math.exp(place))
                    for chance, place in zip(given, places, strict=True)
                ]
                for rule in rules
            ]
            before = math.exp(-((mean / AROUND) ** 2) / 2)
            for index, own in enumerate(joint):
                others = math.prod(sum(each) for number, each in enumerate(joint) if number != index)
                found[index] = [
                    total + before * others * one for total, one in zip(found[index], own, strict=True)
                ]
    return [[each / sum(row) for each in row] for row in found]


def drawn(seed: int) -> list[Rule]:
    """Rules of two to five outcomes, each seen up to thirty times, with priors that are right or not."""
    rng = np.random.default_rng(seed)
    rules: list[Rule] = []
    for _ in range(int(rng.integers(1, 6))):
        prior = rng.dirichlet([1.0] * int(rng.integers(2, 6)))
        truth = rng.dirichlet(rng.choice([2.0, 50.0]) * prior)
        rules.append((rng.multinomial(int(rng.integers(0, 30)), truth).tolist(), prior.tolist()))
    return rules


@pytest.mark.parametrize("seed", range(10))
def test_chances_are_those_of_bayes(seed: int) -> None:
    rules = drawn(seed)
    for found, expected in zip(chances(*rules), reference(rules), strict=True):
        assert found == pytest.approx(expected)


def mean_weight(chances: Sequence[float]) -> float:
    """On the scale of logarithms."""
    return ASKED * math.exp(sum(c * math.log(f) for c, f in zip(chances, FACTORS.tolist(), strict=True)))


def test_a_wrong_prior_weighs_little_and_a_right_one_much() -> None:
    (wrong,), (right,) = chances(([1, 9], [0.8, 0.2])), chances(([40, 10], [0.8, 0.2]))
    assert mean_weight(wrong) < 0.5 * ASKED < 1.5 * ASKED < mean_weight(right)


def test_what_rules_say_of_priors_counts_for_one_without_examples() -> None:
    untried = ([0, 0], [0.7, 0.3])
    *_, among_wrong = chances(*[([1, 9], [0.8, 0.2])] * 4, untried)
    *_, among_right = chances(*[([40, 10], [0.8, 0.2])] * 4, untried)
    assert mean_weight(among_wrong) < 0.5 * ASKED < 2 * ASKED < mean_weight(among_right)


def test_one_wrong_prior_among_right_ones_is_given_up() -> None:
    """Although most priors proved right, twenty examples outweigh this one."""
    *_, wrong = chances(*[([80, 20], [0.8, 0.2])] * 10, ([4, 16], [0.8, 0.2]))
    assert mean_weight(wrong) < 20


@pytest.mark.parametrize(
    "rule",
    [
        foretold([0, 0], [0.5, 0.5]),
        foretold([0, 1], [0.5, 0.5]),
        foretold([5, 0], [1.0, 0.0]),
        foretold([0, 9], [1.0, 0.0]),
        Foretold(np.array([30.0]), np.ones((1, 2)), np.array([[20.0, 9.0]]), np.array([0.7, 0.3])),
        Foretold(np.array([4.0]), np.zeros((1, 2)), np.zeros((1, 2)), np.zeros(2)),
    ],
    ids=[
        "none",
        "a single one",
        "certain",
        "impossible",
        "any outcome may have made them",
        "nothing to learn",
    ],
)
def test_examples_that_nothing_foretells_say_nothing_of_priors(rule: Foretold) -> None:
    (found,), (untried,) = chances_of_weights([rule], ASKED), chances(([0], [1.0]))
    assert found.tolist() == pytest.approx(untried)
    assert mean_weight(untried) == pytest.approx(ASKED, rel=0.5)


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
def test_what_is_learned_is_the_mean_of_the_m_estimates(match: str) -> None:
    seen, prior = (2, 11, 7), (0.7, 0.2, 0.1)
    (by_factor,) = chances((seen, prior))
    learned = only(doors(FREE), pushed(*seen), Method("fitted-m", match=match))
    for probability, count, before in zip(learned.probabilities, seen, prior, strict=True):
        estimates = [(count + ASKED * factor * before) / (20 + ASKED * factor) for factor in FACTORS.tolist()]
        expected = sum(chance * each for chance, each in zip(by_factor, estimates, strict=True))
        assert float(probability) == pytest.approx(expected, abs=1e-4)


def test_outcomes_that_nothing_tells_apart_keep_their_ratio_and_count_as_one() -> None:
    """However often they happened, as if they were one: noise changes nothing here."""
    once = doors("0.3: open(?d) 0.3: stuck(?d) 0.4: nothing")
    twice = doors("0.3: open(?d) 0.3: stuck(?d) 0.3: nothing 0.1: noise")
    seen = pushed(9, 1, 30)
    whole, split = (only(domain, seen, Method("fitted-m")).probabilities for domain in (once, twice))
    assert [float(each) for each in split[:2]] == pytest.approx([float(each) for each in whole[:2]], abs=2e-4)
    assert float(split[2] / split[3]) == pytest.approx(3, abs=0.01)


def test_a_rule_with_nothing_to_learn_is_left_out() -> None:
    learned = only(doors("0.7 [fixed]: open(?d) 0.3 [fixed]: nothing"), pushed(1, 0, 5), Method("fitted-m"))
    assert [float(each) for each in learned.probabilities] == [0.7, 0.3]


def test_without_a_weight_counts_alone_decide() -> None:
    learned = only(doors(FREE), pushed(1, 1, 2), Method("fitted-m", m=0.0))
    assert [float(each) for each in learned.probabilities] == [0.25, 0.25, 0.5]


def test_right_rules_are_spoiled_less_than_by_a_given_weight() -> None:
    """In the mean over draws of thirty examples from the prior itself."""
    prior, rng = (0.7, 0.2, 0.1), np.random.default_rng(1)
    off = dict.fromkeys(("fitted-m", "m", "decreasing-m"), 0.0)
    for _ in range(20):
        seen = pushed(*rng.multinomial(30, prior).tolist())
        for estimator in off:
            learned = only(doors(FREE), seen, Method(estimator)).probabilities
            off[estimator] += sum(abs(float(one) - other) for one, other in zip(learned, prior, strict=True))
    assert off["fitted-m"] < off["m"] < off["decreasing-m"]


def test_the_file_says_how_it_was_learned_and_learning_again_changes_nothing(tmp_path: Path) -> None:
    domain, given = tmp_path / "doors.nid", tmp_path / "e.jsonl"
    domain.write_text(DOORS % FREE, encoding="utf-8")
    given.write_text("".join(f"{encode(each, {})}\n" for each in pushed(2, 11, 7)), encoding="utf-8")
    words = ["learn", str(domain), str(given), "--write"]
    assert run([*words, "--estimator", "fitted-m"]) == ExitCode.DONE
    text = domain.read_text(encoding="utf-8")
    assert "estimator = fitted_m\n" in text
    assert run(words) == ExitCode.DONE
    assert domain.read_text(encoding="utf-8") == text
