"""Quantifiers and references in the overlap check against brute force; and that division loses no pair."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import combinations, product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.language.checking.declarations import Declarations
from cleancli.language.checking.exclusivity import close_pairs
from cleancli.language.checking.first_order import Reading
from cleancli.language.checking.satisfiability import satisfy
from cleancli.language.model import (
    Condition,
    DerivedPredicate,
    Equality,
    Literal,
    Quantified,
    Reference,
    Rule,
    Symbol,
    Term,
    Type,
    Variable,
)

A, M, K = Variable("a", "area"), Variable("m", "area"), Variable("k", "area")
TRUE, FALSE = frozenset({True}), frozenset({False})
HAS_NEIGHBOUR = DerivedPredicate(
    "has", (A,), (Quantified(True, (K,), (Literal("q", (A, K), TRUE), Literal("p", (K,), TRUE))),)
)
DECLARED = Declarations(
    {"area": Type("area")},
    {},
    {"p": Symbol("p", (A,)), "q": Symbol("q", (A, M)), "has": Symbol("has", (A,))},
    {},
    {"has": HAS_NEIGHBOUR},
)
State = frozenset[tuple[str, tuple[int, ...]]]


def _literals(*terms: Term) -> st.SearchStrategy[Literal | Equality]:
    term, sign = st.sampled_from(terms), st.sampled_from([TRUE, FALSE])
    return st.one_of(
        st.builds(lambda t, v: Literal("p", (t,), v), term, sign),
        st.builds(lambda t, u, v: Literal("q", (t, u), v), term, term, sign),
        st.just(Equality(terms[0], terms[-1], False)),
    )


INNER = st.lists(_literals(A, M), min_size=1, max_size=2, unique=True).map(tuple)
PARTS = st.one_of(
    _literals(A).filter(lambda part: isinstance(part, Literal)),
    st.builds(Quantified, st.booleans(), st.just((M,)), INNER),
    st.builds(lambda v: Literal("has", (A,), v), st.sampled_from([TRUE, FALSE])),
)
REFERENCES = st.lists(st.builds(Reference, st.just((M,)), INNER), max_size=1).map(tuple)


@cache
def _states(size: int) -> tuple[State, ...]:
    facts = [("p", (i,)) for i in range(size)] + [("q", pair) for pair in product(range(size), repeat=2)]
    chosen = product([False, True], repeat=len(facts))
    return tuple(frozenset(f for f, holds in zip(facts, bits, strict=True) if holds) for bits in chosen)


def _holds(condition: Condition, binding: Mapping[Term, int], state: State, size: int) -> bool:
    return all(_part_holds(part, binding, state, size) for part in condition)


def _part_holds(
    part: Literal | Equality | Quantified, binding: Mapping[Term, int], state: State, size: int
) -> bool:
    match part:
        case Equality(left, right, equal):
            return (binding[left] == binding[right]) == equal
        case Literal("has", terms, values):
            inner: Mapping[Term, int] = {A: binding[terms[0]]}
            return _holds(HAS_NEIGHBOUR.condition, inner, state, size) == (True in values)
        case Literal(symbol, terms, values):
            return ((symbol, tuple(binding[t] for t in terms)) in state) in values
        case Quantified(exists, (variable,), condition):
            return exists == any(
                _holds(condition, {**binding, variable: i}, state, size) for i in range(size)
            )
    raise AssertionError(part)


def _applies(condition: Condition, references: Sequence[Reference], state: State, size: int) -> bool:
    """Whether a rule of one variable applies to the object 0."""
    if not _holds(condition, {A: 0}, state, size):
        return False
    return all(
        sum(_holds(reference.condition, {A: 0, M: i}, state, size) for i in range(size)) == 1
        for reference in references
    )


@settings(max_examples=150, deadline=None)
@given(st.lists(PARTS, max_size=2).map(tuple), REFERENCES, st.lists(PARTS, max_size=1).map(tuple), REFERENCES)
def test_a_common_state_is_found_exactly_where_there_is_one(
    one: Condition, first: tuple[Reference, ...], other: Condition, second: tuple[Reference, ...]
) -> None:
    """States of up to three objects; what needs more is only known to need more."""
    reading = Reading(DECLARED, (A,))
    formulas = [
        formula
        for condition, references in ((one, first), (other, second))
        for formula in reading.rule(Rule("r", "act", (A,), condition, (), references))
    ]
    found = satisfy(formulas, reading, DECLARED) is not None
    assert reading.exact
    there_is = any(
        _applies(one, first, state, size) and _applies(other, second, state, size)
        for size in (1, 2, 3)
        for state in _states(size)
    )
    assert found or not there_is
    if len(reading.variables) <= 3:
        assert found == there_is


def _every(holds: bool, *condition: Literal) -> Quantified:
    """That the condition holds for some m, or for none."""
    return Quantified(holds, (M,), condition)


@pytest.mark.parametrize("sign", [TRUE, FALSE])
@pytest.mark.parametrize("exists", [True, False])
@pytest.mark.parametrize("outer", [True, False])
def test_no_common_state_is_missed_where_definitions_stand_in_quantifiers(
    sign: frozenset[bool], exists: bool, outer: bool
) -> None:
    """E307 and W307 are never left out: an object that a definition asks for may be another for each one."""
    literals = [Literal("q", (M, M), TRUE), Literal("q", (A, M), TRUE), Literal("p", (M,), TRUE)]
    for other in [*literals, *(Literal(each.symbol, each.terms, FALSE) for each in literals)]:
        condition = (_every(exists, Literal("has", (M,), sign)), _every(outer, other))
        reading = Reading(DECLARED, (A,))
        formulas = reading.rule(Rule("r", "act", (A,), condition, (), ()))
        found = satisfy(formulas, reading, DECLARED) is not None
        there_is = any(_applies(condition, (), state, size) for size in (1, 2) for state in _states(size))
        assert found or not there_is
        if reading.exact and len(reading.variables) <= 2:
            assert found == there_is


ASKED = st.lists(
    st.dictionaries(
        st.tuples(st.sampled_from("fgh"), st.tuples(st.sampled_from([0, 1]))),
        st.sampled_from([TRUE, FALSE, frozenset({True, False})]),
        max_size=3,
    ),
    max_size=40,
)


@given(ASKED)
def test_pairs_that_no_fact_keeps_apart_are_compared(
    asked: list[dict[tuple[str, tuple[int | str, ...]], frozenset[bool | int | str]]],
) -> None:
    close = close_pairs(asked)
    for one, other in combinations(range(len(asked)), 2):
        shared = asked[one].keys() & asked[other].keys()
        if all(asked[one][fact] & asked[other][fact] for fact in shared):
            assert (one, other) in close


def test_thousands_of_rules_are_told_apart_without_comparing_all() -> None:
    def bits(number: int) -> Iterator[bool]:
        return (bool(number >> place & 1) for place in range(11))

    asked: list[dict[tuple[str, tuple[int | str, ...]], frozenset[bool | int | str]]] = [
        {("p", (place,)): frozenset({bit}) for place, bit in enumerate(bits(number))}
        for number in range(2048)
    ]
    assert len(close_pairs(asked)) <= 4 * len(asked)
