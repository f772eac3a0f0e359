"""Grounding: a checked domain and problem become a finite task that lists only what can change.

Guaranteed by the checker: names, arities and types fit, every variable is bound, the probabilities of a rule
sum to 1, and the problem's facts are complete and canonical.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from cleancli.array_types import Longs
from cleancli.compiler.collector import paused_collector
from cleancli.compiler.column_join import ColumnJoin
from cleancli.compiler.conflict import conflicting_effects
from cleancli.compiler.disjoint_cases import Case, TooManyCases, cases_of, too_many_cases
from cleancli.compiler.encoding import Numbering
from cleancli.compiler.exclusive_pairs import Allowed, Pair, TooManyDropped, pairs_of
from cleancli.compiler.fluents import bind, values_of
from cleancli.compiler.ground_formula import Possible, anything
from cleancli.compiler.ground_rules import PlainWords, RuleGroundings, from_cases, from_columns
from cleancli.compiler.grounding_size import RULE_LIMIT, refuse_too_many, too_many_cases_in_all
from cleancli.compiler.instances import instances, instances_of
from cleancli.compiler.partial_evaluation import Conditions
from cleancli.compiler.prices import Prices, by_functions
from cleancli.compiler.relaxed_reachability import Reach
from cleancli.compiler.rewards import (
    costs_of,
    price_of,
    rewards_of,
    usual_objective,
    waiting_can_pay,
)
from cleancli.compiler.static_join import Universe
from cleancli.compiler.task import (
    GroundAction,
    GroundCondition,
    GroundRule,
    Objective,
    Reaching,
    StateVariable,
    Task,
    condition_order,
    literal_text,
    reaching_by,
)
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Problem, RewardKind, weight_of

Called = tuple[str, tuple[str, ...]]
"""An action's name and the names of its objects."""


@paused_collector()
def ground(domain: Domain, problem: Problem, *, compat: bool = False, named: Collection[Called] = ()) -> Task:
    """The task of a problem. Raises `Refused` with the E6xx diagnostics of docs/planners.md.

    The task is for states that actions by these rules lead to from the problem's: it knows no other values,
    and where an instance falls into too many cases, none of `unreachable` states. What meets states that came
    about otherwise grounds anew where they are not of the task.

    Actions that are `named` are listed even if they can change nothing. `compat` grounds as libPRADA does:
    each binding of the references is a rule of its own, whether or not others fit too, and rules may overlap
    (no E603). Such a task is for planners that are asked for the same."""
    universe = Universe(domain, problem)
    join = ColumnJoin(universe)
    _refuse(refuse_too_many(domain, problem, join))
    conditions = Conditions(universe)
    reach = Reach(instances(domain, conditions, join, compat=compat), universe)
    cases, excluding = _cases(domain, reach, conditions, compat)
    _refuse(_conflicts(domain, cases, reach, conditions, join))
    numbering = Numbering(reach.changing, universe)
    prices = Prices(values_of(problem.state), weight_of(domain, RewardKind.COST))
    groundings = _groundings(domain, cases, reach, numbering, join, compat, prices)
    waiting = not compat and waiting_can_pay(domain)
    actions = _ground_actions(domain, groundings, waiting, named, prices)
    rules = _ground_rules(domain, groundings, actions)
    if not compat:
        _refuse(_overlaps(domain, rules, actions, numbering.variables))
    rewards = rewards_of(domain, problem, conditions, numbering, reach.known)
    return Task(
        variables=numbering.variables,
        initial=numbering.initial,
        actions=actions,
        rules=rules,
        rewards=rewards.rewards,
        constant_reward=rewards.constant_reward,
        goal=rewards.goal,
        counted=rewards.counted,
        lengthening=rewards.lengthening,
        horizon=rewards.horizon,
        discount=problem.discount,
        discounts=(problem.discount,) * len(actions),
        step=_step(domain),
        untimed=tuple(sorted(action.name for action in domain.actions if action.duration is None)),
        waiting=waiting,
        reaching=_reaching(domain, problem, actions),
        price=price_of(domain),
        unreachable=tuple(
            sorted((numbering.condition(dict(pair)) for pair in excluding), key=condition_order)
        ),
    )


def _reaching(domain: Domain, problem: Problem, actions: Sequence[GroundAction]) -> Reaching | None:
    """What counts without a horizon, unless something else is asked for; None with one."""
    objective = usual_objective(domain, problem)
    return None if objective is Objective.REWARD else reaching_by(objective, actions)


def _refuse(diagnostics: Iterable[Diagnostic]) -> None:
    found = tuple(diagnostics)
    if found:
        raise Refused(found)


def _cases(
    domain: Domain, reach: Reach, conditions: Conditions, compat: bool
) -> tuple[dict[int, list[Case]], Collection[Pair]]:
    """The cases of rules that are not plain, by rule. Where they are too many, those alone that no two of
    their literals exclude, and the pairs that exclude the others; but not for libPRADA, whose beliefs take
    all values as possible together."""
    try:
        return _divided(domain, reach, conditions, anything), ()
    except Refused:
        pairs = None if compat else pairs_of(reach, conditions)
        if pairs is None:
            raise
    allowed = Allowed(pairs)
    return _divided(domain, reach, conditions, allowed), allowed.excluding


def _divided(
    domain: Domain, reach: Reach, conditions: Conditions, possible: Possible
) -> dict[int, list[Case]]:
    """The possible cases of rules that are not plain, by rule. Raises `Refused` (E605)."""
    most = RULE_LIMIT - sum(len(plain.objects) for plain in reach.plain)
    found: list[Case] = []
    for instance in reach.instances:
        try:
            found += cases_of(instance, conditions, reach.known, possible)
        except (TooManyCases, TooManyDropped):
            raise Refused([too_many_cases(domain, instance, conditions, reach.known)]) from None
        if len(found) > most:
            raise Refused([too_many_cases_in_all(domain, found)])
    return {rule: list(cases) for rule, cases in itertools.groupby(found, key=lambda case: case.rule)}


def _conflicts(
    domain: Domain,
    cases: Mapping[int, Sequence[Case]],
    reach: Reach,
    conditions: Conditions,
    join: ColumnJoin,
) -> Iterator[Diagnostic]:
    """E602 for each outcome that gives one key two values, shown by the first such case. Cases of plain rules
    are made for those alone that conflict."""
    about = reach.vocabulary.fluents_of(reach.vocabulary.assignments.entries)
    shown: dict[int, Iterator[Case]] = {}
    for number, several in itertools.groupby(reach.plain, key=lambda plain: plain.rule):
        rows = np.unique(np.concatenate([each.objects[each.conflicts(about)] for each in several]), axis=0)
        shown[number] = _conflicting(domain, number, rows, reach, conditions, join)
    reported = set()
    for number, rule in enumerate(domain.rules):
        for case in shown.get(number, cases.get(number, ())):
            for position, key in case.conflicts:
                if (number, position) not in reported:
                    reported.add((number, position))
                    binding = bind(rule, case.objects)
                    symbols = conditions.universe.symbols
                    yield conflicting_effects(rule, rule.outcomes[position], binding, key, symbols)


def _conflicting(
    domain: Domain, rule: int, rows: Longs, reach: Reach, conditions: Conditions, join: ColumnJoin
) -> Iterator[Case]:
    """The cases of a plain rule for some rows of objects."""
    for row in rows.tolist():
        for instance in instances_of(rule, domain.rules[rule], join.named(row), conditions):
            yield from cases_of(instance, conditions, reach.known)


def _groundings(
    domain: Domain,
    cases: Mapping[int, Sequence[Case]],
    reach: Reach,
    numbering: Numbering,
    join: ColumnJoin,
    compat: bool,
    prices: Prices,
) -> list[RuleGroundings]:
    """The ground rules of each rule, in no order; those of the same objects and rule in that of its cases."""
    words = PlainWords(reach.vocabulary, numbering, reach.known, compat)
    by_columns = [from_columns(plain, domain.rules[plain.rule], words, join, prices) for plain in reach.plain]
    one_by_one = [
        from_cases(number, domain.rules[number], several, numbering, reach.known, compat, prices)
        for number, several in cases.items()
    ]
    return [*by_columns, *one_by_one]


def _ground_actions(
    domain: Domain,
    groundings: Iterable[RuleGroundings],
    waiting: bool,
    named: Collection[Called],
    prices: Prices,
) -> tuple[GroundAction, ...]:
    """Those that are named, or can change or cost something by at least one of their rules; all that have a
    rule where waiting can pay."""
    found = set(named)
    for each in groundings:
        rule = domain.rules[each.rule]
        every = waiting or any(outcome.reward or outcome.cost for outcome in rule.outcomes)
        found |= {
            (rule.action, objects)
            for objects, changes in zip(each.objects, each.changes, strict=True)
            if changes or every
        }
    durations = {action.name: action.duration for action in domain.actions}
    costs, declared = costs_of(domain), {action.name: action.cost.number for action in domain.actions}
    made = [
        GroundAction(name, objects, durations[name], costs[name], declared[name])
        for name, objects in sorted(found)
    ]
    priced = {action.name: action for action in domain.actions if action.cost.parts}
    for place, action in enumerate(made) if priced else ():
        if action.name in priced:
            declaration = priced[action.name]
            binding = dict(zip(declaration.parameters, action.objects, strict=True))
            more = by_functions(declaration.cost, binding, prices.values)
            made[place] = replace(
                action,
                cost=action.cost - prices.cost_weight * more,
                declared_cost=action.declared_cost + more,
            )
    return tuple(made)


def _ground_rules(
    domain: Domain, groundings: Iterable[RuleGroundings], actions: Sequence[GroundAction]
) -> tuple[GroundRule, ...]:
    """The ground rules of these actions."""
    position = {action.key: index for index, action in enumerate(actions)}
    rules = [
        GroundRule(each.rule, action, condition, outcomes)
        for each in groundings
        for objects, condition, outcomes in each
        if (action := position.get((domain.rules[each.rule].action, objects))) is not None
    ]
    return tuple(sorted(rules, key=lambda rule: (rule.action, rule.rule)))


def _overlaps(
    domain: Domain,
    rules: Sequence[GroundRule],
    actions: Sequence[GroundAction],
    variables: Sequence[StateVariable],
) -> Iterator[Diagnostic]:
    """E603 for each pair of rules that cover one state of an action, with what such a state has in common."""
    reported = set()
    for action, rivals in itertools.groupby(rules, key=lambda rule: rule.action):
        for first, second in itertools.combinations(rivals, 2):
            pair = (first.rule, second.rule)
            if first.rule == second.rule or pair in reported:
                continue  # cases of one rule exclude each other
            if _exclude_each_other(first.condition, second.condition):
                continue
            reported.add(pair)
            names = domain.rules[first.rule].name, domain.rules[second.rule].name
            state = ", ".join(_shared(first.condition, second.condition, variables))
            yield Diagnostic(
                "E603",
                f"rules `{names[0]}` and `{names[1]}` both cover {actions[action]}"
                f" where {state or 'anything'} holds",
                domain.rules[second.rule].span,
                label=f"overlaps with `{names[0]}`",
                help="rules of one action must exclude each other (§3.3.2): add a literal that differs",
            )


def _exclude_each_other(first: GroundCondition, second: GroundCondition) -> bool:
    other = dict(second)
    for variable, allowed in first:  # noqa: SIM110, twice as fast as any() of a generator
        if variable in other and other[variable].isdisjoint(allowed):
            return True
    return False


def _shared(
    first: GroundCondition, second: GroundCondition, variables: Sequence[StateVariable]
) -> Iterator[str]:
    """One state's worth of both conditions: a single value of each variable."""
    one, other = dict(first), dict(second)
    for variable in sorted(one.keys() | other.keys()):
        values = variables[variable].values
        both = one.get(variable, other.get(variable, frozenset())) & other.get(
            variable, one.get(variable, frozenset())
        )
        yield literal_text(variables[variable], [min(both, key=lambda index: str(values[index]))])


def _step(domain: Domain) -> float | None:
    """The mean duration of the actions with a rule that has an effect; of all where no rule has any."""
    acting = {rule.action for rule in domain.rules if any(outcome.effects for outcome in rule.outcomes)}
    durations = [action.duration for action in domain.actions if action.name in acting or not acting]
    known = [duration for duration in durations if duration is not None]
    return sum(known) / len(known) if known and len(known) == len(durations) else None
