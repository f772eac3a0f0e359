"""A drafted domain and its problems as syntax trees whose places are those of PDDL: so the checker looks at
them as at a text, and tells what it finds where the user wrote it.

The trees say what the printed texts say (`print_domain`, `print_problem`), but for the facts of a problem.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import groupby

from cleancli.conversion.pddl.draft import Draft, DraftProblem
from cleancli.conversion.pddl.formula import negated
from cleancli.language import syntax
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.model import (
    Action,
    Assign,
    Condition,
    DerivedPredicate,
    Equality,
    ForAll,
    Horizon,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Price,
    Quantified,
    RewardKind,
    RewardTerm,
    Rule,
    Shift,
    Symbol,
    Term,
    Type,
    Variable,
)


def domain_tree(draft: Draft) -> syntax.DomainNode:
    """The domain: an action and its rules stand where PDDL names the action, the rest where it names the
    domain."""
    domain, place = draft.domain, draft.place
    tree = _Tree(place)
    of_actions = {action.name: _Tree(draft.actions.get(action.name, place)) for action in domain.actions}
    actions = tuple(of_actions[action.name].action(action) for action in domain.actions)
    predicates = [symbol for symbol in domain.symbols if symbol.is_predicate]
    functions = [symbol for symbol in domain.symbols if not symbol.is_predicate]
    sections: list[syntax.DomainSection] = [
        syntax.Types(tuple(map(tree.type, domain.types)), span=place),
        syntax.Constants(tree.groups(domain.constants), span=place),
        syntax.Predicates(tuple(map(tree.predicate, predicates)), span=place),
        syntax.Functions(tuple(map(tree.function, functions)), span=place),
        syntax.Derived(tuple(map(tree.definition, domain.derived)), span=place),
        syntax.Actions(actions, span=place),
        *(of_actions[rule.action].rule(rule) for rule in domain.rules),
        syntax.Reward(tuple(map(tree.payment, domain.reward)), span=place),
    ]
    return syntax.DomainNode(tree.name(domain.name), tuple(sections), span=place)


def problem_tree(draft: DraftProblem) -> syntax.ProblemNode:
    """The problem without its objects and facts."""
    problem, place = draft.problem, draft.place
    tree = _Tree(place)
    steps = tree.number(Fraction(problem.horizon.constant)) if isinstance(problem.horizon, Horizon) else None
    sections: list[syntax.ProblemSection] = [
        syntax.DomainName(tree.name(problem.domain), span=place),
        syntax.HorizonNode(steps, None, span=place),
        syntax.Discount(tree.number(Fraction(problem.discount)), span=place),
    ]
    if problem.goal:
        sections.append(syntax.Goal(tree.condition(problem.goal), span=place))
    return syntax.ProblemNode(tree.name(problem.name), tuple(sections), span=place)


class _Tree:
    """Makes nodes that all stand at one place, so that equal names and terms are one node."""

    def __init__(self, place: Span) -> None:
        self._place = place
        self._names: dict[str, syntax.Name] = {}
        self._terms: dict[Term, syntax.TermNode] = {}

    def name(self, text: str) -> syntax.Name:
        found = self._names.get(text)
        if found is None:
            found = self._names[text] = syntax.Name(text, span=self._place)
        return found

    def number(self, value: Fraction) -> syntax.Number:
        return syntax.Number(value, value.denominator == 1, span=self._place)

    def groups(self, typed: Iterable[Variable | Object]) -> tuple[syntax.Group, ...]:
        return tuple(
            syntax.Group(
                tuple(self.name(each.name) for each in group), self.name(type_name), span=self._place
            )
            for type_name, group in groupby(typed, key=lambda each: each.type)
        )

    # ---- declarations

    def type(self, each: Type) -> syntax.Group:
        parent = None if each.parent is None else self.name(each.parent)
        return syntax.Group((self.name(each.name),), parent, span=self._place)

    def predicate(self, symbol: Symbol) -> syntax.PredicateNode:
        marks = (self._static(),) if symbol.static else ()
        return syntax.PredicateNode(
            self.name(symbol.name), self.groups(symbol.parameters), marks, span=self._place
        )

    def definition(self, derived: DerivedPredicate) -> syntax.DefinitionNode:
        head = self.name(derived.name), self.groups(derived.parameters)
        return syntax.DefinitionNode(*head, self.condition(derived.condition), span=self._place)

    def action(self, action: Action) -> syntax.ActionNode:
        marks = (self._cost(action),) if action.cost else ()
        return syntax.ActionNode(
            self.name(action.name), self.groups(action.parameters), marks, span=self._place
        )

    def function(self, symbol: Symbol) -> syntax.FunctionNode:
        low, high = symbol.values[0], symbol.values[-1]
        assert isinstance(low, int)
        assert isinstance(high, int)
        bounds = syntax.Bounds(self.number(Fraction(low)), self.number(Fraction(high)), span=self._place)
        head = self.name(symbol.name), self.groups(symbol.parameters)
        return syntax.FunctionNode(*head, bounds, (self._static(),), span=self._place)

    def _static(self) -> syntax.Attribute:
        return syntax.Attribute(self.name("static"), None, span=self._place)

    def _cost(self, action: Action) -> syntax.Attribute:
        return syntax.Attribute(self.name("cost"), self._price(action.cost), span=self._place)

    def _price(self, price: Price) -> syntax.Price:
        amount = self.number(price.number) if price.number or not price.parts else None
        parts = tuple(
            syntax.Priced(
                self.number(part.weight), self._application(part.symbol, part.terms), span=self._place
            )
            for part in price.parts
        )
        return syntax.Price(amount, parts, span=self._place)

    def payment(self, term: RewardTerm) -> syntax.Payment:
        what: syntax.ReachedGoal | syntax.ActionCost = syntax.ActionCost(span=self._place)
        if term.kind is RewardKind.GOAL:
            what = syntax.ReachedGoal(span=self._place)
        return syntax.Payment(self.number(abs(term.weight)), what, term.weight < 0, span=self._place)

    # ---- rules

    def rule(self, rule: Rule) -> syntax.RuleNode:
        terms = tuple(map(self._term, rule.variables))
        condition = self.condition(rule.condition) if rule.condition else None
        outcomes = tuple(map(self._outcome, rule.outcomes))
        head = self.name(rule.name), self.name(rule.action), terms, ()
        return syntax.RuleNode(*head, condition, (), outcomes, span=self._place)

    def _outcome(self, outcome: Outcome) -> syntax.OutcomeNode:
        chance = syntax.Rest(span=self._place) if outcome.is_rest else self.number(outcome.probability)
        result: syntax.Nothing | syntax.Effects = syntax.Nothing(span=self._place)
        if outcome.kind is OutcomeKind.CHANGE:
            effects = map(self._effect, outcome.effects)
            result = syntax.Effects((*effects, *self._payments(outcome)), span=self._place)
        weight = syntax.Weight(chance, (), span=self._place)
        return syntax.OutcomeNode(weight, result, span=self._place)

    def _payments(self, outcome: Outcome) -> Iterator[syntax.PayNode]:
        for what, price in (("reward", outcome.reward), ("cost", outcome.cost)):
            for rises, part in zip((True, False), price.by_sign(), strict=True):
                if part:
                    yield syntax.PayNode(self.name(what), rises, self._price(part), span=self._place)

    def _effect(
        self, effect: Assign | Shift | ForAll
    ) -> syntax.Assignment | syntax.ForAllNode | syntax.IfNode:
        if not isinstance(effect, ForAll):
            return self._assignment(effect)
        condition = self.condition(effect.condition)
        effects = tuple(map(self._assignment, effect.effects))
        if not effect.variables:
            return syntax.IfNode(condition, effects, span=self._place)
        groups = self.groups(effect.variables)
        return syntax.ForAllNode(groups, condition if effect.condition else None, effects, span=self._place)

    def _assignment(self, effect: Assign | Shift) -> syntax.Assignment:
        applied = self._application(effect.symbol, effect.terms)
        assert isinstance(effect, Assign)  # PPDDL's numbers become costs
        return syntax.SetTruth(applied, effect.value is True, span=self._place)

    # ---- conditions

    def condition(self, condition: Condition) -> syntax.ConditionNode:
        return syntax.ConditionNode(tuple(map(self._part, condition)), span=self._place)

    def _part(self, part: Literal | Equality | Quantified) -> syntax.PartNode:
        if not isinstance(part, Quantified):
            return self._literal(part)
        if not part.variables:
            return syntax.EitherNode(tuple(map(self._opposite, part.condition)), span=self._place)
        literals = tuple(map(self._literal, part.condition))
        return syntax.ExistsNode(self.groups(part.variables), literals, part.exists, span=self._place)

    def _literal(self, part: Literal | Equality) -> syntax.LiteralNode:
        if isinstance(part, Equality):
            terms = self._term(part.left), self._term(part.right)
            return syntax.EqualityNode(*terms, part.equal, span=self._place)
        applied = self._application(part.symbol, part.terms)
        return syntax.Truth(applied, True in part.values, span=self._place)

    def _opposite(self, part: Literal | Equality) -> syntax.LiteralNode:
        opposite = negated(part)
        assert isinstance(opposite, Literal | Equality)
        return self._literal(opposite)

    def _application(self, symbol: str, terms: Iterable[Term]) -> syntax.Application:
        return syntax.Application(self.name(symbol), tuple(map(self._term, terms)), span=self._place)

    def _term(self, term: Term) -> syntax.TermNode:
        found = self._terms.get(term)
        if found is None:
            found = syntax.TermNode(term.name, isinstance(term, Variable), span=self._place)
            self._terms[term] = found
        return found
