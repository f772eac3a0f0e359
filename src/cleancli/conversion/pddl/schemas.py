"""The action schemas of a domain as actions and rules."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.effects import (
    MOST_OUTCOMES,
    Effects,
    Paid,
    TooMany,
    UnevenCost,
    known_for,
    known_under_conditions,
)
from cleancli.conversion.pddl.formula import ALWAYS, both
from cleancli.conversion.pddl.resolve import NO_VARIABLES, Words
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
from cleancli.language.model import Action, CostPart, Rule

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
    variables, scope, asked = words.bound(node.parameters, NO_VARIABLES)
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
    if not effects.earned:
        cases = list(map(_in_all, cases))
    _refuse_earnings(node, cases, effects, findings)
    acting = [case for case in cases if any(each.changes or each.paid != Paid() for each in case.results)]
    priced = list(dict.fromkeys(case.parts for case in acting))
    written = words.actions.written(node.name)
    names = [written] if len(priced) < 2 else _several(written, acting, priced)
    conditions = conditions_of(precondition, acting, definitions)
    rules = list(zip(acting, _titles(written, acting), conditions, strict=True))
    for parts, wanted in zip(priced, names, strict=False):
        name = words.actions.fresh(wanted, "a")
        cost = min(each.paid.cost for case in acting if case.parts == parts for each in case.results)
        made = tuple(
            Rule(
                title,
                name,
                variables,
                condition,
                tuple(outcome_of(each, cost, definitions) for each in case.results),
            )
            for case, title, condition in rules
            if case.parts == parts
        )
        yield Schema(Action(name, variables, cost=cost, cost_parts=parts), made, node.name.span)


def _in_all(case: Case) -> Case:
    """The case by what each outcome costs in all."""
    return replace(case, results=tuple(replace(each, paid=each.paid.in_all) for each in case.results))


def _refuse_earnings(node: ActionNode, cases: Sequence[Case], effects: Effects, findings: Findings) -> None:
    """E917 for what an action earns and .nid actions cannot: by functions, and where only costs count."""
    name, help = node.name.text, "what is wanted can be a goal with a reward"
    if any(part.weight < 0 for case in cases for part in case.parts):
        message = f"`{name}` earns what a function says, and .nid outcomes earn numbers"
        findings.error("E917", message, node.name.span, help=help)
    elif not effects.earned and any(each.paid.reward for case in cases for each in case.results):
        message = f"`{name}` earns something, and costs alone count until the goal is reached"
        findings.error("E917", message, node.name.span, help=help)


def _several(action: str, cases: Sequence[Case], priced: Sequence[tuple[CostPart, ...]]) -> list[str]:
    """What the actions are called into which one is divided by what functions say that it costs: by what all
    cases of a cost share."""
    alike = [[case for case in cases if case.parts == parts] for parts in priced]
    shared = [
        tuple(each for each in several[0].decisions if all(each in case.decisions for case in several))
        for several in alike
    ]
    return _titles(
        action, [replace(several[0], decisions=d) for several, d in zip(alike, shared, strict=True)]
    )


def _titles(action: str, cases: Sequence[Case]) -> list[str]:
    """What cases are called: by their conditions, or by numbers where that is long or says not which."""
    if len(cases) == 1:
        return [action]
    titles = [title_of(action, case) for case in cases]
    if max(map(len, titles), default=0) > _LONGEST_TITLE or len(set(titles)) < len(titles):
        return [f"{action}_{number}" for number in range(1, len(cases) + 1)]
    return titles
