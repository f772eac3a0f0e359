"""From transitions to better probabilities, and from those to edits of the text they came from (§5.1)."""

from __future__ import annotations

import functools
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.model import Domain, Outcome, Parameter
from cleancli.language.printing.printer import print_fraction
from cleancli.learning.estimate import DEFAULT_M, Estimator, decreasing_m_estimate
from cleancli.learning.experience import Transition
from cleancli.learning.match import Match, matched, outcomes_of, prior_probabilities
from cleancli.learning.share import learn_parameters, probabilities_of

KEPT = 4096
"""Transitions whose explanation is kept."""


@dataclass(frozen=True, slots=True)
class Learned:
    """New probabilities of one rule (None: the default rule), one per outcome; they sum to exactly 1.

    `seen` counts the examples per outcome; `unexplained` those that fit none, in a rule without noise.
    """

    rule: int | None
    priors: tuple[Fraction, ...]
    probabilities: tuple[Fraction, ...]
    seen: tuple[int, ...]
    unexplained: int


def learn(
    domain: Domain,
    transitions: Iterable[Transition],
    estimator: Estimator = decreasing_m_estimate,
    m: float = DEFAULT_M,
) -> tuple[Learned, ...]:
    """Estimates for every rule that the transitions give an example of, or whose parameter they change.

    In the domain's order, the default rule last. Raises `Refused` (E602).
    """
    # What happened often is explained once.
    explained = functools.lru_cache(maxsize=KEPT)(functools.partial(matched, domain))
    counts = Counter(map(explained, transitions))
    seen = {rule: _seen(counts, rule, len(outcomes_of(domain, rule))) for rule in _rules(domain)}
    shared = learn_parameters(domain, seen, estimator, m)
    changed = {p.name for p in domain.parameters if shared[p.name] != p.probability}
    covered = {explanation.rule for explanation in counts}
    learned = []
    for rule in _rules(domain):
        outcomes = outcomes_of(domain, rule)
        if rule in covered or any(outcome.parameter in changed for outcome in outcomes):
            priors = prior_probabilities(outcomes)
            total = sum(seen[rule])
            estimates = [
                estimator(count, total, float(prior), m)
                for count, prior in zip(seen[rule], priors, strict=True)
            ]
            probabilities = probabilities_of(outcomes, estimates, shared)
            unexplained = sum(n for e, n in counts.items() if e.rule == rule and e.outcome is None)
            learned.append(Learned(rule, priors, probabilities, seen[rule], unexplained))
    return tuple(learned)


def _rules(domain: Domain) -> tuple[int | None, ...]:
    return (*range(len(domain.rules)), None)


def _seen(counts: Counter[Match], rule: int | None, outcomes: int) -> tuple[int, ...]:
    return tuple(counts[Match(rule, index)] for index in range(outcomes))


def edits(domain: Domain, sources: Iterable[Source], learned: Sequence[Learned]) -> tuple[Edit, ...]:
    """The text edits that put the estimates in: numbers and their `[prior p, seen n]`, nothing else.

    `sources` are the texts of the domain, those that it includes too; each edit's span names its own. The
    prior stays in the text, so learning again from the same experience changes nothing. `rest` stays too: it
    is what the other outcomes leave. What is fixed is left alone; a parameter changes where it is declared.
    The default rule of a domain that writes none has no text to change.
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
        own = outcome.parameter is None and not outcome.is_rest and not outcome.fixed
        if concerned and own and is_written(outcome):
            yield from _edits_of(outcome, texts, probability, seen)


def _pooled(domain: Domain, learned: Iterable[Learned]) -> dict[str, tuple[Fraction, int]]:
    """For each parameter that rules use its probability, and how often its outcomes were seen in all."""
    pooled: dict[str, tuple[Fraction, int]] = {}
    for estimate in learned:
        outcomes = outcomes_of(domain, estimate.rule)
        for outcome, probability, seen in zip(outcomes, estimate.probabilities, estimate.seen, strict=True):
            if outcome.parameter is not None:
                _, before = pooled.get(outcome.parameter, (probability, 0))
                pooled[outcome.parameter] = probability, before + seen
    return pooled


def is_written(stated: Outcome | Parameter) -> bool:
    """Whether a text says the probability; that of a default rule that is left out stands nowhere."""
    return stated.probability_span is not None


def _edits_of(
    stated: Outcome | Parameter, texts: Mapping[str, str], probability: Fraction, seen: int
) -> list[Edit]:
    number, weight = stated.probability_span, stated.weight_span
    assert number is not None, "a domain read from text knows its places"
    assert weight is not None
    text = texts[number.path]
    old = text[number.start : number.end]
    new = _decimal(probability)
    if stated.seen is None:
        return _first_edits(stated, number, weight, text, new, f"prior {old}, seen {seen}")
    result = [] if probability == stated.probability else [Edit(number, new)]
    if seen != stated.seen:
        result.append(Edit(_seen_span(text, weight), str(seen)))
    return result


def _first_edits(
    stated: Outcome | Parameter, number: Span, weight: Span, text: str, new: str, marks: str
) -> list[Edit]:
    """Add the marks; beside a `prior` that stands there already, only what was seen."""
    if stated.prior is None:
        return [Edit(number, f"{new} [{marks}]")]
    close = Span(weight.path, weight.end - 1, weight.end)
    return [Edit(number, new), Edit(close, f", {marks.partition(', ')[2]}{text[close.start : close.end]}")]


def _seen_span(text: str, weight: Span) -> Span:
    """The digits after `seen` inside an outcome's weight."""
    found = re.search(r"\bseen\s+(\d+(?:\.\d+)?)", text[weight.start : weight.end])
    assert found is not None, "the parser has found it there before"
    return Span(weight.path, weight.start + found.start(1), weight.start + found.end(1))


def _decimal(probability: Fraction) -> str:
    """The shortest exact decimal, with at least one digit after the point; `n/d` where there is none."""
    text = print_fraction(probability)
    return text if "." in text or "/" in text else f"{text}.0"
