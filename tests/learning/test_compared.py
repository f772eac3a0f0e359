"""Rules side by side: what is drawn, what says the same, and where the difference is shown."""

from __future__ import annotations

import itertools
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from cleancli.compiler.conflict import results
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, OutcomeKind, Price
from cleancli.learning.compared import compared
from cleancli.learning.drawn_states import drawn_states
from cleancli.learning.experience import Transition
from cleancli.learning.likeness import Likeness, likeness, vocabulary_differences
from cleancli.learning.variation import variation
from support.exported_ppddl import comes_to
from support.hidden_rules import TEXTS, domain_of
from support.random_domains import Generator


def drawn(domain: Domain, number: int, seed: int = 0) -> list[Transition]:
    return list(itertools.islice(drawn_states((domain,), np.random.default_rng(seed)), number))


@pytest.mark.parametrize("name", TEXTS)
def test_most_rules_are_met_by_what_is_drawn(name: str) -> None:
    domain = domain_of(name)
    rules = LiftedRules(domain)
    met: Counter[int | None] = Counter()
    for each in drawn(domain, 300):
        found = rules.covering(rules.state(each.objects, each.before), each.action, each.arguments)
        met[None if found is None else found[0]] += 1
        known = {thing.name: thing.type for thing in (*domain.constants, *each.objects)}
        assert all(known[thing] for _, objects in each.before for thing in objects)
    assert set(met) >= set(range(len(domain.rules)))
    assert met[None] < 150


def reference(one: Domain, other: Domain, each: Transition) -> float:
    """The total variation in one transition, by the state that follows each outcome, and what it pays."""
    shares: list[Counter[tuple[object, ...]]] = []
    for domain in (one, other):
        rules, share = LiftedRules(domain), Counter[tuple[object, ...]]()
        state = rules.state(each.objects, each.before)
        found = rules.covering(state, each.action, each.arguments)
        if found is None:
            share[frozenset(each.before.items()), 0, 0] = 1.0  # type: ignore[assignment]
        else:
            binding = dict(zip(rules[found[0]].variables, found[1], strict=True))
            changes = results(rules, state, *found)
            for outcome, change in zip(domain.rules[found[0]].outcomes, changes, strict=True):
                after = {**each.before, **(change if outcome.kind is OutcomeKind.CHANGE else {})}
                paid = (comes_to(price, each.before, binding) for price in (outcome.reward, outcome.cost))
                key = frozenset((k, v) for k, v in after.items() if v is not False), *paid
                share[key] += float(outcome.probability)  # type: ignore[assignment]
        shares.append(share)
    keys = shares[0].keys() | shares[1].keys()
    return sum(abs(shares[0][key] - shares[1][key]) for key in keys) / 2


def paying_nothing(domain: Domain) -> Domain:
    """The domain without what its outcomes pay, which changes no state."""
    none = Price()
    rules = (
        replace(rule, outcomes=tuple(replace(each, reward=none, cost=none) for each in rule.outcomes))
        for rule in domain.rules
    )
    return replace(domain, rules=tuple(rules))


@pytest.mark.parametrize("seed", range(6))
def test_totals_are_those_of_all_situations_and_of_the_benchmark(seed: int) -> None:
    """With the rules of another random domain over the same vocabulary."""
    one = Generator(seed).domain()
    other = replace(one, rules=tuple(replace(rule, outcomes=rule.outcomes[::-1]) for rule in one.rules[1:]))
    states = drawn(one, 80, seed)
    found = compared(one, other, states)
    slow = [reference(one, other, each) for each in states]
    assert found.states + found.unclear == len(states)
    assert found.variation == pytest.approx(sum(slow) / len(slow))
    free = compared(paying_nothing(one), paying_nothing(other), states)
    assert found.variation >= free.variation == pytest.approx(variation(one, other, states))
    for pair in found.pairs:
        if pair.witness is not None:
            smaller = pair.witness.transition
            assert reference(one, other, smaller) >= pair.witness.distance - 1e-9
            assert pair.witness.distance <= max(slow) + 1e-9
            assert pair.first is None or one.rules[pair.first].action == smaller.action


def test_a_domain_compared_with_itself_says_the_same() -> None:
    for name in TEXTS:
        domain = domain_of(name)
        found = compared(domain, domain, drawn(domain, 100))
        assert [(pair.first, pair.second) for pair in found.pairs] == [
            (n, n) for n in range(len(domain.rules))
        ]
        assert {pair.likeness for pair in found.pairs} == {Likeness.SAME}
        assert found.variation == 0
        assert not any(pair.witness for pair in found.pairs)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("unlock: unlock(?d)", "open_it: unlock(?d)", Likeness.SAME),
        ("when not jammed(?d), not open(?d)", "when not open(?d), not jammed(?d)", Likeness.SAME),
        ("with ?k - key: held(?k), fits(?k, ?d)", "with ?k - key: fits(?k, ?d), held(?k)", Likeness.SAME),
        ("bent(?k), not held(?k)", "not held(?k), bent(?k)", Likeness.SAME),
        ("0.2: bent(?k)", "0.25: bent(?k)", Likeness.PROBABILITIES),
        ("0.2: bent(?k)", "0.2: bent(?k), reward -= 2", Likeness.OTHER),
        ("0.2: bent(?k)", "0.2: bent(?k), cost += 2", Likeness.OTHER),
        ("bent(?k), not held(?k)", "bent(?k)", Likeness.OTHER),
        ("when not jammed(?d), not open(?d)", "when not open(?d)", Likeness.OTHER),
        ("with ?k - key: held(?k), fits(?k, ?d)", "with ?k - key: held(?k)", Likeness.OTHER),
    ],
)
def test_texts_that_say_the_same_in_other_words(old: str, new: str, expected: Likeness) -> None:
    first, end = TEXTS["locks"].index("  rule unlock"), TEXTS["locks"].index("  rule grab")
    text = TEXTS["locks"][first:end].replace(old, new)
    if expected is Likeness.PROBABILITIES:
        text = text.replace("0.1: nothing", "rest: nothing")
    for name in ("?d", "?k") if expected is Likeness.SAME else ():
        text = text.replace(name, f"?other_{name[1:]}")
    one = domain_of("locks")
    other = load_domain(Source("other.nid", TEXTS["locks"][:first] + text + TEXTS["locks"][end:]))
    assert likeness(one, one.rules[0], other, other.rules[0]) is expected
    assert vocabulary_differences(one, other) == []


def test_a_symmetric_symbol_may_be_written_either_way() -> None:
    one = domain_of("weather")
    other = load_domain(Source("other.nid", TEXTS["weather"].replace("beside(?f, ?t)", "beside(?t, ?f)")))
    assert one != other
    carry = [next(rule for rule in domain.rules if rule.name == "carry") for domain in (one, other)]
    assert likeness(one, carry[0], other, carry[1]) is Likeness.SAME


def test_the_witness_has_what_it_takes_and_nothing_else() -> None:
    one = domain_of("locks")
    other = replace(one, rules=tuple(rule for rule in one.rules if rule.name != "slam_jammed"))
    (pair,) = (pair for pair in compared(one, other, drawn(one, 200)).pairs if pair.witness)
    assert pair.witness is not None
    transition = pair.witness.transition
    assert transition.action == "slam"
    assert dict(transition.before) == {("jammed", transition.arguments): True}
    assert [thing.name for thing in transition.objects] == list(transition.arguments)
    assert pair.witness.distance == pytest.approx(0.3)


def test_a_vocabulary_without_actions_has_no_situations() -> None:
    assert drawn(replace(domain_of("locks"), actions=(), rules=()), 5) == []
