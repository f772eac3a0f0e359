"""Models written by hand: short names for their records, and a domain with a deictic reference."""

from __future__ import annotations

from fractions import Fraction

from cleancli.language.model import (
    Action,
    Assign,
    Count,
    Domain,
    Fact,
    Horizon,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Parameter,
    Problem,
    Reference,
    RewardKind,
    RewardTerm,
    Rule,
    Shift,
    Symbol,
    Term,
    Type,
    Value,
    Variable,
)

A, B, M = (Variable(name, "area") for name in "abm")


def true(symbol: str, *terms: Term) -> Literal:
    return Literal(symbol, terms, frozenset({True}))


def false(symbol: str, *terms: Term) -> Literal:
    return Literal(symbol, terms, frozenset({False}))


def one_of(symbol: str, term: Term, *values: Value) -> Literal:
    return Literal(symbol, (term,), frozenset(values))


def put(symbol: str, *terms: Term, value: Value = True) -> Assign:
    return Assign(symbol, terms, value)


def outcome(probability: str, *effects: Assign | Shift) -> Outcome:
    return Outcome(Fraction(probability), OutcomeKind.CHANGE if effects else OutcomeKind.NOTHING, effects)


def noise(probability: str) -> Outcome:
    return Outcome(Fraction(probability), OutcomeKind.NOISE)


JOIN_DRAGS = Domain(
    name="drags",
    types=(Type("area"),),
    constants=(),
    symbols=(
        Symbol("dirt", (A,)),
        Symbol("scattered", (A,)),
        Symbol("near", (A, B), symmetric=True, static=True),
        Symbol("traversal", (A, B, M), static=True),
        Symbol("size", (A,), ("small", "medium", "big")),
    ),
    counts=(Count("dirty", (A,), (true("dirt", A),)),),
    actions=(Action("join2", (A, B)), Action("pickUp", (A,))),
    rules=(
        Rule(
            "join_drags",
            "join2",
            (A, B),
            (true("dirt", A), true("dirt", B), true("near", A, B)),
            (
                outcome(
                    "0.55",
                    put("dirt", A, value=False),
                    put("dirt", M, value=False),
                    put("size", B, value="big"),
                ),
                outcome(
                    "0.25", put("dirt", A, value=False), put("size", B, value="big"), put("scattered", B)
                ),
                Outcome(Fraction("0.1"), OutcomeKind.CHANGE, (put("scattered", B),), parameter="spill"),
                noise("0.1"),
            ),
            references=(Reference((M,), (true("traversal", A, B, M), true("dirt", M))),),
        ),
        Rule("pick", "pickUp", (A,), (true("dirt", A),), (outcome("1", put("dirt", A, value=False)),)),
    ),
    default=(outcome("1"),),
    reward=(RewardTerm(Fraction(1), RewardKind.DECREASE, "dirty"),),
    parameters=(Parameter("spill", Fraction("0.1")),),
)
"""The example of a deictic reference: joining `?a` with `?b` drags the one dirty area between them along."""


def drags_problem(*dirty: str) -> Problem:
    """Areas a, b, m, n; both m and n lie between a and b, which are near."""
    names = ("a", "b", "m", "n")
    facts = {Fact("dirt", (name,)) for name in dirty}
    facts |= {Fact("near", ("a", "b")), *(Fact("traversal", ("a", "b", name)) for name in "mn")}
    facts |= {Fact("size", (name,), "small") for name in names}
    objects = tuple(Object(name, "area") for name in names)
    return Problem("p", "drags", objects, frozenset(facts), Horizon(3))
