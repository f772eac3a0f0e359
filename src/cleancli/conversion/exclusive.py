"""Groups of predicates, of one argument or none, of which at most one holds at a time, whatever actions do.

Guaranteed by `check`: names are declared and fit. Such a group becomes a function, so that rules which ask
for different members exclude each other. Two arguments of an action are taken as different objects here; if
they are one, grounding finds an outcome that gives the function two values (E602).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from itertools import permutations

from cleancli.conversion.records import Atom, Kind, Library, LibraryRule


@dataclass(frozen=True, slots=True)
class Group:
    """Predicates that exclude each other, in declared order; `partial` where an object has none of them."""

    members: tuple[str, ...]
    partial: bool


def groups_of(library: Library, constants: Sequence[str]) -> tuple[Group, ...]:
    """The groups that rules of one action choose by, none with a member of another."""
    rivals, replaced, together = _rivals(library), _replaced(library), _together(library)
    possible = _possible(library)
    groups: list[Group] = []
    taken: set[str] = set()
    for name in possible:
        for near in ({other for one, other in rivals if one == name}, _grown(name, replaced, together)):
            candidates = [each for each in possible if each == name or each in near]
            members = _largest([each for each in candidates if each not in taken], library)
            if name in members and not rivals.isdisjoint(permutations(members, 2)):
                taken |= set(members)
                groups.append(Group(members, _is_partial(members, library, constants)))
                break
    return tuple(groups)


def _possible(library: Library) -> list[str]:
    """The predicates of one argument or none that may hold at some time."""
    effects = [effect for rule in library.rules for result in rule.results for effect in result.effects]
    possible = {atom.symbol for atom in (*library.facts, *effects) if atom.value is True}
    primitive = [symbol for symbol in library.symbols if symbol.kind is Kind.PRIMITIVE]
    return [symbol.name for symbol in primitive if symbol.arity <= 1 and symbol.name in possible]


def _is_partial(members: Collection[str], library: Library, constants: Iterable[str]) -> bool:
    """Whether none of the members holds for some constant at first."""
    held = {fact.terms for fact in library.facts if fact.symbol in members and fact.value is True}
    alone = any(symbol.name in members and not symbol.arity for symbol in library.symbols)
    return not held.issuperset([()] if alone else [(constant,) for constant in constants])


def _rivals(library: Library) -> set[tuple[str, str]]:
    """Pairs of predicates that two rules of an action ask for of the same argument, or of none, both ways
    round."""
    asked: dict[tuple[str, int | None], set[str]] = {}
    for rule in library.rules:
        for atom in rule.context:
            if atom.value is True and len(atom.terms) <= 1 and set(atom.terms) <= set(rule.action.terms):
                place = rule.action.terms.index(atom.terms[0]) if atom.terms else None
                asked.setdefault((rule.action.symbol, place), set()).add(atom.symbol)
    return {pair for names in asked.values() for pair in permutations(names, 2)}


def _replaced(library: Library) -> set[tuple[str, str]]:
    """Pairs of predicates of which one comes where the other goes, both ways round."""
    found: set[tuple[str, str]] = set()
    for rule in library.rules:
        for result in rule.results:
            for one, other in permutations(result.effects, 2):
                if one.terms == other.terms and one.value is True and other.value is False:
                    found |= {(one.symbol, other.symbol), (other.symbol, one.symbol)}
    return found


def _together(library: Library) -> set[tuple[str, str]]:
    """Pairs of predicates that hold of the same terms at first, or after an outcome, both ways round."""
    states = [library.facts]
    for rule in library.rules:
        for result in rule.results:
            gone = {(each.symbol, each.terms) for each in result.effects if each.value is False}
            stays = [each for each in rule.context if (each.symbol, each.terms) not in gone]
            states.append((*stays, *result.effects))
    found: set[tuple[str, str]] = set()
    for state in states:
        held: dict[tuple[str, ...], set[str]] = {}
        for atom in state:
            if atom.value is True:
                held.setdefault(atom.terms, set()).add(atom.symbol)
        found.update(pair for names in held.values() for pair in permutations(names, 2))
    return found


def _grown(
    name: str, replaced: Collection[tuple[str, str]], together: Collection[tuple[str, str]]
) -> list[str]:
    """A predicate with those that come and go in its place one after the other, of which no two are known to
    hold together."""
    found = [name]
    for here in found:  # which grows
        for other in sorted(two for one, two in replaced if one == here and two not in found):
            if all((other, each) not in together for each in found):
                found.append(other)
    return found


def _largest(candidates: Sequence[str], library: Library) -> tuple[str, ...]:
    """The candidates without those that break the invariant, the worst first; none if fewer than two stay."""
    members = list(candidates)
    while len(members) > 1:
        broken = _broken(members, library)
        if not broken:
            return tuple(members)
        members.remove(max(reversed(members), key=lambda name: broken.count(name)))
    return ()


def _broken(members: Sequence[str], library: Library) -> list[str]:
    """Members that may hold beside another, or go without another coming, once for each time."""
    broken: list[str] = []
    held: dict[tuple[str, ...], str] = {}
    for fact in library.facts:
        if fact.symbol in members and fact.value is True:
            other = held.setdefault(fact.terms, fact.symbol)
            broken += [fact.symbol, other] if other != fact.symbol else []
    for rule in library.rules:
        for result in rule.results:
            broken += _broken_by(result.effects, rule, members)
    return broken


def _broken_by(effects: Sequence[Atom], rule: LibraryRule, members: Sequence[str]) -> list[str]:
    """What an outcome breaks."""
    changed = dict.fromkeys(effect.terms for effect in effects if effect.symbol in members)
    return [name for terms in changed for name in _broken_for(terms, effects, rule.context, members)]


def _broken_for(
    terms: tuple[str, ...], effects: Sequence[Atom], context: Sequence[Atom], members: Sequence[str]
) -> list[str]:
    """What an outcome breaks for one of its terms."""
    added = _said(effects, terms, True, members)
    deleted = _said(effects, terms, False, members)
    absent = _absent(context, terms, members)
    if len(added) != 1:
        return added or [name for name in deleted if name not in absent]
    staying = [name for name in members if name not in (*added, *deleted, *absent)]
    return [name for other in staying for name in (other, *added)]


def _absent(context: Sequence[Atom], terms: tuple[str, ...], members: Sequence[str]) -> list[str]:
    """The members that do not hold of the terms before: where one holds, these are all others."""
    held = _said(context, terms, True, members)
    if held:
        return [name for name in members if name not in held]
    return _said(context, terms, False, members)


def _said(atoms: Iterable[Atom], terms: tuple[str, ...], value: bool, members: Sequence[str]) -> list[str]:
    """The members that the atoms make true, or false, of the terms."""
    return [
        atom.symbol
        for atom in atoms
        if atom.terms == terms and atom.value is value and atom.symbol in members
    ]
