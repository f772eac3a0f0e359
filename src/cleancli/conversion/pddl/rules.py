"""An action schema as rules: one for each way in which the conditions inside of its effect can turn out, so
that the rules exclude each other. Where these are too many, the conditions stay in the effect, as `if`.

What an outcome deletes and adds is added, as PDDL has it: a deletion is left out where the same atom is
added, and where that depends on which objects are one, there is a rule for either case.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice, product

from cleancli.conversion.pddl.define import Definitions, says
from cleancli.conversion.pddl.effect_trees import (
    NOTHING,
    Change,
    Tree,
    decided,
    first_condition,
    guarded,
    known_for,
    renamed,
)
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Both,
    Either,
    Formula,
    Known,
    apart,
    both,
    equality,
    free_variables,
    negated,
    quantified,
    substituted,
)
from cleancli.conversion.pddl.results import (
    Result,
    results_of,
)
from cleancli.conversion.pddl.types import Types
from cleancli.language.model import (
    Assign,
    Condition,
    Equality,
    ForAll,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Price,
    Term,
    Variable,
)

MOST_RULES = 4
"""Rules that one action is divided into; where its effect has more conditions, they stay inside of it, as
`if`. Chosen: as many as people read at a glance."""

MOST_COSTS = 16
"""Cases by conditions that costs depend on, which cannot stay inside of an effect. Chosen."""


@dataclass(frozen=True, slots=True)
class Case:
    """A way in which the conditions of an effect turn out: those that were decided, the outcomes then, and
    what has to be known for what they pay."""

    decisions: tuple[tuple[Formula, bool], ...]
    results: tuple[Result, ...]
    asked: Formula = ALWAYS


NeverBoth = Callable[[Literal, Literal], bool]
"""Whether two literals hold together in no state, beside what their form says of that."""


class UnevenCost(Exception):
    """What an action costs depends on more conditions than it is divided by."""


def cases_of(precondition: Formula, tree: Tree, types: Types, never_both: NeverBoth) -> list[Case]:
    """All cases that the precondition does not rule out; where they would be too many those alone that costs
    depend on. Raises `TooMany`, and `UnevenCost` where these are too many."""
    if precondition == NEVER:
        return []
    tree, known = _with_one_name(tree, _parts(precondition), types)
    found = list(islice(_cases(tree, known, (), types), MOST_RULES + 1))
    if len(found) <= MOST_RULES:
        return found
    found = list(islice(_by_costs(tree, known, (), types, never_both), MOST_COSTS + 1))
    if len(found) > MOST_COSTS:
        raise UnevenCost
    return found


def _by_costs(
    tree: Tree,
    known: tuple[Formula, ...],
    decisions: tuple[tuple[Formula, bool], ...],
    types: Types,
    never_both: NeverBoth,
) -> Iterator[Case]:
    """The cases that costs depend on; all other conditions of the effect stay in it."""
    tree = decided(tree, Known(known))
    condition = first_condition(tree, paying=True)
    if condition is None:
        yield replace(_undivided(tree, known, types, never_both), decisions=decisions)
        return
    for holds, inner in _either_way(tree, known, condition, types):
        yield from _by_costs(*inner, (*decisions, (condition, holds)), types, never_both)


def _either_way(
    tree: Tree, known: tuple[Formula, ...], condition: Formula, types: Types
) -> Iterator[tuple[bool, tuple[Tree, tuple[Formula, ...]]]]:
    """The tree and what is known where a condition holds, and where it does not, as far as that can be."""
    for holds in (True, False):
        asked = condition if holds else negated(condition)
        inner = _with_one_name(tree, (*known, *_parts(asked)), types)
        if both(inner[1]) != NEVER:
            yield holds, inner


def _undivided(tree: Tree, known: tuple[Formula, ...], types: Types, never_both: NeverBoth) -> Case:
    """The case that all conditions of the effect stay in; none of them decides of costs."""
    here = Known(known)
    tree = decided(guarded(tree), here)

    def may_meet(one: Formula, other: Formula) -> bool:
        pairs = product(_alternatives(one), _alternatives(other))
        return not all(_is_excluded(pair, known, types, never_both) for pair in pairs)

    results = (_settled(each, _meetings(each.changes, here, types)) for each in results_of(tree, may_meet))
    return Case((), tuple(results), both(known_for(tree)))


def _alternatives(formula: Formula) -> tuple[Formula, ...]:
    return formula.parts if isinstance(formula, Either) else (formula,)


def _is_excluded(
    pair: tuple[Formula, Formula], known: tuple[Formula, ...], types: Types, never_both: NeverBoth
) -> bool:
    """Whether no state lets both of two formulas hold."""
    if _excluded(both(pair), known, types):
        return True
    ones, others = ([part for part in _parts(each) if isinstance(part, Literal)] for each in pair)
    return any(never_both(one, other) for one in ones for other in others)


def _parts(formula: Formula) -> tuple[Formula, ...]:
    return formula.parts if isinstance(formula, Both) else (formula,)


def _cases(
    tree: Tree, known: tuple[Formula, ...], decisions: tuple[tuple[Formula, bool], ...], types: Types
) -> Iterator[Case]:
    here = Known(known)
    tree = decided(tree, here)
    condition = first_condition(tree)
    if condition is None:
        results = []
        for each in results_of(tree):
            meetings = _meetings(each.changes, here, types)
            condition = _open(each.changes, meetings)
            if condition is not None:
                break
            results.append(_settled(each, meetings))
        else:
            yield Case(decisions, tuple(results), both(known_for(tree)))
            return
    for holds, inner in _either_way(tree, known, condition, types):
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


def _meetings(changes: tuple[Change, ...], known: Known, types: Types) -> list[list[Formula]]:
    """For each change under what others add what it deletes."""
    return [
        [_meeting(change, other, known, types) for other in _adding(change, changes)] for change in changes
    ]


def _open(changes: tuple[Change, ...], meetings: list[list[Formula]]) -> Formula | None:
    """A condition on which it depends whether something is deleted, as it is not where it is added; None
    where there is none, but those on bindings of a `forall`."""
    for change, meets in zip(changes, meetings, strict=True):
        if not change.variables:
            for condition in meets:
                if condition not in (ALWAYS, NEVER):
                    return condition
    return None


def _settled(result: Result, meetings: list[list[Formula]]) -> Result:
    """The result with each deletion only where nothing adds what it deletes, and without changes that another
    makes too."""
    kept: list[Change] = []
    for change, meets in zip(result.changes, meetings, strict=True):
        is_plain = change.variables or change.guard == ALWAYS
        if not is_plain and replace(change, guard=ALWAYS) in result.changes:
            continue
        guard = both([change.guard, *map(negated, meets)])
        if guard != NEVER:
            kept.append(change if guard == change.guard else replace(change, guard=guard))
    changes = tuple(kept)
    return result if changes == result.changes else replace(result, changes=changes)


def _adding(change: Change, changes: tuple[Change, ...]) -> Iterator[Change]:
    """Those changes that may add what one deletes."""
    if not change.value:
        yield from (each for each in changes if each.value and each.symbol == change.symbol)


def _meeting(change: Change, other: Change, known: Known, types: Types) -> Formula:
    """Under what the other change adds what this one deletes, where this one is made."""
    if not other.variables:
        same = (equality(*pair, types.may_be_one) for pair in zip(other.terms, change.terms, strict=True))
        return _where(both([other.guard, *same]), change, known, types)
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
    inner = both([substituted(part, stands, types.may_be_one) for part in asked])
    return _where(quantified(True, sorted(left), inner), change, known, types)


def _where(formula: Formula, change: Change, known: Known, types: Types) -> Formula:
    """What is left of a formula where a change is made; never true where it can't hold there."""
    if formula == NEVER:
        return NEVER
    guard = _parts(change.guard)
    here = Known([*known.formulas, *guard]) if guard else known
    meets = here.left_of(formula)
    return NEVER if meets != NEVER and _excluded(meets, here.formulas, types) else meets


# ---- rules


def conditions_of(
    precondition: Formula, cases: Sequence[Case], definitions: Definitions
) -> Iterator[Condition]:
    """The condition of each case's rule."""
    base = definitions.condition(precondition)
    asked = [formula for case in cases for formula, _ in case.decisions]
    # Beside derived predicates the checker could not tell for sure that quantifiers exclude each other.
    plainly = any(map(definitions.is_made, base)) or any(isinstance(f, Both | Either) for f in asked)
    for case in cases:
        decided = [formula if holds else negated(formula) for formula, holds in case.decisions]
        here = Known(decided)
        left = both(map(here.left_of, _parts(precondition))) if decided else precondition
        shared = base if left == precondition else definitions.condition(left)
        own = [definitions.decision(*each, plainly=plainly) for each in case.decisions]
        known = definitions.condition(case.asked)
        yield tuple(dict.fromkeys([*shared, *(part for parts in own for part in parts), *known]))


def shared_cost(cases: Iterable[Case]) -> Price:
    """What an action costs in all outcomes of its cases."""
    costs = [each.paid.cost for case in cases for each in case.results]
    weights = [{(part.symbol, part.terms): part.weight for part in cost.parts} for cost in costs]
    common = costs[0].parts if costs else ()
    least = [min(each.get((part.symbol, part.terms), Fraction(0)) for each in weights) for part in common]
    parts = [replace(part, weight=weight) for part, weight in zip(common, least, strict=True) if weight]
    return Price(min((cost.number for cost in costs), default=Fraction(0)), tuple(parts))


def outcome_of(result: Result, cost: Price, definitions: Definitions) -> Outcome:
    """An outcome of an action that has a cost by itself; what has one `forall` stands in one."""
    effects: list[Assign | ForAll] = []
    places: dict[tuple[tuple[Variable, ...], Formula], int] = {}
    for change in result.changes:
        assigned = Assign(change.symbol, change.terms, change.value)
        key = change.variables, change.guard
        if not change.variables and change.guard == ALWAYS:
            effects.append(assigned)
        elif key in places:
            before = effects[places[key]]
            assert isinstance(before, ForAll)
            effects[places[key]] = replace(before, effects=(*before.effects, assigned))
        else:
            places[key] = len(effects)
            guard = definitions.literals(change.guard)
            effects.append(ForAll(change.variables, guard, (assigned,)))
    reward, more = result.paid.reward, result.paid.cost + cost.times(Fraction(-1))
    kind = OutcomeKind.CHANGE if effects or reward or more else OutcomeKind.NOTHING
    return Outcome(result.chance, kind, tuple(effects), reward=reward, cost=more)


def title_of(action: str, case: Case) -> str:
    """What the rule of a case is called: the action, and what was decided."""
    said = [says(formula if holds else negated(formula)) for formula, holds in case.decisions]
    return "_".join([action, *said])
