"""Random small domains with all constructs of the language, and problems for them.

Rules of one action exclude each other by a literal of their own, and the effects of an outcome are on
different symbols, so that nothing but the number of cases can be refused.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from fractions import Fraction

import numpy as np

from cleancli.language.model import (
    Action,
    Assign,
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
    Parameter,
    Price,
    PricePart,
    Problem,
    Quantified,
    Reference,
    RewardKind,
    RewardTerm,
    Rule,
    Shift,
    Symbol,
    Term,
    Type,
    Variable,
)

X, Y, Z, W = (Variable(name, "thing") for name in "xyzw")
HOME = Object("home", "place")
THING, PLACE = Variable("p", "thing"), Variable("q", "place")
NAMES = ("a", "b", "c")
GRADES = ("low", "middle", "high")
FALSE, TRUE = frozenset({False}), frozenset({True})


class Generator:
    """One random domain and problem per seed; prices have draws of their own."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        self.prices = np.random.default_rng([seed, 1])
        self.symbols = (
            Symbol("red", (THING,)),
            Symbol("wet", (THING,)),
            Symbol("on", (X, Y), symmetric=bool(self.rng.random() < 0.3)),
            Symbol("at", (THING, PLACE)),
            Symbol("beside", (X, Y), symmetric=True, static=True),
            Symbol("grade", (THING,), GRADES),
            Symbol("load", (THING,), (0, 1, 2)),
            Symbol("far", (X, Y), (0, 1, 2, 3), static=True),
            Symbol("fare", (PLACE,), (1, 2, 3), static=True),
        )
        chosen = Literal("red", (Y,), self._either())
        self.derived = (
            DerivedPredicate(
                "topped", (X,), (Quantified(True, (Y,), (Literal("on", (Y, X), TRUE), chosen)),)
            ),
            DerivedPredicate("plain", (X,), (Literal("topped", (X,), FALSE), self._literal([X]))),
            DerivedPredicate("above", (X, Y), closure="on"),
            DerivedPredicate("joined", (X, Y), closure="beside"),
        )

    def domain(self) -> Domain:
        return Domain(
            name="random",
            types=(Type("thing"), Type("place")),
            constants=(HOME,),
            symbols=self.symbols,
            counts=(
                Count("reds", (X,), (Literal("red", (X,), TRUE),)),
                Count("odd", (X,), self._condition([X], 2)),
            ),
            actions=(
                Action("one", (X,), cost=Price(Fraction(1, 4)) + self._price([X], False)),
                Action("two", (X, Y), cost=self._price([X, Y], False)),
            ),
            rules=tuple(
                self._rule(name, action, variables, value)
                for action, variables in (("one", (X,)), ("two", (X, Y)))
                for name, value in ((f"{action}_wet", True), (f"{action}_dry", False))
            ),
            default=(Outcome(Fraction(1), OutcomeKind.NOTHING),),
            reward=(
                RewardTerm(Fraction(2), RewardKind.DECREASE, "reds"),
                RewardTerm(Fraction(-1, 2), RewardKind.COUNT, "odd"),
                RewardTerm(Fraction(5), RewardKind.GOAL),
                RewardTerm(Fraction(-1), RewardKind.COST),
            ),
            derived=self.derived,
            parameters=(Parameter("half", Fraction(1, 2)),),
        )

    def problem(self) -> Problem:
        facts = [
            *(Fact(p, (n,)) for p in ("red", "wet") for n in NAMES if self.rng.random() < 0.6),
            *(Fact("on", pair) for pair in self._pairs(0.2)),
            *(Fact("beside", pair) for pair in self._pairs(0.3)),
            *(Fact("at", (n, "home")) for n in NAMES if self.rng.random() < 0.5),
            *(Fact("grade", (n,), str(self.rng.choice(GRADES))) for n in NAMES),
            *(Fact("load", (n,), int(self.rng.integers(3))) for n in NAMES),
            *(Fact("far", pair, int(self.prices.integers(4))) for pair in itertools.product(NAMES, repeat=2)),
            Fact("fare", ("home",), int(self.prices.integers(1, 4))),
        ]
        goal = (Quantified(bool(self.rng.random() < 0.5), (X,), self._inner([X])),)
        objects = tuple(Object(name, "thing") for name in NAMES)
        return Problem("random", "random", objects, frozenset(facts), Horizon(4), 0.9, goal)

    def _pairs(self, share: float) -> list[tuple[str, str]]:
        """Sorted pairs, so that they are canonical for symmetric symbols too."""
        pairs = itertools.combinations_with_replacement(NAMES, 2)
        return [pair for pair in pairs if self.rng.random() < share]

    def _either(self) -> frozenset[bool]:
        return TRUE if self.rng.random() < 0.5 else FALSE

    def _literal(self, terms: list[Variable]) -> Literal:
        """A literal of a declared symbol."""

        def term() -> Term:
            return terms[int(self.rng.integers(len(terms)))]

        match int(self.rng.integers(7)):
            case 0 | 1:
                return Literal("red", (term(),), self._either())
            case 2:
                return Literal("on", (term(), term()), self._either())
            case 3:
                return Literal("at", (term(), HOME), self._either())
            case 4:
                return Literal("beside", (term(), term()), self._either())
            case 5:
                size = int(self.rng.integers(1, 3))
                return Literal("grade", (term(),), frozenset(self.rng.permutation(GRADES)[:size].tolist()))
            case _:
                size = int(self.rng.integers(1, 3))
                return Literal("load", (term(),), frozenset(self.rng.permutation(3)[:size].tolist()))

    def _inner(self, terms: list[Variable]) -> tuple[Literal | Equality, ...]:
        """A condition without quantifiers; it speaks of the last term."""
        literals = [self._literal(terms[-1:]), self._literal(terms)]
        differ = len(terms) > 1 and self.rng.random() < 0.3
        more = [Equality(terms[0], terms[-1], False)] if differ else []
        return (*literals[: int(self.rng.integers(1, 3))], *more)

    def _condition(self, terms: list[Variable], parts: int) -> tuple[Literal | Equality | Quantified, ...]:
        found: list[Literal | Equality | Quantified] = []
        for _ in range(parts):
            last = terms[-1]
            match int(self.rng.integers(5)):
                case 0:
                    found.append(self._literal(terms))
                case 1:
                    found.append(Quantified(bool(self.rng.random() < 0.5), (Z,), self._inner([*terms, Z])))
                case 2:
                    name = str(self.rng.choice(["topped", "plain"]))
                    found.append(Literal(name, (last,), self._either()))
                case 3:
                    name = str(self.rng.choice(["above", "joined"]))
                    found.append(Literal(name, (terms[0], last), self._either()))
                case _:
                    pass
        return tuple(found)

    def _rule(self, name: str, action: str, variables: tuple[Variable, ...], wet: bool) -> Rule:
        own = Literal("wet", (X,), TRUE if wet else FALSE)
        differ = (Equality(X, Y, False),) if len(variables) == 2 and self.rng.random() < 0.5 else ()
        condition = (own, *differ, *self._condition(list(variables), 1))
        references: tuple[Reference, ...] = ()
        terms = list(variables)
        if self.rng.random() < 0.4:
            references = (Reference((Z,), self._inner([*terms, Z])),)
            terms.append(Z)
            if self.rng.random() < 0.3:
                references += (Reference((W,), self._inner([*terms, W])),)
                terms.append(W)
        outcomes = (
            self._paying(
                Outcome(Fraction(1, 2), OutcomeKind.CHANGE, self._effects(terms), parameter="half"), terms
            ),
            self._paying(Outcome(Fraction(3, 10), OutcomeKind.CHANGE, self._effects(terms)), terms),
            Outcome(Fraction(2, 10), OutcomeKind.NOISE, is_rest=True),
            self._paying(Outcome(Fraction(0), OutcomeKind.CHANGE, self._effects(terms)), terms),
        )
        return Rule(name, action, variables, condition, outcomes, references)

    def _paying(self, outcome: Outcome, terms: list[Variable]) -> Outcome:
        """The outcome, half of the time with something that it pays or costs."""
        if self.prices.random() < 0.5:
            return outcome
        return replace(outcome, reward=self._price(terms, True), cost=self._price(terms, False))

    def _price(self, terms: list[Variable], may_fall: bool) -> Price:
        """A number and up to two functions of these terms, or nothing."""
        found = Price(Fraction(int(self.prices.integers(3)), 2))
        for _ in range(int(self.prices.integers(3))):
            weight = Fraction(int(self.prices.choice([1, 1, 2, 3])), int(self.prices.choice([1, 2, 3])))
            one, other = (terms[int(each)] for each in self.prices.integers(len(terms), size=2))
            about: tuple[str, tuple[Term, ...]] = ("fare", (HOME,))
            if self.prices.random() < 0.7:
                about = "far", (one, other)
            falls = may_fall and self.prices.random() < 0.5
            found += Price(parts=(PricePart(-weight if falls else weight, *about),))
        return found

    def _effects(self, terms: list[Variable]) -> tuple[Assign | Shift | ForAll, ...]:
        chosen = self.rng.permutation(["red", "wet", "on", "at", "grade", "load"])[:2]
        effects: list[Assign | Shift | ForAll] = []
        for symbol in chosen.tolist():
            if symbol != "on" and self.rng.random() < 0.3:
                inner = self._effect(symbol, [W])
                effects.append(ForAll((W,), self._inner([*terms[:1], W]), (inner,)))
            else:
                effects.append(self._effect(symbol, terms))
        return tuple(effects)

    def _effect(self, symbol: str, terms: list[Variable]) -> Assign | Shift:
        term = terms[int(self.rng.integers(len(terms)))]
        match symbol:
            case "grade":
                return Assign(symbol, (term,), str(self.rng.choice(GRADES)))
            case "load":
                return Shift(symbol, (term,), int(self.rng.choice([-2, -1, 1, 2])))
            case "at":
                return Assign(symbol, (term, HOME), bool(self.rng.random() < 0.5))
            case "on":
                return Assign(symbol, (terms[0], term), bool(self.rng.random() < 0.5))
            case _:
                return Assign(symbol, (term,), bool(self.rng.random() < 0.5))
