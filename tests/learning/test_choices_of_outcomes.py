"""Several outcomes fit, or none does: which one counts, and what is noted in the text."""

from __future__ import annotations

import pytest

from cleancli.compiler.fluents import values_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.text_edit import apply_edits
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Fact, Object, State
from cleancli.learning.edits import edits
from cleancli.learning.experience import Transition
from cleancli.learning.learn import learn
from cleancli.learning.method import Method

TEXT = """domain tidy {
  types { box }
  predicates { dirty(?b - box)  wet(?b - box)  beside(?a ?b - box) }
  derived { left := count ?b - box: dirty(?b) }
  actions { wipe(?b - box) }
  rule wiped: wipe(?b) { when dirty(?b) then %s }
  reward { decrease(left) }
}"""
ALONE = "not dirty(?b)"
BOTH = "not dirty(?b), wet(?b)"
WITH_NEIGHBOURS = "not dirty(?b), forall ?o - box: beside(?b, ?o) => not dirty(?o)"
BOXES = (Object("b1", "box"), Object("b2", "box"))


def tidy(outcomes: str) -> Domain:
    return load_domain(Source("tidy.nid", TEXT % outcomes))


def state(*facts: str) -> State:
    return frozenset(Fact(name, ("b1",)) for name in facts)


def wiped(*after: str) -> Transition:
    return Transition("wipe", ("b1",), BOXES, values_of(state("dirty")), values_of(state(*after)))


@pytest.mark.parametrize(
    ("outcomes", "chosen"),
    [
        (f"0.2: {ALONE} 0.5: {WITH_NEIGHBOURS} 0.3: noise", 1),
        (f"0.5: {ALONE} 0.2: {WITH_NEIGHBOURS} 0.3: noise", 0),
        (f"0.3: {WITH_NEIGHBOURS} 0.3: {ALONE} 0.4: noise", 0),
        (f"0.6: noise 0.1: {WITH_NEIGHBOURS} 0.3: {ALONE}", 2),
        (f"0.5 [prior 0.1]: {ALONE} 0.2 [prior 0.6]: {WITH_NEIGHBOURS} 0.3 [prior 0.3]: noise", 1),
    ],
)
def test_of_outcomes_that_fit_the_likeliest_before_learning_counts_and_of_equals_the_first(
    outcomes: str, chosen: int
) -> None:
    (found,) = learn(tidy(outcomes), [wiped()], Method(match="strict")).rules
    assert [index for index, seen in enumerate(found.seen) if seen] == [chosen]


def test_without_noise_what_no_outcome_explains_counts_as_none() -> None:
    domain = tidy(f"0.6: {BOTH} 0.4: nothing")
    (found,) = learn(domain, [wiped("dirty", "wet")] * 3 + [wiped("wet")] * 2).rules
    assert (tuple(map(float, found.seen)), found.unexplained) == ((2, 0), 3)
    (found,) = learn(domain, [wiped("wet")] * 2).rules
    assert (tuple(map(float, found.seen)), found.unexplained) == ((2, 0), 0)


def learned(outcomes: str, *transitions: Transition) -> str:
    text = TEXT % outcomes
    domain = load_domain(Source("tidy.nid", text))
    return apply_edits(text, edits(domain, [Source("tidy.nid", text)], learn(domain, transitions).rules))


def test_a_rule_whose_examples_nothing_explains_is_noted_as_seen_never() -> None:
    text = learned(f"0.6: {BOTH} 0.4: nothing", wiped("dirty", "wet"))
    assert f"[prior 0.6, seen 0]: {BOTH}" in text
    assert "[prior 0.4, seen 0]: nothing" in text
    assert learned(f"0.6: {BOTH} 0.4: nothing") == TEXT % f"0.6: {BOTH} 0.4: nothing"


def test_a_prior_that_stands_there_gets_what_was_seen_beside_it() -> None:
    text = learned(f"0.6 [prior 0.5]: {ALONE} 0.4 [prior 0.5]: nothing", wiped())
    # Eq. 5 with 1 of 1 and m = 10: (1 + 5) / 11.
    assert f"0.5455 [prior 0.5, seen 1]: {ALONE}" in text
    assert "0.4545 [prior 0.5, seen 0]: nothing" in text


def test_what_was_noted_by_hand_is_completed_and_comments_in_it_stay() -> None:
    """A count without a prior: the number that stood there is the prior, and is not lost."""
    text = learned(f"0.6 [seen 3]: {ALONE} 0.4 [seen # by hand, seen 7\n 2, prior 0.4]: nothing", wiped())
    assert f"0.6364 [prior 0.6, seen 1]: {ALONE}" in text
    assert "[seen # by hand, seen 7\n 0, prior 0.4]: nothing" in text
