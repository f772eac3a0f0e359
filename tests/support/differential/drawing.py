"""Random domains and problems with every construct of the language, as `abstract.py`'s data.

Whether a domain is right is left to the product's checker: what it refuses is looked at by `comparing.py`.
Rules of one action are mostly made to exclude each other, by asking for opposite things; some are not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from random import Random

from support.differential.abstract import (
    Action,
    AnyOf,
    Closure,
    Comparison,
    Count,
    Definition,
    Domain,
    Equality,
    Every,
    Exists,
    Key,
    Literal,
    Part,
    Payment,
    Price,
    Problem,
    Reference,
    Rule,
    Symbol,
    Truth,
    Value,
    Variable,
)
from support.differential.outcomes_drawn import OutcomeDrawer
from support.differential.prices_drawn import price_drawer

Variables = tuple[Variable, ...]
OPPOSITE = {"=": "!=", "!=": "=", "<": ">=", ">=": "<", ">": "<=", "<=": ">"}
WEIGHTS = ("1", "1", "2", "0.5", "1/3", "3", "0", "-1", "-0.5")


@dataclass(slots=True)
class Drawer:
    """Draws one domain and its problem; the fields fill up as it goes."""

    random: Random
    kinds: tuple[tuple[str, str | None], ...] = ()
    objects: list[Variable] = field(default_factory=list)
    constants: tuple[Variable, ...] = ()
    symbols: tuple[Symbol, ...] = ()
    derived: tuple[Definition | Closure, ...] = ()
    names: int = 0

    # ---- small things

    def often(self, share: float) -> bool:
        return self.random.random() < share

    def fresh(self, variables: int, kinds: Sequence[str] | None = None) -> Variables:
        """Variables that no other part of the file uses."""
        made = []
        for _ in range(variables):
            self.names += 1
            kind = self.random.choice(kinds or [name for name, _ in self.kinds])
            made.append(Variable(f"?x{self.names}", kind))
        return tuple(made)

    def below(self, kind: str, top: str) -> bool:
        above = dict(self.kinds)
        here: str | None = kind
        while here is not None and here != top:
            here = above[here]
        return here == top

    def terms(
        self, kinds: Sequence[str], variables: Variables, wanted: Variables = ()
    ) -> tuple[str, ...] | None:
        """Terms that fit, one of `wanted` among them where that is possible."""
        pools = []
        for kind in kinds:
            pool = [each.name for each in variables if self.below(each.kind, kind)]
            pool += [each.name for each in self.constants if self.below(each.kind, kind) and self.often(0.3)]
            if not pool:
                return None
            pools.append(pool)
        chosen = [self.random.choice(pool) for pool in pools]
        for index in self.random.sample(range(len(kinds)), len(kinds)):
            fitting = [each.name for each in wanted if self.below(each.kind, kinds[index])]
            if fitting:
                chosen[index] = self.random.choice(fitting)
                break
        return tuple(chosen)

    # ---- declarations

    def draw_kinds(self) -> None:
        self.kinds = self.random.choice(
            (
                (("thing", None),),
                (("thing", None), ("box", "thing")),
                (("thing", None), ("box", "thing"), ("bag", "thing")),
                (("thing", None), ("place", None)),
                (("thing", None), ("box", "thing"), ("tin", "box"), ("place", None)),
            )
        )
        names = [name for name, _ in self.kinds]
        count = self.random.choice((2, 2, 3, 3, 3, 4))
        made = [Variable(f"o{index}", self.random.choice(names)) for index in range(count)]
        constants = self.random.choice((0, 0, 1, 2))
        self.constants = tuple(replace(each, name=f"c{each.name[1:]}") for each in made[:constants])
        self.objects = made[constants:]

    def draw_symbols(self) -> None:
        names = [name for name, _ in self.kinds]
        symbols = []
        for index in range(self.random.choice((2, 3, 3, 4))):
            arity = self.random.choice((0, 1, 1, 1, 2, 2, 3) if index else (1, 1, 2))
            kinds = tuple(self.random.choice(names) for _ in range(arity))
            symmetric = arity == 2 and self.often(0.5)
            if symmetric:
                kinds = (kinds[0], kinds[0])
            static = index > 1 and self.often(0.25)
            symbols.append(Symbol(f"{'sym' if symmetric else 'p'}{index}", kinds, (), symmetric, static))
        for index in range(self.random.choice((0, 1, 1, 2))):
            kinds = tuple(self.random.choice(names) for _ in range(self.random.choice((0, 1, 1, 1, 2))))
            static = self.often(0.15)
            if self.often(0.6):
                lowest = self.random.randint(-2, 1)
                values: tuple[int | str, ...] = tuple(range(lowest, lowest + self.random.randint(2, 5)))
            else:
                values = ("low", "mid", "top")[: self.random.choice((2, 3))]
            symbols.append(Symbol(f"f{index}", kinds, values, static=static))
        self.symbols = tuple(symbols)

    def draw_derived(self) -> None:
        for index in range(self.random.choice((0, 1, 1, 2, 3))):
            name = f"d{index}"
            pairs = [(each.name, each.kinds) for each in self.symbols if not each.values]
            pairs += [(each.name, tuple(one.kind for one in each.parameters)) for each in self.derived]
            closable = [
                (of, kinds)
                for of, kinds in pairs
                if len(kinds) == 2 and (kinds[0] == kinds[1] or self.often(0.3))
            ]
            if closable and self.often(0.4):
                of, kinds = self.random.choice(closable)
                first, second = (self.fresh(1, [kind])[0] for kind in kinds)
                self.derived += (Closure(name, (first, second), of),)
                continue
            parameters = self.fresh(self.random.choice((0, 1, 1, 2)))
            condition = self.condition(parameters, self.random.choice((1, 1, 2)))
            if condition:
                self.derived += (Definition(name, parameters, condition),)

    def counts(self) -> tuple[Count, ...]:
        made: list[Count] = []
        while len(made) < 2:
            variables = self.fresh(self.random.choice((1, 1, 1, 2)))
            condition = self.condition(variables, self.random.choice((1, 1, 2)), wanted=variables)
            if condition:
                made.append(Count(f"n{len(made)}", variables, condition))
            if made and self.often(0.5):
                break
        return tuple(made)

    # ---- conditions

    def condition(self, variables: Variables, parts: int, wanted: Variables = ()) -> tuple[Part, ...]:
        drawn: list[Part] = []
        for index in range(parts):
            part = self.part(variables, wanted if index == 0 else ())
            if part is not None and part not in drawn:
                drawn.append(part)
        return tuple(drawn)

    def part(self, variables: Variables, wanted: Variables = ()) -> Part | None:
        kind = self.random.choice(("literal",) * 8 + ("any", "exists", "exists", "every", "guarded"))
        if kind == "literal":
            return self.literal(variables, wanted)
        if kind == "any":
            several = self.body(variables, wanted, self.random.choice((2, 2, 3)))
            return AnyOf(several) if len(several) > 1 else None
        inner = self.fresh(self.random.choice((1, 1, 1, 2)))
        outer = (*variables, *inner)
        literals = self.body(outer, inner, self.random.choice((1, 2)) + (kind == "guarded"))
        inner = self.mentioned(inner, literals)
        if not inner or len(literals) < 1 + (kind == "guarded"):
            return None
        if kind == "exists":
            return Exists(inner, literals, self.often(0.5))
        return Every(inner, literals[1:] if kind == "guarded" else (), literals[0])

    def mentioned(self, variables: Variables, literals: Sequence[Literal]) -> Variables:
        """Those of the variables that some literal is about; seldom the others, too."""
        if literals and self.often(0.05):
            return variables
        terms: set[str] = set()
        for literal in literals:
            terms |= {literal.left, literal.right} if isinstance(literal, Equality) else set(literal.terms)
        return tuple(each for each in variables if each.name in terms)

    def body(
        self, variables: Variables, wanted: Variables, literals: int, others: Sequence[Part] = ()
    ) -> tuple[Literal, ...]:
        drawn: list[Literal] = []
        taken = {self.about(part) for part in others if isinstance(part, Literal)}
        for _ in range(literals):
            literal = self.literal(variables, wanted)
            if literal is not None and self.about(literal) not in taken:
                taken.add(self.about(literal))
                drawn.append(literal)
        return tuple(drawn)

    def about(self, literal: Literal) -> object:
        """What a literal asks for, so that nothing is asked for twice."""
        if isinstance(literal, Equality):
            return frozenset((literal.left, literal.right))
        return literal.symbol, frozenset(literal.terms)

    def literal(self, variables: Variables, wanted: Variables = ()) -> Literal | None:
        if variables and self.often(0.1):
            return self.equality(variables, wanted)
        choices: list[tuple[str, tuple[str, ...], tuple[int | str, ...]]] = [
            (each.name, each.kinds, each.values) for each in self.symbols
        ]
        choices += [(each.name, tuple(one.kind for one in each.parameters), ()) for each in self.derived]
        for _ in range(6):
            name, kinds, values = self.random.choice(choices)
            terms = self.terms(kinds, variables, wanted)
            if terms is None or (wanted and not kinds):
                continue
            if values:
                return Comparison(name, terms, *self.relation(values))
            return Truth(name, terms, self.often(0.6))
        return None

    def relation(self, values: tuple[int | str, ...]) -> tuple[str, int | str]:
        """A relation to a value that some values have and others have not."""
        while True:
            relation = self.random.choice(tuple(OPPOSITE))
            index = self.random.randrange(len(values))
            if (relation in ("<", ">=") and index == 0) or (
                relation in (">", "<=") and index == len(values) - 1
            ):
                continue
            return relation, values[index]

    def equality(self, variables: Variables, wanted: Variables) -> Equality | None:
        left = self.random.choice(wanted or variables)
        others = [each for each in variables if each != left and self.related(each, left)]
        others += [each for each in self.constants if self.below(each.kind, left.kind)]
        if not others:
            return None
        return Equality(left.name, self.random.choice(others).name, self.often(0.4))

    def related(self, one: Variable, other: Variable) -> bool:
        return self.below(one.kind, other.kind) or self.below(other.kind, one.kind)

    def opposite(self, part: Part) -> Part:
        if isinstance(part, Truth | Exists):
            return replace(part, holds=not part.holds)
        if isinstance(part, Comparison):
            return replace(part, relation=OPPOSITE[part.relation])
        if isinstance(part, Equality):
            return replace(part, same=not part.same)
        assert isinstance(part, Every), "of several literals each has an opposite"
        opposite = self.opposite(part.then)
        assert isinstance(opposite, Literal)
        return Exists(part.variables, (*part.guard, opposite))

    # ---- actions and rules

    def actions(self) -> tuple[Action, ...]:
        timed = self.often(0.5)
        made = []
        for index in range(self.random.choice((2, 2, 3))):
            duration = self.random.choice(("1 s", "2.5 s", "4 s", "0.1 min", "10 s")) if timed else None
            cost = self.cost(("0", "0.1", "1", "0.25")) if self.often(0.4) else None
            parameters = self.fresh(self.random.choice((0, 1, 1, 1, 2)))
            made.append(Action(f"a{index}", parameters, duration, cost))
        if self.often(0.3):
            made.append(Action("wait", (), "3 s" if timed else None, self.cost((None, "0.2"))))
        return tuple(made)

    def cost(self, numbers: Sequence[str | None]) -> Price | None:
        chosen = self.random.choice(numbers)
        return None if chosen is None else Price(Fraction(chosen))

    def rules(
        self, actions: tuple[Action, ...], shared: tuple[tuple[str, str, str], ...]
    ) -> tuple[Rule, ...]:
        rules: list[Rule] = []
        for action in actions:
            if action.name == "wait":
                rules.append(self.waiting())
                continue
            asked: tuple[Part, ...] = ()
            for index in range(self.random.choice((1, 1, 2, 2, 3)) if self.often(0.95) else 0):
                rule, parts = self.rule(f"{action.name}_r{index}", action, asked, shared)
                rules.append(rule)
                if not parts:
                    break
                asked = (*asked, *parts)
        return tuple(rules)

    def waiting(self) -> Rule:
        drawer = OutcomeDrawer(self, (), ())
        return Rule("waits", "wait", (), (), (), drawer.idle(Fraction(1)))

    def rule(
        self,
        name: str,
        action: Action,
        asked: tuple[Part, ...],
        shared: tuple[tuple[str, str, str], ...],
    ) -> tuple[Rule, tuple[Part, ...]]:
        """A rule that asks for what is asked of it, and the opposite of something that it also asks for: of
        several literals, that of each."""
        renamed = self.often(0.4)
        parameters = tuple(
            Variable(f"{each.name}r" if renamed else each.name, each.kind) for each in action.parameters
        )
        names = {one.name: other.name for one, other in zip(action.parameters, parameters, strict=True)}
        test = None if asked and self.often(0.4) else self.other_part(action.parameters, asked)
        parts = [*asked, *([] if test is None else [test])]
        extra = self.other_part(action.parameters, tuple(parts)) if self.often(0.15) else None
        condition = tuple(rename(part, names) for part in (*parts, *([] if extra is None else [extra])))
        references = self.references(parameters, condition)
        scope = parameters + tuple(each for reference in references for each in reference.variables)
        drawer = OutcomeDrawer(self, scope, shared)
        outcomes = drawer.outcomes()
        numbers = all(outcome.said not in {each[0] for each in shared} for outcome in outcomes)
        fixed = numbers and self.often(0.1)
        rule = Rule(name, action.name, parameters, condition, references, outcomes, fixed)
        if test is None or self.often(0.03):
            return rule, () if test is None else (test,)
        opposite = map(self.opposite, test.literals if isinstance(test, AnyOf) else (test,))
        return rule, tuple(opposite)

    def other_part(self, variables: Variables, asked: tuple[Part, ...]) -> Part | None:
        """A part that is about something else than those that are asked for already."""
        taken = {self.about(part) for part in asked if isinstance(part, Literal)}
        for _ in range(6):
            part = self.part(variables, variables)
            if part is not None and not (isinstance(part, Literal) and self.about(part) in taken):
                return part
        return None

    def references(self, parameters: Variables, condition: tuple[Part, ...]) -> tuple[Reference, ...]:
        made: list[Reference] = []
        scope = parameters
        for _ in range(self.random.choice((0, 0, 0, 0, 0, 1, 1, 2))):
            variables = self.fresh(self.random.choice((1, 1, 1, 2)))
            body = self.body((*scope, *variables), variables, self.random.choice((1, 2, 2)), condition)
            variables = self.mentioned(variables, body)
            if variables:
                made.append(Reference(variables, body))
                scope = (*scope, *variables)
        return tuple(made)

    # ---- what is paid, and the problem

    def reward(self, counts: tuple[Count, ...], timed: bool) -> tuple[Payment, ...]:
        kinds = self.random.sample(("decrease", "count", "goal", "cost"), self.random.choice((1, 1, 2, 3)))
        kinds += ["decrease"] if self.often(0.15) else []
        kinds += ["duration"] if timed and self.often(0.3) else []
        if {*kinds} <= {"cost", "duration"}:
            kinds.append("decrease")
        terms = []
        for kind in kinds:
            takes = kind in ("cost", "duration") and self.often(0.8)
            weight = Fraction(self.random.choice(WEIGHTS)) * (-1 if takes else 1)
            weight *= Fraction(1, 10) if kind == "duration" else 1
            if kind == "decrease" and self.often(0.6):
                weight = abs(weight) or Fraction(1)
            count = self.random.choice(counts).name if kind in ("decrease", "count") else ""
            terms.append(Payment(weight, kind, count))
        return tuple(terms)

    def problem(self, domain: Domain) -> Problem:
        facts = self.facts(self.symbols, self.random)
        goal: tuple[Part, ...] = ()
        if any(payment.kind == "goal" for payment in domain.reward) or self.often(0.3):
            self.constants = (*self.constants, *self.objects)
            goal = self.condition((), self.random.choice((1, 1, 2)))
        count = self.random.choice(domain.counts).name
        steps = self.random.choice((1, 2, 2, 3, 3, 4))
        horizons = [(steps, None), (steps, None), (None, count), (1, count), (2, count)]
        falls = any(each.kind == "decrease" and each.weight > 0 for each in domain.reward)
        horizon = None if falls and self.often(0.4) else self.random.choice(horizons)
        discount = self.random.choice((None, "0", "1", "1", "0.9", "0.5", "0.375", "1.0"))
        return Problem("drawn_problem", tuple(self.objects), facts, goal, horizon, discount)

    def facts(self, symbols: Sequence[Symbol], random: Random) -> tuple[tuple[Key, Value], ...]:
        """Values of symbols, in any order."""
        made: dict[Key, Value] = {}
        every = [*self.constants, *self.objects]
        for symbol in symbols:
            likely = random.choice((0.2, 0.5, 0.8))
            tuples: list[tuple[str, ...]] = [()]
            for kind in symbol.kinds:
                fitting = [each.name for each in every if self.below(each.kind, kind)]
                tuples = [(*terms, name) for terms in tuples for name in fitting]
            for terms in tuples:
                key = (symbol.name, tuple(sorted(terms)) if symbol.symmetric else terms)
                made.setdefault(
                    key, random.choice(symbol.values) if symbol.values else random.random() < likely
                )
        facts = list(made.items())
        random.shuffle(facts)
        return tuple(facts)


def rename(part: Part, names: dict[str, str]) -> Part:
    """The part with other names for some variables."""
    if isinstance(part, AnyOf):
        return replace(part, literals=tuple(rename_literal(each, names) for each in part.literals))
    if isinstance(part, Exists):
        return replace(part, body=tuple(rename_literal(each, names) for each in part.body))
    if isinstance(part, Every):
        guard = tuple(rename_literal(each, names) for each in part.guard)
        return replace(part, guard=guard, then=rename_literal(part.then, names))
    return rename_literal(part, names)


def rename_literal(literal: Literal, names: dict[str, str]) -> Literal:
    """The same of a literal."""
    if isinstance(literal, Equality):
        left, right = (names.get(term, term) for term in (literal.left, literal.right))
        return replace(literal, left=left, right=right)
    return replace(literal, terms=tuple(names.get(term, term) for term in literal.terms))


def draw(seed: int) -> tuple[Domain, Problem]:
    """The domain and the problem of a seed."""
    drawer = Drawer(Random(seed))
    random = drawer.random
    drawer.draw_kinds()
    drawer.draw_symbols()
    drawer.draw_derived()
    counts = drawer.counts()
    shared = drawer.random.choice(
        (
            (),
            (("slip", "0.1", ""),),
            (("slip", "1/6", "prior 0.25, seen 3.125"), ("spill", "0.05", "fixed")),
        )
    )
    actions = drawer.actions()
    rules = drawer.rules(actions, shared)
    prices, functions = price_drawer(drawer, Random(f"prices of {seed}"))
    values = drawer.facts(functions, prices.random)
    used = {outcome.said for rule in rules for outcome in rule.outcomes}
    domain = Domain(
        name="drawn",
        kinds=drawer.kinds,
        constants=drawer.constants,
        symbols=(*drawer.symbols, *functions),
        derived=drawer.derived,
        counts=counts,
        shared=tuple(each for each in shared if each[0] in used or drawer.often(0.1)),
        actions=tuple(map(prices.action, actions)),
        rules=tuple(map(prices.rule, rules)),
        default=random.choice(
            (None, None, "1: nothing", "1: noise", "0.9 [seen 12.4]: nothing  0.1: noise", "rest: noise")
        ),
        reward=drawer.reward(counts, all(action.duration for action in actions)),
        included=random.randint(1, len(rules)) if rules and random.random() < 0.1 else 0,
    )
    problem = drawer.problem(domain)
    return domain, replace(problem, facts=(*problem.facts, *values))
