"""Chance in the initial state, which a .nid problem does not have: an action that draws it comes first.

Nothing else can be done before, and the goal does not hold before. So a plan takes one action more, and
nothing else is different.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.effect_trees import (
    All,
    Change,
    first_condition,
)
from cleancli.conversion.pddl.effects import (
    Effects,
)
from cleancli.conversion.pddl.formula import ALWAYS, literal, negated
from cleancli.conversion.pddl.problem import Start
from cleancli.conversion.pddl.resolve import NO_VARIABLES, Predicate, Words
from cleancli.conversion.pddl.results import (
    MOST_OUTCOMES,
    Result,
    TooMany,
    results_of,
)
from cleancli.conversion.pddl.rules import outcome_of
from cleancli.conversion.pddl.schemas import Schema
from cleancli.conversion.pddl.syntax import ChanceNode
from cleancli.language.model import NOTHING_PAID, Action, Rule


@dataclass(frozen=True, slots=True)
class Begun:
    """Schemas and starts with the action that begins, where there is one, and its name."""

    schemas: tuple[Schema, ...]
    starts: tuple[Start, ...]
    action: str | None = None


def begun(
    schemas: tuple[Schema, ...],
    starts: tuple[Start, ...],
    words: Words,
    effects: Effects,
    definitions: Definitions,
) -> Begun:
    """The schemas and starts where chance decides of no initial state; E917 for more than one problem."""
    drawn = [node for start in starts for node in start.node.init if isinstance(node, ChanceNode)]
    if not drawn:
        return Begun(schemas, starts)
    if len(starts) > 1:
        message = "chance decides of the initial state, and a .nid domain has to say how"
        words.findings.error("E917", message, drawn[0].span, help="convert one problem at a time")
        return Begun(schemas, starts)
    results = _results(drawn, words, effects)
    symbol, name = words.symbols.fresh("begun"), words.actions.fresh("begin")
    words.predicates[symbol] = Predicate(symbol, (), [])
    has_begun = literal(symbol, ())
    first = Change((), ALWAYS, symbol, (), True)
    begins = (replace(each, changes=(*each.changes, first)) for each in results)
    outcomes = tuple(outcome_of(each, NOTHING_PAID, definitions) for each in begins)
    rule = Rule(name, name, (), definitions.condition(negated(has_begun)), outcomes)
    later = tuple(
        replace(s, rules=tuple(replace(r, condition=(*r.condition, has_begun)) for r in s.rules))
        for s in schemas
    )
    (start,) = starts
    goal = (*start.goal, has_begun) if start.goal else ()
    return Begun(
        (Schema(Action(name, ()), (rule,), drawn[0].span), *later), (replace(start, goal=goal),), name
    )


def _results(drawn: Sequence[ChanceNode], words: Words, effects: Effects) -> list[Result]:
    """What the initial state may be besides the facts; E917 where that depends on conditions."""
    tree = All(tuple(effects.tree(node, NO_VARIABLES) for node in drawn))
    if first_condition(tree) is not None:
        words.findings.error("E917", "conditions decide of nothing before the first action", drawn[0].span)
        return []
    try:
        return list(results_of(tree))
    except TooMany:
        message = f"there are more than {MOST_OUTCOMES} initial states"
        words.findings.error("E917", message, drawn[0].span)
        return []
