"""The journal of a run, told action by action: what was planned, what was expected, what happened."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from cleancli.recording.journal import (
    Acted,
    AreaEntry,
    Chance,
    Expected,
    FactEntry,
    Failed,
    Looked,
    Planned,
    Record,
    Started,
    StepEntry,
)

NOISE = "noise"


@dataclass(frozen=True, slots=True)
class Step:
    """One action. `plan`: the plan made right before it, if one was. `expected` in the state believed then;
    `outcome` counts among those, None where none of them explains what was seen. `changed`: what is believed
    otherwise since. `failure`: why the robot did not carry it out. Not `finished`: the run was cut short.
    `before`, `after`: the areas seen."""

    number: int
    action: str
    arguments: tuple[str, ...]
    plan: Planned | None
    expected: Expected
    rule: str | None
    outcome: int | None
    changed: tuple[FactEntry, ...]
    failure: str
    seconds: Mapping[str, float]
    finished: bool
    before: tuple[AreaEntry, ...]
    after: tuple[AreaEntry, ...]

    @property
    def call(self) -> str:
        """The action with its objects, as a rule file would write it."""
        return call(self.action, self.arguments)

    @property
    def chance(self) -> float | None:
        """How likely what happened was held to be; None where nothing says so."""
        outcomes = self.expected.outcomes
        if not self.finished or self.failure or not outcomes:
            return None
        if self.outcome is None:
            return sum(outcome.probability for outcome in outcomes if outcome.kind == NOISE)
        return outcomes[self.outcome].probability


def steps_of(records: Iterable[Record]) -> tuple[Step, ...]:
    """Every action that was begun, in order."""
    steps: list[Step] = []
    plan: Planned | None = None
    areas: tuple[AreaEntry, ...] = ()
    begun: Started | None = None
    before = areas
    for record in records:
        match record:
            case Looked():
                areas = record.areas
            case Planned():
                plan = record
            case Started():
                begun, before = record, areas
            case Acted() | Failed():
                steps.append(_step(record, begun, plan, before, areas))
                begun, plan = None, None
    if begun is not None:
        steps.append(_unfinished(begun, plan, before))
    return tuple(steps)


def call(action: str, arguments: Sequence[str]) -> str:
    """An action with its objects."""
    return f"{action}({', '.join(arguments)})"


def likeliest(expected: Expected) -> int | None:
    """The number of the likeliest outcome, the first of several; None where there is none."""
    outcomes = expected.outcomes
    return max(range(len(outcomes)), key=lambda number: outcomes[number].probability, default=None)


def step_text(step: StepEntry) -> str:
    """What the plan goes on from after one of its steps."""
    best = likeliest(step.expected)
    number = best if step.follows is None else step.follows
    if number is None:
        return "no rule says what it does"
    outcome = step.expected.outcomes[number]
    word = "likeliest" if number == best else "once it comes to"
    return f"{word}: {chance_text(outcome)} ({outcome.probability:z.2f})"


def chance_text(outcome: Chance) -> str:
    """What an outcome would set, as a rule file would write it."""
    if outcome.kind == NOISE:
        return "noise: anything else"
    return facts_text(outcome.effects) or "nothing changes"


def facts_text(facts: Sequence[FactEntry]) -> str:
    """Facts as a rule file would write them, with commas between."""
    return ", ".join(_fact_text(fact) for fact in facts)


def _fact_text(fact: FactEntry) -> str:
    subject = f"{fact.symbol}({', '.join(fact.objects)})" if fact.objects else fact.symbol
    if fact.value is True:
        return subject
    if fact.value is False:
        return f"not {subject}"
    return f"no {subject}" if fact.value is None else f"{subject} := {fact.value}"


_NOTHING = Expected(None, ())


def _step(
    record: Acted | Failed,
    begun: Started | None,
    plan: Planned | None,
    before: tuple[AreaEntry, ...],
    after: tuple[AreaEntry, ...],
) -> Step:
    acted = record if isinstance(record, Acted) else None
    return Step(
        number=record.number,
        action=record.action,
        arguments=record.arguments,
        plan=plan,
        expected=begun.expected if begun is not None else _NOTHING,
        rule=acted.rule if acted is not None else None,
        outcome=acted.outcome if acted is not None else None,
        changed=acted.changed if acted is not None else (),
        failure=record.reason if isinstance(record, Failed) else "",
        seconds=record.seconds,
        finished=True,
        before=before,
        after=after,
    )


def _unfinished(begun: Started, plan: Planned | None, before: tuple[AreaEntry, ...]) -> Step:
    return Step(
        number=begun.number,
        action=begun.action,
        arguments=begun.arguments,
        plan=plan,
        expected=begun.expected,
        rule=begun.expected.rule,
        outcome=None,
        changed=(),
        failure="",
        seconds={},
        finished=False,
        before=before,
        after=before,
    )
