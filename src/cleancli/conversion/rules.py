"""libPRADA's rules in the words of the language.

Guaranteed by `check`: atoms fit their declarations, and effects have no variables but the rule's.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

from cleancli.conversion.names import OBJECT, fresh
from cleancli.conversion.records import Atom, Library, LibraryRule, Result, is_variable, variables_of
from cleancli.conversion.symbols import Asked, Vocabulary
from cleancli.language.model import (
    Assign,
    Condition,
    Equality,
    Object,
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


def rules_of(library: Library, words: Vocabulary, *, whole: bool) -> tuple[Translated, ...]:
    """All rules but the default, in the file's order; as a `whole`, also with the effects that their contexts
    hold already, and with references that find and ask at once."""
    numbers: dict[str, int] = {}
    contested = set[_Question]() if whole else _contested(library, words)
    found = []
    for rule in library.rules:
        action = rule.action.symbol
        numbers[action] = numbers.get(action, 0) + 1
        name = f"{words.names.symbols[action]}_{numbers[action]}"
        found.append(_translated(rule, name, words, contested, whole))
    return tuple(found)


def _about_references(rule: LibraryRule) -> list[Atom]:
    """What the context says of its deictic references, which are no arguments of the action."""
    return [atom for atom in rule.context if not set(variables_of(atom)) <= set(rule.action.terms)]


def _about_arguments(rule: LibraryRule) -> list[Atom]:
    """What the context says of the action's arguments alone."""
    about = _about_references(rule)
    return [atom for atom in rule.context if atom not in about]


_Question = tuple[str, str, tuple[int | str | None, ...]]
"""An action, a symbol, and terms: positions among the action's, constants, None for what is referred to."""


def _question(atom: Atom, rule: LibraryRule, words: Vocabulary) -> _Question:
    """What a literal asks for, the same in all rules of the action that ask for it."""
    places: dict[str, int] = {term: place for place, term in enumerate(rule.action.terms)}
    terms = tuple(places.get(term, None if is_variable(term) else term) for term in atom.terms)
    return rule.action.symbol, words.literal(atom, _variables(rule)).symbol, terms


def _contested(library: Library, words: Vocabulary) -> set[_Question]:
    """The questions about what rules of an action refer to that these want answered in different ways; none
    where something would be found by what ties it to nothing else, and so had to be the only one of all."""
    asked: dict[_Question, set[frozenset[Value]]] = {}
    for rule in library.rules:
        for atom in _about_references(rule):
            values = words.literal(atom, _variables(rule)).values
            asked.setdefault(_question(atom, rule, words), set()).add(values)
    found = {question for question, values in asked.items() if len(values) > 1}
    loose = {rule.action.symbol for rule in library.rules if _is_loose(rule, words, found)}
    return {question for question in found if question[0] not in loose}


def _is_loose(rule: LibraryRule, words: Vocabulary, contested: set[_Question]) -> bool:
    """Whether a reference would be found by literals that have no other term than it."""
    naming, _ = _naming_and_asking(rule, words, contested)
    referred = [name for name in variables_of(*naming) if name not in rule.action.terms]
    return any(all({*atom.terms} == {name} for atom in naming if name in atom.terms) for name in referred)


def _naming_and_asking(
    rule: LibraryRule, words: Vocabulary, contested: set[_Question]
) -> tuple[list[Atom], list[Atom]]:
    """What the context says of its references, in two parts: what finds them, and what is contested."""
    about = _about_references(rule)
    asking = [atom for atom in about if _question(atom, rule, words) in contested]
    return [atom for atom in about if atom not in asking], asking


def _translated(
    rule: LibraryRule, name: str, words: Vocabulary, contested: set[_Question], whole: bool
) -> Translated:
    variables = _variables(rule)
    head, equal = _head(rule, words, variables)
    plain = words.conjunction(_about_arguments(rule), variables)
    references = _references(rule, *_naming_and_asking(rule, words, contested), words, variables)
    context = words.conjunction(rule.context, variables)
    if plain is None or references is None or context is None:
        return Translated(rule.line, None, ())
    known = {} if whole else {(part.symbol, part.terms): part.values for part in context}
    outcomes, remarks = _outcomes([_outcome(r, known, words, variables) for r in rule.results])
    apart = _apart(outcomes)
    if apart:
        remarks = (*remarks, "what `!=` keeps apart, one outcome would both set and clear")
    bound = {variable for reference in references for variable in reference.variables}
    known_apart = [part for part in apart if bound.isdisjoint((part.left, part.right))]
    condition: Condition = (*equal, *known_apart, *plain)
    references = _with([part for part in apart if part not in known_apart], references)
    action = words.names.symbols[rule.action.symbol]
    return Translated(rule.line, Rule(name, action, head, condition, outcomes, references), remarks)


def _apart(outcomes: Iterable[Outcome]) -> tuple[Equality, ...]:
    """Terms that must not be one object, because an outcome gives a symbol one value for each."""
    assigned = [[effect for effect in o.effects if isinstance(effect, Assign)] for o in outcomes]
    pairs = [pair for effects in assigned for pair in combinations(effects, 2)]
    apart = (_kept_apart(one, other) for one, other in pairs)
    return tuple(dict.fromkeys(each for each in apart if each is not None))


def _kept_apart(one: Assign, other: Assign) -> Equality | None:
    """That two terms differ, where the effects would clash if they were one object; None where these cannot
    clash, or differ anyway."""
    if one.symbol != other.symbol or one.value == other.value:
        return None
    differing = [pair for pair in zip(one.terms, other.terms, strict=True) if pair[0] != pair[1]]
    if len(differing) != 1:
        return None
    left, right = sorted(differing[0], key=lambda term: (isinstance(term, Object), term.name))
    return Equality(left, right, False) if isinstance(left, Variable) else None


def _with(apart: Sequence[Equality], references: tuple[Reference, ...]) -> tuple[Reference, ...]:
    """The references, of which the last asks for what is apart, too."""
    if not apart:
        return references
    last = references[-1]
    return (*references[:-1], Reference(last.variables, (*last.condition, *apart)))


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
    rule: LibraryRule,
    naming: Sequence[Atom],
    asking: Sequence[Atom],
    words: Vocabulary,
    variables: Mapping[str, Variable],
) -> tuple[Reference, ...] | None:
    """References that find the one binding of which `naming` holds, and then ask the rest of what was found.

    So rules that ask for opposites of what they refer to exclude each other. None where the literals
    contradict each other.
    """
    if not naming:
        naming, asking = asking, ()
    found = [name for name in variables_of(*naming) if name not in rule.action.terms]
    asked = [name for name in variables_of(*asking) if name not in rule.action.terms]
    further = [name for name in asked if name not in found]
    again = {} if further else _aliases(asked, variables)
    same = [Equality(alias, variables[name], True) for name, alias in again.items()]
    inner = {**variables, **again}
    stages = [
        *([_reference(found, naming, [], words, variables)] if naming else []),
        *([_reference(further or asked, asking, same, words, inner)] if asking else []),
    ]
    references = tuple(each for each in stages if each is not None)
    return references if len(references) == len(stages) else None


def _aliases(names: Iterable[str], variables: Mapping[str, Variable]) -> dict[str, Variable]:
    """Further variables for what some stand for, by the names of those."""
    aliases: dict[str, Variable] = {}
    for name in names:
        taken = [variable.name for variable in (*variables.values(), *aliases.values())]
        aliases[name] = Variable(fresh(f"same_{variables[name].name}", taken), OBJECT)
    return aliases


def _reference(
    names: Iterable[str],
    atoms: Iterable[Atom],
    same: Iterable[Equality],
    words: Vocabulary,
    variables: Mapping[str, Variable],
) -> Reference | None:
    """The reference that binds these names; None where its literals contradict each other."""
    literals = words.conjunction(atoms, variables)
    if literals is None:
        return None
    return Reference(tuple(variables[name] for name in names), (*same, *literals))


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
