"""Fluents: symbols applied to objects, their values in a state, and the objects that variables stand for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cleancli.language.model import (
    DerivedPredicate,
    Domain,
    Fact,
    ForAll,
    Rule,
    State,
    Symbol,
    Term,
    Value,
    Variable,
)

Binding = Mapping[Variable, str]
"""Names of the objects that variables stand for."""


Fluent = tuple[str, tuple[str, ...]]
"""A symbol for some objects, in canonical order: what has a value in a state."""


Values = Mapping[Fluent, Value]
"""A state as a lookup; a predicate that is missing is false."""


def values_of(state: State) -> dict[Fluent, Value]:
    """The state as a lookup."""
    return {(fact.symbol, fact.objects): fact.value for fact in state}


def shifted(symbol: Symbol, before: Value, amount: int) -> Value:
    """The value of an integer function after a shift, which stops at the function's bounds."""
    low, high = symbol.values[0], symbol.values[-1]
    assert isinstance(before, int), "the checker lets only integer functions shift"
    assert isinstance(low, int)
    assert isinstance(high, int)
    return min(max(before + amount, low), high)


def parameters_of(
    predicate: str, symbols: Mapping[str, Symbol], derived: Mapping[str, DerivedPredicate]
) -> tuple[Variable, ...]:
    """The parameters of a declared or derived predicate, under names of their own.

    The names are numbers, so that `p(?a, ?a)` has two parameters too.
    """
    found = symbols[predicate].parameters if predicate in symbols else derived[predicate].parameters
    return tuple(Variable(str(index), parameter.type) for index, parameter in enumerate(found))


def bind(rule: Rule, arguments: Sequence[str]) -> Binding:
    """The rule's variables, in the action's order, as the arguments."""
    return dict(zip(rule.variables, arguments, strict=True))


def changeable_symbols(domain: Domain) -> frozenset[str]:
    """Names of the symbols that some outcome of some rule sets; the others stay as they were observed."""
    changed: set[str] = set()
    for rule in domain.rules:
        for outcome in rule.outcomes:
            for effect in outcome.effects:
                assigns = effect.effects if isinstance(effect, ForAll) else (effect,)
                changed.update(assign.symbol for assign in assigns)
    return frozenset(changed)


def canonical_state(domain: Domain, facts: Sequence[Fact]) -> State:
    """The facts with symmetric symbols in canonical order and false predicates left out."""
    symbols = {symbol.name: symbol for symbol in domain.symbols}
    return frozenset(
        Fact(fact.symbol, symbols[fact.symbol].canonical(fact.objects), fact.value)
        for fact in facts
        if fact.value is not False
    )


def name_of(term: Term, binding: Binding) -> str:
    """The object that a bound term stands for."""
    return binding[term] if isinstance(term, Variable) else term.name


def names_of(terms: Sequence[Term], binding: Binding) -> tuple[str, ...]:
    """The objects that bound terms stand for."""
    return tuple([binding[term] if isinstance(term, Variable) else term.name for term in terms])
