"""A .nid domain and one problem of it as libPRADA's rules.dat, symbols.dat and state.dat.

The library has rules over literals alone: what a condition leaves open, or an effect depends on, becomes a
rule for each case, and these exclude each other. What is asked of some object or of each, and what happens to
all that something holds of, is written out for the objects of the problem. It has no types, no values with
names and no equality: a type is a predicate, a function a predicate for each value, and `same` holds of each
object and itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

from cleancli.conversion.export.changes import changes_of
from cleancli.conversion.export.formulas import Formulas, NotSaid
from cleancli.conversion.export.instances import Instances
from cleancli.conversion.export.libprada_cases import Known, cases_of, differ_in
from cleancli.conversion.export.libprada_names import SAME, LibpradaNames
from cleancli.conversion.export.names import Naming
from cleancli.conversion.export.unsaid import Unsaid
from cleancli.conversion.export.written import Written, closure_of, counted
from cleancli.conversion.pddl.effect_trees import (
    Change,
)
from cleancli.conversion.pddl.formula import (
    ALWAYS,
    NEVER,
    Both,
    assuming,
    both,
    free_variables,
)
from cleancli.language.model import (
    Count,
    Domain,
    Equality,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Problem,
    Rule,
    Term,
    Variable,
)

_DIGITS = 15
"""Digits of a probability that is no decimal."""

_ONE_LITERAL, _LITERALS = "0", "1"
"""What the library calls rewards of one literal, and of several that all hold."""


def libprada(
    domain: Domain, problem: Problem, noise: str, unsaid: Unsaid, names: LibpradaNames | None = None
) -> Written:
    """The files, with reward.dat where the goal is literals; `noise` is one of `NOISE`, `names` are those of
    further files beside them.

    What can't be said is told to `unsaid`, and then Refused raised with all of it (E919).
    """
    names = LibpradaNames(domain, problem) if names is None else names
    writer = _Writer(domain, problem, noise, unsaid, names)
    # What rules and the goal ask for is declared and stated.
    rules, reward = writer.rules(), writer.reward()
    texts = {"rules.dat": rules, "symbols.dat": writer.symbols(), "state.dat": writer.state()}
    unsaid.refuse()
    if reward is not None:
        texts["reward.dat"] = reward
    return Written(texts, writer.notes(), writer.changed_names())


class _Writer:
    """Writes the files of a domain and a problem, with the same names in all of them."""

    def __init__(
        self, domain: Domain, problem: Problem, noise: str, unsaid: Unsaid, names: LibpradaNames
    ) -> None:
        self._domain, self._problem, self._unsaid = domain, problem, unsaid
        self._noise = "noise" if noise == "predicate" else None
        self._names = names
        self._formulas = Formulas(domain, names.predicates, [counted(domain, problem)])
        self._things = (*domain.constants, *problem.objects)
        self._uses_same = False
        self._written_out = self._has_reward = False
        self._counts_left_out: list[str] = []
        self._divided: list[str] = []
        self._asking_again: list[str] = []

    # ---- rules.dat

    def rules(self) -> str:
        """The rules, the default first."""
        default = [(each.probability, _KINDS[each.kind]) for each in self._domain.default]
        found = [_rule("default()", "--", default or [(Fraction(1), _KINDS[OutcomeKind.NOTHING])])]
        for rule in self._domain.rules:
            with self._unsaid.of(rule.span):
                found += self._cases(rule)
        return f"#rules = {len(found)}\n" + "\n".join(found)

    def _cases(self, rule: Rule) -> list[str]:
        """The rules that a rule becomes."""
        referred, again = _referred(rule)
        asked = [rule.condition, *(reference.condition for reference in rule.references)]
        known = both(self._formulas.condition(condition) for condition in asked)
        known = self._formulas.renamed(known, again)
        if self._asks_again(rule, referred, again):
            self._asking_again.append(rule.name)
        # What is referred to is as good as a parameter: the library finds the one binding itself.
        scope = (*rule.variables, *(v for reference in rule.references for v in reference.variables))
        plain = replace(rule, references=(), variables=scope)
        outcomes = [outcome for outcome in rule.outcomes if outcome.probability]
        done = [(o, changes_of(o, plain, known, self._formulas, self._noise)) for o in outcomes]
        if moving := self._formulas.forget_moving():
            raise NotSaid(moving[0])
        instances = Instances(self._formulas, self._problem)
        known = instances.formula(known)
        done = [(outcome, instances.changes(changes, again)) for outcome, changes in done]
        self._written_out = self._written_out or instances.were_needed
        names = Naming((), folded=False)
        variables = {each: names.fresh(each.name.upper()) for each in (*rule.variables, *referred)}
        guards = [change.guard for _, changes in done for change in changes]
        cases = cases_of(known, guards, instances, self._formulas)
        if differ_in(referred, cases):
            self._divided.append(rule.name)
        return [self._case(rule, case, done, variables) for case in cases]

    def _case(
        self,
        rule: Rule,
        case: Known,
        done: Sequence[tuple[Outcome, tuple[Change, ...]]],
        variables: Mapping[Variable, str],
    ) -> str:
        kinds = self._kinds(rule, variables) if self._names.typed else ()
        context = [*kinds, *(self._said(part, variables) for part in case)]
        lines: dict[str, Fraction] = {}
        for outcome, changes in done:
            effects = [
                self._atom(change.symbol, change.terms, change.value, variables)
                for change in changes
                if assuming(change.guard, case) == ALWAYS
            ]
            text = " ".join(dict.fromkeys(effects)) or _KINDS[_kind(outcome)]
            lines[text] = lines.get(text, Fraction(0)) + outcome.probability
        head = f"{self._names.of(rule.action, 'action')}({' '.join(variables[v] for v in rule.variables)})"
        return _rule(head, " ".join(context) or "--", [(chance, text) for text, chance in lines.items()])

    def _kinds(self, rule: Rule, variables: Mapping[Variable, str]) -> Iterator[str]:
        """Of which types what a rule speaks of has to be."""
        for variable, name in variables.items():
            yield f"{self._names.of(variable.type, 'type')}({name})"
        for narrower, term in self._narrower(_referred(rule)[1]):
            yield f"{self._names.of(narrower.type, 'type')}({self._term(term, variables)})"

    def _narrower(self, again: Mapping[Term, Term]) -> list[tuple[Term, Term]]:
        """The variables of a type that what they stand for need not have, and what that is."""
        return [(one, other) for one, other in again.items() if not self._domain.is_a(other.type, one.type)]

    def _asks_again(self, rule: Rule, referred: Sequence[Variable], again: Mapping[Term, Term]) -> bool:
        """Whether later references ask more of what the first one finds."""
        asked = both(self._formulas.condition(reference.condition) for reference in rule.references[1:])
        said = free_variables(self._formulas.renamed(asked, again))
        narrowed = [term for _, term in self._narrower(again)]
        return not {*said, *narrowed}.isdisjoint(referred)

    def _said(self, part: Literal | Equality, variables: Mapping[Variable, str]) -> str:
        if isinstance(part, Equality):
            self._uses_same = True
            terms = f"{self._term(part.left, variables)} {self._term(part.right, variables)}"
            return f"{'' if part.equal else '-'}{SAME}({terms})"
        return self._atom(part.symbol, part.terms, True in part.values, variables)

    def _atom(
        self, symbol: str, terms: Sequence[Term], value: bool, variables: Mapping[Variable, str]
    ) -> str:
        said = " ".join(self._term(term, variables) for term in terms)
        name = symbol if symbol == self._noise else self._names.of(symbol)
        return f"{'' if value else '-'}{name}({said})"

    def _term(self, term: Term, variables: Mapping[Variable, str]) -> str:
        return self._names.numbers[term.name] if isinstance(term, Object) else variables[term]

    # ---- symbols.dat

    def symbols(self) -> str:
        """Actions, predicates and counts."""
        # What counts ask for is declared, too.
        counts = [line for count in self._domain.counts for line in self._count(count)]
        lines = [
            f"{self._names.of(a.name, 'action')} {len(a.parameters)} action binary"
            for a in self._domain.actions
        ]
        if self._names.typed:
            lines += [
                f"{self._names.of(kind.name, 'type')} 1 primitive binary" for kind in self._domain.types
            ]
        # Values of one function come first: who reads the files may find that they exclude each other.
        for symbol in sorted(self._domain.symbols, key=lambda symbol: symbol.is_predicate):
            for value in [None] if symbol.is_predicate else symbol.values:
                name = self._names.of(self._names.predicates.of(symbol.name, value))
                lines.append(f"{name} {len(symbol.parameters)} primitive binary")
        lines += [f"{self._names.of(name)} 2 primitive binary" for name in self._formulas.closures]
        if self._noise is not None:
            lines.append(f"{self._noise} 0 primitive binary")
        if self._uses_same:
            lines.append(f"{SAME} 2 primitive binary")
        return "\n".join([*lines, *counts]) + "\n"

    def _count(self, count: Count) -> Iterator[str]:
        """A count of what literals hold of; others are left out, and a note says so."""
        names = Naming((), folded=False)
        variables = {each: names.fresh(each.name.upper()) for each in count.variables}
        try:
            formula = self._formulas.condition(count.condition)
        except NotSaid:
            formula = NEVER
        parts = formula.parts if isinstance(formula, Both) else (formula,)
        plain = [part for part in parts if isinstance(part, Literal | Equality)]
        if len(plain) < len(parts) or not variables or self._formulas.forget_moving():
            self._counts_left_out.append(count.name)
            return
        bound = list(variables.items()) if self._names.typed else []
        kinds = [f"{self._names.of(variable.type, 'type')}({name})" for variable, name in bound]
        said = " ".join([*kinds, *(self._said(part, variables) for part in plain)])
        yield f"{self._names.of(count.name)} 0 count integers <-- Num {' '.join(variables.values())} {said}"

    # ---- state.dat

    def state(self) -> str:
        """The facts that hold, a symbol's on a line of their own."""
        found: dict[str, list[str]] = {}

        def holds(name: str, objects: Sequence[str]) -> None:
            found.setdefault(name, []).append(
                f"{name}({' '.join(self._names.numbers[each] for each in objects)})"
            )

        for kind in self._domain.types if self._names.typed else ():
            for thing in self._things:
                if self._domain.is_a(thing.type, kind.name):
                    holds(self._names.of(kind.name, "type"), [thing.name])
        for fact in sorted(self._problem.state, key=lambda f: (f.symbol, f.objects)):
            symbol = self._formulas.symbols[fact.symbol]
            name = self._names.of(
                self._names.predicates.of(fact.symbol, None if symbol.is_predicate else fact.value)
            )
            ways = {fact.objects, fact.objects[::-1]} if symbol.symmetric else {fact.objects}
            for objects in sorted(ways):
                holds(name, objects)
        for closure in self._formulas.closures.values():
            base = self._formulas.symbols[closure.closure or ""]
            for pair in sorted(closure_of(self._problem.state, base.name, base.symmetric)):
                holds(self._names.of(closure.name), pair)
        if self._uses_same:
            for thing in self._things:
                holds(SAME, [thing.name, thing.name])
        return "\n".join(" ".join(facts) for facts in found.values()) + "\n"

    # ---- reward.dat

    def reward(self) -> str | None:
        """The literals of the goal, of which the library pays for all together; None where it has others."""
        try:
            goal = self._formulas.condition(self._problem.goal)
            goal = Instances(self._formulas, self._problem).formula(goal)
        except NotSaid:
            return None
        parts = goal.parts if isinstance(goal, Both) else (goal,)
        literals = [
            self._atom(p.symbol, p.terms, True in p.values, {}) for p in parts if isinstance(p, Literal)
        ]
        if not literals or len(literals) < len(parts) or self._formulas.forget_moving():
            return None
        self._has_reward = True
        kind = _ONE_LITERAL if len(literals) == 1 else _LITERALS
        return "".join(f"{line}\n" for line in (kind, *literals))

    # ---- what has to be told

    def notes(self) -> tuple[str, ...]:
        """What the files do not say as the .nid files do."""
        goal = "" if self._has_reward else "the goal, "
        found = [f"left out: rewards, costs, durations, {goal}the horizon and the discount"]
        paying = [r.name for r in self._domain.rules if any(o.reward or o.cost for o in r.outcomes)]
        if paying:
            found.append(f"left out: what outcomes pay, of the rules {', '.join(paying)}")
        if self._has_reward:
            found.append("reward.dat pays in each state in which the goal holds")
        if self._counts_left_out:
            found.append(
                f"left out: counts that ask for more than literals: {', '.join(self._counts_left_out)}"
            )
        if self._names.typed:
            found.append("types are predicates")
        if self._written_out:
            found.append("what is said of all objects is written out for those of the problem")
        if self._divided:
            found.append(
                "rules for each case of what these refer to, which has to be the only one in its case and not"
                f" of all: {', '.join(self._divided)}"
            )
        if self._asking_again:
            found.append(
                "what these refer to has to be the only one that all references fit, and not the only one of"
                f" the first: {', '.join(self._asking_again)}"
            )
        if self._uses_same:
            found.append(f"`{SAME}` holds of each object and itself: libPRADA has no equality")
        return tuple(found)

    def changed_names(self) -> Mapping[str, str]:
        """The names that could not stay, with what they have become."""
        told = {old: new for (_, old), new in self._names.given.items() if old != new}
        return told | {old: new for old, new in self._names.numbers.items() if old != new}


_KINDS = {OutcomeKind.NOTHING: "<no-change>", OutcomeKind.NOISE: "<noise>"}


def _kind(outcome: Outcome) -> OutcomeKind:
    """What an outcome without effects is."""
    return OutcomeKind.NOISE if outcome.kind is OutcomeKind.NOISE else OutcomeKind.NOTHING


def _referred(rule: Rule) -> tuple[tuple[Variable, ...], Mapping[Term, Term]]:
    """The variables of the first reference, and what those of later ones are that ask again of what was
    found. Raises `NotSaid` for others: each has one binding by itself, and in the library all have one."""
    if not rule.references:
        return (), {}
    first, *later = rule.references
    again: dict[Term, Term] = {}
    for reference in later:
        same = [part for part in reference.condition if isinstance(part, Equality) and part.equal]
        pairs = [pair for part in same for pair in ((part.left, part.right), (part.right, part.left))]
        left: set[Term] = set(reference.variables)
        for _ in reference.variables:  # one may be the same as another of them
            for one, other in pairs:
                if one in left and other not in left:
                    again[one] = again.get(other, other)
                    left.remove(one)
        if left:
            raise NotSaid("a rule has several references, each of which has to be the only one")
    return first.variables, again


def _rule(action: str, context: str, outcomes: Sequence[tuple[Fraction, str]]) -> str:
    numbers = _decimals([chance for chance, _ in outcomes])
    lines = [f"  {number} {text}" for number, (_, text) in zip(numbers, outcomes, strict=True)]
    return "\n".join(["ACTION:", f"  {action}", "CONTEXT:", f"  {context}", "OUTCOMES:", *lines, ""])


def _decimals(chances: Sequence[Fraction]) -> list[str]:
    """Probabilities as decimals that sum to 1, too: where some are rounded, the greatest makes up for it."""
    rounded = [round(Decimal(each.numerator) / Decimal(each.denominator), _DIGITS) for each in chances]
    rounded[rounded.index(max(rounded))] += 1 - sum(rounded)
    return [format(each.normalize(), "f") for each in rounded]
