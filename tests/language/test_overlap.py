"""The overlap test against brute force: all states over all ways in which terms can be one object."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.language.checking.declarations import Declarations
from cleancli.language.checking.literals import negated, separating, witness
from cleancli.language.model import Condition, Equality, Literal, Object, Symbol, Term, Type, Variable

A, B, C = Variable("a", "area"), Variable("b", "area"), Variable("c", "thing")
BIN = Object("bin", "thing")
TERMS: tuple[Term, ...] = (A, B, C, BIN)
THINGS = (Variable("x", "thing"), Variable("y", "thing"))
DECLARED = Declarations(
    {"thing": Type("thing"), "area": Type("area", "thing")},
    {"bin": BIN},
    {
        "p": Symbol("p", THINGS[:1]),
        "near": Symbol("near", THINGS, symmetric=True),
        "size": Symbol("size", THINGS[:1], ("s", "m", "b")),
    },
)


def _literals() -> st.SearchStrategy[Literal | Equality]:
    term = st.sampled_from(TERMS)
    sign = st.booleans().map(lambda value: frozenset({value}))
    sizes = st.sampled_from([{"s"}, {"m"}, {"b"}, {"s", "m"}, {"m", "b"}, {"s", "b"}]).map(frozenset)
    return st.one_of(
        st.builds(lambda t, v: Literal("p", (t,), v), term, sign),
        st.builds(lambda t, u, v: Literal("near", (t, u), v), term, term, sign),
        st.builds(lambda t, v: Literal("size", (t,), v), term, sizes),
        st.tuples(term, term, st.booleans())
        .filter(lambda e: e[0] != e[1])
        .map(lambda e: Equality(e[0], e[1], e[2])),
    )


CONDITIONS = st.lists(_literals(), max_size=5).map(tuple)


def _bindings() -> Iterator[dict[Term, str]]:
    """Three areas, one other thing and the bin: enough for three variables to differ or coincide."""
    areas, things = ("1", "2", "3"), ("1", "2", "3", "other", "bin")
    for a, b, c in product(areas, areas, things):
        yield {A: a, B: b, C: c, BIN: "bin"}


def _satisfiable(condition: Condition) -> bool:
    return any(_holds_somewhere(condition, binding) for binding in _bindings())


def _holds_somewhere(condition: Condition, binding: dict[Term, str]) -> bool:
    allowed: dict[tuple[str, ...], set[object]] = {}
    for part in condition:
        if isinstance(part, Equality):
            if (binding[part.left] == binding[part.right]) != part.equal:
                return False
            continue
        assert isinstance(part, Literal)
        objects = sorted(binding[t] for t in part.terms)
        key = (part.symbol, *objects)
        allowed.setdefault(key, set(DECLARED.symbols[part.symbol].values)).intersection_update(part.values)
    return all(allowed.values())


@settings(max_examples=300, deadline=None)
@given(CONDITIONS, CONDITIONS)
def test_witness_exactly_where_a_state_exists(one: Condition, other: Condition) -> None:
    assert (witness([one, other], DECLARED) is not None) == _satisfiable((*one, *other))


@settings(max_examples=100, deadline=None)
@given(CONDITIONS, CONDITIONS)
def test_the_advice_separates(one: Condition, other: Condition) -> None:
    part = separating(one, other, DECLARED)
    if part is not None:
        mended = (*other, negated(part, DECLARED))
        assert _satisfiable(mended)
        assert not _satisfiable((*one, *mended))


def test_variables_that_may_coincide_do_not_hide_an_overlap() -> None:
    one: Condition = (Literal("p", (A,), frozenset({True})),)
    other: Condition = (Literal("p", (B,), frozenset({False})),)
    assert witness([one, other], DECLARED) is not None
    assert witness([one, other, (Equality(A, B, True),)], DECLARED) is None


def test_symmetric_terms_are_one() -> None:
    one: Condition = (Literal("near", (A, B), frozenset({True})),)
    other: Condition = (Literal("near", (B, A), frozenset({False})),)
    assert witness([one, other], DECLARED) is None
