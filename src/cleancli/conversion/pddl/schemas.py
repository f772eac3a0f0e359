"""The action schemas of a domain as actions and rules."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.effects import MOST_OUTCOMES, Effects, TooMany, UnevenCost
from cleancli.conversion.pddl.formula import Formula, both
from cleancli.conversion.pddl.resolve import Words
from cleancli.conversion.pddl.rules import (
    Case,
    cases_of,
    conditions_of,
    outcome_of,
    title_of,
)
from cleancli.conversion.pddl.syntax import ActionNode
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Action, Rule, Variable

_LONGEST_TITLE = 48
"""Characters up to which a rule is called by the conditions that it is for. Chosen."""


@dataclass(frozen=True, slots=True)
class Schema:
    """An action and its rules, which may share a name yet; `place` is that of the schema's name."""

    action: Action
    rules: tuple[Rule, ...]
    place: Span


def schemas_of(
    nodes: Sequence[ActionNode], words: Words, effects: Effects, definitions: Definitions
) -> tuple[Schema, ...]:
    """The schemas that do something. E916 and E917 for what can't be said."""
    found = []
    for node in _each_once(nodes, words.findings):
        schema = _schema(node, words, effects, definitions)
        if schema is not None:
            found.append(schema)
    return tuple(found)


def _each_once(nodes: Sequence[ActionNode], findings: Findings) -> Iterator[ActionNode]:
    """Without those that are there already; what has the name of another and is not the same stays."""
    seen: dict[str, list[ActionNode]] = {}
    for node in nodes:
        others = seen.setdefault(node.name.text, [])
        if node in others:
            message = f"the action `{node.name.text}` is declared twice"
            findings.warning("W911", message, node.name.span, "passed over")
            continue
        if others:
            message = f"another action is called `{node.name.text}` too"
            findings.warning("W911", message, node.name.span, "taken as an action of its own")
        others.append(node)
        yield node


def _schema(node: ActionNode, words: Words, effects: Effects, definitions: Definitions) -> Schema | None:
    findings, before = words.findings, words.findings.errors
    variables, scope, asked = words.bound(node.parameters, {})
    precondition = both([asked, words.formula(node.precondition, scope)])
    tree = effects.tree(node.effect, scope)
    if findings.errors > before:
        return None
    try:
        cases = cases_of(precondition, tree, words.types)
    except TooMany:
        message = f"`{node.name.text}` has more than {MOST_OUTCOMES} outcomes"
        findings.error("E917", message, node.name.span, help="what is drawn for itself multiplies outcomes")
        return None
    except UnevenCost:
        _refuse_uneven(node, findings)
        return None
    acting = [case for case in cases if _acts(case)]
    costs = {case.cost for case in acting}
    if len(costs) > 1:
        _refuse_uneven(node, findings)
    if not acting:
        return None
    name = words.actions.fresh(words.actions.written(node.name), "a")
    made = tuple(_rules(name, variables, precondition, acting, definitions))
    return Schema(Action(name, variables, cost=next(iter(costs), Fraction(0))), made, node.name.span)


def _refuse_uneven(node: ActionNode, findings: Findings) -> None:
    message = f"what `{node.name.text}` costs depends on conditions, and a .nid action has one cost"
    findings.error("E917", message, node.name.span)


def _acts(case: Case) -> bool:
    """Whether something may change: where nothing can, no rule is needed to say so."""
    return any(changes for _, changes in case.results)


def _rules(
    action: str,
    variables: tuple[Variable, ...],
    precondition: Formula,
    cases: Sequence[Case],
    definitions: Definitions,
) -> Iterator[Rule]:
    titles = [title_of(action, case) for case in cases]
    if max(map(len, titles)) > _LONGEST_TITLE or len(set(titles)) < len(titles):
        titles = [f"{action}_{number}" for number in range(1, len(cases) + 1)]
    conditions = conditions_of(precondition, cases, definitions)
    for title, case, condition in zip(titles, cases, conditions, strict=True):
        outcomes = tuple(outcome_of(*result, definitions) for result in case.results)
        yield Rule(title, action, variables, condition, outcomes)
