"""Experience as libPRADA's data.dat: a line for each state and each action in turn.

The library reads one chain of states and actions, or transitions one by one, of which each has two states; so
a state behind a state begins anew here. Types are predicates, which tell which objects there are.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from cleancli.compiler.fluents import Values
from cleancli.conversion.check import misfits
from cleancli.conversion.convert import Converted
from cleancli.conversion.experience.chains import Chain
from cleancli.conversion.experience.vocabulary import Meaning, Vocabulary, meanings_of, values_of
from cleancli.conversion.export.libprada_names import LibpradaNames
from cleancli.conversion.names import OBJECT, called
from cleancli.conversion.records import Atom
from cleancli.conversion.scan import Unreadable, lines_of
from cleancli.conversion.symbols import facts
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Object, Symbol
from cleancli.learning.experience import Transition


def data_text(chains: Sequence[Chain], domain: Domain, names: LibpradaNames) -> str:
    """The file of chains: as they are where there is one, otherwise each transition with its two states."""
    vocabulary = vocabulary_of(domain, names)
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    several = len(chains) > 1
    lines: list[str] = []
    for chain in chains:
        things = sorted({*chain.objects, *domain.constants})
        kinds = [
            (names.of(kind.name, "type"), (thing.name,))
            for kind in domain.types
            for thing in things
            if domain.is_a(thing.type, kind.name)
        ]
        states = [
            " ".join(_said(*atom, names) for atom in (*kinds, *vocabulary.atoms(values, symbols)))
            for values in chain.states
        ]
        for place, (action, objects) in enumerate(chain.actions):
            if place == 0 or several:
                lines.append(states[place])
            lines += [_said(names.of(action, "action"), objects, names), states[place + 1]]
    return "".join(f"{line}\n" for line in lines)


def _said(name: str, objects: Sequence[str], names: LibpradaNames) -> str:
    return f"{name}({' '.join(names.numbers[each] for each in objects)})"


def vocabulary_of(domain: Domain, names: LibpradaNames) -> Vocabulary:
    """What the predicates of a domain are called in its files for libPRADA."""
    found: dict[Meaning, str] = {}
    for symbol, value in meanings_of(domain):
        found[symbol, value] = names.of(
            names.predicates.of(symbol.name, None if symbol.is_predicate else value)
        )
    return Vocabulary(found, {name: meaning for meaning, name in found.items()})


# ---- and back


@dataclass(frozen=True, slots=True)
class Step:
    """An action, and what held before and after it, as the file has them."""

    before: tuple[Atom, ...]
    action: Atom
    after: tuple[Atom, ...]


def steps_of(source: Source, is_action: Callable[[str], bool]) -> tuple[Step, ...]:
    """The transitions of a text. Raises Refused with E911 for each line that cannot be read."""
    found: list[Diagnostic] = []
    steps: list[Step] = []
    state: tuple[Atom, ...] | None = None
    action: Atom | None = None
    follows = True
    for atoms in _lines(source, found):
        if len(atoms) == 1 and is_action(atoms[0].symbol):
            if state is None or action is not None:
                found.append(Diagnostic("E911", "no state stands before this action", atoms[0].span))
            action = atoms[0]
            continue
        if state is not None and action is not None:
            steps.append(Step(state, action, atoms))
        elif not follows and state:
            found.append(_alone(state))
        follows = action is not None
        state, action = atoms, None
    if action is not None:
        found.append(Diagnostic("E911", "no state stands behind this action", action.span))
    elif not follows and state:
        found.append(_alone(state))
    if found:
        raise Refused(found, [source])
    return tuple(steps)


def _alone(state: tuple[Atom, ...]) -> Diagnostic:
    message = "no action stands before or behind this state"
    return Diagnostic("E911", message, state[0].span, help="is an action misspelled?")


def _lines(source: Source, found: list[Diagnostic]) -> Iterator[tuple[Atom, ...]]:
    """The literals of each line that has some."""
    for scanner in lines_of(source):
        try:
            yield scanner.all_atoms()
        except Unreadable as unreadable:
            found.append(unreadable.diagnostic)


def read_data(
    source: Source, domain: Domain, objects: Collection[Object], names: LibpradaNames
) -> tuple[Transition, ...]:
    """The transitions of a file about a .nid domain, under the names that its files for libPRADA have.

    `objects` are those of the problem: others are called by their numbers. Raises Refused (E911, E912).
    """
    reader = _Reader(domain, objects, names)
    steps = steps_of(source, reader.actions.__contains__)
    transitions = [each for each in map(reader.transition, steps) if each is not None]
    if reader.found:
        raise Refused(reader.found, [source])
    return tuple(transitions)


class _Misfit(Exception):
    """An atom does not fit the domain."""

    def __init__(self, message: str, atom: Atom) -> None:
        super().__init__(message)
        self.diagnostic = Diagnostic("E912", message, atom.span)


class _Reader:
    """Makes transitions of steps; `found` has what is wrong with them."""

    def __init__(self, domain: Domain, objects: Collection[Object], names: LibpradaNames) -> None:
        self.found: list[Diagnostic] = []
        self.actions = {names.of(action.name, "action"): action for action in domain.actions}
        self._domain = domain
        self._meanings = vocabulary_of(domain, names).meanings
        self._types = {names.of(kind.name, "type"): kind.name for kind in domain.types}
        self._counts = {names.of(count.name) for count in domain.counts}
        self._called = {number: name for name, number in names.numbers.items()}
        self._constants = {each.name for each in domain.constants}
        self._kinds = {each.name: each.type for each in (*domain.constants, *objects)}

    def transition(self, step: Step) -> Transition | None:
        """The transition that a step is; None where something is wrong with it."""
        try:
            kinds = self._kinds_of(step)
            before, after = (self._values(atoms, kinds) for atoms in (step.before, step.after))
            action = self.actions[step.action.symbol]
            names = self._fitting(step.action, action.name, [p.type for p in action.parameters], kinds)
        except _Misfit as wrong:
            self.found.append(wrong.diagnostic)
            return None
        things = sorted(Object(name, kind) for name, kind in kinds.items() if name not in self._constants)
        return Transition(action.name, names, tuple(things), before, after)

    def _name(self, term: str) -> str:
        return self._called.get(term) or (f"o{term}" if term.isdecimal() else term)

    def _kinds_of(self, step: Step) -> Mapping[str, str]:
        """The type of each object of the step: as types tell, or the problem, or the one there is."""
        atoms = (*step.before, *step.after, step.action)
        told: dict[str, str] = {}
        for atom in atoms:
            if atom.symbol in self._types and len(atom.terms) == 1 and atom.value is True:
                name, kind = self._name(atom.terms[0]), self._types[atom.symbol]
                if name not in told or self._domain.is_a(kind, told[name]):
                    told[name] = kind
        for atom in atoms:
            for name in map(self._name, atom.terms):
                if name not in told:
                    told[name] = self._kind(name, atom)
        return told

    def _kind(self, name: str, atom: Atom) -> str:
        if name in self._kinds:
            return self._kinds[name]
        if len(self._domain.types) > 1:
            raise _Misfit(f"nothing tells the type of `{name}`", atom)
        return self._domain.types[0].name

    def _values(self, atoms: Sequence[Atom], kinds: Mapping[str, str]) -> Values:
        """What a state gives things for values; what is false is left out, and what follows from others."""
        stated: list[tuple[Meaning, tuple[str, ...]]] = []
        for atom in atoms:
            if atom.value is False or atom.symbol in self._types or atom.symbol in self._counts:
                continue
            meaning = self._meanings.get(atom.symbol)
            if meaning is None or atom.value is not True:
                raise _Misfit(f"`{self._domain.name}` has no predicate `{atom.symbol}` there", atom)
            wanted = [parameter.type for parameter in meaning[0].parameters]
            stated.append((meaning, self._fitting(atom, atom.symbol, wanted, kinds)))
        try:
            return values_of(stated)
        except ValueError as error:
            raise _Misfit(str(error), atoms[0]) from None

    def _fitting(
        self, atom: Atom, name: str, wanted: Sequence[str], kinds: Mapping[str, str]
    ) -> tuple[str, ...]:
        """The objects of an atom, as many and of such types as wanted."""
        names = tuple(map(self._name, atom.terms))
        if len(names) != len(wanted):
            raise _Misfit(f"`{name}` takes {plural(len(wanted), 'object')}, not {len(names)}", atom)
        for each, kind in zip(names, wanted, strict=True):
            if not self._domain.is_a(kinds[each], kind):
                raise _Misfit(f"`{each}` is of type `{kinds[each]}`, and `{name}` is for `{kind}`", atom)
        return names


# ---- beside rules, state and symbols


@dataclass(frozen=True, slots=True)
class Recorded:
    """The transitions of a domain that was converted, and the actions that it lacks, of others."""

    transitions: tuple[Transition, ...]
    lacking: tuple[str, ...]


def recorded(source: Source, made: Converted) -> Recorded:
    """The transitions of a file that goes with rules.dat and symbols.dat, in the words of the domain that
    these were converted to. Raises Refused (E911 to E913)."""
    library, words = made.library, made.words
    known = {symbol.name for symbol in library.symbols if symbol.kind.value == "action"}
    steps = steps_of(source, known.__contains__)
    wrong = [*misfits(dict.fromkeys(atoms for s in steps for atoms in (s.before, s.after)), library)]
    if wrong:
        raise Refused(wrong, [source])
    atoms = (atom for step in steps for atom in (*step.before, step.action, *step.after))
    names = called(words.names.objects, (term for atom in atoms for term in atom.terms))
    words = replace(words, names=replace(words.names, objects=names))
    found: list[Transition] = []
    lacking: set[str] = set()
    for step in steps:
        action = words.names.symbols[step.action.symbol]
        if action not in made.actions:
            lacking.add(step.action.symbol)
            continue
        terms = {term for atom in (*step.before, step.action, *step.after) for term in atom.terms}
        objects = sorted(names[term] for term in terms)
        before, after = (
            {(f.symbol, f.objects): f.value for f in facts(replace(library, facts=atoms), words, objects)}
            for atoms in (step.before, step.after)
        )
        arguments = tuple(names[term] for term in step.action.terms)
        things = tuple(Object(name, OBJECT) for name in objects)
        _refuse_outside({**before, **after}, words.symbols, step.action, source)
        found.append(Transition(action, arguments, things, before, after))
    return Recorded(tuple(found), tuple(sorted(lacking)))


def _refuse_outside(values: Values, symbols: Mapping[str, Symbol], action: Atom, source: Source) -> None:
    """Raises Refused (E913) for a number that the files of the domain do not mention."""
    for (name, objects), value in values.items():
        if value not in symbols[name].values:
            low, high = symbols[name].values[0], symbols[name].values[-1]
            shown = f"{name}({', '.join(objects)})"
            message = f"`{shown}` is {value} around this action, and rules and state have {low} to {high}"
            raise Refused([Diagnostic("E913", message, action.span)], [source])
