"""How the probabilities of a rule are shared out when some are fixed and some are another rule's too.

Guaranteed by the checker: the outcomes of a rule sum to 1, and at most one says `rest`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from cleancli.language.model import Domain, Outcome, Parameter
from cleancli.learning.estimate import Estimator
from cleancli.learning.match import outcomes_of

DIGITS = 4
"""Decimals of a learned probability in the text."""

_UNIT = 10**DIGITS

Seen = Mapping[int | None, tuple[int, ...]]
"""Examples per outcome, of each rule by its index and of the default rule by None."""


def learn_parameters(domain: Domain, seen: Seen, estimator: Estimator, m: float) -> dict[str, Fraction]:
    """The shared parameters' new values: each from the examples of all outcomes that use it, together.

    One that is fixed, that no example concerns, or that a rule could not make up for stays as it is; and none
    is so large that its rules' probabilities would go above 1.
    """
    groups = [outcomes_of(domain, rule) for rule in seen]
    stuck = {o.parameter for outcomes in groups if not any(map(_is_free, outcomes)) for o in outcomes}
    values = {
        parameter.name: parameter.probability
        if parameter.fixed or parameter.name in stuck
        else _learned(parameter, list(_uses(domain, seen, parameter.name)), estimator, m)
        for parameter in domain.parameters
    }
    for outcomes in groups:
        _limit(outcomes, values)
    return values


def _learned(
    parameter: Parameter, uses: Sequence[tuple[int, int]], estimator: Estimator, m: float
) -> Fraction:
    """What its `uses` estimate of a parameter, in units of the text; what it was without examples."""
    examples = sum(total for _, total in uses)
    if not examples:
        return parameter.probability
    prior = parameter.probability if parameter.prior is None else parameter.prior
    estimate = estimator(sum(count for count, _ in uses), examples, float(prior), m)
    return Fraction(round(estimate * _UNIT), _UNIT)


def _is_free(outcome: Outcome) -> bool:
    return outcome.parameter is None and not outcome.fixed


def _uses(domain: Domain, seen: Seen, parameter: str) -> Iterator[tuple[int, int]]:
    """Times seen and examples of the rule, for each outcome with this parameter."""
    for rule, counts in seen.items():
        for outcome, count in zip(outcomes_of(domain, rule), counts, strict=True):
            if outcome.parameter == parameter:
                yield count, sum(counts)


def _limit(outcomes: Sequence[Outcome], values: dict[str, Fraction]) -> None:
    """Lower the learned parameters of a rule that ask for more than what is fixed leaves them."""
    names = [o.parameter for o in outcomes if o.parameter is not None]
    learned = [o.parameter for o in outcomes if o.parameter is not None and not o.fixed]
    fixed = sum((o.probability for o in outcomes if o.fixed), start=Fraction(0))
    asked = sum((values[name] for name in learned), start=Fraction(0))
    if names and asked > 0 and asked + fixed > 1:
        factor = (1 - fixed) / asked
        for name in set(learned):
            values[name] = Fraction(math.floor(values[name] * factor * _UNIT), _UNIT)


def probabilities_of(
    outcomes: Sequence[Outcome], estimates: Sequence[float], shared: Mapping[str, Fraction]
) -> tuple[Fraction, ...]:
    """The outcomes' new probabilities, which sum to exactly 1.

    Fixed outcomes keep theirs and parameters have their own; the other outcomes share what is left in
    proportion to their estimates, but where nothing is fixed a `rest` makes up for the parameters alone.
    """
    held = [_held(outcome, shared) for outcome in outcomes]
    left = 1 - sum((value for value in held if value is not None), start=Fraction(0))
    free = [index for index, value in enumerate(held) if value is None]
    wanted = _wanted(outcomes, {index: estimates[index] for index in free}, float(left))
    parts = dict(zip(wanted, _rounded(tuple(wanted.values()), left), strict=True))
    return tuple(parts[index] if value is None else value for index, value in enumerate(held))


def _held(outcome: Outcome, shared: Mapping[str, Fraction]) -> Fraction | None:
    """The probability that an outcome has whatever the others get; None where it has none."""
    if outcome.parameter is not None:
        return shared[outcome.parameter]
    return outcome.probability if outcome.fixed else None


def _wanted(outcomes: Sequence[Outcome], estimates: Mapping[int, float], left: float) -> dict[int, float]:
    """By their numbers, what the outcomes with these estimates are to get of what is left."""
    stated = {index: estimate for index, estimate in estimates.items() if not outcomes[index].is_rest}
    surplus = left - sum(stated.values())
    if len(stated) < len(estimates) and surplus >= 0 and not any(o.fixed for o in outcomes):
        (rest,) = estimates.keys() - stated.keys()
        return {**stated, rest: surplus}
    total = sum(estimates.values())
    if total <= 0:
        return {index: left / len(estimates) for index in estimates}
    return {index: estimate * (left / total) for index, estimate in estimates.items()}


def _rounded(estimates: Sequence[float], total: Fraction) -> tuple[Fraction, ...]:
    """The estimates in units of 10^-DIGITS (largest remainders are rounded up), summing to exactly `total`.

    Where the total is no multiple of the unit, the largest takes what the units leave.
    """
    if not estimates:
        return ()
    scaled = [estimate * _UNIT for estimate in estimates]
    floors = [max(0, math.floor(value)) for value in scaled]
    by_remainder = sorted(range(len(scaled)), key=lambda index: (floors[index] - scaled[index], index))
    missing = math.floor(total * _UNIT) - sum(floors)
    for index in by_remainder[: max(0, missing)]:
        floors[index] += 1
    values = [Fraction(value, _UNIT) for value in floors]
    largest = max(range(len(values)), key=lambda index: values[index])
    values[largest] += total - sum(values, start=Fraction(0))
    return tuple(values)
