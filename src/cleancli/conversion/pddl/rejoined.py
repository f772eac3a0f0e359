"""Schemas that were written for the rules of one .nid action, as that action again.

The way out writes a schema for each rule, with `; rule NAME of ACTION` above it (`conversion.export.ppddl`).
Where that still stands there, and the rules still exclude each other for sure, nothing else was meant.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import groupby
from typing import NamedTuple

from cleancli.conversion.pddl.naming import Naming
from cleancli.conversion.pddl.schemas import Schema
from cleancli.language.checking.conditions import Scope
from cleancli.language.checking.declarations import Declarations
from cleancli.language.checking.exclusivity import refuse_overlaps
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Outcome, OutcomeKind, Price, Rule

_ABOVE = re.compile(r"; rule (\w+) of (\w+)\s*\(:action\s+\Z")
_LONGEST = 1000
"""Characters before the name of a schema that are looked at."""


class _Origin(NamedTuple):
    """The action and the rule that a schema was written for; no action where that is not said."""

    action: str
    rule: str


def rejoined(
    schemas: Sequence[Schema],
    sources: Mapping[str, Source],
    declared: Callable[[], Declarations],
    actions: Naming,
) -> tuple[Schema, ...]:
    """The schemas, in which those of one action are one where they can be; `declared` is all that their rules
    speak of, and `actions` gives the action its name."""
    found: list[Schema] = []
    for origin, several in groupby(schemas, key=lambda each: _origin(each, sources).action):
        alike = list(several)
        one = _one(origin, alike, sources, declared(), actions) if origin and len(alike) > 1 else None
        found += alike if one is None else [one]
    return tuple(found)


def _origin(schema: Schema, sources: Mapping[str, Source]) -> _Origin:
    start = schema.place.start
    before = sources[schema.place.path].text[max(0, start - _LONGEST) : start]
    match = _ABOVE.search(before)
    return _Origin("", "") if match is None else _Origin(match[2], match[1])


def _one(
    name: str,
    schemas: Sequence[Schema],
    sources: Mapping[str, Source],
    declared: Declarations,
    actions: Naming,
) -> Schema | None:
    """One action of schemas with parameters of the same types and with costs that differ by a number at most;
    None where they are not, or where it is not sure that their rules exclude each other."""
    first, *others = (schema.action for schema in schemas)
    types = [[parameter.type for parameter in action.parameters] for action in (first, *others)]
    costs = [schema.action.cost for schema in schemas]
    if any(each != types[0] for each in types) or any(each.parts != costs[0].parts for each in costs):
        return None
    least = min(costs, key=lambda cost: cost.number)
    rules = tuple(
        replace(
            rule,
            name=_origin(schema, sources).rule if len(schema.rules) == 1 else rule.name,
            action=name,
            outcomes=tuple(_dearer(each, schema.action.cost.number - least.number) for each in rule.outcomes),
        )
        for schema in schemas
        for rule in schema.rules
    )
    if not _exclude_each_other(rules, schemas[0], sources, declared):
        return None
    title = actions.fresh(name, "a")
    return replace(
        schemas[0],
        action=replace(first, name=title, cost=least),
        rules=tuple(replace(rule, action=title) for rule in rules),
        joined=tuple(schema.place for schema in schemas[1:]),
    )


def _dearer(outcome: Outcome, more: Fraction) -> Outcome:
    if not more:
        return outcome
    return replace(outcome, kind=OutcomeKind.CHANGE, cost=outcome.cost + Price(more))


def _exclude_each_other(
    rules: Sequence[Rule], first: Schema, sources: Mapping[str, Source], declared: Declarations
) -> bool:
    """Whether it is proved that no state lets two of the rules apply."""
    findings = Findings(sources[first.place.path])
    refuse_overlaps((replace(rule, span=first.place) for rule in rules), Scope(declared, {}, {}, findings))
    return not findings.sorted
