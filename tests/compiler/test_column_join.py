"""What a join by columns finds is what trying all objects finds."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from cleancli.compiler import column_join
from cleancli.compiler.column_join import ColumnJoin
from cleancli.compiler.lifted_state import StateView
from cleancli.compiler.static_join import Universe
from cleancli.language.model import (
    Condition,
    DerivedPredicate,
    Domain,
    Equality,
    Fact,
    Literal,
    Object,
    Problem,
    Quantified,
    Symbol,
    Term,
    Type,
    Variable,
)

X, Y, Z, W = (Variable(name, "thing") for name in "xyzw")
TOOL = Variable("t", "tool")
NAMES = ("a", "b", "c", "d")
MOP = Object("mop", "tool")
TRUE, FALSE = frozenset({True}), frozenset({False})
DOMAIN = Domain(
    name="d",
    types=(Type("thing"), Type("tool", "thing"), Type("other")),
    constants=(MOP,),
    symbols=(
        Symbol("p", (X,)),
        Symbol("q", (X, Y)),
        Symbol("s", (X, Y), symmetric=True),
        Symbol("u", (X, Y, Z)),
        Symbol("f", (X,), ("low", "middle", "high")),
        Symbol("n", (X, Y), (0, 1, 2)),
        Symbol("always", ()),
        Symbol("never", ()),
    ),
    counts=(),
    actions=(),
    rules=(),
    default=(),
    reward=(),
    derived=(
        DerivedPredicate("linked", (X, Y), closure="q"),
        DerivedPredicate("alone", (X,), (Quantified(False, (Y,), (Literal("s", (X, Y), TRUE),)),)),
    ),
)


class Drawn:
    """A random problem without rules, and conditions on it."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        things = (*NAMES, "mop")
        facts = [Fact("always", ())]
        facts += [Fact("p", (x,)) for x in things if self.rng.random() < 0.5]
        facts += [Fact("f", (x,), str(self.rng.choice(["low", "middle", "high"]))) for x in things]
        for pair in itertools.product(things, things):
            facts += [Fact("q", pair)] if self.rng.random() < 0.3 else []
            facts += [Fact("s", pair)] if self.rng.random() < 0.3 and pair[0] <= pair[1] else []
            facts.append(Fact("n", pair, int(self.rng.integers(3))))
            facts += [Fact("u", (*pair, x)) for x in things if self.rng.random() < 0.2]
        objects = (*(Object(name, "thing") for name in NAMES), Object("else", "other"))
        self.problem = Problem("p", "d", objects, frozenset(facts))

    def condition(self, variables: tuple[Variable, ...]) -> Condition:
        parts = [self._part(variables) for _ in range(int(self.rng.integers(1, 5)))]
        return tuple(parts)

    def _part(self, variables: tuple[Variable, ...]) -> Literal | Equality | Quantified:
        one, other, third = (self._term(variables) for _ in range(3))
        either = TRUE if self.rng.random() < 0.7 else FALSE
        choices: list[Literal | Equality | Quantified] = [
            Literal("p", (one,), either),
            Literal("q", (one, other), either),
            Literal("s", (one, other), either),
            Literal("u", (one, other, third), either),
            Literal("f", (one,), frozenset({"low", "high"} if self.rng.random() < 0.5 else {"middle"})),
            Literal("n", (one, other), frozenset({0, 2} if self.rng.random() < 0.5 else {1})),
            Literal("linked", (one, other), either),
            Literal("alone", (one,), either),
            Literal("always" if self.rng.random() < 0.9 else "never", (), TRUE),
            Equality(one, other, bool(self.rng.random() < 0.5)),
            Quantified(bool(self.rng.random() < 0.5), (W,), (Literal("q", (one, W), either),)),
        ]
        return choices[int(self.rng.integers(len(choices)))]

    def _term(self, variables: tuple[Variable, ...]) -> Term:
        terms: tuple[Term, ...] = (*variables, MOP)
        return terms[int(self.rng.integers(len(terms)))]


@pytest.mark.parametrize("few", [0, 1000])
@pytest.mark.parametrize("seed", range(40))
def test_joined_is_what_satisfies(seed: int, few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where tuples are few enough to try one by one."""
    monkeypatch.setattr(column_join, "FEW", few)
    drawn = Drawn(seed)
    join = ColumnJoin(Universe(DOMAIN, drawn.problem))
    view = StateView(DOMAIN, (*DOMAIN.constants, *drawn.problem.objects), drawn.problem.state)
    for variables in ((), (X,), (TOOL, X), (X, Y, Z), (Z, TOOL, Y, X)):
        condition = drawn.condition(variables)
        found = [join.named(row) for row in join.bindings(variables, condition).tolist()]
        satisfying = [tuple(each[v] for v in variables) for each in view.extensions(variables, condition, {})]
        assert found == sorted(satisfying), condition
        assert join.count(variables, condition, 5**4) == len(satisfying)


def test_a_join_that_leaves_too_much_is_not_counted() -> None:
    join = ColumnJoin(Universe(DOMAIN, Drawn(0).problem))
    apart = (Equality(X, Y, False),)
    assert join.count((X, Y), apart, 25) == 20, "five by five, of which five are no pairs"
    assert join.count((X, Y), apart, 24) is None


def test_the_most_that_a_literal_leaves() -> None:
    drawn = Drawn(1)
    rows = [fact.objects for fact in drawn.problem.state if fact.symbol == "u"]
    join, literal = ColumnJoin(Universe(DOMAIN, drawn.problem)), Literal("u", (X, Y, MOP), TRUE)
    for bound, places in (((), (2,)), ((X,), (0, 2)), ((X, Y), (0, 1, 2))):
        chosen = {tuple(row[place] for place in places) for row in rows}
        most = max(sum(tuple(row[p] for p in places) == each for row in rows) for each in chosen)
        assert join.widest(literal, bound) == most
    assert join.widest(Literal("u", (X, Y, Z), FALSE), ()) is None, "facts do not list it"
    assert join.widest(Literal("always", (), TRUE), ()) == 1
    assert join.widest(Literal("never", (), TRUE), ()) == 0


def test_numbers_of_many_columns_do_not_run_over() -> None:
    """Forty columns of six objects make more rows than 64 bits tell apart."""
    join = ColumnJoin(Universe(DOMAIN, Drawn(2).problem))
    rows = np.zeros((3, 40), dtype=np.int64)
    rows[1, 0], rows[2, 39] = 1, 1
    distinct, place = join.projected(np.concatenate([rows, rows]))
    assert distinct.tolist() == rows[[0, 2, 1]].tolist()
    assert place.tolist() == [0, 2, 1, 0, 2, 1]
