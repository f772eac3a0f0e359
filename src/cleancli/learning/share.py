"""How the probabilities of a rule are shared out when some are fixed and some are another rule's too.

Guaranteed by the checker: the outcomes of a rule sum to 1, and at most one says `rest`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TypeVar

from cleancli.language.model import Domain, Outcome, Parameter
from cleancli.learning.estimate import Estimator
from cleancli.learning.match import outcomes_of

DIGITS = 4
"""Decimals of a learned probability in the text."""

_UNIT = 10**DIGITS

_COUNTED = 100
"""Parts of an example that counts are rounded to."""

Counts = Mapping[int | None, tuple[float, ...]]
"""Examples per outcome, of each rule by its index and of the default rule by None."""

_Number = TypeVar("_Number", float, Fraction)


# ---- shared parameters


def learn_parameters(domain: Domain, counts: Counts, estimator: Estimator, m: float) -> dict[str, float]:
    """The shared parameters' new values: each from the examples of all outcomes that use it, together.

    One that is fixed, that no example concerns, or that a rule could not make up for stays as it is; and none
    is so large that its rules' probabilities would go above 1.
    """
    groups = [outcomes_of(domain, rule) for rule in counts]
    stuck = {o.parameter for outcomes in groups if not any(map(_is_free, outcomes)) for o in outcomes}
    values = {
        parameter.name: float(parameter.probability)
        if parameter.fixed or parameter.name in stuck
        else _learned(parameter, list(_uses(domain, counts, parameter.name)), estimator, m)
        for parameter in domain.parameters
    }
    for outcomes in groups:
        _limit(outcomes, values, float, lambda value: value)
    return values


def in_units(domain: Domain, learned: Mapping[str, float]) -> dict[str, Fraction]:
    """The parameters' values as the text says them; those that nothing changed stay what they were."""
    values = {
        parameter.name: parameter.probability
        if learned[parameter.name] == float(parameter.probability)
        else Fraction(round(learned[parameter.name] * _UNIT), _UNIT)
        for parameter in domain.parameters
    }
    for outcomes in (*(rule.outcomes for rule in domain.rules), domain.default):
        _limit(outcomes, values, Fraction, lambda value: Fraction(math.floor(value * _UNIT), _UNIT))
    return values


def _learned(
    parameter: Parameter, uses: Sequence[tuple[float, float]], estimator: Estimator, m: float
) -> float:
    """What its `uses` estimate of a parameter; what it was without examples."""
    examples = sum(total for _, total in uses)
    if not examples:
        return float(parameter.probability)
    prior = parameter.probability if parameter.prior is None else parameter.prior
    return estimator(sum(count for count, _ in uses), examples, float(prior), m)


def _is_free(outcome: Outcome) -> bool:
    return outcome.parameter is None and not outcome.fixed


def _uses(domain: Domain, counts: Counts, parameter: str) -> Iterator[tuple[float, float]]:
    """Times seen and examples of the rule, for each outcome with this parameter."""
    for rule, seen in counts.items():
        for outcome, count in zip(outcomes_of(domain, rule), seen, strict=True):
            if outcome.parameter == parameter:
                yield count, sum(seen)


def _limit(
    outcomes: Sequence[Outcome],
    values: dict[str, _Number],
    exact: Callable[[Fraction], _Number],
    down: Callable[[_Number], _Number],
) -> None:
    """Lower the learned parameters of a rule that ask for more than what is fixed leaves them."""
    names = [o.parameter for o in outcomes if o.parameter is not None]
    if not names:
        return
    learned = [o.parameter for o in outcomes if o.parameter is not None and not o.fixed]
    left = exact(1 - sum((o.probability for o in outcomes if o.fixed), start=Fraction(0)))
    asked = sum((values[name] for name in learned), start=exact(Fraction(0)))
    if asked > 0 and asked > left:
        for name in set(learned):
            values[name] = down(values[name] * (left / asked))


# ---- the outcomes of a rule


def estimated(
    counts: Sequence[float], priors: Sequence[float], estimator: Estimator, m: float
) -> list[float]:
    """What the counts and the priors make of each outcome by itself."""
    total = sum(counts)
    return [estimator(count, total, prior, m) for count, prior in zip(counts, priors, strict=True)]


def shared_out(
    outcomes: Sequence[Outcome], estimates: Sequence[float], shared: Mapping[str, float]
) -> tuple[float, ...]:
    """The outcomes' new probabilities, which sum to 1.

    Fixed outcomes keep theirs and parameters have their own; the other outcomes share what is left in
    proportion to their estimates, but where nothing is fixed a `rest` makes up for the parameters alone.
    """
    held = [_held(outcome, shared) for outcome in outcomes]
    wanted = _wanted(outcomes, estimates, held, 1 - sum(float(value) for value in held if value is not None))
    return tuple(wanted[index] if value is None else float(value) for index, value in enumerate(held))


def exactly(
    outcomes: Sequence[Outcome], probabilities: Sequence[float], shared: Mapping[str, Fraction]
) -> tuple[Fraction, ...]:
    """Probabilities as the text says them: those of parameters are given, the others rounded; their sum is
    exactly 1."""
    held = [_held(outcome, shared) for outcome in outcomes]
    left = 1 - sum((Fraction(value) for value in held if value is not None), start=Fraction(0))
    free = [probabilities[index] for index, value in enumerate(held) if value is None]
    total = sum(free)
    scaled = [value * (float(left) / total) if total > 0 else float(left) / len(free) for value in free]
    parts = iter(rounded(scaled, left, _UNIT))
    return tuple(next(parts) if value is None else Fraction(value) for value in held)


def _held(outcome: Outcome, shared: Mapping[str, _Number]) -> _Number | Fraction | None:
    """The probability that an outcome has whatever the others get; None where it has none."""
    if outcome.parameter is not None:
        return shared[outcome.parameter]
    return outcome.probability if outcome.fixed else None


def _wanted(
    outcomes: Sequence[Outcome], estimates: Sequence[float], held: Sequence[object], left: float
) -> dict[int, float]:
    """By their numbers, what the outcomes that hold nothing are to get of what is left."""
    free = {index: estimates[index] for index, value in enumerate(held) if value is None}
    stated = {index: estimate for index, estimate in free.items() if not outcomes[index].is_rest}
    surplus = left - sum(stated.values())
    if len(stated) < len(free) and surplus >= 0 and not any(o.fixed for o in outcomes):
        (rest,) = free.keys() - stated.keys()
        return {**stated, rest: surplus}
    total = sum(free.values())
    if total <= 0:
        return {index: left / len(free) for index in free}
    return {index: estimate * (left / total) for index, estimate in free.items()}


def counted(number: float) -> Fraction:
    """A number of examples as the text says it: to hundredths."""
    return Fraction(round(number * _COUNTED), _COUNTED)


def counts_rounded(counts: Sequence[float]) -> tuple[Fraction, ...]:
    """Counts as the text says them, which sum to what their rounded sum is."""
    return rounded(counts, counted(sum(counts)), _COUNTED)


def rounded(values: Sequence[float], total: Fraction, units: int) -> tuple[Fraction, ...]:
    """Values as multiples of 1 / units (largest remainders are rounded up), summing to exactly `total`.

    Where the total is no multiple of the unit, the largest takes what the units leave.
    """
    if not values:
        return ()
    scaled = [value * units for value in values]
    floors = [max(0, math.floor(value)) for value in scaled]
    by_remainder = sorted(range(len(scaled)), key=lambda index: (floors[index] - scaled[index], index))
    missing = math.floor(total * units) - sum(floors)
    for index in by_remainder[: max(0, missing)]:
        floors[index] += 1
    parts = [Fraction(value, units) for value in floors]
    largest = max(range(len(parts)), key=lambda index: parts[index])
    parts[largest] += total - sum(parts, start=Fraction(0))
    return tuple(parts)
