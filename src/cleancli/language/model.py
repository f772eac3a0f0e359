"""The checked model: what the text means, once `check` has found no mistake in it.

Guaranteed by the checker: every name is declared, arities and types fit, every variable is bound,
the probabilities of each rule sum to exactly 1, and the facts of a problem are complete and canonical.
Records hold plain names; spans stay only where a later pass writes back into the text (`Outcome`, `Action`,
`Knowledge`) or reports a mistake that needs objects to be seen (`Rule`), and equality ignores them.
"""

from __future__ import annotations

import enum
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction

from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.record import Record

Value = bool | int | str
"""A value of a symbol: a truth value of a predicate, a named value or an integer of a function."""


@dataclass(frozen=True, slots=True, order=True)
class Variable:
    """A typed variable; the name has no `?`."""

    name: str
    type: str


@dataclass(frozen=True, slots=True, order=True)
class Object:
    """A typed constant or object of a problem."""

    name: str
    type: str


Term = Variable | Object


class Type(Record):
    """A declared type; `parent` is None at a root."""

    name: str
    parent: str | None = None


class Symbol(Record):
    """A declared predicate (`values` is (False, True)) or function (its values in rising order).

    Values are all names, or consecutive integers. `static`: no rule may change it.
    """

    name: str
    parameters: tuple[Variable, ...]
    values: tuple[Value, ...] = (False, True)
    symmetric: bool = False
    static: bool = False

    @property
    def is_predicate(self) -> bool:
        return isinstance(self.values[0], bool)

    def canonical(self, objects: tuple[str, ...]) -> tuple[str, ...]:
        """The objects in the order under which a state stores them (sorted when symmetric)."""
        return tuple(sorted(objects)) if self.symmetric else objects


@dataclass(frozen=True, slots=True)
class Literal:
    """Holds where the symbol's value for these terms is one of `values` (never all, never none).

    The symbol may be a derived predicate. `relation` is the sign by which a comparison was written (`>=`),
    and empty where nobody wrote one: it matters to who prints the literal, and to nothing else.
    """

    symbol: str
    terms: tuple[Term, ...]
    values: frozenset[Value]
    relation: str = field(default="", compare=False)

    def opposite(self, symbol: Symbol) -> Literal:
        """What holds where this does not, for the literal's symbol."""
        return Literal(
            self.symbol, self.terms, frozenset(symbol.values) - self.values, _OPPOSITE[self.relation]
        )


_OPPOSITE = {"": "", "=": "!=", "!=": "=", "<": ">=", ">=": "<", "<=": ">", ">": "<="}


@dataclass(frozen=True, slots=True)
class Equality:
    """Holds where both terms are the same object (`equal`) or differ (not `equal`)."""

    left: Term
    right: Term
    equal: bool


class Quantified(Record):
    """Holds where some binding of `variables` satisfies the conjunction (`exists`), or none does.

    `forall ?x - t: guard => literal` is read as: no binding satisfies the guard and the literal's opposite.
    Without variables there is one binding: `(p or q)` is read as: none satisfies the opposites of both.
    `forall` says that it was written so, and its literal's opposite stands last: for who prints it.
    """

    exists: bool
    variables: tuple[Variable, ...]
    condition: tuple[Literal | Equality, ...]
    forall: bool = field(default=False, compare=False)


Condition = tuple[Literal | Equality | Quantified, ...]
"""A conjunction; empty means true."""


class DerivedPredicate(Record):
    """A predicate that follows from others: it holds where `condition` does, or is the transitive closure of
    the predicate of two parameters that `closure` names. Definitions are not cyclic."""

    name: str
    parameters: tuple[Variable, ...]
    condition: Condition = ()
    closure: str | None = None


class Reference(Record):
    """A deictic reference: the rule applies only where exactly one binding of the variables fits."""

    variables: tuple[Variable, ...]
    condition: tuple[Literal | Equality, ...]


class Assign(Record):
    """An effect: the symbol takes `value` for these terms."""

    symbol: str
    terms: tuple[Term, ...]
    value: Value


class Shift(Record):
    """An effect: an integer function rises by `amount` (falls, if negative), but not beyond its bounds."""

    symbol: str
    terms: tuple[Term, ...]
    amount: int


class ForAll(Record):
    """An effect on every binding of `variables` that satisfies `condition` before the action; without
    variables one that happens where the condition holds (`if`)."""

    variables: tuple[Variable, ...]
    condition: tuple[Literal | Equality, ...]
    effects: tuple[Assign | Shift, ...]


class PricePart(Record):
    """`weight` times the value of an integer function that never changes."""

    weight: Fraction
    symbol: str
    terms: tuple[Term, ...]


class Price(Record):
    """A number, and what functions come to: `2 + 0.5 * distance(?a, ?b)`.

    Sums have one part for a function and terms, none of weight 0, in an order of their own: so what is the
    same price is equal.
    """

    number: Fraction = Fraction(0)
    parts: tuple[PricePart, ...] = ()

    def __bool__(self) -> bool:
        """Whether something may have to be paid."""
        return bool(self.number or self.parts)

    def __add__(self, other: Price) -> Price:
        if not self.parts and not other.parts:
            if not self.number or not other.number:  # as of most outcomes, which pay nothing
                return self if self.number else other
            return Price(self.number + other.number)
        weights: dict[tuple[str, tuple[Term, ...]], Fraction] = {}
        for part in (*self.parts, *other.parts):
            key = part.symbol, part.terms
            weights[key] = weights.get(key, Fraction(0)) + part.weight
        parts = [PricePart(weight, *key) for key, weight in weights.items() if weight]
        return Price(self.number + other.number, tuple(sorted(parts, key=_part_order)))

    def times(self, factor: Fraction) -> Price:
        """So many times the price."""
        if not factor or not self:
            return NOTHING_PAID
        parts = tuple(PricePart(factor * part.weight, part.symbol, part.terms) for part in self.parts)
        return Price(factor * self.number, parts)

    def by_sign(self) -> tuple[Price, Price]:
        """What is added, and what is taken away; nothing in either is below 0."""
        return (self._above_0(), self.times(Fraction(-1))._above_0()) if self else (self, self)

    def _above_0(self) -> Price:
        return Price(max(self.number, Fraction(0)), tuple(part for part in self.parts if part.weight > 0))

    def renamed(self, terms: Mapping[Term, Term]) -> Price:
        """The price with other terms in place of some."""
        parts = tuple(
            PricePart(part.weight, part.symbol, tuple(terms.get(term, term) for term in part.terms))
            for part in self.parts
        )
        return Price(self.number) + Price(parts=parts)


def _part_order(part: PricePart) -> tuple[str, list[tuple[bool, str]]]:
    return part.symbol, [(isinstance(term, Object), term.name) for term in part.terms]


NOTHING_PAID = Price()


class OutcomeKind(enum.Enum):
    """`CHANGE` lists effects, `NOTHING` leaves the state as it is, `NOISE` does something unmodelled."""

    CHANGE = "change"
    NOTHING = "nothing"
    NOISE = "noise"


class Outcome(Record):
    """One possible result of a rule.

    `seen` may be no whole number, since one transition may count for several outcomes in part. `is_rest`
    means that the text says `rest` and no number; it has no `prior`, which is what the others leave.
    `parameter` names the shared parameter that the text says instead of a number; its marks are then the
    parameter's. The learner does not touch what is `fixed`. In a step in which it happens, the reward is
    `reward` more, and the action costs `cost` more (0 or more). `probability_span` covers the probability's
    own token, `weight_span` that token with its `[prior p, seen n]`, if it has one.
    """

    probability: Fraction
    kind: OutcomeKind
    effects: tuple[Assign | Shift | ForAll, ...] = ()
    prior: Fraction | None = None
    seen: Fraction | None = None
    is_rest: bool = False
    parameter: str | None = None
    fixed: bool = False
    probability_span: Span | None = field(default=None, compare=False)
    weight_span: Span | None = field(default=None, compare=False)
    reward: Price = NOTHING_PAID
    cost: Price = NOTHING_PAID


class Rule(Record):
    """A probabilistic rule for one action (§3.3.2); `variables` are the action's, as the rule names them."""

    name: str
    action: str
    variables: tuple[Variable, ...]
    condition: Condition
    outcomes: tuple[Outcome, ...]
    references: tuple[Reference, ...] = ()
    span: Span | None = field(default=None, compare=False)


class Parameter(Record):
    """A probability that outcomes share by its name; the other fields are as in `Outcome`."""

    name: str
    probability: Fraction
    prior: Fraction | None = None
    seen: Fraction | None = None
    fixed: bool = False
    probability_span: Span | None = field(default=None, compare=False)
    weight_span: Span | None = field(default=None, compare=False)


class Action(Record):
    """A declared action; `duration` in seconds of robot time, None where the file does not say. Its `cost` is
    in units of reward, and never below 0.

    What the learner noted of the duration is as in `Outcome`, its prior in seconds. `duration_span` covers
    the duration with its unit, `noted_span` that with its `[prior 9 s, seen n]`, if it has one.
    """

    name: str
    parameters: tuple[Variable, ...]
    duration: float | None = None
    cost: Price = NOTHING_PAID
    duration_prior: float | None = None
    duration_seen: Fraction | None = None
    duration_fixed: bool = False
    duration_span: Span | None = field(default=None, compare=False)
    noted_span: Span | None = field(default=None, compare=False)


class Count(Record):
    """A derived number: how many bindings of `variables` satisfy `condition`."""

    name: str
    variables: tuple[Variable, ...]
    condition: Condition


class RewardKind(enum.Enum):
    """What a step pays: how much a count has fallen (eq. 2), a count's value after the step, 1 when the
    problem's goal has come to hold (-1 when it is lost), the action's cost, or its duration in seconds."""

    DECREASE = "decrease"
    COUNT = "count"
    GOAL = "goal"
    COST = "cost"
    DURATION = "duration"


REWARD_WORDS = frozenset(kind.value for kind in RewardKind if kind is not RewardKind.COUNT)
"""Words of a reward, where counts are named too: so no count may be called by one."""


class RewardTerm(Record):
    """A share of the reward: `weight` times what `kind` says; `count` is named for the first two kinds."""

    weight: Fraction
    kind: RewardKind
    count: str | None = None


class Experience(Record):
    """Transitions that the counts of a domain rest on: the first `transitions` lines of a file.

    `sha256` holds the first 16 hexadecimal digits of the hash of these lines, by which they are told from
    others; `name` is for people.
    """

    name: str
    sha256: str
    transitions: int


class Knowledge(Record):
    """What the counts of a domain mean: the estimator that makes probabilities of them, with a prior that
    weighs as much as `m` examples, how transitions were matched with outcomes, what was counted, and by which
    share an example counts for less than the next one of its rule (`forgetting`).

    `span` covers the block that says so, which may stand in a file that the domain includes.
    """

    estimator: str
    m: float
    match: str
    experience: tuple[Experience, ...]
    forgetting: float = 0.0
    span: Span | None = field(default=None, compare=False)


class Domain(Record):
    """A whole domain, in the order of the file, what it includes first; `reward` is the sum of its terms.

    `learned` is None where no file says what the counts rest on. `end`: the empty place before the last brace
    of the file that was asked for, where another block may stand.
    """

    name: str
    types: tuple[Type, ...]
    constants: tuple[Object, ...]
    symbols: tuple[Symbol, ...]
    counts: tuple[Count, ...]
    actions: tuple[Action, ...]
    rules: tuple[Rule, ...]
    default: tuple[Outcome, ...]
    reward: tuple[RewardTerm, ...]
    derived: tuple[DerivedPredicate, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    learned: Knowledge | None = None
    end: Span | None = field(default=None, compare=False)

    def is_a(self, type_name: str, ancestor: str) -> bool:
        """Whether `type_name` is `ancestor` or below it."""
        parents = {t.name: t.parent for t in self.types}
        current: str | None = type_name
        while current is not None:
            if current == ancestor:
                return True
            current = parents[current]
        return False


@dataclass(frozen=True, slots=True, order=True)
class Fact:
    """A symbol's value for some objects; predicates appear in a state only when true."""

    symbol: str
    objects: tuple[str, ...]
    value: Value = True


State = frozenset[Fact]
"""Closed world: a predicate that is not listed is false; a function lists its value for every binding."""


class Horizon(Record):
    """Plan length: `constant`, plus the value of `count` in the initial state where one is named (§4.2.2).
    `is_guess`: no text says it, as none in PPDDL can."""

    constant: int
    count: str | None = None
    is_guess: bool = field(default=False, compare=False)


class Unlimited(Record):
    """As many actions as it takes: the problem has a goal, and that alone counts, and what it costs."""


USUAL_DISCOUNT = 0.95
"""What a problem that says no discount has: after §6, where it is the same for all experiments."""


class Problem(Record):
    """What to plan for; `objects` are the problem's own, without the constants of the domain it names.

    An empty `goal` is none. `planner`, `samples` and `seed` are what the file asks for, None where it does
    not.
    """

    name: str
    domain: str
    objects: tuple[Object, ...]
    state: State
    horizon: Horizon | Unlimited | None = None
    discount: float = USUAL_DISCOUNT
    goal: Condition = ()
    planner: str | None = None
    samples: int | None = None
    seed: int | None = None


def weight_of(domain: Domain, kind: RewardKind) -> Fraction:
    """How much the reward of a domain pays of a kind that names no count, all its terms together."""
    return sum((term.weight for term in domain.reward if term.kind is kind), Fraction(0))


def usual_discount(domain: Domain) -> float:
    """The discount of a problem that says none: 1 where the reward counts durations, which is what time
    costs then."""
    return 1.0 if weight_of(domain, RewardKind.DURATION) else USUAL_DISCOUNT


def wanted_decreased(domain: Domain) -> str | None:
    """The first count that the reward wants decreased (#dirt of eq. 3): a term of positive weight."""
    wanted = (t.count for t in domain.reward if t.kind is RewardKind.DECREASE and t.weight > 0)
    return next(wanted, None)


def without_objects(problem: Problem, names: Collection[str]) -> Problem:
    """The problem without the objects of these names, and without all facts about them."""
    objects = tuple(thing for thing in problem.objects if thing.name not in names)
    state = frozenset(fact for fact in problem.state if not any(name in names for name in fact.objects))
    return replace(problem, objects=objects, state=state)
