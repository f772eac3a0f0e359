"""A .nid domain that was written for libPRADA and converted back, compared with itself.

What follows an action in a state must be equally likely in both. A state is atoms of the files, and these are
facts of the domain that has come back as those of state.dat are.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

import numpy as np

from cleancli.compiler.fluents import Fluent, Values, values_of
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.conversion.convert import Converted, Wishes, convert
from cleancli.conversion.records import Atom
from cleancli.conversion.symbols import facts
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain, Problem, Value
from cleancli.learning.experience import Transition
from cleancli.learning.variation import foretold
from support.exported_libprada import FILES, Called, Step, World, called, steps, written
from support.round_trips import ACCURACY

Facts = frozenset[tuple[Fluent, Value]]


@dataclass(frozen=True)
class Returned:
    """A domain and its problem as they have come back, how they were made, and what the files call things."""

    domain: Domain
    problem: Problem
    made: Converted
    files: Called

    def values(self, world: World) -> Values | None:
        """What atoms of the files say; None where they give a function two values, or none: its predicates
        held by turns in the problem's state, and nothing says so of others."""
        words = self.made.words
        functions = words.names.functions
        held: Counter[Fluent] = Counter(
            (functions[atom[0]].name, atom[1:]) for atom in world if atom[0] in functions
        )
        arity = {symbol.name: symbol.arity for symbol in self.made.library.symbols}
        for member, function in functions.items():
            least = 0 if len(function.values) > len(function.value_of) else 1
            every = product(words.names.objects, repeat=arity[member])
            if any(not least <= held[function.name, terms] <= 1 for terms in every):
                return None
        atoms = tuple(Atom(atom[0], atom[1:], "=", True, Span("", 0, 0)) for atom in world)
        library = replace(self.made.library, facts=atoms)
        return values_of(facts(library, words, list(words.names.objects.values())))


def through_libprada(domain: Domain, problem: Problem) -> Returned:
    """The domain, written for libPRADA and converted back. Raises Refused for what libPRADA can't say, or
    what can't be read back."""
    there = written(domain, problem)
    rules, state, symbols = (Source(name, there.texts[name]) for name in FILES)
    made = convert(rules, state, symbols, Wishes(reward="cost"), ("domain.nid", "problem.nid"))
    back = load_domain(made.sources[0])
    files = called(domain, problem, made.library, there.notes)
    return Returned(back, load_problem(made.sources[1], back), made, files)


def disagreements(
    domain: Domain, problem: Problem, back: Returned, states: int, rng: np.random.Generator
) -> Iterator[str]:
    """Where the domain that has come back does something else, in so many random states, by one action."""
    rules = LiftedRules(back.domain)
    for step in steps(domain, problem, back.files, states, rng):
        before = back.values(step.before)
        if before is None:
            continue
        wanted: defaultdict[Facts | None, float] = defaultdict(float)
        likely = [each for draws in step.wanted for each in draws.items()] or [(step.before, Fraction(1))]
        for after, chance in likely:
            wanted[_facts(back.values(after))] += float(chance)
        found = _found(rules, back, step, before)
        keys = wanted.keys() | found.keys()
        if any(abs(wanted[key] - found[key]) > ACCURACY for key in keys):
            yield f"{step.action}{step.names} in {sorted(step.before)}: {dict(found)} and not {dict(wanted)}"


def _found(
    rules: LiftedRules, back: Returned, step: Step, before: Values
) -> defaultdict[Facts | None, float]:
    """What follows, and how likely, in the domain that has come back."""
    words = back.made.words.names
    action = words.symbols[back.files.actions[step.action]]
    arguments = tuple(words.objects[number] for number in back.files.terms(step.names))
    here = Transition(action, arguments, back.problem.objects, before, before)
    found: defaultdict[Facts | None, float] = defaultdict(float)
    for moved, chance in foretold(rules, here).items():
        found[_facts({**before, **dict(moved)})] += chance
    return found


def _facts(values: Values | None) -> Facts | None:
    """The facts that hold; false ones may be said or not."""
    return None if values is None else frozenset(each for each in values.items() if each[1] is not False)
