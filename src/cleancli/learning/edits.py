"""What was learned as edits of the text that it was learned for (§5)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.model import Domain, Outcome, Parameter
from cleancli.language.printing.printer import print_fraction
from cleancli.learning.learn import Learned
from cleancli.learning.match import outcomes_of


def edits(domain: Domain, sources: Iterable[Source], learned: Sequence[Learned]) -> tuple[Edit, ...]:
    """The text edits that put the estimates in: numbers and their `[prior p, seen n]`, nothing else.

    `sources` are the texts of the domain, those that it includes too; each edit's span names its own. The
    prior stays in the text, so learning again from the same experience changes nothing. `rest` stays too, and
    gets its count alone: it is what the other outcomes leave. What is fixed is left alone; a parameter
    changes where it is declared. The default rule of a domain that writes none has no text to change.
    """
    texts = {source.path: source.text for source in sources}
    result: list[Edit] = []
    for estimate in learned:
        result += _edits_of_rule(estimate, outcomes_of(domain, estimate.rule), texts)
    pooled = _pooled(domain, learned)
    for parameter in domain.parameters:
        if parameter.name in pooled and not parameter.fixed:
            result += _edits_of(parameter, texts, *pooled[parameter.name])
    return tuple(result)


def _edits_of_rule(
    estimate: Learned, outcomes: Sequence[Outcome], texts: Mapping[str, str]
) -> Iterator[Edit]:
    """Those of the outcomes whose numbers stand in the rule itself, and which experience concerns."""
    examined = any(estimate.seen) or estimate.unexplained > 0
    for outcome, probability, seen in zip(outcomes, estimate.probabilities, estimate.seen, strict=True):
        concerned = examined or probability != outcome.probability
        own = outcome.parameter is None and not outcome.fixed
        if concerned and own and is_written(outcome):
            yield from _edits_of(outcome, texts, probability, seen)


def _pooled(domain: Domain, learned: Iterable[Learned]) -> dict[str, tuple[Fraction, Fraction]]:
    """For each parameter that rules use its probability, and how often its outcomes were seen in all."""
    pooled: dict[str, tuple[Fraction, Fraction]] = {}
    for estimate in learned:
        outcomes = outcomes_of(domain, estimate.rule)
        for outcome, probability, seen in zip(outcomes, estimate.probabilities, estimate.seen, strict=True):
            if outcome.parameter is not None:
                _, before = pooled.get(outcome.parameter, (probability, Fraction(0)))
                pooled[outcome.parameter] = probability, before + seen
    return pooled


def is_written(stated: Outcome | Parameter) -> bool:
    """Whether a text says the probability; that of a default rule that is left out stands nowhere."""
    return stated.probability_span is not None


def _edits_of(
    stated: Outcome | Parameter, texts: Mapping[str, str], probability: Fraction, seen: Fraction
) -> Iterator[Edit]:
    number, weight = stated.probability_span, stated.weight_span
    assert number is not None, "a domain read from text knows its places"
    assert weight is not None
    text = texts[number.path]
    old, count = text[number.start : number.end], f"seen {print_fraction(seen)}"
    is_rest = isinstance(stated, Outcome) and stated.is_rest
    if stated.seen is not None:
        if probability != stated.probability and not is_rest:
            yield Edit(number, _decimal(probability))
        if seen != stated.seen:
            yield Edit(_seen_span(text, weight), print_fraction(seen))
    elif is_rest:
        yield Edit(number, f"{old} [{count}]")
    elif stated.prior is None:
        yield Edit(number, f"{_decimal(probability)} [prior {old}, {count}]")
    else:
        close = Span(weight.path, weight.end - 1, weight.end)
        yield Edit(number, _decimal(probability))
        yield Edit(close, f", {count}{text[close.start : close.end]}")


def _seen_span(text: str, weight: Span) -> Span:
    """The digits after `seen` inside an outcome's weight."""
    found = re.search(r"\bseen\s+([\d.]+)", text[weight.start : weight.end])
    assert found is not None, "the parser has found it there before"
    return Span(weight.path, weight.start + found.start(1), weight.start + found.end(1))


def _decimal(probability: Fraction) -> str:
    """The shortest exact decimal, with at least one digit after the point; `n/d` where there is none."""
    text = print_fraction(probability)
    return text if "." in text or "/" in text else f"{text}.0"
