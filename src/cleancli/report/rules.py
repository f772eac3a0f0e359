"""How the probabilities of rules changed in a series, action by action, from the journals of its episodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cleancli.language.model import Domain, Outcome
from cleancli.language.printing.printer import print_result, symbols_of
from cleancli.learning.match import outcomes_of, prior_probabilities, rule_name
from cleancli.recording.folder import refused
from cleancli.recording.journal import Acted, Failed, Learned, RuleEntry
from cleancli.report.run import Run
from cleancli.report.texts import domain_of, text_of


@dataclass(frozen=True, slots=True)
class Point:
    """What was believed of a rule after so many actions of the series. `intervals` may be missing."""

    action: int
    probabilities: tuple[float, ...]
    seen: tuple[float, ...]
    intervals: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class RuleCourse:
    """A rule over the actions of a series: what its outcomes are, their probabilities before anything was
    learned and as the domain's text says them, and what was believed after each action that changed it.
    `known_from`: after which action it counted as known, None where it does not yet."""

    name: str
    outcomes: tuple[str, ...]
    priors: tuple[float, ...]
    stated: tuple[float, ...]
    points: tuple[Point, ...]
    known_from: int | None

    @property
    def last(self) -> Point:
        """What is believed in the end."""
        return self.points[-1]


def courses(runs: Sequence[Run]) -> tuple[RuleCourse, ...]:
    """Those of all rules of which something was learned, in the domain's order, the default rule last.

    Raises Refused (E705) where the texts that went in are not as a run leaves them, or the journals tell of
    other rules.
    """
    found: dict[str | None, list[Point]] = {}
    for action, entry in _entries(runs):
        points = found.setdefault(entry.rule, [])
        point = Point(action, entry.probabilities, entry.seen, entry.intervals)
        if points and points[-1].action == action:
            points.pop()
        points.append(point)
    if not found:
        return ()
    domain = domain_of([text_of(runs[0], file) for file in runs[0].header.files[:-1]])
    known = runs[0].header.options.get("known")
    return tuple(_courses(domain, found, known if isinstance(known, int) else 0, runs[0].folder))


def actions_of(runs: Sequence[Run]) -> tuple[int, ...]:
    """How many actions there had been in all at the end of each episode."""
    ends, total = [], 0
    for run in runs:
        total += sum(isinstance(record, Acted | Failed) for record in run.records)
        ends.append(total)
    return tuple(ends)


def _entries(runs: Sequence[Run]) -> Iterator[tuple[int, RuleEntry]]:
    """What was learned, and after how many actions of all runs."""
    action = 0
    for run in runs:
        for record in run.records:
            match record:
                case Acted() | Failed():
                    action += 1
                case Learned(rules):
                    yield from ((action, entry) for entry in rules)


def _courses(
    domain: Domain, found: Mapping[str | None, list[Point]], known: int, folder: Path
) -> Iterator[RuleCourse]:
    symbols = symbols_of(domain)
    left = dict(found)
    for rule in (*range(len(domain.rules)), None):
        points = left.pop(None if rule is None else domain.rules[rule].name, [])
        if not points:
            continue
        outcomes = outcomes_of(domain, rule)
        if any(not _fits(point, len(outcomes)) for point in points):
            raise refused(folder, f"its journal tells of other outcomes of {rule_name(domain, rule)}")
        yield RuleCourse(
            rule_name(domain, rule),
            tuple(print_result(outcome, symbols) for outcome in outcomes),
            tuple(map(float, prior_probabilities(outcomes))),
            tuple(float(outcome.probability) for outcome in outcomes),
            tuple(points),
            _known_from(outcomes, points, known),
        )
    if left:
        raise refused(
            folder, f"its journal tells of rules that its domain has not: {', '.join(map(str, left))}"
        )


def _fits(point: Point, outcomes: int) -> bool:
    lengths = {len(point.probabilities), len(point.seen), len(point.intervals) or outcomes}
    return lengths == {outcomes}


def _known_from(outcomes: Sequence[Outcome], points: Sequence[Point], known: int) -> int | None:
    """After which action so many examples were seen, with those that the text has counted."""
    if sum(float(outcome.seen or 0) for outcome in outcomes if outcome.parameter is None) >= known:
        return 0
    return next((point.action for point in points if sum(point.seen) >= known), None)
