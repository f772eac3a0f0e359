"""The action schemas of a domain as actions and rules."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.effects import (
    MOST_OUTCOMES,
    Cost,
    Effects,
    TooMany,
    UnevenCost,
    known_for,
    known_under_conditions,
)
from cleancli.conversion.pddl.formula import ALWAYS, both
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
from cleancli.language.model import Action, Outcome, Rule

_FEWER_OUTCOMES = (
    "what is drawn for itself multiplies them, so that ten draws of two results have 1,024:"
    " divide the draws among several actions, one after the other"
)

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
    return tuple(
        schema
        for node in _each_once(nodes, words.findings)
        for schema in _schemas(node, words, effects, definitions)
    )


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


def _schemas(node: ActionNode, words: Words, effects: Effects, definitions: Definitions) -> Iterator[Schema]:
    """The schema; where its cost depends on conditions one for each cost, of which one can be applied in a
    state. None where nothing can change: what only costs is worth nothing."""
    findings, before = words.findings, words.findings.errors
    variables, scope, asked = words.bound(node.parameters, {})
    precondition = both([asked, words.formula(node.precondition, scope)])
    tree = effects.tree(node.effect, scope)
    precondition = both([precondition, *known_for(tree)])
    if known_under_conditions(tree) != ALWAYS:
        message = f"a cost of `{node.name.text}` depends on a condition, and not all its values are known"
        findings.error("E917", message, node.name.span, help="give each of its values in the problem")
    if findings.errors > before:
        return
    try:
        cases = cases_of(precondition, tree, words.types)
    except TooMany:
        message = f"`{node.name.text}` has more than {MOST_OUTCOMES} outcomes"
        findings.error("E917", message, node.name.span, help=_FEWER_OUTCOMES)
        return
    except UnevenCost:
        message = f"what `{node.name.text}` costs depends on more conditions than rules are made for"
        findings.error("E917", message, node.name.span, help="make several actions of it, each with its cost")
        return
    if any(case.cost.may_earn for case in cases):
        # Where no rule of an action applies it does nothing, at its usual cost: it would earn there, too.
        message = f"`{node.name.text}` earns something, and .nid actions only cost"
        findings.error("E917", message, node.name.span, help="what is wanted can be a goal with a reward")
        return
    acting = [case for case in cases if any(changes for _, changes in case.results)]
    costs = list(dict.fromkeys(case.cost for case in acting))
    written = words.actions.written(node.name)
    names = [written] if len(costs) < 2 else _several(written, acting, costs)
    conditions = conditions_of(precondition, acting, definitions)
    rules = list(zip(acting, _titles(written, acting), conditions, strict=True))
    for cost, wanted in zip(costs, names, strict=False):
        name = words.actions.fresh(wanted, "a")
        made = tuple(
            Rule(title, name, variables, condition, _outcomes(case, definitions))
            for case, title, condition in rules
            if case.cost == cost
        )
        action = Action(name, variables, cost=cost.amount, cost_parts=cost.parts)
        yield Schema(action, made, node.name.span)


def _several(action: str, cases: Sequence[Case], costs: Sequence[Cost]) -> list[str]:
    """What the actions are called into which one is divided by costs: by what all cases of a cost share."""
    alike = [[case for case in cases if case.cost == cost] for cost in costs]
    shared = [
        tuple(each for each in several[0].decisions if all(each in case.decisions for case in several))
        for several in alike
    ]
    return _titles(
        action, [replace(several[0], decisions=d) for several, d in zip(alike, shared, strict=True)]
    )


def _titles(action: str, cases: Sequence[Case]) -> list[str]:
    """What cases are called: by their conditions, or by numbers where that is long or says not which."""
    titles = [title_of(action, case) for case in cases]
    if max(map(len, titles), default=0) > _LONGEST_TITLE or len(set(titles)) < len(titles):
        return [f"{action}_{number}" for number in range(1, len(cases) + 1)]
    return titles


def _outcomes(case: Case, definitions: Definitions) -> tuple[Outcome, ...]:
    return tuple(outcome_of(*result, definitions) for result in case.results)
