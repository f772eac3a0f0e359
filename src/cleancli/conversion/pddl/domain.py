"""The .nid domain and problems that schemas and starts make: what they use is declared, and nothing else.

What the language's checker would find idle or twice is put right here, with its own means.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from cleancli.conversion.pddl.define import Definitions
from cleancli.conversion.pddl.naming import Naming
from cleancli.conversion.pddl.problem import Metric, Start
from cleancli.conversion.pddl.resolve import Words
from cleancli.conversion.pddl.schemas import Schema
from cleancli.conversion.pddl.types import OBJECT
from cleancli.language.checking.declarations import Declarations
from cleancli.language.checking.derived import as_symbols
from cleancli.language.checking.equivalence import asked_by, doing, idle_because
from cleancli.language.checking.exclusivity import can_apply
from cleancli.language.model import (
    Assign,
    Condition,
    DerivedPredicate,
    Domain,
    Equality,
    ForAll,
    Horizon,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Problem,
    Quantified,
    Rule,
    Shift,
    Symbol,
    Type,
    Unlimited,
    Variable,
)

USUAL_HORIZON = 40
"""Steps of a problem that is to earn rewards, where nobody says how many: PPDDL has no horizon. Chosen, as in
the planning competitions since 2011."""


def domain_of(
    name: str,
    schemas: Sequence[Schema],
    starts: Sequence[Start],
    metric: Metric,
    words: Words,
    definitions: Definitions,
    functions: Sequence[Symbol],
    naming: Naming,
) -> Domain:
    """The domain; `functions` are what costs are counted with, and `naming` gives its rules their names."""
    declared = declarations_of(schemas, words, definitions)
    rules = [rule for schema in schemas for rule in _rules(schema, declared, naming)]
    acting = {rule.action for rule in rules}
    actions = tuple(schema.action for schema in schemas if schema.action.name in acting)
    derived = _used_definitions(rules, starts, definitions)
    conditions = [*_conditions(rules), *(d.condition for d in derived), *(start.goal for start in starts)]
    asked = {part.symbol for condition in conditions for part in _literals(condition)}
    effects = [effect for rule in rules for outcome in rule.outcomes for effect in _plain(outcome)]
    changed = {effect.symbol for effect in effects}
    symbols = tuple(
        Symbol(each.name, each.parameters, static=each.name not in changed)
        for each in words.predicates.values()
        if each.name in asked | changed
    )
    prices = [action.cost for action in actions]
    prices += [price for rule in rules for each in rule.outcomes for price in (each.reward, each.cost)]
    parts = [part for price in prices for part in price.parts]
    counting = [each for each in functions if each.name in {part.symbol for part in parts}]
    named = _objects_in(conditions[: len(conditions) - len(starts)], effects)
    named |= {term for part in parts for term in part.terms if isinstance(term, Object)}
    everything = words.everything
    constants = tuple(thing for thing in everything if thing in named) if named else ()
    heads = (
        *(s.parameters for s in (*symbols, *counting)),
        *(a.parameters for a in actions),
        *(d.parameters for d in derived),
    )
    bound = [*(v for head in heads for v in head), *_bound(conditions), *_bound_by_effects(rules)]
    things = everything if starts else constants
    types = _types({v.type for v in bound} | {thing.type for thing in things}, words)
    costs = any(action.cost for action in actions) or any(
        outcome.cost for rule in rules for outcome in rule.outcomes
    )
    return Domain(
        name,
        types,
        constants,
        (*symbols, *counting),
        (),
        actions,
        tuple(rules),
        (Outcome(Fraction(1), OutcomeKind.NOTHING),),
        metric.reward(costs, any(start.goal for start in starts) or not starts),
        derived,
    )


def problem_of(name: str, start: Start, domain: Domain, words: Words, horizon: int | None) -> Problem:
    """A problem for the domain with a horizon (None: unlimited), and those facts that something asks for."""
    known = {symbol.name for symbol in domain.symbols}
    constants = set(domain.constants)
    things = (*words.constants.values(), *start.objects)
    return Problem(
        name,
        domain.name,
        tuple(thing for thing in things if thing not in constants) if constants else things,
        start.facts.difference(fact for fact in start.facts if fact.symbol not in known),
        Unlimited() if horizon is None else Horizon(horizon),
        1.0,
        start.goal,
    )


def declarations_of(schemas: Sequence[Schema], words: Words, definitions: Definitions) -> Declarations:
    """All that the rules of schemas speak of, for the checker's means."""
    symbols = {each.name: Symbol(each.name, each.parameters) for each in words.predicates.values()}
    derived = {each.name: each for each in definitions.predicates}
    parents = {name: None if above == OBJECT else above for name, above in words.types.declared.items()}
    types = {name: Type(name, above or OBJECT) for name, above in parents.items()}
    rules = [rule for schema in schemas for rule in schema.rules]
    conditions = [*_conditions(rules), *(each.condition for each in definitions.predicates)]
    named = _objects_in(conditions, [e for rule in rules for o in rule.outcomes for e in _plain(o)])
    constants = {thing.name: thing for thing in sorted(named)}
    return Declarations(
        types | {OBJECT: Type(OBJECT)}, constants, symbols | as_symbols(derived.values()), derived=derived
    )


# ---- rules


def _rules(schema: Schema, declared: Declarations, naming: Naming) -> Iterator[Rule]:
    """The rules that can change something; one that is alone is called as its action is."""
    kept = [tidy for rule in schema.rules if (tidy := _tidied(rule, declared)) is not None]
    for rule in kept:
        name = naming.fresh(rule.name if len(kept) > 1 else rule.action)
        yield rule if name == rule.name else replace(rule, name=name)


def _tidied(rule: Rule, declared: Declarations) -> Rule | None:
    """The rule without effects that its condition says already, and each outcome once; None for a rule that
    can never apply, or that changes and pays nothing."""
    if not can_apply(rule, declared):
        return None
    asked = asked_by(rule.condition, declared)
    found: dict[object, Outcome] = {}
    for outcome in rule.outcomes:
        idle = idle_because(outcome, asked, declared)
        tidy = outcome
        if any(why is not None for why in idle):
            effects = tuple(e for e, why in zip(outcome.effects, idle, strict=True) if why is None)
            does = effects or outcome.reward or outcome.cost
            tidy = replace(outcome, effects=effects, kind=OutcomeKind.CHANGE if does else OutcomeKind.NOTHING)
        if len(rule.outcomes) == 1:  # there is no other to compare it with
            found[None] = tidy
            break
        done = doing(tidy, asked, declared), outcome.reward, outcome.cost
        before = found.get(done)
        if before is not None:
            tidy = replace(before, probability=before.probability + tidy.probability)
        found[done] = tidy
    outcomes = list(found.values())
    if all(outcome.kind is OutcomeKind.NOTHING for outcome in outcomes):
        return None
    if outcomes[-1].kind is OutcomeKind.NOTHING:
        outcomes[-1] = replace(outcomes[-1], is_rest=True)
    return rule if tuple(outcomes) == rule.outcomes else replace(rule, outcomes=tuple(outcomes))


# ---- what is used


def _used_definitions(
    rules: Sequence[Rule], starts: Sequence[Start], definitions: Definitions
) -> tuple[DerivedPredicate, ...]:
    """The derived predicates that rules and goals use, directly or not, each before those that use it."""
    made = {each.name: each for each in definitions.predicates}
    waiting = [*_conditions(rules), *(start.goal for start in starts)]
    used: set[str] = set()
    while waiting:
        for part in _literals(waiting.pop()):
            if part.symbol in made and part.symbol not in used:
                used.add(part.symbol)
                waiting.append(made[part.symbol].condition)
    return tuple(each for each in definitions.predicates if each.name in used)


def _conditions(rules: Iterable[Rule]) -> Iterator[Condition]:
    """The conditions of rules, and those of what they do."""
    for rule in rules:
        yield rule.condition
        for outcome in rule.outcomes:
            yield from (effect.condition for effect in outcome.effects if isinstance(effect, ForAll))


def _literals(condition: Condition) -> Iterator[Literal]:
    for part in condition:
        if isinstance(part, Quantified):
            yield from (inner for inner in part.condition if isinstance(inner, Literal))
        elif isinstance(part, Literal):
            yield part


def _bound(conditions: Iterable[Condition]) -> Iterator[Variable]:
    for condition in conditions:
        for part in condition:
            yield from part.variables if isinstance(part, Quantified) else ()


def _bound_by_effects(rules: Iterable[Rule]) -> Iterator[Variable]:
    for rule in rules:
        for outcome in rule.outcomes:
            for effect in outcome.effects:
                yield from effect.variables if isinstance(effect, ForAll) else ()


def _plain(outcome: Outcome) -> Iterator[Assign | Shift]:
    for effect in outcome.effects:
        if isinstance(effect, ForAll):
            yield from effect.effects
        else:
            yield effect


def _objects_in(conditions: Iterable[Condition], effects: Iterable[Assign | Shift]) -> set[Object]:
    """The objects that a domain names."""
    terms = [term for effect in effects for term in effect.terms]
    for condition in conditions:
        for part in condition:
            for inner in part.condition if isinstance(part, Quantified) else (part,):
                terms += [inner.left, inner.right] if isinstance(inner, Equality) else inner.terms
    return {term for term in terms if isinstance(term, Object)}


def _types(mentioned: Collection[str], words: Words) -> tuple[Type, ...]:
    """The types of these and those above them; `object` only where something is of it."""
    parents: Mapping[str, str] = words.types.declared
    kept = {name for each in mentioned for name in words.types.line(each)} - {OBJECT}
    root = OBJECT if OBJECT in mentioned else None
    found = [Type(n, root if parents[n] == OBJECT else parents[n]) for n in parents if n in kept]
    return (*([Type(OBJECT)] if root else []), *found)
