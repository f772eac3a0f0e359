"""A .nid domain and its problems as PPDDL (Younes and Littman 2004).

Each rule is a schema of its own: `ACTION`, or `ACTION--RULE` where an action has several. At most one of them
applies in a state, so a planner chooses an action by choosing the rule of it that applies.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from cleancli.conversion.export.changes import changes_of
from cleancli.conversion.export.cost_functions import CostFunctions
from cleancli.conversion.export.draws import draws_of
from cleancli.conversion.export.formulas import Formulas
from cleancli.conversion.export.names import Naming
from cleancli.conversion.export.payments import Payment, payments_of, priced
from cleancli.conversion.export.ppddl_formulas import OBJECT, WORDS, FormulaWriter, predicates_of
from cleancli.conversion.export.s_expressions import Node, laid_out
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import Written, closure_of, counted
from cleancli.conversion.pddl.effect_trees import (
    Change,
)
from cleancli.conversion.pddl.formula import ALWAYS, Formula, apart
from cleancli.language.model import (
    Action,
    DerivedPredicate,
    Domain,
    Horizon,
    Outcome,
    OutcomeKind,
    Price,
    Problem,
    RewardKind,
    Rule,
    Symbol,
    Unlimited,
    Variable,
    weight_of,
)
from cleancli.language.printing.printer import print_fraction

_Part = Change | tuple[int, str, Payment]
"""What an outcome does: a change, or what it adds to a numeric function, with a number of its own."""

_FROM = "Written by `cleancli convert` from a .nid file."


def ppddl(domain: Domain, problems: Sequence[Problem], noise: str, unsaid: Unsaid) -> Written:
    """The files; `noise` is one of `NOISE`. What can't be said is told to `unsaid`, and then Refused raised
    with all of it (E919)."""
    writer = _Writer(domain, problems, noise, unsaid)
    domain_text = writer.domain_text()
    texts = [writer.problem_text(problem) for problem in problems]
    unsaid.refuse()
    file = Naming([], folded=True)
    titles = [domain.name] + [problem.name for problem in problems]
    names = [file.fresh(title) for title in titles]
    found = {f"{name}.pddl": text for name, text in zip(names, (domain_text, *texts), strict=True)}
    return Written(found, writer.notes(), writer.changed_names())


class _Writer:
    """Writes one domain and its problems, with the same names in all files."""

    def __init__(self, domain: Domain, problems: Sequence[Problem], noise: str, unsaid: Unsaid) -> None:
        self._domain = domain
        self._problems = problems
        self._noise = "noise" if noise == "predicate" else None
        self._unsaid = unsaid
        self._texts = FormulaWriter(domain)
        self._schemas = Naming(WORDS, folded=True)
        self._predicates = predicates_of(domain)
        self._formulas = Formulas(
            domain, self._predicates, [counted(domain, problem) for problem in problems]
        )
        self._costs = CostFunctions(domain, self._predicates.naming)
        limited = [problem for problem in problems if not isinstance(problem.horizon, Unlimited)]
        self._earned = bool(limited) or not problems
        outcomes = [outcome for rule in domain.rules for outcome in rule.outcomes]
        costly = any(action.cost for action in domain.actions) or any(each.cost for each in outcomes)
        self._priced = costly and len(limited) < len(problems)
        # Only what actions and goals ask for is declared.
        self._actions = list(self._action_sections())
        self._goals = [list(self._goal(problem)) for problem in problems]

    # ---- the domain

    def domain_text(self) -> str:
        """The text of the domain."""
        domain = self._domain
        parts: list[Node] = [(":requirements", *self._requirements())]
        parts += self._type_section()
        parts += self._section(":constants", self._texts.typed_objects(domain.constants))
        parts.append((":predicates", *self._declarations()))
        counted = (("reward", self._earned), ("total-cost", self._priced))
        functions: list[Node] = [(name,) for name, is_counted in counted if is_counted]
        parts += self._section(":functions", [*functions, *self._cost_functions()])
        parts += self._closures()
        title = ("domain", _title(domain.name))
        return _text(("define", title, *parts, *self._actions), [_FROM, *self.notes()])

    def _requirements(self) -> Iterator[str]:
        yield ":adl"
        if any(0 < o.probability < 1 for rule in self._domain.rules for o in rule.outcomes):
            yield ":probabilistic-effects"
        if self._earned:
            yield ":rewards"
        if self._priced:
            yield ":action-costs"
        if self._axioms():
            yield ":derived-predicates"

    def _axioms(self) -> list[DerivedPredicate]:
        """The closures that are neither written out nor facts of problems."""
        return [each for each in self._formulas.closures.values() if not self._formulas.has_facts(each)]

    def _section(self, name: str, parts: Sequence[Node]) -> list[Node]:
        return [(name, *parts)] if parts else []

    def _type_section(self) -> list[Node]:
        shown = [each for each in self._domain.types if self._texts.type_of(each.name) != OBJECT]
        return self._section(
            ":types", [f"{self._texts.type_of(e.name)} - {self._texts.above(e.parent)}" for e in shown]
        )

    def _declarations(self) -> Iterator[Node]:
        for symbol in self._domain.symbols:
            if not self._is_number(symbol):
                yield from self._declared(symbol)
        for derived in self._formulas.closures.values():
            yield f"; the transitive closure of {derived.closure}"
            yield (self._predicates.of(derived.name), *self._texts.typed(derived.parameters))
        if self._noise is not None:
            yield "; an outcome that is not modelled has happened"
            yield (self._noise,)

    def _declared(self, symbol: Symbol) -> Iterator[Node]:
        parameters = self._texts.typed(symbol.parameters)
        if symbol.is_predicate:
            if symbol.symmetric:
                yield "; symmetric: it holds both ways round, or neither"
            yield (self._predicates.of(symbol.name), *parameters)
            return
        low, high = symbol.values[0], symbol.values[-1]
        range_ = f"{low}..{high}" if isinstance(low, int) else " < ".join(map(str, symbol.values))
        yield f"; the function {symbol.name}: {range_}; one of these holds at a time"
        for value in symbol.values:
            yield (self._predicates.of(symbol.name, value), *parameters)

    def _cost_functions(self) -> Iterator[Node]:
        for name, symbol in self._costs.declared():
            yield (name, *self._texts.typed(self._formulas.symbols[symbol].parameters))

    def _is_number(self, symbol: Symbol) -> bool:
        """Whether costs alone ask for a function: then it has no predicates."""
        return symbol.name in self._costs.symbols and symbol.name not in self._predicates.asked

    def _closures(self) -> Iterator[Node]:
        """Axioms of PDDL 2.2."""
        for derived in self._axioms():
            first, last = derived.parameters
            middle = apart(Variable("via", first.type), (first, last))
            name, step = self._predicates.of(derived.name), self._formulas.step
            y, z = self._texts.term(last), self._texts.term(middle)
            later = ("and", self._texts.formula(step(derived, first, middle)), (name, z, y))
            paths = (
                "or",
                self._texts.formula(step(derived, first, last)),
                ("exists", self._texts.typed([middle]), later),
            )
            yield (":derived", (name, *self._texts.typed(derived.parameters)), paths)

    # ---- actions

    def _action_sections(self) -> Iterator[Node]:
        for action in self._domain.actions:
            rules = [rule for rule in self._domain.rules if rule.action == action.name]
            for rule in rules:
                alone = len(rules) == 1
                title = self._schemas.of(action.name if alone else f"{action.name}--{rule.name}")
                yield f"; rule {rule.name} of {action.name}"
                with self._unsaid.of(rule.span):
                    yield (":action", title, *self._schema(rule, action))

    def _schema(self, rule: Rule, action: Action) -> Iterator[Node]:
        known = self._formulas.applies(rule)
        effects = self._effect(rule, action, known)
        yield ":parameters"
        yield self._texts.typed(rule.variables)
        if known != ALWAYS:
            yield ":precondition"
            yield self._texts.formula(self._formulas.apart(known, rule.variables))
        yield ":effect"
        yield _conjunction(effects)

    def _effect(self, rule: Rule, action: Action, known: Formula) -> list[Node]:
        """What the rule does: what its outcomes share stands outside of them, and what is independent of the
        rest is drawn by itself."""
        likely = [outcome for outcome in rule.outcomes if outcome.probability]
        draws = draws_of((each.probability, self._parts(each, rule, known)) for each in likely)
        return [*(node for draw in draws for node in self._drawn(draw, rule)), *self._constant(action, rule)]

    def _parts(self, outcome: Outcome, rule: Rule, known: Formula) -> Iterator[_Part]:
        """What an outcome changes, and what it pays and costs; equal payments have different numbers."""
        changes = changes_of(outcome, rule, known, self._formulas, self._noise)
        yield from changes
        earned: list[Payment] = []
        if self._earned:
            price = outcome.reward + outcome.cost.times(weight_of(self._domain, RewardKind.COST))
            earned += payments_of(self._domain.reward, changes, known, self._formulas)
            earned += priced(price, rule, self._formulas)
        costs = priced(outcome.cost, rule, self._formulas) if self._priced else ()
        yield from ((number, "reward", each) for number, each in enumerate(earned))
        yield from ((number, "total-cost", each) for number, each in enumerate(costs))

    def _drawn(self, draw: Iterable[tuple[Fraction, Sequence[_Part]]], rule: Rule) -> Iterator[Node]:
        """The effects of one draw."""
        chances: list[Node] = []
        for chance, parts in draw:
            does = list(self._changes([each for each in parts if isinstance(each, Change)], rule.variables))
            for part in parts:
                if isinstance(part, tuple):
                    _, function, payment = part
                    paid = self._increase(function, payment.price)
                    does.append(self._for_each(payment.variables, payment.guard, paid, rule.variables))
            if chance == 1:
                yield from does
            elif does:
                chances += [print_fraction(chance), _conjunction(does)]
        if chances:
            yield ("probabilistic", *chances)

    def _constant(self, action: Action, rule: Rule) -> list[Node]:
        """What the action costs, whatever comes of it; the rule has names of its own for its objects."""
        cost = action.cost.renamed(dict(zip(action.parameters, rule.variables, strict=True)))
        lasts = Fraction(action.duration or 0) * weight_of(self._domain, RewardKind.DURATION)
        price = Price(lasts) + cost.times(weight_of(self._domain, RewardKind.COST))
        return [
            *(self._increase("reward", price) if self._earned else []),
            *(self._increase("total-cost", cost) if self._priced else []),
        ]

    def _increase(self, function: str, price: Price) -> list[Node]:
        """What adds a price to a numeric function."""
        added: list[tuple[Fraction, Node]] = []
        if price.number:
            added.append((price.number, print_fraction(abs(price.number))))
        for part in price.parts:
            value = (self._costs.of(part, abs(part.weight)), *map(self._texts.term, part.terms))
            added.append((part.weight, value))
        return [("increase" if sign > 0 else "decrease", (function,), amount) for sign, amount in added]

    def _changes(self, changes: Sequence[Change], scope: tuple[Variable, ...]) -> Iterator[Node]:
        """The changes; those for the bindings of one guard stand together."""
        found: dict[tuple[tuple[Variable, ...], Formula], list[Node]] = {}
        for change in changes:
            atom = (change.symbol, *map(self._texts.term, change.terms))
            set_ = atom if change.value else ("not", atom)
            done = found.setdefault((change.variables, change.guard), [])
            if set_ not in done:
                done.append(set_)
        for (variables, guard), done in found.items():
            if variables or guard != ALWAYS:
                yield self._for_each(variables, guard, done, scope)
            else:
                yield from done

    def _for_each(
        self,
        variables: tuple[Variable, ...],
        guard: Formula,
        done: Sequence[Node],
        scope: tuple[Variable, ...],
    ) -> Node:
        node = _conjunction(done)
        if guard != ALWAYS:
            node = ("when", self._texts.formula(self._formulas.apart(guard, (*scope, *variables))), node)
        return ("forall", self._texts.typed(variables), node) if variables else node

    # ---- problems

    def problem_text(self, problem: Problem) -> str:
        """The text of a problem."""
        parts: list[Node] = [(":domain", _title(self._domain.name))]
        parts += self._section(":objects", self._texts.typed_objects(problem.objects))
        parts.append((":init", *self._facts(problem)))
        parts += self._goals[self._problems.index(problem)]
        parts += self._metric(problem)
        title = ("problem", _title(problem.name))
        return _text(("define", title, *parts), [_FROM, _course(problem)])

    def _goal(self, problem: Problem) -> Iterator[Node]:
        if problem.goal:
            with self._unsaid.of(None, f"the goal of `{problem.name}`"):
                yield (":goal", self._texts.formula(self._formulas.condition(problem.goal)))

    def _facts(self, problem: Problem) -> Iterator[Node]:
        """The facts, those of symmetric predicates both ways round, and closures of what never changes."""
        symbols = self._formulas.symbols
        for fact in sorted(problem.state, key=lambda f: (f.symbol, f.objects)):
            symbol = symbols[fact.symbol]
            if self._is_number(symbol):
                continue
            name = self._predicates.of(fact.symbol, None if symbol.is_predicate else fact.value)
            yield (name, *map(self._texts.objects.of, fact.objects))
            if symbol.symmetric and len(set(fact.objects)) > 1:
                yield (name, *map(self._texts.objects.of, fact.objects[::-1]))
        for derived in self._formulas.closures.values():
            if self._formulas.has_facts(derived) and derived.closure is not None:
                symmetric = symbols[derived.closure].symmetric
                for pair in sorted(closure_of(problem.state, derived.closure, symmetric)):
                    yield (self._predicates.of(derived.name), *map(self._texts.objects.of, pair))
        for name, objects, value in self._costs.values(problem):
            yield ("=", (name, *map(self._texts.objects.of, objects)), print_fraction(value))
        if self._priced and isinstance(problem.horizon, Unlimited):
            yield ("=", ("total-cost",), "0")

    def _metric(self, problem: Problem) -> Iterator[Node]:
        if isinstance(problem.horizon, Unlimited):
            if self._priced:
                yield (":metric", "minimize", ("total-cost",))
            return
        paid = weight_of(self._domain, RewardKind.GOAL)
        if problem.goal and paid:
            yield (":goal-reward", print_fraction(paid))
        yield (":metric", "maximize", ("reward",))

    # ---- what has to be told

    def notes(self) -> tuple[str, ...]:
        """What the files do not say as the .nid files do."""
        domain, found = self._domain, []
        idle = {action.name for action in domain.actions} - {rule.action for rule in domain.rules}
        if idle:
            found.append(f"left out: actions that no rule is for: {', '.join(sorted(idle))}")
        if domain.rules:
            found.append("an action that no rule covers does nothing in .nid, and cannot be taken in PPDDL")
        if any(o.kind is OutcomeKind.NOISE and o.probability for rule in domain.rules for o in rule.outcomes):
            does = "changes nothing" if self._noise is None else f"makes `({self._noise})` true"
            found.append(f"noise {does}")
        if self._earned and weight_of(domain, RewardKind.GOAL):
            found.append(
                "the goal is paid for once, when it is reached: PPDDL has no price of losing it again"
            )
        if any(isinstance(problem.horizon, Horizon) for problem in self._problems):
            found.append("horizons and discounts are comments: PPDDL has neither")
        if any(outcome.seen is not None for rule in domain.rules for outcome in rule.outcomes):
            found.append("what was learned, and how surely, is left out")
        if self._axioms():
            found.append("closures that change are axioms (`:derived`): PDDL 2.2 has them, PPDDL 1.0 has not")
        if self._formulas.written_out:
            found.append("closures that change are written out for as many objects as the problems have")
        return tuple(found)

    def changed_names(self) -> Mapping[str, str]:
        """The names that could not stay, with what they have become."""
        kinds = (self._texts.types, self._texts.objects, self._schemas, self._predicates.naming)
        return {old: new for naming in kinds for old, new in naming.changed.items()}


def _title(name: str) -> str:
    """What a domain or a problem is called."""
    return Naming(WORDS, folded=True).of(name)


def _course(problem: Problem) -> str:
    """What PPDDL has no word for."""
    if isinstance(problem.horizon, Unlimited):
        return "As many actions as it takes."
    horizon = problem.horizon
    steps = "as the .nid file says" if horizon is None else str(horizon.constant)
    more = f" + {horizon.count}" if horizon is not None and horizon.count is not None else ""
    return f"Horizon: {steps}{more}. Discount: {problem.discount:g}. PPDDL has neither."


def _conjunction(parts: Sequence[Node]) -> Node:
    """All parts together, none of which is a conjunction then."""
    flat: list[Node] = []
    for part in parts:
        flat += part[1:] if part[0] == "and" else [part]
    return flat[0] if len(flat) == 1 else ("and", *flat)


def _text(node: Node, head: Sequence[str]) -> str:
    return "".join(f"; {line}\n" for line in head) + laid_out(node) + "\n"
