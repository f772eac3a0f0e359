"""A task's rules as columns: one array for each thing that is known of all their literals and effects.

Guaranteed by `ground`: rules share literals and outcomes that are the same, so these are looked at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from cleancli.array_types import Bools, Floats, Longs
from cleancli.compiler.ragged import floats, spans, starts
from cleancli.compiler.task import GroundLiteral, GroundRule

_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class RuleColumns:
    """R rules with n literals and m effects. Literals and effects ascend by rule; the effects of a rule by
    outcome, and then by variable."""

    action: Longs  # (R,)
    changes: Bools  # (R,) whether an outcome has an effect at all
    literal_rule: Longs  # (n,)
    literal: Longs  # (n,) which of `literals`
    literals: Sequence[GroundLiteral]
    effect_rule: Longs  # (m,)
    effect_variable: Longs  # (m,)
    effect_value: Longs  # (m,)
    effect_probability: Floats  # (m,) that of its outcome; may be 0

    def possible(self) -> RuleColumns:
        """The same without effects that never happen."""
        kept = self.effect_probability != 0
        return replace(
            self,
            effect_rule=self.effect_rule[kept],
            effect_variable=self.effect_variable[kept],
            effect_value=self.effect_value[kept],
            effect_probability=self.effect_probability[kept],
        )


def rule_columns(rules: Sequence[GroundRule]) -> RuleColumns:
    """The columns of rules."""
    everything = np.arange(len(rules))
    literals, literal = _distinct([literal for rule in rules for literal in rule.condition])
    outcomes, outcome = _distinct([outcome for rule in rules for outcome in rule.outcomes])
    outcome_rule = np.repeat(everything, [len(rule.outcomes) for rule in rules])
    effects = [effect for outcome in outcomes for effect in outcome.effects]
    variable, value = np.array(effects, dtype=np.int64).reshape(-1, 2).T
    first = starts(outcome.effects for outcome in outcomes)
    which, entry = spans(first[outcome], np.diff(first)[outcome])
    changes = np.zeros(len(rules), dtype=np.bool_)
    changes[outcome_rule[which]] = True
    return RuleColumns(
        action=np.array([rule.action for rule in rules], dtype=np.int64),
        changes=changes,
        literal_rule=np.repeat(everything, [len(rule.condition) for rule in rules]),
        literal=literal,
        literals=literals,
        effect_rule=outcome_rule[which],
        effect_variable=variable[entry],
        effect_value=value[entry],
        effect_probability=floats(outcome.probability for outcome in outcomes)[outcome[which]],
    )


def _distinct(items: Sequence[_Item]) -> tuple[list[_Item], Longs]:
    """The items without those that are there already, and where each went. Told apart by identity, which is
    quick; equal ones may come several times."""
    identities = np.fromiter(map(id, items), dtype=np.int64, count=len(items))
    _, first, place = np.unique(identities, return_index=True, return_inverse=True)
    return [items[index] for index in first], place.astype(np.int64)
