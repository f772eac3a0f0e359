"""Ground formulas over state variables, and their division into cases that exclude each other.

A formula that can never hold is None, so that the code that makes formulas drops it at once. Values are
sets, because a function's literal may allow several.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from cleancli.compiler.fluents import Fluent
from cleancli.language.model import Value

Requirement = Mapping[Fluent, frozenset[Value]]
"""The values that a conjunction allows to each key it speaks of; no set is empty."""

Known = Callable[[Fluent], frozenset[Value]]
"""The values that a key may have, as far as is known."""

Possible = Callable[[Requirement], bool]
"""Whether a requirement may hold, as far as is known of values beside each other."""


@dataclass(frozen=True, slots=True)
class Formula:
    """Holds where each key has one of its `required` values and some member of each choice holds."""

    required: Requirement = field(default_factory=dict)
    choices: tuple[tuple[Formula, ...], ...] = ()

    @property
    def always(self) -> bool:
        """Whether it asks for nothing."""
        return not self.required and not self.choices


ALWAYS = Formula()


def conjunction(parts: Iterable[Formula | None]) -> Formula | None:
    """Holds where all parts do."""
    required: dict[Fluent, frozenset[Value]] = {}
    choices: list[tuple[Formula, ...]] = []
    for part in parts:
        if part is None or not _require(required, part.required):
            return None
        choices += part.choices
    return Formula(required, tuple(choices))


def disjunction(members: Iterable[Formula | None]) -> Formula | None:
    """Holds where some member does; members that speak of one and the same key become one."""
    single: dict[Fluent, frozenset[Value]] = {}
    others: list[Formula] = []
    for member in members:
        if member is None:
            continue
        if member.always:
            return ALWAYS
        if len(member.required) == 1 and not member.choices:
            ((key, values),) = member.required.items()
            single[key] = single.get(key, frozenset()) | values
        else:
            others.append(member)
    everyone = (*(Formula({key: values}) for key, values in single.items()), *others)
    if not everyone:
        return None
    return everyone[0] if len(everyone) == 1 else Formula({}, (everyone,))


def negation(formula: Formula | None, all_values: Known) -> Formula | None:
    """Holds where the formula does not."""
    if formula is None:
        return ALWAYS
    literals = (
        Formula({key: rest}) if (rest := all_values(key) - values) else None
        for key, values in formula.required.items()
    )
    choices = (conjunction(negation(m, all_values) for m in choice) for choice in formula.choices)
    return disjunction((*literals, *choices))


def can_hold(formula: Formula, known: Known) -> bool:
    """Whether each literal may hold, taken alone: false only where the formula can not hold."""
    return all(values & known(key) for key, values in formula.required.items()) and all(
        any(can_hold(member, known) for member in choice) for choice in formula.choices
    )


def restricted(formula: Formula, known: Known) -> Formula | None:
    """The formula without what is known to hold; None where it is known not to."""
    required: dict[Fluent, frozenset[Value]] = {}
    for key, values in formula.required.items():
        before = known(key)
        both = values & before
        if not both:
            return None
        if len(both) < len(before):
            required[key] = both
    choices: list[tuple[Formula, ...]] = []
    for choice in formula.choices:
        left = disjunction(restricted(member, known) for member in choice)
        if left is None or not _require(required, left.required):
            return None
        choices += left.choices
    return Formula(required, tuple(choices))


def anything(required: Requirement) -> bool:
    """That every requirement may hold: nothing is known of values beside each other."""
    return True


def disjoint(formula: Formula, known: Known, possible: Possible = anything) -> Iterator[Requirement]:
    """Conjunctions that exclude each other and together mean the formula, always in the same order; without
    those that are not possible.

    Shannon's expansion: what a choice still asks of a key is tried value by value, those values together
    that make no difference.
    """
    if formula.choices:
        yield from _expanded({}, formula, known, possible)
    elif (left := restricted(formula, known)) is not None and possible(left.required):
        yield left.required


def _expanded(
    required: Requirement, formula: Formula, known: Known, possible: Possible
) -> Iterator[Requirement]:
    def now(key: Fluent) -> frozenset[Value]:
        return required.get(key) or known(key)

    left = restricted(formula, now)
    if left is None:
        return
    required = {**required, **left.required}
    if not possible(required):
        return
    open_choices = Formula({}, left.choices)
    if not left.choices:
        yield required
    elif left.required:
        yield from _expanded(required, open_choices, known, possible)
    else:
        mentions = list(_mentions(open_choices))
        often = Counter(key for key, _ in mentions)
        key = min(often, key=lambda key: (-often[key], key))
        asked = {values for other, values in mentions if other == key}
        for values in _indistinct(now(key), asked):
            yield from _expanded({**required, key: values}, open_choices, known, possible)


def _mentions(formula: Formula) -> Iterator[tuple[Fluent, frozenset[Value]]]:
    yield from formula.required.items()
    for choice in formula.choices:
        for member in choice:
            yield from _mentions(member)


def _indistinct(values: frozenset[Value], asked: set[frozenset[Value]]) -> list[frozenset[Value]]:
    """The values in groups that each asked set has or lacks as a whole; what is asked most first."""
    groups: dict[frozenset[frozenset[Value]], set[Value]] = {}
    for value in sorted(values, reverse=True):
        groups.setdefault(frozenset(a for a in asked if value in a), set()).add(value)
    return [frozenset(group) for group in groups.values()]


def _require(required: dict[Fluent, frozenset[Value]], more: Requirement) -> bool:
    """Adds a requirement in place; False where they contradict each other."""
    for key, values in more.items():
        both = required[key] & values if key in required else values
        if not both:
            return False
        required[key] = both
    return True
