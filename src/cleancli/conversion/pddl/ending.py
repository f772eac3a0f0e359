"""The end of problems in which something is earned: where the goal holds, nothing is done any more.

A goal of PPDDL is a set of absorbing states where rewards are maximized (Younes, Littman, Weissman and Asmuth
2005, JAIR 24, "Plan Objectives"). In a .nid file what comes after the goal counts as well, up to the horizon,
so rules ask for it. Where nothing is earned nobody gains by going on, and rules stay as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.formula import ALWAYS, negated, substituted
from cleancli.conversion.pddl.problem import Metric, Start
from cleancli.conversion.pddl.resolve import Words
from cleancli.conversion.pddl.schemas import Schema
from cleancli.language.model import Rule, Term


def ended(
    schemas: tuple[Schema, ...],
    starts: Sequence[Start],
    metric: Metric,
    words: Words,
    definitions: Definitions,
) -> tuple[Schema, ...]:
    """The schemas, which do nothing where the goal holds if something can be earned; E917 where problems have
    different goals, since it is the domain that says so."""
    rules = [rule for schema in schemas for rule in schema.rules]
    earning = any(outcome.reward for rule in rules for outcome in rule.outcomes)
    ending = [start for start in starts if start.asked != ALWAYS]
    if not (metric.earned and earning and ending):
        return schemas
    first = starts[0]
    for other in starts[1:]:
        if other.asked != first.asked:
            message = "a goal ends what is earned, and not all problems have the same"
            words.findings.error("E917", message, other.node.name.span, help="convert one problem at a time")
            return schemas
    missed = negated(first.asked)

    def before(rule: Rule) -> Rule:
        own: dict[Term, Term] = {variable: variable for variable in rule.variables}
        asked = definitions.condition(substituted(missed, own, words.types.may_be_one))
        return replace(rule, condition=tuple(dict.fromkeys((*rule.condition, *asked))))

    return tuple(replace(schema, rules=tuple(map(before, schema.rules))) for schema in schemas)
