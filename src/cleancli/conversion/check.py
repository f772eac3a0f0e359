"""Whether libPRADA's files fit together, and say nothing that .nid files have no word for.

Guaranteed by `read`: the files have the form of their format.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction

from cleancli.conversion.records import (
    Atom,
    Declaration,
    Kind,
    Library,
    LibraryRule,
    is_variable,
    variables_of,
)
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.sink import meant
from cleancli.language.model import OutcomeKind
from cleancli.language.printing.printer import print_fraction

ROUNDING = Fraction(1, 1000)
"""How far the probabilities of a rule may be from 1 to count as rounded. Chosen."""


def check(library: Library) -> None:
    """Raises Refused with E912, E913 and E914 for everything that cannot be converted."""
    declared = {symbol.name: symbol for symbol in library.symbols}
    found = [
        *_declared_twice(library.symbols),
        *(d for symbol in library.symbols for d in _counted(symbol, declared)),
        *(d for rule in library.rules for d in _rule(rule, declared)),
        *(_default(library.default) if library.default else ()),
        *(d for fact in library.facts for d in _fact(fact, declared)),
        *_sets_twice(library.facts),
        *_values(library),
    ]
    if found:
        raise Refused(found, library.sources)


def misfits(steps: Iterable[Iterable[Atom]], library: Library) -> Iterator[Diagnostic]:
    """E912 and E913 for literals of further states that do not fit the declarations."""
    declared = {symbol.name: symbol for symbol in library.symbols}
    for facts in steps:
        stated = tuple(facts)
        yield from (d for fact in stated for d in _fact(fact, declared))
        yield from _sets_twice(stated)


def _declared_twice(symbols: Iterable[Declaration]) -> Iterator[Diagnostic]:
    seen = set()
    for symbol in symbols:
        if symbol.name in seen:
            yield Diagnostic("E912", f"`{symbol.name}` is declared a second time", symbol.span)
        seen.add(symbol.name)


def _counted(symbol: Declaration, declared: Mapping[str, Declaration]) -> Iterator[Diagnostic]:
    if symbol.kind is not Kind.COUNT:
        return
    yield from _literals(symbol.condition, declared)
    unbound = [v for v in variables_of(*symbol.condition) if v not in symbol.variables]
    if symbol.arity or unbound:
        message = f"the count `{symbol.name}` is one for each object"
        yield Diagnostic("E913", message, symbol.span, help="a .nid file counts over all objects together")


def _rule(rule: LibraryRule, declared: Mapping[str, Declaration]) -> Iterator[Diagnostic]:
    yield from _atom(rule.action, declared, Kind.ACTION)
    yield from _literals(rule.context, declared)
    bound = set(variables_of(rule.action, *rule.context))
    for result in rule.results:
        yield from _literals(result.effects, declared)
        for effect in result.effects:
            yield from _effect(effect, bound)
        yield from _sets_twice(result.effects)
    yield from _probabilities(rule)


def _default(rule: LibraryRule) -> Iterator[Diagnostic]:
    effects = [effect for result in rule.results for effect in result.effects]
    for atom in (*rule.context, *effects):
        message = "the default rule has neither context nor effects here"
        yield Diagnostic("E913", message, atom.span, help="it covers every action, and so has no variables")
    if rule.action.terms:
        yield Diagnostic("E913", "the default rule has no arguments", rule.action.span)
    yield from _probabilities(rule)


def _probabilities(rule: LibraryRule) -> Iterator[Diagnostic]:
    total = Fraction(0)
    for result in rule.results:
        total += result.probability
        if result.probability > 1:
            yield Diagnostic("E914", "a probability is at most 1", result.span)
    if abs(total - 1) > ROUNDING:
        message = f"the probabilities of a rule for `{rule.action.symbol}` sum to {print_fraction(total)}"
        yield Diagnostic("E914", message, rule.results[0].span, "the first of them")


def _literals(atoms: Iterable[Atom], declared: Mapping[str, Declaration]) -> Iterator[Diagnostic]:
    for atom in atoms:
        yield from _atom(atom, declared, Kind.PRIMITIVE)


def _atom(atom: Atom, declared: Mapping[str, Declaration], wanted: Kind) -> Iterator[Diagnostic]:
    symbol = declared.get(atom.symbol)
    if symbol is None:
        known = [name for name, each in declared.items() if each.kind is wanted]
        message = f"`{atom.symbol}` is not declared in symbols.dat"
        yield Diagnostic("E912", message, atom.span, help=meant(atom.symbol, known, "symbol"))
    elif (symbol.kind is Kind.ACTION) != (wanted is Kind.ACTION):
        what = "an action" if symbol.kind is Kind.ACTION else "no action"
        yield Diagnostic("E912", f"`{atom.symbol}` is declared as {what}", atom.span)
    elif len(atom.terms) != symbol.arity:
        wants = plural(symbol.arity, "argument")
        message = f"`{atom.symbol}` is declared with {wants}, and has {len(atom.terms)}"
        yield Diagnostic("E912", message, atom.span)
    elif symbol.kind is not wanted:
        message = f"`{atom.symbol}` follows from other symbols in a way that is not converted"
        help = "write what it follows from in its place, or a derived predicate by hand"
        yield Diagnostic("E913", message, atom.span, help=help)
    elif symbol.is_binary != isinstance(atom.value, bool):
        what = "is true or false" if symbol.is_binary else "has a number as its value"
        yield Diagnostic("E912", f"`{atom.symbol}` {what}", atom.span)


def _effect(effect: Atom, bound: set[str]) -> Iterator[Diagnostic]:
    for variable in variables_of(effect):
        if variable not in bound:
            message = f"neither the action nor the context binds `{variable}`"
            yield Diagnostic("E913", message, effect.span)
    if effect.relation != "=":
        yield Diagnostic("E913", f"`{effect.symbol}` is set to no value", effect.span, help="write `=`")


def _sets_twice(effects: Iterable[Atom]) -> Iterator[Diagnostic]:
    values: dict[tuple[str, tuple[str, ...]], bool | int] = {}
    for effect in effects:
        if values.setdefault((effect.symbol, effect.terms), effect.value) != effect.value:
            message = f"one outcome gives `{effect.symbol}` two values"
            yield Diagnostic("E913", message, effect.span)


def _fact(fact: Atom, declared: Mapping[str, Declaration]) -> Iterator[Diagnostic]:
    symbol = declared.get(fact.symbol)
    if symbol is not None and symbol.kind in (Kind.COUNT, Kind.OTHER):
        return  # it follows from the other facts
    yield from _atom(fact, declared, Kind.PRIMITIVE)
    for term in fact.terms:
        if is_variable(term):
            yield Diagnostic("E912", f"a state has no variables: `{term}`", fact.span)
    if fact.relation != "=":
        yield Diagnostic("E912", f"a state gives `{fact.symbol}` a value", fact.span, help="write `=`")


def _values(library: Library) -> Iterator[Diagnostic]:
    """E913 for functions that the state gives no value."""
    given = {(fact.symbol, fact.terms) for fact in library.facts}
    constants = [(each,) for each in constants_of(library)]
    for function in _used_functions(library):
        for terms in constants if function.arity else [()]:
            if (function.name, terms) not in given:
                shown = f"{function.name}({' '.join(terms)})"
                yield Diagnostic("E913", f"state.dat has no value of `{shown}`", function.span)


def _used_functions(library: Library) -> list[Declaration]:
    """The functions of no argument or one that rules or facts mention."""
    declared = {symbol.name: symbol for symbol in library.symbols}
    mentioned = [declared[name] for name in used(library) if name in declared]
    functions = [s for s in mentioned if s.kind is Kind.PRIMITIVE and not s.is_binary]
    return [function for function in functions if function.arity <= 1]


def used(library: Library) -> tuple[str, ...]:
    """The names that rules or facts mention, sorted."""
    return tuple(sorted({atom.symbol for atom in (*rule_atoms(library), *library.facts)}))


def rule_atoms(library: Library) -> Iterator[Atom]:
    """All literals of the rules' contexts and outcomes."""
    for rule in library.rules:
        yield from rule.context
        for result in rule.results:
            if result.kind is OutcomeKind.CHANGE:
                yield from result.effects


def constants_of(library: Library) -> tuple[str, ...]:
    """All constants of rules and state, sorted, numbers by their size."""
    heads = [rule.action for rule in library.rules]
    counted = [atom for symbol in library.symbols for atom in symbol.condition]
    terms = {term for atom in (*rule_atoms(library), *heads, *counted, *library.facts) for term in atom.terms}
    constants = [term for term in terms if not is_variable(term)]
    return tuple(sorted(constants, key=lambda term: (not term.isdecimal(), term.rjust(20, "0"))))
