"""Rules that are grounded by columns mean what they mean when they are grounded instance by instance.

The latter is how rules with references, alternatives and shifts are grounded, and test_meaning.py compares it
with the rules themselves.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import pytest

from cleancli.compiler import column_join
from cleancli.compiler import instances as instances_module
from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import successors
from cleancli.compiler.task import GroundState, Task
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import (
    Action,
    Assign,
    Condition,
    Count,
    DerivedPredicate,
    Domain,
    Equality,
    Fact,
    ForAll,
    Horizon,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Problem,
    RewardKind,
    RewardTerm,
    Rule,
    Symbol,
    Term,
    Type,
    Variable,
)

X, Y, Z, W = (Variable(name, "thing") for name in "xyzw")
HOME = Object("home", "thing")
NAMES = ("a", "b", "c")
TRUE, FALSE = frozenset({True}), frozenset({False})
GRADES = ("low", "middle", "high")
ACTIONS = (("one", (X,)), ("two", (X, Y)), ("three", (X, Y, Z)), ("all", ()))
SYMBOLS = (
    Symbol("red", (X,)),
    Symbol("wet", (X,)),
    Symbol("on", (X, Y)),
    Symbol("beside", (X, Y), symmetric=True),
    Symbol("grade", (X,), GRADES),
    Symbol("near", (X, Y), symmetric=True, static=True),
    Symbol("way", (X, Y, Z), static=True),
    Symbol("kind", (X,), GRADES, static=True),
)


DERIVED = (
    DerivedPredicate(
        "ripe", (X, Y), (Literal("red", (X,), TRUE), Literal("grade", (Y,), frozenset(GRADES[1:])))
    ),
    DerivedPredicate("lone", (X,), (Literal("on", (X, HOME), FALSE), Literal("on", (X, X), FALSE))),
)


class Drawn:
    """A random domain whose rules are all plain; many overlap, and some set one thing twice. With derived
    predicates, their conditions are of several conjunctions."""

    def __init__(self, seed: int, derived: tuple[DerivedPredicate, ...] = ()) -> None:
        self.rng = np.random.default_rng(seed)
        self.derived = derived
        self.domain = Domain(
            name="plain",
            types=(Type("thing"),),
            constants=(HOME,),
            symbols=SYMBOLS,
            derived=derived,
            counts=(Count("reds", (X,), (Literal("red", (X,), TRUE),)),),
            actions=(
                Action("one", (X,)),
                Action("two", (X, Y)),
                Action("three", (X, Y, Z)),
                Action("all", ()),
            ),
            rules=tuple(self._rules()),
            default=(Outcome(Fraction(1), OutcomeKind.NOTHING),),
            reward=(RewardTerm(Fraction(1), RewardKind.DECREASE, "reds"),),
        )
        self.problem = self._problem()

    def _rules(self) -> list[Rule]:
        """For each action one rule for what is wet and one for what is not, or for all."""
        found = []
        for action, variables in ACTIONS:
            for name, values in (("wet", TRUE), ("dry", FALSE)):
                own = Literal("wet", variables[:1] or (HOME,), values)
                apart = self.rng.random() < 0.97
                condition = (*self._condition(variables), *((own,) if apart else ()))
                found.append(
                    Rule(f"{action}_{name}", action, variables, condition, self._outcomes(variables))
                )
        return found

    def _condition(self, variables: tuple[Variable, ...]) -> Condition:
        parts: list[Literal | Equality] = []
        for _ in range(int(self.rng.integers(0, 4))):
            one, other, third = (self._term(variables) for _ in range(3))
            either = TRUE if self.rng.random() < 0.5 else FALSE
            some = frozenset(
                str(g) for g in self.rng.choice(GRADES, int(self.rng.integers(1, 3)), replace=False)
            )
            choices: list[Literal | Equality] = [
                Literal("red", (one,), either),
                Literal("on", (one, other), either),
                Literal("beside", (one, other), either),
                Literal("grade", (one,), some),
                Literal("near", (one, other), either),
                Literal("way", (one, other, third), TRUE),
                Literal("kind", (one,), some),
                Equality(one, other, bool(self.rng.random() < 0.3)),
            ]
            if self.derived:
                choices += [Literal("ripe", (one, other), either), Literal("lone", (one,), either)] * 2
            parts.append(choices[int(self.rng.integers(len(choices)))])
        return tuple(parts)

    def _outcomes(self, variables: tuple[Variable, ...]) -> tuple[Outcome, ...]:
        shares = [Fraction(1, 2), Fraction(1, 2), Fraction(0)][: int(self.rng.integers(2, 4))]
        changing = [
            Outcome(share, OutcomeKind.CHANGE, tuple(self._effect(variables) for _ in range(self._few())))
            for share in shares
        ]
        return (*changing, Outcome(Fraction(0), OutcomeKind.NOISE))

    def _few(self) -> int:
        return 1 if self.rng.random() < 0.8 else 2

    def _effect(self, variables: tuple[Variable, ...]) -> Assign | ForAll:
        if self.rng.random() < 0.3:
            guard = Literal("way", (W, self._term(variables), self._term((*variables, W))), TRUE)
            condition = ((guard,), (), (Equality(W, self._term(variables), False),))[
                int(self.rng.integers(3))
            ]
            return ForAll((W,), condition, (self._assign((W,)),))
        return self._assign(variables)

    def _assign(self, variables: tuple[Variable, ...]) -> Assign:
        one, other = self._term(variables), self._term(variables)
        value = bool(self.rng.random() < 0.5)
        return [
            Assign("red", (one,), value),
            Assign("wet", (one,), value),
            Assign("on", (one, other), value),
            Assign("beside", (one, other), value),
            Assign("grade", (one,), str(self.rng.choice(GRADES))),
        ][int(self.rng.integers(5))]

    def _term(self, variables: tuple[Variable, ...]) -> Term:
        terms: tuple[Term, ...] = (*variables, *variables, HOME)
        return terms[int(self.rng.integers(len(terms)))]

    def _problem(self) -> Problem:
        things = (*NAMES, "home")
        facts = [Fact(symbol, (x,)) for symbol in ("red", "wet") for x in things if self.rng.random() < 0.5]
        facts += [Fact(s, (x,), str(self.rng.choice(GRADES))) for s in ("grade", "kind") for x in things]
        for pair in itertools.product(things, things):
            facts += [Fact("on", pair)] if self.rng.random() < 0.2 else []
            symmetric = pair == tuple(sorted(pair))
            facts += [Fact(s, pair) for s in ("beside", "near") if symmetric and self.rng.random() < 0.4]
            facts += [Fact("way", (*pair, x)) for x in things if self.rng.random() < 0.2]
        objects = tuple(Object(name, "thing") for name in NAMES)
        return Problem("p", "plain", objects, frozenset(facts), Horizon(3))


def grounded(drawn: Drawn, compat: bool) -> Task | tuple[Diagnostic, ...]:
    try:
        return ground(drawn.domain, drawn.problem, compat=compat, named=[("two", ("a", "home"))])
    except Refused as refused:
        return refused.diagnostics


@pytest.mark.parametrize("compat", [False, True])
def test_the_same_task_by_columns_and_one_by_one(compat: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(instances_module, "FEW", 0)
    monkeypatch.setattr(column_join, "FEW", 0)
    drawn = [Drawn(seed) for seed in range(60)]
    by_columns = [grounded(each, compat) for each in drawn]
    monkeypatch.setattr(instances_module, "plain_conjunctions", lambda rule, universe: None)
    assert by_columns == [grounded(each, compat) for each in drawn]
    codes = Counter(d.code for found in by_columns if isinstance(found, tuple) for d in found)
    tasks = [found for found in by_columns if isinstance(found, Task)]
    assert codes["E602"] > 5, "conflicts are among what is compared"
    assert compat or codes["E603"] > 1, "and rules that overlap"
    assert len(tasks) > 20
    assert sum(len(task.rules) for task in tasks) > 500


def test_several_conjunctions_mean_what_derived_predicates_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(instances_module, "FEW", 0)
    drawn = [Drawn(seed, DERIVED) for seed in range(60)]
    by_columns = [grounded(each, compat=False) for each in drawn]
    monkeypatch.setattr(instances_module, "plain_conjunctions", lambda rule, universe: None)
    one_by_one = [grounded(each, compat=False) for each in drawn]
    tasks, divided = 0, 0
    for seed, (left, right) in enumerate(zip(by_columns, one_by_one, strict=True)):
        if not isinstance(left, Task) or not isinstance(right, Task):
            assert codes(left) == codes(right) != [], seed
            continue
        assert walked(left, seed) == walked(right, seed), seed
        tasks += 1
        pairs = [p for p in itertools.combinations(left.rules, 2) if p[0].action == p[1].action]
        alike = [(one, other) for one, other in pairs if one.rule == other.rule]
        assert all(excluding(dict(one.condition), dict(other.condition)) for one, other in alike), seed
        divided += bool(alike)
    assert tasks > 20
    assert divided > 10, "some rules are divided into several conjunctions"


def walked(task: Task, seed: int) -> list[tuple[dict[str, object], dict[str, float]]]:
    """States of a random walk, by what differs from the initial one, and the chance of each that may follow;
    by the names of fluents and actions, since a task may list some that never change anything."""
    rng, state, found = np.random.default_rng(seed), task.initial, []
    for _ in range(30):
        moves = {
            f"{action}: {sorted(told(task, successor).items())}": (chance, successor)
            for number, action in enumerate(task.actions)
            for chance, successor in successors(task, state, number)
            if successor != state
        }
        found.append((told(task, state), {move: chance for move, (chance, _) in moves.items()}))
        if not moves:
            break
        state = moves[sorted(moves)[int(rng.integers(len(moves)))]][1]
    return found


def excluding(one: Mapping[int, frozenset[int]], other: Mapping[int, frozenset[int]]) -> bool:
    return any(not allowed & other.get(variable, allowed) for variable, allowed in one.items())


def told(task: Task, state: GroundState) -> dict[str, object]:
    """What differs from the initial state."""
    pairs = zip(task.variables, zip(task.initial, state, strict=True), strict=True)
    return {
        f"{variable.symbol}{variable.objects}": variable.values[now]
        for variable, (before, now) in pairs
        if now != before
    }


def codes(found: Task | tuple[Diagnostic, ...]) -> list[str]:
    return [] if isinstance(found, Task) else [diagnostic.code for diagnostic in found]
