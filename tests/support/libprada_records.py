"""libPRADA's records executed as they stand, slowly, and compared with the task that is made of them."""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import product

from cleancli.compiler.ground import ground
from cleancli.compiler.task import GroundRule, GroundState, Task, holds
from cleancli.conversion.check import check, constants_of
from cleancli.conversion.convert import Wishes, convert
from cleancli.conversion.read import read
from cleancli.conversion.records import Atom, Library, LibraryRule, is_variable, variables_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem

FILES = ("rules.dat", "state.dat", "symbols.dat")

Fact = tuple[str, tuple[str, ...]]
State = dict[Fact, bool | int]
"""What is not false."""

Outcomes = tuple[tuple[frozenset[tuple[Fact, bool | int]], float], ...]
"""States with their probabilities, each once, sorted."""


def disagreements(
    files: dict[str, str], steps: int, seed: int, read_from: dict[str, str] | None = None
) -> list[str]:
    """Actions and states along a random walk for which records and task disagree; `read_from` has the records
    if they are not those of the task."""
    rng = random.Random(seed)
    library = read(*[Source(name, (read_from or files)[name]) for name in FILES])
    check(library)
    rules, start, symbols = (Source(name, files[name]) for name in FILES)
    made = convert(rules, start, symbols, Wishes(), ("domain.nid", "problem.nid"))
    domain = load_domain(made.sources[0])
    task = ground(domain, load_problem(made.sources[1], domain), compat=True)
    members = dict(made.functions)
    state, found = task.initial, []
    for _ in range(steps):
        index = rng.randrange(len(task.actions))
        applying = [r for r in task.rules if r.action == index and holds(r.condition, state)]
        ours = sorted(_ours(rule, state, task, library, members) for rule in applying)
        theirs = sorted(_theirs(task, index, _facts(task, state, library, members), library))
        if [_rounded(o) for o in ours] != [_rounded(o) for o in theirs]:
            found.append(f"{task.actions[index]}: {len(ours)} rules against {len(theirs)}")
        if applying:
            outcome = rng.choice(rng.choice(applying).outcomes)
            state = _changed(state, outcome.effects)
    return found


def _rounded(outcomes: Outcomes) -> list[tuple[object, float]]:
    return [(state, round(probability, 2)) for state, probability in outcomes]


def _summed(pairs: list[tuple[State, float]]) -> Outcomes:
    total: dict[frozenset[tuple[Fact, bool | int]], float] = {}
    for state, probability in pairs:
        key = frozenset(state.items())
        total[key] = total.get(key, 0.0) + probability
    return tuple(sorted(total.items(), key=lambda pair: (sorted(map(str, pair[0])), pair[1])))


# ---- the task's side


def _ours(
    rule: GroundRule, state: GroundState, task: Task, library: Library, members: dict[str, tuple[str, ...]]
) -> Outcomes:
    after = [(_changed(state, o.effects), float(o.probability)) for o in rule.outcomes]
    return _summed([(_facts(task, s, library, members), p) for s, p in after])


def _changed(state: GroundState, effects: tuple[tuple[int, int], ...]) -> GroundState:
    values = list(state)
    for variable, value in effects:
        values[variable] = value
    return tuple(values)


def _facts(task: Task, state: GroundState, library: Library, members: dict[str, tuple[str, ...]]) -> State:
    """An assignment as libPRADA's facts: the initial ones, with those that can change as they are."""
    facts = {(f.symbol, f.terms): f.value for f in library.facts if f.value is not False}
    for variable, index in zip(task.variables, state, strict=True):
        terms = tuple(name.removeprefix("o") for name in variable.objects)
        value = variable.values[index]
        for member in members.get(variable.symbol, ()):
            _set(facts, (member, terms), str(value).casefold() == member[: len(str(value))].casefold())
        if variable.symbol not in members:
            _set(facts, (variable.symbol, terms), value)  # type: ignore[arg-type]
    return facts


def _set(facts: State, fact: Fact, value: bool | int) -> None:
    facts.pop(fact, None)
    if value is not False:
        facts[fact] = value


# ---- the records' side


def _theirs(task: Task, action: int, state: State, library: Library) -> Iterator[Outcomes]:
    """One for each rule and binding of its references that covers the state."""
    arguments = tuple(name.removeprefix("o") for name in task.actions[action].objects)
    for rule in library.rules:
        if rule.action.symbol == task.actions[action].name:
            for binding in _bindings(rule, arguments, library):
                atoms = [_bound(atom, binding) for atom in rule.context]
                if all(_true(atom, state) for atom in atoms) and not _contradicts(rule, binding):
                    yield _summed(
                        [
                            (_after([_bound(e, binding) for e in r.effects], state), float(r.probability))
                            for r in rule.results
                        ]
                    )


def _bindings(rule: LibraryRule, arguments: tuple[str, ...], library: Library) -> Iterator[dict[str, str]]:
    head: dict[str, str] = {}
    for term, argument in zip(rule.action.terms, arguments, strict=True):
        if (head.setdefault(term, argument) if is_variable(term) else term) != argument:
            return
    referred = [v for v in variables_of(*rule.context) if v not in head]
    for values in product(constants_of(library), repeat=len(referred)):
        yield head | dict(zip(referred, values, strict=True))


def _bound(atom: Atom, binding: dict[str, str]) -> Atom:
    terms = tuple(binding.get(term, term) for term in atom.terms)
    return Atom(atom.symbol, terms, atom.relation, atom.value, atom.span)


def _true(atom: Atom, state: State) -> bool:
    value = state.get((atom.symbol, atom.terms), False)
    assert atom.relation in ("=", "<", ">=")
    compared = {"=": value == atom.value, "<": value < atom.value, ">=": value >= atom.value}
    return compared[atom.relation]


def _contradicts(rule: LibraryRule, binding: dict[str, str]) -> bool:
    """Whether an outcome gives a fact two values; such bindings are kept apart."""
    for result in rule.results:
        values: State = {}
        for effect in (_bound(e, binding) for e in result.effects):
            if values.setdefault((effect.symbol, effect.terms), effect.value) != effect.value:
                return True
    return False


def _after(effects: list[Atom], state: State) -> State:
    after = dict(state)
    for effect in effects:
        _set(after, (effect.symbol, effect.terms), effect.value)
    return after
