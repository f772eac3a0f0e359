"""A .nid domain and what is written of it for libPRADA, compared state by state.

The library's side is its records executed as they stand: a rule covers a state where exactly one binding of
what it refers to fits. Names are taken to have stayed.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import product

import numpy as np

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Values
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.conversion.check import check
from cleancli.conversion.export.libprada import libprada
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import Written
from cleancli.conversion.read import read
from cleancli.conversion.records import Atom, Library, LibraryRule, is_variable, variables_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Problem
from support.exported_ppddl import calls, drawn_values

World = frozenset[tuple[str, ...]]
"""The atoms that hold, a symbol and its objects."""

Distribution = dict[World, Fraction]

FILES = ("rules.dat", "state.dat", "symbols.dat")


def written(domain: Domain, problem: Problem) -> Written:
    """The files of a domain and a problem."""
    return libprada(domain, problem, "unchanged", Unsaid("libPRADA", [Source("domain.nid", "")]))


def library_of(made: Written) -> Library:
    """The records of the files, which fit together."""
    rules, state, symbols = (Source(name, made.texts[name]) for name in FILES)
    library = read(rules, state, symbols)
    check(library)
    return library


def world_of(domain: Domain, values: Values, made: Written, fixed: World) -> World:
    """A state as atoms of the files; `fixed` are those of symbols that the domain does not have."""
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    found = set(fixed)
    for (name, objects), value in values.items():
        symbol = symbols[name]
        shown = name if symbol.is_predicate else f"{name}_{value}"
        ways = {objects, objects[::-1]} if symbol.symmetric else {objects}
        if value is not False:
            found |= {(shown, *(made.names[each] for each in way)) for way in ways}
    return frozenset(found)


def disagreements(domain: Domain, problem: Problem, states: int, rng: np.random.Generator) -> Iterator[str]:
    """Where the files do something else, in so many random states, by an action each. Raises Refused for what
    libPRADA can't say."""
    made = written(domain, problem)
    library, rules = library_of(made), LiftedRules(domain)
    own = {f"{s.name}_{v}" for s in domain.symbols for v in s.values} | {s.name for s in domain.symbols}
    fixed = frozenset((fact.symbol, *fact.terms) for fact in library.facts if fact.symbol not in own)
    every = list(calls(domain, problem))
    objects = [made.names[each.name] for each in (*domain.constants, *problem.objects)]
    for _ in range(states):
        values = drawn_values(domain, problem, rng)
        state = rules.state(problem.objects, values)
        covered = [each for each in every if rules.covering(state, *each)]
        among = covered if covered and rng.random() < 0.8 else every
        action, names = among[int(rng.integers(len(among)))]
        try:
            wanted = _expected(rules, problem, values, action, names, made, fixed)
        except Refused:  # an outcome gives something two values (E602)
            continue
        world = world_of(domain, values, made, fixed)
        arguments = tuple(made.names[name] for name in names)
        acting = [rule for rule in library.rules if rule.action.symbol == action]
        found = [_done(rule, arguments, world, objects) for rule in acting]
        actual = [each for each in found if each is not None]
        if len(actual) > 1:  # where more than one rule covers, the default rule counts (Pasula et al. 2007)
            actual = []
        if actual != wanted:
            yield f"{action}{names} in {sorted(world)}: {actual} and not {wanted}"


def _expected(
    rules: LiftedRules,
    problem: Problem,
    values: Values,
    action: str,
    names: tuple[str, ...],
    made: Written,
    fixed: World,
) -> list[Distribution]:
    """What the domain says of an action; nothing where no rule covers the state."""
    state = rules.state(problem.objects, values)
    found = rules.covering(state, action, names)
    if found is None:
        return []
    number, bound = found
    likely: Distribution = {}
    outcomes = rules.domain.rules[number].outcomes
    for outcome, changed in zip(outcomes, results(rules, state, number, bound), strict=True):
        if outcome.probability:
            after = world_of(rules.domain, {**values, **changed}, made, fixed)
            likely[after] = likely.get(after, Fraction(0)) + outcome.probability
    return [likely]


def _done(
    rule: LibraryRule, arguments: tuple[str, ...], world: World, objects: list[str]
) -> Distribution | None:
    """What a rule leads to; None where it does not cover the state."""
    head = dict(zip(rule.action.terms, arguments, strict=True))
    referred = [each for each in variables_of(*rule.context) if each not in head]
    every = [
        head | dict(zip(referred, chosen, strict=True)) for chosen in product(objects, repeat=len(referred))
    ]
    bindings = [binding for binding in every if all(_holds(atom, binding, world) for atom in rule.context)]
    if len(bindings) != 1:
        return None
    found: Distribution = {}
    for result in rule.results:
        added = {_ground(effect, bindings[0]) for effect in result.effects if effect.value}
        deleted = {_ground(effect, bindings[0]) for effect in result.effects if not effect.value}
        after = (world - deleted) | added
        found[after] = found.get(after, Fraction(0)) + result.probability
    return found


def _ground(atom: Atom, binding: dict[str, str]) -> tuple[str, ...]:
    return (atom.symbol, *(binding[term] if is_variable(term) else term for term in atom.terms))


def _holds(atom: Atom, binding: dict[str, str], world: World) -> bool:
    return (_ground(atom, binding) in world) is atom.value
