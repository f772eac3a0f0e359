"""From lark's parse tree to the syntax tree: one builder for each grammar rule, and none by default."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any, cast

from lark import Token, Tree

from cleancli.language import syntax
from cleancli.language.diagnostics.diagnostic import Span

_Child = Any  # lark hands the results of other builders over without their types


class Builder:
    """Builds the syntax tree of the text at `path`."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._builders: dict[str, Callable[[list[_Child], Span], _Child]] = {}

    def build(self, tree: Tree[Token]) -> _Child:
        """The node for a tree; raises LookupError for a grammar rule that has no builder."""
        builder = self._builders.get(tree.data) or self._builder(tree.data)
        children = [self.build(child) if isinstance(child, Tree) else child for child in tree.children]
        meta = tree.meta
        return builder(
            children, Span(self._path, 0, 0) if meta.empty else Span(self._path, meta.start_pos, meta.end_pos)
        )

    def _builder(self, rule: str) -> Callable[[list[_Child], Span], _Child]:
        builder = getattr(self, f"build_{rule}", None)
        if builder is None:
            raise LookupError(f"grammar rule `{rule}` has no builder")
        return self._builders.setdefault(rule, cast(Callable[[list[_Child], Span], _Child], builder))

    def _name(self, token: Token) -> syntax.Name:
        start, end = cast(int, token.start_pos), cast(int, token.end_pos)
        return syntax.Name(token.removeprefix("?"), span=Span(self._path, start, end))

    def _number(self, token: Token) -> syntax.Number:
        span = Span(self._path, cast(int, token.start_pos), cast(int, token.end_pos))
        _, slash, below = token.partition("/")
        if slash and int(below) == 0:
            return syntax.Number(Fraction(0), False, True, span=span)
        return syntax.Number(Fraction(token), "." not in token and not slash, span=span)

    def _quoted(self, token: Token) -> syntax.Quoted:
        start, end = cast(int, token.start_pos), cast(int, token.end_pos)
        return syntax.Quoted(token[1:-1], span=Span(self._path, start, end))

    def _value(self, child: _Child) -> syntax.Name | syntax.Number:
        """A function's value: a name is still a token, an integer is built already."""
        return self._name(child) if isinstance(child, Token) else cast(syntax.Number, child)

    # ---- domains

    def build_start(self, c: list[_Child], span: Span) -> syntax.Root:
        return cast(syntax.Root, c[0])

    def build_domain(self, c: list[_Child], span: Span) -> syntax.DomainNode:
        return syntax.DomainNode(self._name(c[0]), tuple(c[1:]), span=span)

    def build_include(self, c: list[_Child], span: Span) -> syntax.Include:
        return syntax.Include(c[0][1:-1], span=span)

    def build_types(self, c: list[_Child], span: Span) -> syntax.Types:
        return syntax.Types(tuple(c), span=span)

    def build_type_group(self, c: list[_Child], span: Span) -> syntax.Group:
        *names, parent = c
        return syntax.Group(
            tuple(map(self._name, names)), None if parent is None else self._name(parent), span=span
        )

    def build_constants(self, c: list[_Child], span: Span) -> syntax.Constants:
        return syntax.Constants(tuple(c), span=span)

    build_object_group = build_type_group
    build_variable_group = build_type_group

    def build_predicates(self, c: list[_Child], span: Span) -> syntax.Predicates:
        return syntax.Predicates(tuple(c), span=span)

    def build_predicate(self, c: list[_Child], span: Span) -> syntax.PredicateNode:
        return syntax.PredicateNode(self._name(c[0]), c[1], c[2], span=span)

    def build_functions(self, c: list[_Child], span: Span) -> syntax.Functions:
        return syntax.Functions(tuple(c), span=span)

    def build_function(self, c: list[_Child], span: Span) -> syntax.FunctionNode:
        name, parameters, values, attributes = c
        return syntax.FunctionNode(self._name(name), parameters, values, attributes, span=span)

    def build_names(self, c: list[_Child], span: Span) -> tuple[syntax.Name, ...]:
        return tuple(self._name(token) for token in c if token.type == "NAME")

    def build_bounds(self, c: list[_Child], span: Span) -> syntax.Bounds:
        return syntax.Bounds(c[0], c[1], span=span)

    def build_integer(self, c: list[_Child], span: Span) -> syntax.Number:
        minus, token = c
        number = self._number(token)
        return number if minus is None else replace(number, value=-number.value, span=span)

    def build_derived(self, c: list[_Child], span: Span) -> syntax.Derived:
        return syntax.Derived(tuple(c), span=span)

    def build_count(self, c: list[_Child], span: Span) -> syntax.CountNode:
        return syntax.CountNode(self._name(c[0]), c[1], c[2], span=span)

    def build_definition(self, c: list[_Child], span: Span) -> syntax.DefinitionNode:
        return syntax.DefinitionNode(self._name(c[0]), c[1], c[2], span=span)

    def build_closure(self, c: list[_Child], span: Span) -> syntax.ClosureNode:
        return syntax.ClosureNode(self._name(c[0]), c[1], self._name(c[2]), span=span)

    def build_shared(self, c: list[_Child], span: Span) -> syntax.Shared:
        return syntax.Shared(tuple(c), span=span)

    def build_parameter(self, c: list[_Child], span: Span) -> syntax.ParameterNode:
        return syntax.ParameterNode(self._name(c[0]), c[1], span=span)

    def build_actions(self, c: list[_Child], span: Span) -> syntax.Actions:
        return syntax.Actions(tuple(c), span=span)

    def build_action(self, c: list[_Child], span: Span) -> syntax.ActionNode:
        return syntax.ActionNode(self._name(c[0]), c[1], c[2], span=span)

    def build_parameters(self, c: list[_Child], span: Span) -> tuple[syntax.Group, ...]:
        return tuple(c)

    def build_attributes(self, c: list[_Child], span: Span) -> tuple[syntax.Attribute, ...]:
        return tuple(c)

    def build_attribute(self, c: list[_Child], span: Span) -> syntax.Attribute:
        name, value, *marks = c
        noted = tuple(mark for mark in marks if mark is not None)
        return syntax.Attribute(self._name(name), value, noted, span=span)

    def build_ratio(self, c: list[_Child], span: Span) -> syntax.Price:
        return syntax.Price(self._number(c[0]), (), span=span)

    def build_amount(self, c: list[_Child], span: Span) -> syntax.Price:
        return syntax.Price(c[0], (), span=span)

    def build_price(self, c: list[_Child], span: Span) -> syntax.Price:
        return syntax.Price(c[0], tuple(c[1:]), span=span)

    def build_priced(self, c: list[_Child], span: Span) -> syntax.Priced:
        return syntax.Priced(c[0], c[1], span=span)

    def build_rule(self, c: list[_Child], span: Span) -> syntax.RuleNode:
        name, action, *others = c
        return syntax.RuleNode(self._name(name), self._name(action), *others, span=span)

    def build_references(self, c: list[_Child], span: Span) -> tuple[syntax.ReferenceNode, ...]:
        return tuple(c)

    def build_reference(self, c: list[_Child], span: Span) -> syntax.ReferenceNode:
        return syntax.ReferenceNode(c[0], c[1], span=span)

    def build_arguments(self, c: list[_Child], span: Span) -> tuple[syntax.TermNode, ...]:
        return tuple(c)

    def build_default(self, c: list[_Child], span: Span) -> syntax.Default:
        return syntax.Default(c[0], span=span)

    def build_reward(self, c: list[_Child], span: Span) -> syntax.Reward:
        signs, payments = c[0::2], c[1::2]
        return syntax.Reward(
            tuple(
                replace(payment, negative=sign == "-") for sign, payment in zip(signs, payments, strict=True)
            ),
            span=span,
        )

    def build_payment(self, c: list[_Child], span: Span) -> syntax.Payment:
        return syntax.Payment(c[0], c[1], span=span)

    def build_decrease(self, c: list[_Child], span: Span) -> syntax.Decrease:
        return syntax.Decrease(self._name(c[0]), span=span)

    def build_count_value(self, c: list[_Child], span: Span) -> syntax.CountValue:
        return syntax.CountValue(self._name(c[0]), span=span)

    def build_reached_goal(self, c: list[_Child], span: Span) -> syntax.ReachedGoal:
        return syntax.ReachedGoal(span=span)

    def build_action_cost(self, c: list[_Child], span: Span) -> syntax.ActionCost:
        return syntax.ActionCost(span=span)

    def build_action_duration(self, c: list[_Child], span: Span) -> syntax.ActionDuration:
        return syntax.ActionDuration(span=span)

    def build_learned(self, c: list[_Child], span: Span) -> syntax.Learned:
        return syntax.Learned(tuple(c), span=span)

    def build_unitless(self, c: list[_Child], span: Span) -> syntax.Quantity:
        return self.build_quantity([*c, None], span)

    def build_experience(self, c: list[_Child], span: Span) -> syntax.ExperienceNode:
        name, digest, transitions = c
        return syntax.ExperienceNode(
            self._quoted(name), self._quoted(digest), self._number(transitions), span=span
        )

    # ---- conditions

    def build_condition(self, c: list[_Child], span: Span) -> syntax.ConditionNode:
        return syntax.ConditionNode(tuple(c), span=span)

    build_conjunction = build_condition

    def build_either(self, c: list[_Child], span: Span) -> syntax.EitherNode:
        return syntax.EitherNode(tuple(c), span=span)

    def build_exists(self, c: list[_Child], span: Span) -> syntax.ExistsNode:
        return syntax.ExistsNode(c[1], c[2], c[0] is None, span=span)

    def build_every(self, c: list[_Child], span: Span) -> syntax.EveryNode:
        return syntax.EveryNode(c[0], (), c[1], span=span)

    def build_every_guarded(self, c: list[_Child], span: Span) -> syntax.EveryNode:
        return syntax.EveryNode(c[0], c[1], c[2], span=span)

    def build_body(self, c: list[_Child], span: Span) -> tuple[syntax.LiteralNode, ...]:
        return tuple(c)

    def build_truth(self, c: list[_Child], span: Span) -> syntax.Truth:
        return syntax.Truth(c[1], c[0] is None, span=span)

    def build_comparison(self, c: list[_Child], span: Span) -> syntax.Comparison:
        application, relation, value = c
        return syntax.Comparison(application, str(relation), self._value(value), span=span)

    def build_equality(self, c: list[_Child], span: Span) -> syntax.EqualityNode:
        left, relation, right = c
        return syntax.EqualityNode(left, right, relation == "=", span=span)

    def build_application(self, c: list[_Child], span: Span) -> syntax.Application:
        return syntax.Application(self._name(c[0]), c[1], span=span)

    def build_term(self, c: list[_Child], span: Span) -> syntax.TermNode:
        return syntax.TermNode(c[0].removeprefix("?"), c[0].type == "VARIABLE", span=span)

    # ---- outcomes

    def build_outcomes(self, c: list[_Child], span: Span) -> tuple[syntax.OutcomeNode, ...]:
        return tuple(c)

    def build_outcome(self, c: list[_Child], span: Span) -> syntax.OutcomeNode:
        return syntax.OutcomeNode(c[0], c[1], span=span)

    def build_weight(self, c: list[_Child], span: Span) -> syntax.Weight:
        return syntax.Weight(c[0], tuple(mark for mark in c[1:] if mark is not None), span=span)

    build_stated = build_weight

    def build_probability(self, c: list[_Child], span: Span) -> syntax.Number:
        return self._number(c[0])

    def build_rest(self, c: list[_Child], span: Span) -> syntax.Rest:
        return syntax.Rest(span=span)

    def build_share(self, c: list[_Child], span: Span) -> syntax.Share:
        return syntax.Share(self._name(c[0]), span=span)

    def build_fixed(self, c: list[_Child], span: Span) -> syntax.Fixed:
        return syntax.Fixed(span=span)

    def build_prior(self, c: list[_Child], span: Span) -> syntax.Prior:
        return syntax.Prior(c[0], span=span)

    def build_quantity_prior(self, c: list[_Child], span: Span) -> syntax.QuantityPrior:
        return syntax.QuantityPrior(c[0], span=span)

    def build_seen(self, c: list[_Child], span: Span) -> syntax.Seen:
        return syntax.Seen(self._number(c[0]), span=span)

    def build_nothing(self, c: list[_Child], span: Span) -> syntax.Nothing:
        return syntax.Nothing(span=span)

    def build_noise(self, c: list[_Child], span: Span) -> syntax.Noise:
        return syntax.Noise(span=span)

    def build_effects(self, c: list[_Child], span: Span) -> syntax.Effects:
        return syntax.Effects(tuple(c), span=span)

    def build_set_truth(self, c: list[_Child], span: Span) -> syntax.SetTruth:
        return syntax.SetTruth(c[1], c[0] is None, span=span)

    def build_set_value(self, c: list[_Child], span: Span) -> syntax.SetValue:
        return syntax.SetValue(c[0], self._value(c[1]), span=span)

    def build_shift(self, c: list[_Child], span: Span) -> syntax.ShiftNode:
        application, sign, amount = c
        return syntax.ShiftNode(application, sign == "+=", self._number(amount), span=span)

    def build_pay(self, c: list[_Child], span: Span) -> syntax.PayNode:
        what, sign, price = c
        return syntax.PayNode(self._name(what), sign == "+=", price, span=span)

    def build_forall(self, c: list[_Child], span: Span) -> syntax.ForAllNode:
        return syntax.ForAllNode(c[0], c[1], c[2], span=span)

    def build_conditional(self, c: list[_Child], span: Span) -> syntax.IfNode:
        return syntax.IfNode(c[0], c[1], span=span)

    def build_consequence(self, c: list[_Child], span: Span) -> tuple[syntax.Assignment, ...]:
        return tuple(c)

    # ---- problems

    def build_problem(self, c: list[_Child], span: Span) -> syntax.ProblemNode:
        return syntax.ProblemNode(self._name(c[0]), tuple(c[1:]), span=span)

    def build_domain_name(self, c: list[_Child], span: Span) -> syntax.DomainName:
        return syntax.DomainName(self._name(c[0]), span=span)

    def build_objects(self, c: list[_Child], span: Span) -> syntax.Objects:
        return syntax.Objects(tuple(c), span=span)

    def build_init(self, c: list[_Child], span: Span) -> syntax.Init:
        return syntax.Init(tuple(c), span=span)

    def build_fact(self, c: list[_Child], span: Span) -> syntax.FactNode:
        application, *value = c
        return syntax.FactNode(application, self._value(value[0]) if value else None, span=span)

    def build_goal(self, c: list[_Child], span: Span) -> syntax.Goal:
        return syntax.Goal(c[0], span=span)

    def build_horizon(self, c: list[_Child], span: Span) -> syntax.HorizonNode:
        numbers = [token for token in c if token is not None and token.type == "NUMBER"]
        names = [token for token in c if token is not None and token.type == "NAME"]
        return syntax.HorizonNode(
            self._number(numbers[0]) if numbers else None, self._name(names[0]) if names else None, span=span
        )

    def build_discount(self, c: list[_Child], span: Span) -> syntax.Discount:
        return syntax.Discount(self._number(c[0]), span=span)

    def build_planner(self, c: list[_Child], span: Span) -> syntax.Planner:
        return syntax.Planner(tuple(c), span=span)

    # ---- scenes and studies

    def build_scene(self, c: list[_Child], span: Span) -> syntax.SceneNode:
        return syntax.SceneNode(self._name(c[0]), tuple(c[1:]), span=span)

    def build_section(self, c: list[_Child], span: Span) -> syntax.Section:
        return syntax.Section(self._name(c[0]), None, tuple(c[1:]), span=span)

    def build_titled(self, c: list[_Child], span: Span) -> syntax.Section:
        return syntax.Section(self._name(c[0]), self._name(c[1]), tuple(c[2:]), span=span)

    def build_study(self, c: list[_Child], span: Span) -> syntax.StudyNode:
        return syntax.StudyNode(self._name(c[0]), tuple(c[1:]), span=span)

    def build_block(self, c: list[_Child], span: Span) -> syntax.Section:
        return self.build_section(c, span)

    def build_named(self, c: list[_Child], span: Span) -> syntax.Section:
        return self.build_titled(c, span)

    def build_listed(self, c: list[_Child], span: Span) -> syntax.Listed:
        return syntax.Listed(self._name(c[0]), tuple(c[1:]), span=span)

    def build_setting(self, c: list[_Child], span: Span) -> syntax.Setting:
        return syntax.Setting(self._name(c[0]), c[1], span=span)

    def build_quantity(self, c: list[_Child], span: Span) -> syntax.Quantity:
        minus, number, unit = c
        value = Fraction(number)
        return syntax.Quantity(
            value if minus is None else -value, None if unit is None else str(unit), span=span
        )

    def build_pair(self, c: list[_Child], span: Span) -> syntax.Pair:
        return syntax.Pair(c[0], c[1], span=span)

    def build_points(self, c: list[_Child], span: Span) -> syntax.Points:
        return syntax.Points(tuple(c), span=span)

    def build_image_size(self, c: list[_Child], span: Span) -> syntax.ImageSize:
        return syntax.ImageSize(self._number(c[0]), self._number(c[1]), span=span)

    def build_call(self, c: list[_Child], span: Span) -> syntax.Call:
        return syntax.Call(self._name(c[0]), tuple(map(self._number, c[1:])), span=span)

    def build_word(self, c: list[_Child], span: Span) -> syntax.Word:
        return syntax.Word(str(c[0]), span=span)

    def build_quoted(self, c: list[_Child], span: Span) -> syntax.Quoted:
        return self._quoted(c[0])
