"""What happens in an episode, as lines for its journal.

What was expected of an action is worked out here, once for all readers, in the state believed at its start.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Fluent, Values, values_of
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.execution import events
from cleancli.execution.episode_state import Account, Situation
from cleancli.language.model import Domain, Fact, Object, State, Value
from cleancli.learning.expectation import likeliest_outcome, prior_beliefs
from cleancli.learning.experience import Transition
from cleancli.learning.intervals import Interval, Intervals
from cleancli.learning.learn import Learned, Lesson
from cleancli.learning.match import Matcher, outcomes_of
from cleancli.learning.share import DIGITS
from cleancli.recording import journal
from cleancli.recording.journal import (
    AreaEntry,
    Chance,
    CorrectionEntry,
    DurationEntry,
    Expected,
    FactEntry,
    RuleEntry,
    StepEntry,
)


class Entries:
    """Remembers of an episode what its next lines need; `clock()` is the robot's, `spent` what earlier lines
    tell already."""

    def __init__(self, domain: Domain, clock: Callable[[], float], spent: Account | None = None) -> None:
        self._domain, self._clock = domain, clock
        self._matcher, self._beliefs = Matcher(domain), prior_beliefs(domain)
        self._learnt: list[RuleEntry] = []
        self._timed: list[DurationEntry] = []
        self._corrected: list[CorrectionEntry] = []
        self._situation: Situation | None = None
        self._failure = ""
        self._spent = Account() if spent is None else spent

    def of(self, event: events.Event) -> Iterator[journal.Record]:
        """The lines of one event; many have none."""
        match event:
            case events.Looked(situation, _, seconds, purpose):
                self._situation = situation
                yield _looked(situation, self._clock(), seconds, purpose)
            case events.Decided():
                yield self._planned(event)
            case events.Started(number, move):
                yield journal.Started(
                    number, move.action, move.objects, self._expected(move.action, move.objects)
                )
            case events.Failed(_, _, reason):
                self._failure = reason
            case events.Acted():
                yield self._acted(event)
                self._failure = ""
            case events.Learned(lesson, domain, intervals):
                yield self._learned(lesson, domain, intervals)
            case events.Checkpoint(state):
                yield from self._spent_since(state.spent)
            case events.Ended(reason, clean, actions, spent, clock):
                yield journal.Ended(clock, reason, clean, actions, spent.by_kind())

    def _learned(self, lesson: Lesson, domain: Domain, intervals: Intervals) -> journal.Learned:
        """What is new; from now on the domain is what is believed."""
        entries = [_entry(domain, learned, intervals[learned.rule]) for learned in lesson.rules]
        durations = [DurationEntry(each.action, each.seconds, float(each.seen)) for each in lesson.durations]
        corrections = [
            CorrectionEntry(each.action, round(each.factor, 4), float(each.seen))
            for each in lesson.corrections
        ]
        told = journal.Learned(
            tuple(entry for entry in entries if entry not in self._learnt),
            tuple(entry for entry in durations if entry not in self._timed),
            tuple(entry for entry in corrections if entry not in self._corrected),
        )
        self._domain, self._learnt = domain, entries
        self._timed, self._corrected = durations, corrections
        self._beliefs = lesson.beliefs
        return told

    def _planned(self, event: events.Decided) -> journal.Planned:
        plan = event.plan
        if plan is None:
            calls = tuple((move.action, move.objects) for move in event.moves)
            steps = tuple(StepEntry(*call, Expected(None, ())) for call in calls)
            return journal.Planned("teacher" if event.is_taught else "", event.seconds, 0.0, "", None, steps)
        calls = tuple((action.name, action.objects) for action in plan.actions)
        before = event.situation
        course = course_of(self._domain, before.objects, before.state, calls, plan.results)
        return journal.Planned(plan.planner, event.seconds, plan.value, plan.measure, plan.coverage, course)

    def _expected(self, action: str, arguments: tuple[str, ...]) -> Expected:
        """Nothing, of moves that are no actions of the domain."""
        if self._situation is None or action not in {each.name for each in self._domain.actions}:
            return Expected(None, ())
        return expected(self._domain, self._situation.objects, self._situation.state, action, arguments)

    def _acted(self, event: events.Acted) -> journal.Acted | journal.Failed:
        move = event.move
        seconds = {"transits": event.transit, "actions": event.seconds}
        if self._failure:
            return journal.Failed(
                event.number, move.action, move.objects, self._clock(), seconds, self._failure
            )
        rule, outcome, changed = None, None, tuple[FactEntry, ...]()
        if event.transition is not None:
            found = self._matcher.match(event.transition)
            rule = None if found.rule is None else self._domain.rules[found.rule].name
            outcome, changed = likeliest_outcome(found, self._beliefs), _changed(event.transition)
        return journal.Acted(
            event.number, move.action, move.objects, self._clock(), seconds, rule, outcome, changed
        )

    def _spent_since(self, spent: Account) -> Iterator[journal.Spent]:
        before = self._spent.by_kind()
        seconds = {kind: now - before[kind] for kind, now in spent.by_kind().items() if now != before[kind]}
        self._spent = spent
        if seconds:
            yield journal.Spent(seconds)


def expected(
    domain: Domain, objects: Sequence[Object], state: State, action: str, arguments: tuple[str, ...]
) -> Expected:
    """What an action does in a state, by the rule that covers it or by the default rule."""
    rules = LiftedRules(domain)
    now = rules.state(tuple(objects), values_of(state))
    found = rules.covering(now, action, arguments)
    rule = None if found is None else found[0]
    outcomes = outcomes_of(domain, rule)
    changes = [{} for _ in outcomes] if found is None else results(rules, now, *found)
    chances = tuple(
        Chance(float(outcome.probability), outcome.kind.value, _entries(change))
        for outcome, change in zip(outcomes, changes, strict=True)
    )
    return Expected(None if rule is None else domain.rules[rule].name, chances)


def course_of(
    domain: Domain,
    objects: Sequence[Object],
    state: State,
    calls: Sequence[tuple[str, tuple[str, ...]]],
    results: Sequence[Values] = (),
) -> tuple[StepEntry, ...]:
    """What is expected of each action of a plan, if all before it have come to the plan's `results`; of a
    sequence, which has none, if all before it have ended as is likeliest."""
    steps, before = [], values_of(state)
    for number, (action, arguments) in enumerate(calls):
        found = expected(domain, objects, _state(before), action, arguments)
        changes = [{(e.symbol, e.objects): e.value for e in each.effects} for each in found.outcomes]
        fitting = list(range(len(changes)))
        if results:
            after = _state({**before, **results[number]})
            fitting = [index for index in fitting if _state({**before, **changes[index]}) == after]
        follows = max(fitting, key=lambda index: found.outcomes[index].probability, default=None)
        steps.append(StepEntry(action, arguments, found, follows))
        goes_on: Mapping[Fluent, Value | None] = {} if follows is None else changes[follows]
        before = values_of(_state({**before, **(results[number] if results else goes_on)}))
    return tuple(steps)


def _state(values: Mapping[Fluent, Value | None]) -> State:
    return frozenset(
        Fact(symbol, objects, value)
        for (symbol, objects), value in values.items()
        if value is not None and value is not False
    )


def _looked(situation: Situation, clock: float, seconds: float, purpose: events.Purpose) -> journal.Looked:
    areas = tuple(
        AreaEntry(
            area.name,
            area.ellipse.centre,
            area.ellipse.axes,
            area.ellipse.angle,
            area.covered,
            area.name not in situation.unseen,
        )
        for area in situation.areas
    )
    objects = {thing.name: thing.type for thing in situation.objects}
    return journal.Looked(clock, seconds, areas, objects, journal.facts(situation.state), purpose.value)


def _changed(transition: Transition) -> tuple[FactEntry, ...]:
    """The facts whose value differs from before, with the value now."""
    before, after = transition.before, transition.after
    keys = sorted(transition.changed)
    functions = {key for key in keys if not isinstance(before.get(key, after.get(key)), bool)}
    return tuple(FactEntry(*key, after.get(key, None if key in functions else False)) for key in keys)


def _entry(domain: Domain, learned: Learned, intervals: Sequence[Interval]) -> RuleEntry:
    name = None if learned.rule is None else domain.rules[learned.rule].name
    sure = tuple((round(low, DIGITS), round(high, DIGITS)) for low, high in intervals)
    return RuleEntry(name, tuple(map(float, learned.probabilities)), tuple(map(float, learned.seen)), sure)


def _entries(changes: Mapping[Fluent, Value]) -> tuple[FactEntry, ...]:
    return tuple(FactEntry(*key, value) for key, value in sorted(changes.items(), key=lambda item: item[0]))
