"""A .nid domain that was written in another language and converted back, compared with itself.

What follows an action in a state must be equally likely in both, over what both speak of: the converter
leaves out what nothing asks for and nothing changes, and a function comes back as a predicate for each value.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product

import numpy as np

from cleancli.compiler.fluents import Fluent, Values
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.compiler.objects_by_type import ObjectsByType
from cleancli.conversion.pddl.convert import Wishes, convert
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import (
    NOTHING_PAID,
    Domain,
    Fact,
    Horizon,
    Object,
    Problem,
    RewardKind,
    RewardTerm,
    Symbol,
    Unlimited,
    Value,
)
from cleancli.learning.experience import Transition
from cleancli.learning.variation import foretold
from support.exported_ppddl import at_most_one_covers, calls, drawn_values, happening, written

ACCURACY = 1e-9
"""How far a probability may be from what it was."""

Moved = frozenset[tuple[Fluent, Value]]


@dataclass(frozen=True)
class Returned:
    """A domain and its problem as they have come back; `lost` says what was left out on the way."""

    domain: Domain
    problem: Problem
    lost: tuple[str, ...]


def through_ppddl(domain: Domain, problem: Problem) -> Returned:
    """The domain, written as PPDDL and converted back; without its reward, if a .nid file has no form for
    what has become of it. Raises Refused for what is lost altogether."""
    try:
        return _through_ppddl(domain, problem, ())
    except Refused as refused:
        lost = sorted({each.code for each in refused.diagnostics})
    return _through_ppddl(_without_reward(domain), problem, (f"the reward ({', '.join(lost)})",))


def _without_reward(domain: Domain) -> Domain:
    """The domain, in which actions cost something and nothing else is paid."""
    rules = tuple(
        replace(
            rule, outcomes=tuple(replace(o, reward=NOTHING_PAID, cost=NOTHING_PAID) for o in rule.outcomes)
        )
        for rule in domain.rules
    )
    return replace(domain, rules=rules, reward=(RewardTerm(Fraction(-1), RewardKind.COST),))


def _through_ppddl(domain: Domain, problem: Problem, lost: tuple[str, ...]) -> Returned:
    texts = written(domain, problem).texts
    made = convert([Source(name, text) for name, text in texts.items()], Wishes())
    returned = load_domain(Source("domain.nid", made.domain))
    (text,) = made.problems.values()
    return Returned(returned, load_problem(Source("problem.nid", text), returned), lost)


def disagreements(
    domain: Domain, problem: Problem, back: Returned, states: int, rng: np.random.Generator
) -> Iterator[str]:
    """Where the domain that has come back does something else, or pays something else where its reward has
    come back too, in so many random states, by one action."""
    before, after = LiftedRules(domain), LiftedRules(back.domain)
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    known = {symbol.name for symbol in back.domain.symbols}
    atoms_of = {_name(symbol, value) for symbol in domain.symbols for value in symbol.values}
    always = {(f.symbol, f.objects): f.value for f in back.problem.state if f.symbol not in atoms_of}
    pays = not back.lost and not isinstance(problem.horizon, Unlimited)
    every = list(calls(domain, problem))
    # A goal of PPDDL ends what is earned, and a .nid file goes on after it (docs/from-pddl.md).
    earns = problem.goal and not isinstance(problem.horizon, Unlimited)
    ends = before.meaning.test(problem.goal, {}) if earns else None
    called = {each.name: _came_of(each.name, domain) for each in back.domain.actions}
    for _ in range(states if every else 0):
        values = drawn_values(domain, problem, rng)
        state = before.state(problem.objects, values)
        if ends is not None and ends(state, ()):
            continue
        covered = [each for each in every if before.covering(state, *each)]
        among = covered if covered and rng.random() < 0.8 else every
        action, names = among[int(rng.integers(len(among)))]
        if not at_most_one_covers(before, state, action, names):
            continue
        here = Transition(action, names, problem.objects, values, values)
        try:
            following = foretold(before, here)
        except Refused:  # an outcome gives something two values (E602)
            continue
        wanted: dict[Moved, float] = {}
        for moved, chance in following.items():
            atoms = frozenset(_moved(symbols, values, moved, known))
            wanted[atoms] = wanted.get(atoms, 0.0) + chance
        facts = {**always, **{atom: True for atom in _atoms(symbols, values) if atom[0] in known}}
        own = [each for each in called if called[each] == action]
        taken = next(
            (e for e in own if after.covering(after.state(back.problem.objects, facts), e, names)), None
        )
        found = _found(after, back, taken, names, facts)
        keys = wanted.keys() | found.keys()
        if any(abs(wanted.get(key, 0.0) - found.get(key, 0.0)) > ACCURACY for key in keys):
            yield f"{action}{names} in {sorted(values.items())}: {found} and not {wanted}"
        elif pays and taken is not None and before.covering(state, action, names) is not None:
            due = _as_atoms(_paid(before, problem, values, action, names), symbols, values, known)
            paid = _paid(after, back.problem, facts, taken, names)
            if paid != due:
                yield f"{action}{names} in {sorted(values.items())} pays {paid} and not {due}"


def _came_of(name: str, domain: Domain) -> str:
    """The action that one of the domain that has come back has come of: its rules are actions by themselves,
    and an action is several where its costs depend on conditions."""
    fitting = [each.name for each in domain.actions if f"{name}_".startswith(f"{each.name}_")]
    return max(fitting, key=len)


def _found(
    rules: LiftedRules, back: Returned, action: str | None, names: tuple[str, ...], facts: Values
) -> Mapping[Moved, float]:
    """What follows by an action that a rule covers, or by none."""
    if action is None:
        return {frozenset(): 1.0}
    return foretold(rules, Transition(action, names, back.problem.objects, facts, facts))


_Paid = dict[tuple[Moved, Fraction], Fraction]
"""How likely what moves is, together with what that is paid but for the goal."""


def _paid(rules: LiftedRules, problem: Problem, values: Values, action: str, names: tuple[str, ...]) -> _Paid:
    """What an action that some rule covers moves, and what it is paid for that."""
    happen = happening(rules, problem, values, action, names)
    assert happen is not None
    found: _Paid = {}
    for chance, after, earned in happen:
        keys = after.keys() | values.keys()
        others = {
            key: after.get(key, False) for key in keys if after.get(key, False) != values.get(key, False)
        }
        key = frozenset(others.items()), earned
        found[key] = found.get(key, Fraction(0)) + chance
    return found


def _as_atoms(paid: _Paid, symbols: Mapping[str, Symbol], values: Values, known: set[str]) -> _Paid:
    """The same of what becomes of atoms."""
    found: _Paid = {}
    for (moved, earned), chance in paid.items():
        key = frozenset(_moved(symbols, values, moved, known)), earned
        found[key] = found.get(key, Fraction(0)) + chance
    return found


def _name(symbol: Symbol, value: Value) -> str:
    if symbol.is_predicate:
        return symbol.name
    return (
        f"{symbol.name}_minus_{-value}" if isinstance(value, int) and value < 0 else f"{symbol.name}_{value}"
    )


def _ways(symbol: Symbol, value: Value, names: tuple[str, ...]) -> Iterator[Fluent]:
    """The atoms that say a fact."""
    yield _name(symbol, value), names
    if symbol.symmetric and len(set(names)) > 1:
        yield _name(symbol, value), names[::-1]


def _atoms(symbols: Mapping[str, Symbol], values: Values) -> Iterator[Fluent]:
    for (name, names), value in values.items():
        if value is not False:
            yield from _ways(symbols[name], value, names)


def _moved(
    symbols: Mapping[str, Symbol], values: Values, moved: Moved, known: set[str]
) -> Iterator[tuple[Fluent, Value]]:
    """What becomes of atoms where facts change."""
    for (name, names), value in moved:
        symbol = symbols[name]
        if symbol.is_predicate:
            changes = [(atom, value) for atom in _ways(symbol, value, names)]
        else:
            old = values[name, names]
            changes = [((_name(symbol, value), names), True), ((_name(symbol, old), names), False)]
        yield from (change for change in changes if change[0][0] in known)


# ---- problems for domains that come without


def drawn_problem(domain: Domain, rng: np.random.Generator, each: int = 2) -> Problem:
    """A problem of a domain with so many objects of each type, and facts at random."""
    objects = tuple(Object(f"{t.name}_{n}", t.name) for t in domain.types for n in range(1, each + 1))
    by_type = ObjectsByType(domain, (*domain.constants, *objects))
    facts = set()
    for symbol in domain.symbols:
        for names in product(*(by_type[v.type] for v in symbol.parameters)):
            if not symbol.is_predicate:
                facts.add(Fact(symbol.name, names, symbol.values[int(rng.integers(len(symbol.values)))]))
            elif names == symbol.canonical(names) and rng.random() < 0.4:
                facts.add(Fact(symbol.name, names))
    return Problem("drawn", domain.name, objects, frozenset(facts), Horizon(5))
