"""An action schema as rules: one for each way in which the conditions inside of its effect can turn out, so
that the rules exclude each other.

What an outcome deletes and adds is added, as PDDL has it: a deletion is left out where the same atom is
added, and where that depends on which objects are one, there is a rule for either case.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from cleancli.conversion.pddl.define import Definitions, says
from cleancli.conversion.pddl.effects import (
    NOTHING,
    Change,
    Tree,
    decided,
    first_condition,
    mean_cost,
    renamed,
    results_of,
)
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Both,
    Either,
    Formula,
    apart,
    assuming,
    both,
    equality,
    free_variables,
    negated,
    quantified,
    substituted,
)
from cleancli.conversion.pddl.types import Types
from cleancli.language.model import (
    Assign,
    Condition,
    Equality,
    ForAll,
    Object,
    Outcome,
    OutcomeKind,
    Term,
    Variable,
)

MOST_RULES = 64
"""Rules that one action may become. Chosen: more than people read."""


class TooManyRules(Exception):
    """An action would become more rules than `MOST_RULES`."""


@dataclass(frozen=True, slots=True)
class Case:
    """A way in which the conditions of an effect turn out: those that were decided, the outcomes then, and
    what the action costs on average."""

    decisions: tuple[tuple[Formula, bool], ...]
    results: tuple[tuple[Fraction, tuple[Change, ...]], ...]
    cost: Fraction


def cases_of(precondition: Formula, tree: Tree, types: Types) -> list[Case]:
    """All cases that the precondition does not rule out. Raises `TooMany` and `TooManyRules`."""
    found: list[Case] = []
    if precondition != NEVER:
        for case in _cases(*_with_one_name(tree, _parts(precondition), types), (), types):
            found.append(case)
            if len(found) > MOST_RULES:
                raise TooManyRules
    return found


def _parts(formula: Formula) -> tuple[Formula, ...]:
    return formula.parts if isinstance(formula, Both) else (formula,)


def _cases(
    tree: Tree, known: tuple[Formula, ...], decisions: tuple[tuple[Formula, bool], ...], types: Types
) -> Iterator[Case]:
    tree = decided(tree, known)
    condition = first_condition(tree)
    if condition is None:
        settled = [(chance, _settled(changes, known, types)) for chance, changes in results_of(tree).values()]
        open_ones = [found for _, found in settled if not isinstance(found, tuple)]
        if not open_ones:
            results = tuple((chance, found) for chance, found in settled if isinstance(found, tuple))
            yield Case(decisions, results, mean_cost(tree))
            return
        condition = open_ones[0]
    for holds in (True, False):
        asked = condition if holds else negated(condition)
        if not _excluded(asked, known, types):
            inner = _with_one_name(tree, (*known, *_parts(asked)), types)
            yield from _cases(*inner, (*decisions, (condition, holds)), types)


# ---- terms that are one object


def _with_one_name(tree: Tree, known: tuple[Formula, ...], types: Types) -> tuple[Tree, tuple[Formula, ...]]:
    """The tree, and what is known, with one name for terms that are known to be one object."""
    while (same := next((part for part in known if _is_same(part)), None)) is not None:
        assert isinstance(same, Equality)
        names = _one_name(same, types)
        tree = renamed(tree, names, types.may_be_one)
        known = tuple(substituted(part, names, types.may_be_one) for part in known)
    return tree, known


def _is_same(part: Formula) -> bool:
    return isinstance(part, Equality) and part.equal


def _one_name(same: Equality, types: Types) -> Mapping[Term, Term]:
    """An object stands for a variable, and of two variables the one of the narrower type."""
    if isinstance(same.right, Object) or not (
        isinstance(same.left, Object) or types.is_a(same.left.type, same.right.type)
    ):
        return {same.left: same.right}
    return {same.right: same.left}


def _excluded(asked: Formula, known: tuple[Formula, ...], types: Types) -> bool:
    """Whether literals show that the formula can't hold beside what is known."""
    _, parts = _with_one_name(NOTHING, (*known, *_parts(asked)), types)
    return both(parts) == NEVER


# ---- delete, then add


def _settled(
    changes: tuple[Change, ...], known: tuple[Formula, ...], types: Types
) -> tuple[Change, ...] | Formula:
    """The changes without deletions of what is added; or a condition on which that depends."""
    found: list[Change] = []
    added = [change for change in changes if change.value]
    for change in changes:
        kept: Change | None = change
        for other in added if not change.value else ():
            if kept is None or other.symbol != change.symbol:
                continue
            meets = _meeting(kept, other, known, types)
            if meets == NEVER:
                continue
            if meets != ALWAYS and not kept.variables:
                return meets
            guard = both([kept.guard, negated(meets)])
            kept = None if guard == NEVER else replace(kept, guard=guard)
        if kept is not None:
            found.append(kept)
    return tuple(found)


def _meeting(change: Change, other: Change, known: tuple[Formula, ...], types: Types) -> Formula:
    """Under what the other change is on what this one is on, where this one is made."""
    met: list[Term] = [*change.variables, *change.terms, *free_variables(change.guard)]
    names: dict[Term, Term] = {}
    for variable in other.variables:
        names[variable] = apart(variable, met)
        met.append(names[variable])
    bound = set(names.values())
    stands: dict[Term, Term] = {}
    asked = [substituted(other.guard, names, types.may_be_one)]
    for term, place in zip(other.terms, change.terms, strict=True):
        own = names.get(term, term)
        if own in bound and own not in stands and types.is_a(place.type, own.type):
            stands[own] = place
        else:
            asked.append(equality(stands.get(own, own), place, types.may_be_one))
    left = [one for one in bound - stands.keys() if isinstance(one, Variable)]
    inner = both(substituted(part, stands, types.may_be_one) for part in asked)
    here = (*known, *_parts(change.guard))
    meets = assuming(quantified(True, sorted(left), inner), here)
    return NEVER if _excluded(meets, here, types) else meets


# ---- rules


def conditions_of(
    precondition: Formula, cases: Sequence[Case], definitions: Definitions
) -> Iterator[Condition]:
    """The condition of each case's rule."""
    shared = definitions.condition(precondition)
    asked = [formula for case in cases for formula, _ in case.decisions]
    # Beside derived predicates the checker could not tell for sure that quantifiers exclude each other.
    plainly = any(map(definitions.is_made, shared)) or any(isinstance(f, Both | Either) for f in asked)
    for case in cases:
        decided = [formula if holds else negated(formula) for formula, holds in case.decisions]
        shared = definitions.condition(both(assuming(part, decided) for part in _parts(precondition)))
        own = [definitions.decision(*each, plainly=plainly) for each in case.decisions]
        yield tuple(dict.fromkeys([*shared, *(part for parts in own for part in parts)]))


def outcome_of(chance: Fraction, changes: tuple[Change, ...], definitions: Definitions) -> Outcome:
    """An outcome; what has one `forall` stands in one."""
    effects: list[Assign | ForAll] = []
    places: dict[tuple[tuple[Variable, ...], Formula], int] = {}
    for change in changes:
        assigned = Assign(change.symbol, change.terms, change.value)
        key = change.variables, change.guard
        if not change.variables:
            effects.append(assigned)
        elif key in places:
            before = effects[places[key]]
            assert isinstance(before, ForAll)
            effects[places[key]] = replace(before, effects=(*before.effects, assigned))
        else:
            places[key] = len(effects)
            guard = definitions.literals(change.guard)
            effects.append(ForAll(change.variables, guard, (assigned,)))
    kind = OutcomeKind.CHANGE if effects else OutcomeKind.NOTHING
    return Outcome(chance, kind, tuple(effects))


def title_of(action: str, case: Case) -> str:
    """What the rule of a case is called: the action, and what was decided."""
    said = [says(formula if holds else negated(formula)) for formula, holds in case.decisions]
    return "_".join([action, *said])
