"""libPRADA's rules in the words of the language.

Guaranteed by `check`: atoms fit their declarations, and effects have no variables but the rule's.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from cleancli.conversion.names import OBJECT, fresh
from cleancli.conversion.records import Atom, Library, LibraryRule, Result, is_variable, variables_of
from cleancli.conversion.symbols import Asked, Vocabulary
from cleancli.language.model import (
    Assign,
    Equality,
    Outcome,
    OutcomeKind,
    Reference,
    Rule,
    Value,
    Variable,
)


@dataclass(frozen=True, slots=True)
class Translated:
    """A rule with its line in rules.dat; without `rule` where its context can never hold."""

    line: int
    rule: Rule | None
    remarks: tuple[str, ...]


def rules_of(library: Library, words: Vocabulary) -> tuple[Translated, ...]:
    """All rules but the default, in the file's order."""
    changed = {effect.symbol for rule in library.rules for r in rule.results for effect in r.effects}
    static = {symbol.name for symbol in library.symbols} - changed
    numbers: dict[str, int] = {}
    choosing = [rule.action.symbol for rule in library.rules if _referred(rule)]
    found = []
    for rule in library.rules:
        action = rule.action.symbol
        numbers[action] = numbers.get(action, 0) + 1
        places = static if choosing.count(action) > 1 else set()
        found.append(_translated(rule, f"{words.names.symbols[action]}_{numbers[action]}", words, places))
    return tuple(found)


def _referred(rule: LibraryRule) -> list[str]:
    """The deictic references: variables of the context that are no arguments of the action."""
    return [v for v in variables_of(*rule.context) if v not in rule.action.terms]


def _translated(rule: LibraryRule, name: str, words: Vocabulary, static: set[str]) -> Translated:
    variables = _variables(rule)
    head, equal = _head(rule, words, variables)
    referred = _referred(rule)
    about = [atom for atom in rule.context if set(atom.terms) & set(referred)]
    plain = words.conjunction([a for a in rule.context if a not in about], variables)
    references = _references(about, referred, words, variables, static)
    whole = words.conjunction(rule.context, variables)
    if plain is None or references is None or whole is None:
        return Translated(rule.line, None, ())
    known = {(part.symbol, part.terms): part.values for part in whole}
    outcomes, remarks = _outcomes([_outcome(r, known, words, variables) for r in rule.results])
    action = words.names.symbols[rule.action.symbol]
    made = Rule(name, action, head, (*equal, *plain), outcomes, references)
    return Translated(rule.line, made, remarks)


def _variables(rule: LibraryRule) -> dict[str, Variable]:
    """X -> ?x."""
    variables: dict[str, Variable] = {}
    for name in variables_of(rule.action, *rule.context):
        taken = [variable.name for variable in variables.values()]
        variables[name] = Variable(fresh(name.lower(), taken), OBJECT)
    return variables


def _head(
    rule: LibraryRule, words: Vocabulary, variables: Mapping[str, Variable]
) -> tuple[tuple[Variable, ...], tuple[Equality, ...]]:
    """The rule's parameters, which are variables and differ, and what the others say instead."""
    head: list[Variable] = []
    equal: list[Equality] = []
    for place, term in enumerate(rule.action.terms, start=1):
        if is_variable(term) and variables[term] not in head:
            head.append(variables[term])
        else:
            taken = [variable.name for variable in (*variables.values(), *head)]
            head.append(Variable(fresh(f"argument{place}", taken), OBJECT))
            equal.append(Equality(head[-1], words.term(term, variables), True))
    return tuple(head), tuple(equal)


def _references(
    about: Sequence[Atom],
    referred: Sequence[str],
    words: Vocabulary,
    variables: Mapping[str, Variable],
    static: set[str],
) -> tuple[Reference, ...] | None:
    """References that say, by what no rule changes, which objects are meant; the rest is asked of these.

    Two rules that ask for opposites of the object that is meant exclude each other so. Without a `static`
    literal, everything says which is meant.
    """
    naming = [atom for atom in about if atom.symbol in static]
    if not naming:
        naming = list(about)
    asking = [atom for atom in about if atom not in naming]
    first = [name for name in referred if name in variables_of(*naming)]
    second = [name for name in referred if name not in first]
    inner = dict(variables)
    same: list[Equality] = []
    if asking and not second:
        for name in (n for n in first if n in variables_of(*asking)):
            taken = [variable.name for variable in inner.values()]
            inner[name] = Variable(fresh(f"same_{variables[name].name}", taken), OBJECT)
            same.append(Equality(inner[name], variables[name], True))
            second.append(name)
    stages = ((first, variables, naming, ()), (second, inner, asking, same))
    found = []
    for names, words_for, atoms, equal in stages:
        literals = words.conjunction(atoms, words_for)
        if literals is None:
            return None
        if names:
            found.append(Reference(tuple(words_for[name] for name in names), (*equal, *literals)))
    return tuple(found)


# ---- outcomes


def _outcome(
    result: Result,
    known: Mapping[Asked, frozenset[Value]],
    words: Vocabulary,
    variables: Mapping[str, Variable],
) -> Outcome:
    """An outcome without the effects that the context holds already."""
    effects: dict[Asked, Assign] = {}
    for effect in result.effects:
        # That a member of a group goes follows from what comes in its place; it changes nothing by itself.
        if effect.value is not False or effect.symbol not in words.names.functions:
            literal = words.literal(effect, variables)
            key = literal.symbol, literal.terms
            if known.get(key) != literal.values:
                effects[key] = Assign(*key, next(iter(literal.values)))
    kind = OutcomeKind.NOTHING if result.kind is OutcomeKind.CHANGE and not effects else result.kind
    return Outcome(result.probability, kind, tuple(effects.values()))


def _outcomes(outcomes: Iterable[Outcome]) -> tuple[tuple[Outcome, ...], tuple[str, ...]]:
    """Those with one result as one, and with probabilities that sum to exactly 1; remarks on both."""
    total: dict[tuple[OutcomeKind, frozenset[Assign]], Fraction] = {}
    first: dict[tuple[OutcomeKind, frozenset[Assign]], Outcome] = {}
    number = 0
    for outcome in outcomes:
        number += 1
        key = outcome.kind, frozenset(e for e in outcome.effects if isinstance(e, Assign))
        total[key] = total.get(key, Fraction(0)) + outcome.probability
        first.setdefault(key, outcome)
    remarks = ["outcomes that come to the same are one"] if len(total) < number else []
    missing = 1 - sum(total.values())
    if missing:
        likeliest = max(total, key=lambda key: total[key])
        total[likeliest] += missing
        remarks.append("the probabilities were rounded: the largest takes the difference")
    return tuple(Outcome(p, first[key].kind, first[key].effects) for key, p in total.items()), tuple(remarks)


def default_of(library: Library) -> tuple[Outcome, ...]:
    """What actions do where no rule covers them; nothing if the file does not say."""
    if library.default is None:
        return (Outcome(Fraction(1), OutcomeKind.NOTHING),)
    return _outcomes([Outcome(r.probability, r.kind) for r in library.default.results])[0]
