"""Transitions that several outcomes could have made, and outcomes that are wrong about other objects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from random import Random

import pytest
from scipy.optimize import minimize

from cleancli.compiler.fluents import Values
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Object
from cleancli.learning.expectation import SLIPS_BEFORE, prior_beliefs, shares
from cleancli.learning.experience import Transition
from cleancli.learning.learn import Learned, Lesson, learn
from cleancli.learning.match import Fit, Matcher
from cleancli.learning.method import Method

TEXT = """domain tidy {
  types { box }
  predicates { dirty(?b - box)  wet(?b - box)  beside(?a ?b - box) }
  functions { size(?b - box): small < large }
  derived { left := count ?b - box: dirty(?b) }
  actions { wipe(?b - box) }
  rule wiped: wipe(?b) { when dirty(?b) then %s }
  reward { decrease(left) }
}"""
ALONE = "not dirty(?b)"
WITH_NEIGHBOURS = "not dirty(?b), forall ?o - box: beside(?b, ?o) => not dirty(?o)"
BOXES = tuple(Object(f"b{number}", "box") for number in range(1, 10))
FREE = Method("m", m=0.0)
"""Without a weight for the prior, counts alone decide."""


def tidy(outcomes: str) -> Domain:
    return load_domain(Source("tidy.nid", TEXT % outcomes))


def state(
    dirty: Sequence[int], wet: Sequence[int] = (), small: Sequence[int] = (), beside: int = 1
) -> Values:
    """Which boxes are dirty, wet and small; b1 stands beside the first `beside` others."""
    facts: dict[tuple[str, tuple[str, ...]], bool | str] = {("dirty", (f"b{n}",)): True for n in dirty}
    facts |= {("wet", (f"b{n}",)): True for n in wet}
    facts |= {("size", (box.name,)): "small" if int(box.name[1:]) in small else "large" for box in BOXES}
    return facts | {("beside", ("b1", f"b{n}")): True for n in range(2, 2 + beside)}


def wiped(before: Values, after: Values) -> Transition:
    return Transition("wipe", ("b1",), BOXES, before, after)


def only(lesson: Lesson) -> Learned:
    (found,) = lesson.rules
    return found


def test_outcomes_that_cannot_be_told_apart_share_as_they_were_expected_to() -> None:
    """Where nothing stands beside it, both make it clean, and nothing is ever learned of which it was."""
    domain = tidy(f"0.6: {WITH_NEIGHBOURS} 0.2: {ALONE} 0.2: noise")
    lonely = wiped(state([1], beside=0), state([], beside=0))
    for times in (1, 10, 1000):
        gone, alone, noise = map(float, only(learn(domain, [lonely] * times)).seen)
        assert (gone, alone, noise) == pytest.approx((0.75 * times, 0.25 * times, 0), abs=0.01)


def test_what_can_be_told_apart_decides_for_what_cannot() -> None:
    """Ten times its neighbour stayed: so most of the lonely ones were the outcome that lets neighbours be."""
    domain = tidy(f"0.6: {WITH_NEIGHBOURS} 0.2: {ALONE} 0.2: noise")
    lonely = wiped(state([1], beside=0), state([], beside=0))
    stayed = wiped(state([1, 2]), state([2]))
    gone, alone, _ = map(float, only(learn(domain, [lonely] * 10 + [stayed] * 30, FREE)).probabilities)
    assert alone > 0.95
    assert gone < 0.05


def test_an_outcome_is_judged_by_what_it_changes_beyond_what_held() -> None:
    """A small box that stays small shows nothing about the outcome that makes boxes small."""
    domain = tidy("0.5: size(?b) := small 0.5: nothing")
    stays = wiped(state([1], small=[1]), state([1], small=[1]))
    assert shares(Matcher(domain).match(stays), prior_beliefs(domain)) == pytest.approx((0.5, 0.5))
    shrinks = wiped(state([1]), state([1], small=[1]))
    assert shares(Matcher(domain).match(shrinks), prior_beliefs(domain)) == (1, 0)


def test_noise_shares_where_nothing_changed_and_takes_what_nothing_explains() -> None:
    domain = tidy(f"0.5: {ALONE} 0.3: nothing 0.2: noise")
    still = state([1])
    assert shares(Matcher(domain).match(wiped(still, still)), prior_beliefs(domain)) == pytest.approx(
        (0, 0.6, 0.4)
    )
    odd = wiped(still, state([1], wet=[1])), wiped(still, state([], small=[1]))
    for transition in odd:
        changes_what_rules_change = transition.after.get(("dirty", ("b1",))) is None
        expected = (1, 0, 0) if changes_what_rules_change else (0, 0.6, 0.4)
        # No rule changes how wet or large a box is, so that both are passed over.
        assert shares(Matcher(domain).match(transition), prior_beliefs(domain)) == pytest.approx(expected)
    domain = tidy(f"0.5: {ALONE}, wet(?b) 0.3: nothing 0.2: noise")
    assert shares(Matcher(domain).match(wiped(still, state([]))), prior_beliefs(domain)) == (0, 0, 1)


def test_an_outcome_may_slip_about_others_and_the_nearest_gets_the_credit() -> None:
    """Six of eight neighbours: the outcome that clears them all is nearer than the one that clears none."""
    domain = tidy(f"0.5: {WITH_NEIGHBOURS} 0.1: {ALONE} 0.4: noise")
    six_of_eight = wiped(state(range(1, 10), beside=8), state([8, 9], beside=8))
    match = Matcher(domain).match(six_of_eight)
    assert match.fits == (Fit(hits=6, misses=2), Fit(strays=6, quiet=2), None)
    found = learn(domain, [six_of_eight])
    assert [round(float(seen)) for seen in only(found).seen] == [1, 0, 0]
    slips, chances = SLIPS_BEFORE
    assert found.beliefs.slips.missed == pytest.approx((2 + slips) / (8 + chances), rel=1e-3)
    assert found.beliefs.slips.stray == pytest.approx(slips / chances, rel=1e-3)
    strict = only(learn(domain, [six_of_eight], Method(match="strict")))
    assert list(map(float, strict.seen)) == [0, 0, 1], "the paper's reading has a rare effect"


def test_what_becomes_of_the_own_object_decides_strictly() -> None:
    domain = tidy(f"0.5: {WITH_NEIGHBOURS} 0.5: noise")
    neighbour_alone = wiped(state([1, 2]), state([1]))
    assert shares(Matcher(domain).match(neighbour_alone), prior_beliefs(domain)) == (0, 1)


def test_slips_become_rare_where_there_are_none_and_frequent_where_there_are_many() -> None:
    domain = tidy(f"0.9: {WITH_NEIGHBOURS} 0.1: noise")
    before = state(range(1, 10), beside=8)
    exact = learn(domain, [wiped(before, state([], beside=8))] * 200)
    assert exact.beliefs.slips.missed < 0.001
    half = learn(domain, [wiped(before, state([6, 7, 8, 9], beside=8))] * 200)
    assert half.beliefs.slips.missed == pytest.approx(0.5, abs=0.01)


def test_the_order_of_transitions_changes_no_digit() -> None:
    domain = tidy(f"0.4: {WITH_NEIGHBOURS} 0.3: {ALONE} 0.1: nothing 0.2: noise")
    random = Random(3)
    before = [state([1, 2, 3], beside=random.randint(0, 2)) for _ in range(60)]
    after = [dict(each) for each in before]
    for each in after:
        for number in (1, 2, 3):
            if random.random() < 0.6:
                each.pop(("dirty", (f"b{number}",)))
    experience = [wiped(*pair) for pair in zip(before, after, strict=True)]
    first = learn(domain, experience)
    for _ in range(5):
        random.shuffle(experience)
        assert learn(domain, experience) == first


OUTCOMES = "0.3: not dirty(?b) 0.25: size(?b) := small 0.2: not dirty(?b), size(?b) := small 0.25: noise"
PRIORS = (0.3, 0.25, 0.2, 0.25)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("m", [0.5, 10.0])
def test_the_greatest_posterior_is_found(seed: int, m: float) -> None:
    """Against maximising it by a general method: eq. 4 is the mode under a Dirichlet prior of m times P0."""
    random = Random(seed)
    domain, kinds = tidy(OUTCOMES), []
    for _ in range(30):
        is_small = random.random() < 0.5
        clean, shrunk = random.random() < 0.4, random.random() < 0.5
        kinds.append((is_small, clean, is_small or shrunk))
    experience = [
        wiped(state([1], small=[1] * was), state([] if clean else [1], small=[1] * now))
        for was, clean, now in kinds
    ]
    found = only(learn(domain, experience, Method("m", m)))

    def fits(was: bool, clean: bool, now: bool) -> list[bool]:
        """Which outcomes leave the box so; noise leaves it as it was."""
        return [clean and now == was, not clean and now, clean and now, not clean and now == was]

    def badness(free: Sequence[float]) -> float:
        weights = [math.exp(value) for value in (*free, 0.0)]
        chances = [weight / sum(weights) for weight in weights]
        by_kind = [sum(p for p, fit in zip(chances, fits(*kind), strict=True) if fit) for kind in kinds]
        seen = sum(map(math.log, by_kind))
        prior = sum(m * before * math.log(p) for before, p in zip(PRIORS, chances, strict=True))
        return -seen - prior

    best = minimize(badness, [0.0, 0.0, 0.0], method="BFGS", options={"gtol": 1e-9})
    weights = [math.exp(value) for value in (*best.x, 0.0)]
    assert list(map(float, found.probabilities)) == pytest.approx(
        [w / sum(weights) for w in weights], abs=2e-4
    )
