"""What was learned as edits of the text that it was learned for (§5)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.model import Action, Domain, Outcome, Parameter
from cleancli.language.parsing.lexemes import Lexeme, LexemeKind, lexemes
from cleancli.language.printing.printer import print_fraction
from cleancli.learning.durations import LearnedDuration
from cleancli.learning.learn import Learned
from cleancli.learning.match import outcomes_of


def edits(
    domain: Domain,
    sources: Iterable[Source],
    learned: Sequence[Learned],
    durations: Iterable[LearnedDuration] = (),
) -> tuple[Edit, ...]:
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
    timed = {duration.action: duration for duration in durations}
    for action in domain.actions:
        if action.name in timed:
            result += _edits_of_duration(action, texts, timed[action.name])
    return tuple(result)


def _edits_of_duration(action: Action, texts: Mapping[str, str], learned: LearnedDuration) -> Iterator[Edit]:
    number, whole = action.duration_span, action.noted_span
    assert number is not None, "a domain read from text knows its places"
    assert whole is not None
    text = texts[number.path]
    old = text[number.start : number.end]
    new = old if learned.seconds == action.duration else f"{print_fraction(Fraction(str(learned.seconds)))} s"
    prior = {"prior": old} if action.duration_prior is None else {}
    return noted(text, number, whole, new, {**prior, "seen": print_fraction(learned.seen)})


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
    number, whole = stated.probability_span, stated.weight_span
    assert number is not None, "a domain read from text knows its places"
    assert whole is not None
    text = texts[number.path]
    old = text[number.start : number.end]
    if isinstance(stated, Outcome) and stated.is_rest:
        return noted(text, number, whole, old, {"seen": print_fraction(seen)})
    new = old if probability == stated.probability else _decimal(probability)
    prior = {"prior": old} if stated.prior is None else {}
    return noted(text, number, whole, new, {**prior, "seen": print_fraction(seen)})


def noted(text: str, number: Span, whole: Span, new: str, marks: Mapping[str, str]) -> Iterator[Edit]:
    """The edits after which a number is a new one and its marks have these values; `whole` is the place of
    the number with its marks. Comments, and marks of which nothing is said, stay."""
    if number == whole:
        listed = ", ".join(f"{word} {value}" for word, value in marks.items())
        yield Edit(number, f"{new} [{listed}]")
        return
    if new != text[number.start : number.end]:
        yield Edit(number, new)
    opening, places, closing = _marks(text, number, whole)
    for word, value in marks.items():
        if word in places:
            if text[places[word].start : places[word].end] != value:
                yield Edit(places[word], value)
        elif word == "prior":
            yield Edit(Span(whole.path, opening, opening), f"prior {value}, ")
        else:
            yield Edit(Span(whole.path, closing, closing), f", {word} {value}")


def _marks(text: str, number: Span, whole: Span) -> tuple[int, Mapping[str, Span], int]:
    """Where the marks beside a number begin, where the values of each stand, and where they end."""
    found = [each for each in lexemes(text[number.end : whole.end]) if each.kind is not LexemeKind.COMMENT]
    places: dict[str, Span] = {}
    for word, first, *rest in _parts(found):
        last = rest[-1] if rest else first
        places[word.text] = Span(whole.path, number.end + first.start, number.end + last.end)
    return number.end + found[0].end, places, number.end + found[-1].start


def _parts(found: Sequence[Lexeme]) -> Iterator[list[Lexeme]]:
    """The lexemes of each mark that has a value, between brackets and commas."""
    part: list[Lexeme] = []
    for each in found[1:]:
        if each.text not in {",", "]"}:
            part.append(each)
            continue
        if len(part) > 1:
            yield part
        part = []


def _decimal(probability: Fraction) -> str:
    """The shortest exact decimal, with at least one digit after the point; `n/d` where there is none."""
    text = print_fraction(probability)
    return text if "." in text or "/" in text else f"{text}.0"
