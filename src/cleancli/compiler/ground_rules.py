"""Ground rules from what is known of each rule of the domain: plain ones by columns, others by their cases.

Guaranteed by `Reach`: each instance can apply, and no outcome gives one key two values. What makes no
difference is left out here: literals that always hold, and effects on what never changes or is there anyway.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from cleancli.array_types import Bools, Longs
from cleancli.compiler.column_join import ColumnJoin
from cleancli.compiler.disjoint_cases import Case
from cleancli.compiler.encoding import Numbering
from cleancli.compiler.fluents import bind
from cleancli.compiler.ground_formula import Known
from cleancli.compiler.instances import Changes
from cleancli.compiler.plain_rules import PlainInstances, Vocabulary
from cleancli.compiler.prices import Prices
from cleancli.compiler.ragged import distinct, starts
from cleancli.compiler.task import GroundCondition, GroundLiteral, GroundOutcome
from cleancli.language.model import Outcome, OutcomeKind, Rule

_NEVER = -1
"""In the place of a slot: what is assigned makes no difference."""


@dataclass(frozen=True, slots=True)
class RuleGroundings:
    """A rule of the domain (its index) grounded: one of each list for each of its ground rules."""

    rule: int
    objects: Sequence[tuple[str, ...]]
    conditions: Sequence[GroundCondition]
    outcomes: Sequence[tuple[GroundOutcome, ...]]
    changes: Sequence[bool]

    def __iter__(self) -> Iterator[tuple[tuple[str, ...], GroundCondition, tuple[GroundOutcome, ...]]]:
        return zip(self.objects, self.conditions, self.outcomes, strict=True)


def from_cases(
    number: int,
    rule: Rule,
    cases: Sequence[Case],
    numbering: Numbering,
    known: Known,
    compat: bool,
    prices: Prices,
) -> RuleGroundings:
    """The ground rules of a rule that falls into cases."""
    outcomes = []
    for case in cases:
        kept = [_kept(case, changes, known, compat) for changes in case.changes]
        pairs = zip(rule.outcomes, kept, strict=True)
        outcomes.append(
            tuple(
                [
                    _outcome(each, numbering.effects(changes), prices.paid(each, case.binding))
                    for each, changes in pairs
                ]
            )
        )
    return RuleGroundings(
        rule=number,
        objects=[case.objects for case in cases],
        conditions=[numbering.condition(case.required) for case in cases],
        outcomes=outcomes,
        changes=[any(outcome.effects for outcome in several) for several in outcomes],
    )


def _kept(case: Case, changes: Changes, known: Known, compat: bool) -> Changes:
    """Without effects that assign what is there anyway. libPRADA's update takes the condition and what is set
    as independent, so there they count."""
    return {
        key: values
        for key, values in changes.items()
        if (compat or case.required.get(key) != values) and len(known(key)) > 1
    }


def _outcome(
    outcome: Outcome, effects: tuple[tuple[int, int], ...], paid: tuple[Fraction, Fraction]
) -> GroundOutcome:
    kind = outcome.kind if effects or outcome.kind is OutcomeKind.NOISE else OutcomeKind.NOTHING
    return GroundOutcome(outcome.probability, kind, effects, *paid)


class PlainWords:
    """What the literals and assignments of a vocabulary are in a task.

    A slot is a variable's value; the slots of a variable stand together.
    """

    def __init__(self, vocabulary: Vocabulary, numbering: Numbering, known: Known, compat: bool) -> None:
        first = starts(variable.values for variable in numbering.variables).tolist()
        self.pairs = [(v, i) for v, each in enumerate(numbering.variables) for i in range(len(each.values))]
        self.literals: list[GroundLiteral] = []
        variables, single, slots = [], [], []
        for key, values in vocabulary.literals.entries:
            left = values & known(key)
            asks = 0 < len(left) < len(known(key))
            literal = numbering.literal(key, left) if asks else (len(first), frozenset())
            self.literals.append(literal)
            variables.append(literal[0])
            single.append(
                first[literal[0]] + min(literal[1]) if asks and len(left) == 1 and not compat else _NEVER
            )
        for key, value in vocabulary.assignments.entries:
            changes = len(known(key)) > 1 and value in known(key)
            variable, index = numbering.assignment(key, value) if changes else (0, 0)
            slots.append(first[variable] + index if changes else _NEVER)
        self.none = len(first)
        """In the place of a variable: a literal asks for nothing."""
        self.variable: Longs = np.array([*variables, self.none], dtype=np.int64)
        self.single: Longs = np.array([*single, _NEVER], dtype=np.int64)
        """The slot of literals that leave one value, for which an assignment of it makes no difference."""
        self.slot: Longs = np.array(slots, dtype=np.int64)


def from_columns(
    plain: PlainInstances, rule: Rule, words: PlainWords, join: ColumnJoin, prices: Prices
) -> RuleGroundings:
    """The ground rules of a plain rule."""
    count = len(plain.objects)
    changes = np.zeros(count, dtype=np.bool_)
    names = [[join.names[number] for number in column] for column in plain.objects.T.tolist()]
    objects = list(zip(*names, strict=True)) if names else [()] * count
    outcomes = [
        _outcomes_of(
            outcome, rows, assigned, plain.literals, words, changes, _paid(outcome, rule, objects, prices)
        )
        for outcome, (rows, assigned) in zip(rule.outcomes, plain.assigned, strict=True)
    ]
    return RuleGroundings(
        rule=plain.rule,
        objects=objects,
        conditions=_conditions(plain.literals, words),
        outcomes=list(zip(*outcomes, strict=True)),
        changes=changes.tolist(),
    )


def _paid(
    outcome: Outcome, rule: Rule, objects: Sequence[tuple[str, ...]], prices: Prices
) -> Sequence[tuple[Fraction, Fraction]]:
    """What an outcome pays for each of some objects, as `Prices.paid` has it."""
    if not (outcome.reward.parts or outcome.cost.parts):
        return [prices.paid(outcome, {})] * len(objects)
    return [prices.paid(outcome, bind(rule, names)) for names in objects]


def _conditions(literals: Longs, words: PlainWords) -> list[GroundCondition]:
    """Those of each row, by variable, without what always holds."""
    variables = words.variable[literals]
    order = np.argsort(variables, axis=1, kind="stable")
    ordered = np.take_along_axis(literals, order, axis=1)
    lengths = (variables != words.none).sum(axis=1)
    found: list[GroundCondition] = [()] * len(literals)
    for length in distinct(lengths[lengths > 0]).tolist():
        rows = np.flatnonzero(lengths == length)
        columns = (
            [words.literals[number] for number in column] for column in ordered[rows, :length].T.tolist()
        )
        for row, condition in zip(rows.tolist(), zip(*columns, strict=True), strict=True):
            found[row] = condition
    return found


def _outcomes_of(
    outcome: Outcome,
    rows: Longs,
    assigned: Longs,
    literals: Longs,
    words: PlainWords,
    changes: Bools,
    paid: Sequence[tuple[Fraction, Fraction]],
) -> list[GroundOutcome]:
    """The outcome for each row, one object where it is the same; marks rows that it changes something in."""
    slots = words.slot[assigned]
    kept = slots != _NEVER
    for column in literals.T:
        kept &= words.single[column[rows]] != slots
    rows, slots = rows[kept], slots[kept]
    changes[rows] = True
    entries = iter(slots[np.lexsort((slots, rows))].tolist())
    lengths = np.bincount(rows, minlength=len(literals)).tolist()
    changed = [tuple(itertools.islice(entries, length)) for length in lengths]
    does = list(zip(changed, paid, strict=True))
    known = {
        each: _outcome(outcome, tuple([words.pairs[slot] for slot in each[0]]), each[1]) for each in set(does)
    }
    return [known[each] for each in does]
