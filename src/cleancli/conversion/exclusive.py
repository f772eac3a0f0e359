"""Groups of unary predicates of which at most one holds for each object, whatever the actions do.

Guaranteed by `check`: names are declared and fit. Such a group becomes a function, so that rules which ask
for different members exclude each other. Two arguments of an action are taken as different objects here; if
they are one, grounding finds an outcome that gives the function two values (E602).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

from cleancli.conversion.records import Atom, Kind, Library, LibraryRule


@dataclass(frozen=True, slots=True)
class Group:
    """Predicates that exclude each other, in declared order; `partial` where an object has none of them."""

    members: tuple[str, ...]
    partial: bool


def groups_of(library: Library, constants: Sequence[str]) -> tuple[Group, ...]:
    """The groups that rules of one action choose by, none with a member of another."""
    rivals = _rivals(library)
    effects = [effect for rule in library.rules for result in rule.results for effect in result.effects]
    possible = {atom.symbol for atom in (*library.facts, *effects) if atom.value is True}
    unary = [
        symbol.name
        for symbol in library.symbols
        if symbol.kind is Kind.PRIMITIVE and symbol.arity == 1 and symbol.name in possible
    ]
    groups: list[Group] = []
    taken: set[str] = set()
    for name in unary:
        candidates = [
            each for each in unary if each not in taken and (each == name or (name, each) in rivals)
        ]
        members = _largest(candidates, library)
        if name in members:
            taken |= set(members)
            held = {fact.terms[0] for fact in library.facts if fact.symbol in members and fact.value is True}
            groups.append(Group(members, not held.issuperset(constants)))
    return tuple(groups)


def _rivals(library: Library) -> set[tuple[str, str]]:
    """Pairs of predicates that two rules of an action ask for of the same argument, both ways round."""
    asked: dict[tuple[str, int], set[str]] = {}
    for rule in library.rules:
        for atom in rule.context:
            if atom.value is True and len(atom.terms) == 1 and atom.terms[0] in rule.action.terms:
                place = rule.action.terms.index(atom.terms[0])
                asked.setdefault((rule.action.symbol, place), set()).add(atom.symbol)
    return {
        pair
        for names in asked.values()
        for one, other in combinations(sorted(names), 2)
        for pair in ((one, other), (other, one))
    }


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
    held: dict[str, str] = {}
    for fact in library.facts:
        if fact.symbol in members and fact.value is True:
            other = held.setdefault(fact.terms[0], fact.symbol)
            broken += [fact.symbol, other] if other != fact.symbol else []
    for rule in library.rules:
        for result in rule.results:
            broken += _broken_by(result.effects, rule, members)
    return broken


def _broken_by(effects: Sequence[Atom], rule: LibraryRule, members: Sequence[str]) -> list[str]:
    """What an outcome breaks for one of its terms."""
    broken: list[str] = []
    for term in dict.fromkeys(effect.terms for effect in effects if effect.symbol in members):
        added = _said(effects, term, True, members)
        deleted = _said(effects, term, False, members)
        before = _said(rule.context, term, True, members)
        absent = _said(rule.context, term, False, members)
        if before:
            absent = [name for name in members if name not in before]
        if len(added) != 1:
            broken += added or [name for name in deleted if name not in absent]
            continue
        others = [name for name in members if name not in (*added, *deleted, *absent)]
        broken += [name for other in others for name in (other, *added)]
    return broken


def _said(atoms: Iterable[Atom], terms: tuple[str, ...], value: bool, members: Sequence[str]) -> list[str]:
    """The members that the atoms make true, or false, of the terms."""
    return [
        atom.symbol
        for atom in atoms
        if atom.terms == terms and atom.value is value and atom.symbol in members
    ]
