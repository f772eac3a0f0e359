"""A .nid domain and what is written of it for libPRADA, compared state by state.

The library's side is its records executed as they stand: a rule covers a state where exactly one binding of
what it refers to fits.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice, product

import numpy as np

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Values
from cleancli.compiler.lifted import LiftedState
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.conversion.check import check
from cleancli.conversion.experience.data import vocabulary_of
from cleancli.conversion.experience.vocabulary import Vocabulary
from cleancli.conversion.export.libprada import libprada
from cleancli.conversion.export.libprada_names import LibpradaNames
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import Written
from cleancli.conversion.read import read
from cleancli.conversion.records import Atom, Library, LibraryRule, is_variable, variables_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Problem, Rule
from support.exported_ppddl import at_most_one_covers, calls, drawn_values

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


@dataclass(frozen=True)
class Called:
    """What the files of a domain and a problem call its things; `fixed` are the atoms of symbols that the
    domain does not have, `divided` the actions of rules of which a note tells that what they refer to is
    found in another way there."""

    vocabulary: Vocabulary
    numbers: Mapping[str, str]
    actions: Mapping[str, str]
    fixed: World
    divided: frozenset[str]

    def world(self, domain: Domain, values: Values) -> World:
        """A state as atoms of the files."""
        symbols = {symbol.name: symbol for symbol in domain.symbols}
        atoms = self.vocabulary.atoms(values, symbols)
        return self.fixed | {(name, *(self.numbers[each] for each in objects)) for name, objects in atoms}

    def terms(self, names: tuple[str, ...]) -> tuple[str, ...]:
        """Objects as the files call them."""
        return tuple(self.numbers[name] for name in names)


def called(domain: Domain, problem: Problem, library: Library, notes: Sequence[str]) -> Called:
    """The names of a domain and a problem in their files, of which notes were told."""
    names = LibpradaNames(domain, problem)
    vocabulary = vocabulary_of(domain, names)
    others = (fact for fact in library.facts if fact.symbol not in vocabulary.meanings)
    fixed = frozenset((fact.symbol, *fact.terms) for fact in others)
    actions = {action.name: names.of(action.name, "action") for action in domain.actions}
    told = {name for note in notes if "refer to" in note for name in note.split(": ")[1].split(", ")}
    divided = frozenset(rule.action for rule in domain.rules if rule.name in told)
    return Called(vocabulary, names.numbers, actions, fixed, divided)


@dataclass(frozen=True)
class Step:
    """An action in a state, and what the domain says of it; nothing where no rule covers the state. It is
    `exact` where all probabilities of the rule can be written to the last digit."""

    action: str
    names: tuple[str, ...]
    before: World
    wanted: Sequence[Distribution]
    exact: bool


def steps(
    domain: Domain, problem: Problem, files: Called, states: int, rng: np.random.Generator
) -> Iterator[Step]:
    """An action in each of so many random states, but for those in which an outcome gives something two
    values (E602), or several rules apply, or a rule is one for each case of what it refers to and several
    objects fit."""
    rules, every = LiftedRules(domain), list(calls(domain, problem))
    for _ in range(states if every else 0):
        values = drawn_values(domain, problem, rng)
        state = rules.state(problem.objects, values)
        covered = [each for each in every if rules.covering(state, *each)]
        among = covered if covered and rng.random() < 0.8 else every
        action, names = among[int(rng.integers(len(among)))]
        if not at_most_one_covers(rules, state, action, names):
            continue
        if action in files.divided and _several_fit(rules, state, action, names):
            continue
        found = rules.covering(state, action, names)
        try:
            wanted = [] if found is None else [_expected(rules, state, values, *found, files)]
        except Refused:
            continue
        exact = found is None or _are_written_exactly(domain.rules[found[0]])
        yield Step(action, names, files.world(domain, values), wanted, exact)


def _are_written_exactly(rule: Rule) -> bool:
    return all(10**15 % outcome.probability.denominator == 0 for outcome in rule.outcomes)


def _several_fit(rules: LiftedRules, state: LiftedState, action: str, names: tuple[str, ...]) -> bool:
    """Whether several objects fit the first reference of a rule of an action."""
    numbers = [number for number, rule in enumerate(rules.domain.rules) if rule.action == action]
    found = [rules[number] for number in numbers if rules.domain.rules[number].references]
    return any(
        len(list(islice(rule.references[0](state, names), 2))) > 1
        for rule in found
        if rule.condition(state, names)
    )


def disagreements(domain: Domain, problem: Problem, states: int, rng: np.random.Generator) -> Iterator[str]:
    """Where the files do something else, in so many random states, by an action each. Raises Refused for what
    libPRADA can't say."""
    made = written(domain, problem)
    library = library_of(made)
    files = called(domain, problem, library, made.notes)
    objects = list(files.numbers.values())
    for step in steps(domain, problem, files, states, rng):
        acting = [rule for rule in library.rules if rule.action.symbol == files.actions[step.action]]
        found = [_done(rule, files.terms(step.names), step.before, objects) for rule in acting]
        actual = [each for each in found if each is not None]
        if len(actual) > 1:  # where more than one rule covers, the default rule counts (Pasula et al. 2007)
            actual = []
        if not _same(actual, step):
            yield f"{step.action}{step.names} in {sorted(step.before)}: {actual} and not {step.wanted}"


def _same(actual: Sequence[Distribution], step: Step) -> bool:
    """Whether the same is as likely: to the last digit, and to 1e-14 where what is written is rounded."""
    most = Fraction(0) if step.exact else Fraction(1, 10**14)
    return len(actual) == len(step.wanted) and all(
        one.keys() == other.keys() and all(abs(one[world] - other[world]) <= most for world in other)
        for one, other in zip(actual, step.wanted, strict=True)
    )


def _expected(
    rules: LiftedRules,
    state: LiftedState,
    values: Values,
    number: int,
    bound: tuple[str, ...],
    files: Called,
) -> Distribution:
    """What a rule of the domain that covers the state leads to."""
    likely: Distribution = {}
    outcomes = rules.domain.rules[number].outcomes
    for outcome, changed in zip(outcomes, results(rules, state, number, bound), strict=True):
        if outcome.probability:
            after = files.world(rules.domain, {**values, **changed})
            likely[after] = likely.get(after, Fraction(0)) + outcome.probability
    return likely


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
