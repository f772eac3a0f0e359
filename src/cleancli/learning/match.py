"""Matches a transition with the outcome of a rule that explains it (§5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Fluent, changeable_symbols
from cleancli.compiler.lifted_state import StateView
from cleancli.language.model import Domain, Outcome, OutcomeKind
from cleancli.learning.experience import Transition


@dataclass(frozen=True, slots=True)
class Match:
    """`rule` is the covering rule's index in the domain, None for the default rule. `outcome` is an index
    into its outcomes: the noise outcome where no other fits, None where there is no noise outcome either."""

    rule: int | None
    outcome: int | None


def matched(domain: Domain, transition: Transition) -> Match:
    """The rule that covered the state before, and its likeliest outcome that predicts the state after.

    Prediction and observation are compared on the symbols that rules can change, over the objects that the
    rule binds or changes: an area elsewhere that happens to look different explains nothing. Raises `Refused`
    (E602) where an outcome of the rule gives something two values in the state before.
    """
    before = StateView(domain, transition.objects, transition.before)
    after = StateView(domain, transition.objects, transition.after)
    rule, binding = before.covering(transition.action, transition.arguments) or (None, {})
    outcomes = outcomes_of(domain, rule)
    priors = prior_probabilities(outcomes)
    changes = [{} for _ in outcomes] if rule is None else results(domain, before, rule, binding)
    scope = {*transition.arguments, *binding.values()}.union(
        *(key[1] for change in changes for key in change)
    )
    keys = _keys_within(domain, transition, scope).union(*changes)
    fitting = [
        index
        for index, outcome in enumerate(outcomes)
        if outcome.kind is not OutcomeKind.NOISE
        and all(after.value(key) == changes[index].get(key, before.value(key)) for key in keys)
    ]
    if fitting:
        return Match(rule, max(fitting, key=lambda index: priors[index]))
    noise = [index for index, outcome in enumerate(outcomes) if outcome.kind is OutcomeKind.NOISE]
    return Match(rule, noise[0] if noise else None)


def outcomes_of(domain: Domain, rule: int | None) -> tuple[Outcome, ...]:
    """The outcomes of a rule by index, or of the default rule for None."""
    return domain.default if rule is None else domain.rules[rule].outcomes


def prior_probabilities(outcomes: Sequence[Outcome]) -> tuple[Fraction, ...]:
    """What each outcome's probability was before anything was learned; `rest` takes what the others leave."""
    stated = [
        Fraction(0) if outcome.is_rest else (outcome.probability if outcome.prior is None else outcome.prior)
        for outcome in outcomes
    ]
    left = 1 - sum(stated, start=Fraction(0))
    return tuple(left if o.is_rest else prior for o, prior in zip(outcomes, stated, strict=True))


def _keys_within(domain: Domain, transition: Transition, scope: set[str]) -> set[Fluent]:
    """What to compare: changeable symbols for objects of the scope, wherever either state says something."""
    changeable = changeable_symbols(domain)
    return {
        (fact.symbol, fact.objects)
        for fact in transition.before | transition.after
        if fact.symbol in changeable and scope.issuperset(fact.objects)
    }
