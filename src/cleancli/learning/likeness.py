"""Whether two domains declare one vocabulary, and whether two rules say the same in other words."""

from __future__ import annotations

import enum
from collections.abc import Mapping, Sequence
from fractions import Fraction

from cleancli.language.model import (
    Assign,
    Condition,
    Domain,
    Equality,
    ForAll,
    Literal,
    Outcome,
    Price,
    Quantified,
    Rule,
    Shift,
    Symbol,
    Term,
    Variable,
)


class Likeness(enum.Enum):
    """How alike the texts of two rules are, whatever their variables are called and in which order their
    parts stand: the same, the same but for probabilities, or others."""

    SAME = "same"
    PROBABILITIES = "probabilities"
    OTHER = "other"


def vocabulary_differences(one: Domain, other: Domain) -> list[str]:
    """What keeps rules of two domains from being compared: what one declares and the other does not, or
    otherwise. Whether a symbol is static, and what follows from symbols, may differ."""

    def declared(domain: Domain) -> dict[tuple[str, str], object]:
        return {
            **{("type", each.name): each.parent for each in domain.types},
            **{("constant", each.name): each.type for each in domain.constants},
            **{("symbol", each.name): _signature(each) for each in domain.symbols},
            **{("action", each.name): [p.type for p in each.parameters] for each in domain.actions},
        }

    first, second = declared(one), declared(other)
    found = []
    for kind, name in dict.fromkeys((*first, *second)):
        key = kind, name
        if key not in second:
            found.append(f"only the first declares the {kind} `{name}`")
        elif key not in first:
            found.append(f"only the second declares the {kind} `{name}`")
        elif first[key] != second[key]:
            found.append(f"they declare the {kind} `{name}` otherwise")
    return found


def _signature(symbol: Symbol) -> object:
    return [each.type for each in symbol.parameters], symbol.values, symbol.symmetric


def likeness(one: Domain, rule: Rule, other: Domain, like: Rule) -> Likeness:
    """How alike the texts of two rules of one action are."""
    (asked, says), (also, too) = _canonical(one, rule), _canonical(other, like)
    if asked != also or says.keys() != too.keys():
        return Likeness.OTHER
    return Likeness.SAME if says == too else Likeness.PROBABILITIES


_Says = Mapping[object, Fraction]


def _canonical(domain: Domain, rule: Rule) -> tuple[object, _Says]:
    """What a rule asks for, and how likely it says that what happens and is paid; variables are numbered as
    they come, and what is in any order is a set."""
    symmetric = {symbol.name for symbol in domain.symbols if symbol.symmetric}
    names: dict[Term, str] = {each: f"?{number}" for number, each in enumerate(rule.variables)}
    asked: list[object] = [_condition(rule.condition, names, symmetric)]
    for reference in rule.references:
        names = _with(names, reference.variables)
        types = tuple(each.type for each in reference.variables)
        asked.append((types, _condition(reference.condition, names, symmetric)))
    says: dict[object, Fraction] = {}
    for outcome in rule.outcomes:
        paid = tuple(_price(price, names, symmetric) for price in (outcome.reward, outcome.cost))
        key = outcome.kind, _effects(outcome, names, symmetric), paid
        says[key] = says.get(key, Fraction(0)) + outcome.probability
    return tuple(asked), {key: share for key, share in says.items() if share}


def _with(names: Mapping[Term, str], variables: Sequence[Variable]) -> dict[Term, str]:
    return {**names, **{each: f"?{len(names) + number}" for number, each in enumerate(variables)}}


def _condition(condition: Condition, names: Mapping[Term, str], symmetric: set[str]) -> frozenset[object]:
    return frozenset(_part(part, names, symmetric) for part in condition)


def _part(
    part: Literal | Equality | Quantified, names: Mapping[Term, str], symmetric: set[str]
) -> tuple[object, ...]:
    match part:
        case Literal(symbol, terms, values):
            return symbol, _ordered(symbol, terms, names, symmetric), values
        case Equality(left, right, equal):
            return frozenset({names.get(left, left.name), names.get(right, right.name)}), equal
        case Quantified(exists, variables, condition):
            inner = _with(names, variables)
            types = tuple(each.type for each in variables)
            return exists, types, _condition(condition, inner, symmetric)


def _ordered(
    symbol: str, terms: Sequence[Term], names: Mapping[Term, str], symmetric: set[str]
) -> tuple[str, ...]:
    found = (names.get(term, term.name) for term in terms)
    return tuple(sorted(found) if symbol in symmetric else found)


def _price(price: Price, names: Mapping[Term, str], symmetric: set[str]) -> tuple[object, ...]:
    parts = ((p.weight, p.symbol, _ordered(p.symbol, p.terms, names, symmetric)) for p in price.parts)
    return price.number, frozenset(parts)


def _effects(outcome: Outcome, names: Mapping[Term, str], symmetric: set[str]) -> frozenset[object]:
    found: set[object] = set()
    for effect in outcome.effects:
        if isinstance(effect, ForAll):
            inner = _with(names, effect.variables)
            guard = _condition(effect.condition, inner, symmetric)
            types = tuple(each.type for each in effect.variables)
            found |= {(types, guard, _effect(each, inner, symmetric)) for each in effect.effects}
        else:
            found.add(_effect(effect, names, symmetric))
    return frozenset(found)


def _effect(effect: Assign | Shift, names: Mapping[Term, str], symmetric: set[str]) -> tuple[object, ...]:
    value = effect.value if isinstance(effect, Assign) else effect.amount
    terms = _ordered(effect.symbol, effect.terms, names, symmetric)
    return type(effect), effect.symbol, terms, type(value), value
