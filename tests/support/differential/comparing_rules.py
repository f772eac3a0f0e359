"""Compares what `compare-rules` says of a domain and of one that pays something else for an outcome."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from random import Random

from support.differential import product
from support.differential.abstract import Domain, Key, Outcome, Price, Value
from support.differential.comparison import Comparison
from support.differential.interpreter import Call, Meaning, State
from support.differential.product import Loaded
from support.differential.worth import Worth

ASKED = 30
"""States and actions in which the two domains are compared."""

Paid = tuple[frozenset[tuple[Key, Value]], Fraction, Fraction]
"""What an outcome changes, and what it pays and costs beside."""


def compare_rules(
    comparison: Comparison, loaded: Loaded, worth: Worth, states: tuple[State, ...], random: Random
) -> None:
    """How far from each other the domains are, rule by rule, where some outcome pays by functions: the second
    one is in other words, and counts one function twice as much."""
    places = list(priced_outcomes(worth.meaning.domain))
    if not places or not worth.calls:
        return
    changed = random.choice(places)
    domain = paying_twice(worth.meaning.domain, *changed)
    other = product.respelt(domain, comparison.seed)
    if other is None:  # two of its outcomes pay the same now
        return
    asked = [(random.choice(states), random.choice(worth.calls)) for _ in range(ASKED)]
    both = worth.meaning, Meaning(domain, worth.meaning.problem)
    totals, numbers = dict[tuple[str | None, str | None], float](), Counter[tuple[str | None, str | None]]()
    for state, call in asked:
        (one, first), (two, second) = (foretold(meaning, call, state) for meaning in both)
        numbers[one, two] += 1
        totals[one, two] = totals.get((one, two), 0.0) + variation(first, second)
    for pair in product.rules_compared(loaded, other, asked):
        key = pair.first, pair.second
        comparison.same("compare-rules: states", numbers[key], pair.states, str(key))
        comparison.same("compare-rules: variation", totals.get(key, 0.0), pair.total, str(key))
        if pair.first is not None and pair.first == pair.second:
            wanted = "other" if pair.first == domain.rules[changed[0]].name else "same"
            comparison.same("compare-rules: text", wanted, pair.likeness, str(key))


def priced_outcomes(domain: Domain) -> Iterator[tuple[int, int]]:
    """The rules and outcomes of which some function, which counts, says what is paid."""
    for number, rule in enumerate(domain.rules):
        for place, outcome in enumerate(rule.outcomes):
            if outcome.probability and any(outcome.reward.parts + outcome.cost.parts):
                yield number, place


def paying_twice(domain: Domain, number: int, place: int) -> Domain:
    """The domain, in one file, with a function that counts twice as much in what an outcome pays."""
    rule = domain.rules[number]
    outcomes = list(rule.outcomes)
    outcomes[place] = dearer(outcomes[place])
    rules = list(domain.rules)
    rules[number] = replace(rule, outcomes=tuple(outcomes))
    return replace(domain, rules=tuple(rules), included=0)


def dearer(outcome: Outcome) -> Outcome:
    if outcome.reward.parts:
        return replace(outcome, reward=doubled(outcome.reward))
    return replace(outcome, cost=doubled(outcome.cost))


def doubled(price: Price) -> Price:
    return replace(price, parts=(price.parts[0], *price.parts))


def foretold(meaning: Meaning, call: Call, state: State) -> tuple[str | None, dict[Paid, Fraction]]:
    """The rule that covers an action, and how likely what changes and is paid by it."""
    covering = meaning.covering(call, state)
    if covering is None:
        return None, {(frozenset(), Fraction(0), Fraction(0)): Fraction(1)}
    rule, binding = covering
    likely: dict[Paid, Fraction] = {}
    for outcome in rule.outcomes:
        changes = frozenset(
            (key, value)
            for key, value in meaning.changes(outcome, binding, state).items()
            if value != state[meaning.place[key]]
        )
        reward, cost = (meaning.price(each, state, binding) for each in (outcome.reward, outcome.cost))
        paid = changes, reward, cost
        likely[paid] = likely.get(paid, Fraction(0)) + outcome.probability
    return rule.name, likely


def variation(one: dict[Paid, Fraction], other: dict[Paid, Fraction]) -> float:
    """Half of what the probabilities differ by in all (total variation)."""
    zero = Fraction(0)
    apart = sum((abs(one.get(key, zero) - other.get(key, zero)) for key in one.keys() | other.keys()), zero)
    return float(apart / 2)
