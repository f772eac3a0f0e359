"""Grounding: a checked domain and problem become a finite task that lists only what can change.

Guaranteed by the checker: names, arities and types fit, every variable is bound, the probabilities of a rule
sum to 1, and the problem's facts are complete and canonical.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Sequence
from fractions import Fraction

from cleancli.compiler.collector import paused_collector
from cleancli.compiler.conflict import conflicting_effects
from cleancli.compiler.disjoint_cases import Case, TooManyCases, cases_of, too_many_cases
from cleancli.compiler.encoding import Numbering
from cleancli.compiler.fluents import bind
from cleancli.compiler.ground_formula import Requirement
from cleancli.compiler.grounding_size import RULE_LIMIT, refuse_too_many, too_many_cases_in_all
from cleancli.compiler.instances import instances
from cleancli.compiler.partial_evaluation import Conditions
from cleancli.compiler.relaxed_reachability import Reach
from cleancli.compiler.rewards import costs_of, rewards_of, usual_objective, waiting_can_pay
from cleancli.compiler.static_join import Universe
from cleancli.compiler.task import (
    GroundAction,
    GroundOutcome,
    GroundRule,
    Objective,
    Reaching,
    Task,
    literal_text,
)
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, OutcomeKind, Problem

Called = tuple[str, tuple[str, ...]]
"""An action's name and the names of its objects."""


@paused_collector()
def ground(domain: Domain, problem: Problem, *, compat: bool = False, named: Collection[Called] = ()) -> Task:
    """The task of a problem. Raises `Refused` with the E6xx diagnostics of docs/planning.md.

    Actions that are `named` are listed even if they can change nothing. `compat` grounds as libPRADA does:
    each binding of the references is a rule of its own, whether or not others fit too, and rules may overlap
    (no E603). Such a task is for planners that are asked for the same."""
    universe = Universe(domain, problem)
    _refuse(refuse_too_many(domain, problem, universe))
    conditions = Conditions(universe)
    reach = Reach(instances(domain, conditions, compat=compat), universe)
    cases = _cases(domain, reach, conditions)
    _refuse(_conflicts(domain, cases, universe))
    waiting = not compat and waiting_can_pay(domain)
    useful = _useful([_simplified(case, reach, compat) for case in cases], domain, waiting, named)
    numbering = Numbering(reach.changing, universe)
    if not compat:
        _refuse(_overlaps(domain, useful, numbering))
    rewards = rewards_of(domain, problem, conditions, numbering, reach.known)
    actions = _ground_actions(domain, useful, named)
    return Task(
        variables=numbering.variables,
        initial=numbering.initial,
        actions=actions,
        rules=_ground_rules(domain, useful, actions, numbering),
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
    )


def _reaching(domain: Domain, problem: Problem, actions: Sequence[GroundAction]) -> Reaching | None:
    """What counts without a horizon, unless something else is asked for; None with one."""
    objective = usual_objective(domain, problem)
    match objective:
        case Objective.COST:
            return Reaching(objective, tuple(action.declared_cost for action in actions))
        case Objective.PROBABILITY:
            return Reaching(objective, (Fraction(1),) * len(actions))
        case Objective.REWARD | Objective.TIME:
            return None


def _refuse(diagnostics: Iterable[Diagnostic]) -> None:
    found = tuple(diagnostics)
    if found:
        raise Refused(found)


def _cases(domain: Domain, reach: Reach, conditions: Conditions) -> list[Case]:
    found: list[Case] = []
    for instance in reach.instances:
        try:
            found += cases_of(instance, conditions, reach.known)
        except TooManyCases:
            raise Refused([too_many_cases(domain, instance, conditions, reach.known)]) from None
        if len(found) > RULE_LIMIT:
            raise Refused([too_many_cases_in_all(domain, found)])
    return found


def _conflicts(domain: Domain, found: Iterable[Case], universe: Universe) -> Iterator[Diagnostic]:
    """E602 for each outcome that gives one key two values, shown by the first such case."""
    reported = set()
    for case in found:
        rule = domain.rules[case.rule]
        for position, key in case.conflicts:
            if (case.rule, position) not in reported:
                reported.add((case.rule, position))
                binding = bind(rule, case.objects)
                yield conflicting_effects(rule, rule.outcomes[position], binding, key, universe.symbols)


def _simplified(case: Case, reach: Reach, compat: bool) -> Case:
    """Without effects that assign what is there anyway. libPRADA's update takes the condition and what is set
    as independent, so there they count."""
    changes = tuple(
        [
            {
                key: values
                for key, values in change.items()
                if (compat or case.required.get(key) != values) and len(reach.known(key)) > 1
            }
            for change in case.changes
        ]
    )
    return Case(case.rule, case.objects, case.required, changes)


def _useful(
    found: Sequence[Case], domain: Domain, waiting: bool, named: Collection[Called]
) -> Sequence[Case]:
    """The cases of those actions that are named or can change something by at least one of their rules; all
    where waiting can pay."""
    if waiting:
        return found

    def action(case: Case) -> Called:
        return domain.rules[case.rule].action, case.objects

    useful = {action(case) for case in found if any(case.changes)} | set(named)
    return [case for case in found if action(case) in useful]


def _overlaps(domain: Domain, found: Sequence[Case], numbering: Numbering) -> Iterator[Diagnostic]:
    """E603 for each pair of rules that cover one state of an action, with what such a state has in common."""
    reported = set()
    by_action: dict[tuple[str, tuple[str, ...]], list[Case]] = {}
    for instance in found:
        by_action.setdefault((domain.rules[instance.rule].action, instance.objects), []).append(instance)
    for (action, objects), rivals in sorted(by_action.items()):
        for first, second in itertools.combinations(rivals, 2):
            pair = (first.rule, second.rule)
            if first.rule == second.rule or pair in reported:
                continue  # cases of one rule exclude each other
            shared = _both(first.required, second.required)
            if shared is not None:
                reported.add(pair)
                names = domain.rules[first.rule].name, domain.rules[second.rule].name
                state = ", ".join(
                    literal_text(numbering.variables[variable], allowed)
                    for variable, allowed in numbering.condition(shared)
                )
                yield Diagnostic(
                    "E603",
                    f"rules `{names[0]}` and `{names[1]}` both cover {action}({', '.join(objects)})"
                    f" where {state or 'anything'} holds",
                    domain.rules[second.rule].span,
                    label=f"overlaps with `{names[0]}`",
                    help="rules of one action must exclude each other (§3.3.2): add a literal that differs",
                )


def _both(first: Requirement, second: Requirement) -> Requirement | None:
    """One state's worth of both requirements (a single value per key); None where they exclude each other."""
    if any(not values & second[key] for key, values in first.items() if key in second):
        return None
    shared = {**second, **{key: values & second.get(key, values) for key, values in first.items()}}
    return {key: frozenset({min(values, key=str)}) for key, values in sorted(shared.items())}


def _ground_rules(
    domain: Domain, found: Iterable[Case], actions: Sequence[GroundAction], numbering: Numbering
) -> tuple[GroundRule, ...]:
    position = {(action.name, action.objects): index for index, action in enumerate(actions)}
    outcomes = [[(o.probability, o.kind) for o in rule.outcomes] for rule in domain.rules]
    rules = [
        GroundRule(
            case.rule,
            position[domain.rules[case.rule].action, case.objects],
            numbering.condition(case.required),
            _outcomes(case, outcomes[case.rule], numbering),
        )
        for case in found
    ]
    return tuple(sorted(rules, key=lambda rule: (rule.action, rule.rule)))


def _ground_actions(
    domain: Domain, found: Iterable[Case], named: Collection[Called]
) -> tuple[GroundAction, ...]:
    durations = {action.name: action.duration for action in domain.actions}
    costs, declared = costs_of(domain), {action.name: action.cost for action in domain.actions}
    names = sorted({(domain.rules[case.rule].action, case.objects) for case in found} | set(named))
    return tuple(
        GroundAction(name, objects, durations[name], costs[name], declared[name]) for name, objects in names
    )


def _step(domain: Domain) -> float | None:
    """The mean duration of the actions with a rule that has an effect; of all where no rule has any."""
    acting = {rule.action for rule in domain.rules if any(outcome.effects for outcome in rule.outcomes)}
    durations = [action.duration for action in domain.actions if action.name in acting or not acting]
    known = [duration for duration in durations if duration is not None]
    return sum(known) / len(known) if known and len(known) == len(durations) else None


def _outcomes(
    case: Case, probabilities: Sequence[tuple[Fraction, OutcomeKind]], numbering: Numbering
) -> tuple[GroundOutcome, ...]:
    ground_outcomes = []
    for (probability, kind), changes in zip(probabilities, case.changes, strict=True):
        effects = numbering.effects(changes)
        left = kind if effects or kind is OutcomeKind.NOISE else OutcomeKind.NOTHING
        ground_outcomes.append(GroundOutcome(probability, left, effects))
    return tuple(ground_outcomes)
