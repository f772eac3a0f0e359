"""The action schemas of a domain as actions and rules."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.effect_trees import (
    known_for,
)
from cleancli.conversion.pddl.effects import (
    Effects,
)
from cleancli.conversion.pddl.formula import both
from cleancli.conversion.pddl.resolve import NO_VARIABLES, Words
from cleancli.conversion.pddl.results import (
    MOST_OUTCOMES,
    TooMany,
)
from cleancli.conversion.pddl.rules import (
    Case,
    UnevenCost,
    cases_of,
    conditions_of,
    outcome_of,
    shared_cost,
    title_of,
)
from cleancli.conversion.pddl.syntax import ActionNode
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.model import Action, Rule

_FEWER_OUTCOMES = (
    "what is drawn for itself multiplies them, so that ten draws of two results have 1,024:"
    " divide the draws among several actions, one after the other"
)

_LONGEST_TITLE = 48
"""Characters up to which a rule is called by the conditions that it is for. Chosen."""


@dataclass(frozen=True, slots=True)
class Schema:
    """An action and its rules, which may share a name yet; `place` is that of the schema's name, and `joined`
    are those of schemas that have become part of it."""

    action: Action
    rules: tuple[Rule, ...]
    place: Span
    joined: tuple[Span, ...] = ()


def schemas_of(
    nodes: Sequence[ActionNode], words: Words, effects: Effects, definitions: Definitions
) -> tuple[Schema, ...]:
    """The schemas that do something. E916 and E917 for what can't be said."""
    made = (_schema(node, words, effects, definitions) for node in _each_once(nodes, words.findings))
    return tuple(schema for schema in made if schema is not None)


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
    """The schema; None where nothing can change and nothing is paid, and where something can't be said."""
    findings, before = words.findings, words.findings.errors
    variables, scope, asked = words.bound(node.parameters, NO_VARIABLES)
    precondition = both([asked, words.formula(node.precondition, scope)])
    tree = effects.tree(node.effect, scope)
    precondition = both([precondition, *known_for(tree)])
    if findings.errors > before:
        return None
    try:
        cases = cases_of(precondition, tree, words.types, effects.never_both)
    except TooMany:
        message = f"`{node.name.text}` has more than {MOST_OUTCOMES} outcomes"
        findings.error("E917", message, node.name.span, help=_FEWER_OUTCOMES)
        return None
    except UnevenCost:
        message = f"what `{node.name.text}` pays depends on more conditions than rules are made for"
        findings.error("E917", message, node.name.span, help="make several actions of it, each with its cost")
        return None
    if not effects.earned:
        cases = list(map(_in_all, cases))
        _refuse_earnings(node, cases, findings)
    acting = [case for case in cases if any(each.changes or each.paid for each in case.results)]
    if not acting:
        return None
    name, cost = words.actions.fresh(words.actions.written(node.name), "a"), shared_cost(acting)
    titles = _titles(words.actions.written(node.name), acting)
    made = tuple(
        Rule(
            title,
            name,
            variables,
            condition,
            tuple(outcome_of(each, cost, definitions) for each in case.results),
        )
        for case, title, condition in zip(
            acting, titles, conditions_of(precondition, acting, definitions), strict=True
        )
    )
    return Schema(Action(name, variables, cost=cost), made, node.name.span)


def _in_all(case: Case) -> Case:
    """The case by what each outcome costs in all."""
    if not any(each.paid for each in case.results):
        return case
    return replace(case, results=tuple(replace(each, paid=each.paid.in_all) for each in case.results))


def _refuse_earnings(node: ActionNode, cases: Sequence[Case], findings: Findings) -> None:
    """E917 for an action that earns something where only costs count."""
    if any(each.paid.reward for case in cases for each in case.results):
        message = f"`{node.name.text}` earns something, and costs alone count until the goal is reached"
        findings.error("E917", message, node.name.span, help="what is wanted can be a goal with a reward")


def _titles(action: str, cases: Sequence[Case]) -> list[str]:
    """What cases are called: by their conditions, or by numbers where that is long or says not which."""
    if len(cases) == 1:
        return [action]
    titles = [title_of(action, case) for case in cases]
    if max(map(len, titles), default=0) > _LONGEST_TITLE or len(set(titles)) < len(titles):
        return [f"{action}_{number}" for number in range(1, len(cases) + 1)]
    return titles
