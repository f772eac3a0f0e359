"""Grounding: a checked domain and problem become a finite task that lists only what can change.

Guaranteed by the checker: names, arities and types fit, every variable is bound, the probabilities of a rule
sum to 1, and the problem's facts are complete and canonical.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from cleancli.compiler.evaluate import Key
from cleancli.compiler.instance import (
    Instance,
    Requirement,
    changeable_forall,
    conflicting_effects,
    instances,
    requirement,
)
from cleancli.compiler.join import Universe
from cleancli.compiler.task import (
    GroundAction,
    GroundCondition,
    GroundOutcome,
    GroundRule,
    StateVariable,
    Task,
    condition_order,
    holds,
    literal_text,
)
from cleancli.language.diagnostics import Diagnostic, Refused
from cleancli.language.model import Count, Domain, Horizon, OutcomeKind, Problem, Value

Possible = Mapping[Key, frozenset[Value]]
"""The values a key may ever take; a key that is missing keeps its initial value."""


def ground(domain: Domain, problem: Problem) -> Task:
    """The task of a problem. Raises `Refused` with the E6xx diagnostics of docs/planning.md."""
    universe = Universe(domain, problem)
    _refuse(changeable_forall(domain, universe))
    possible, reachable = _reachable(instances(domain, universe), universe)
    _refuse(conflicting_effects(domain, reachable))
    simplified = [_simplified(instance, possible) for instance in reachable]
    useful = _without_idle_actions(simplified, domain)
    numbering = Numbering(possible, universe)
    _refuse(_overlaps(domain, useful, numbering))
    return _task(domain, problem, useful, numbering)


def _refuse(diagnostics: Iterable[Diagnostic]) -> None:
    found = tuple(diagnostics)
    if found:
        raise Refused(found)


def _reachable(candidates: Sequence[Instance], universe: Universe) -> tuple[Possible, list[Instance]]:
    """The least fixpoint in which a value once possible stays so, and the instances that apply in it.

    Every state that actions can reach is inside it, so what it leaves out changes no plan's value.
    """
    possible: dict[Key, frozenset[Value]] = {}
    pending, reachable = list(candidates), []
    while True:
        applicable = [i for i in pending if _can_hold(i.required, possible, universe)]
        if not applicable:
            break
        for changes in itertools.chain.from_iterable(instance.changes for instance in applicable):
            for key, values in changes.items():
                possible[key] = possible.get(key, frozenset({universe.initial(key)})) | values
        reachable += applicable
        applied = {(instance.rule, instance.objects) for instance in applicable}
        pending = [i for i in pending if (i.rule, i.objects) not in applied]
    changing = {key: values for key, values in possible.items() if len(values) > 1}
    return changing, sorted(reachable, key=lambda instance: (instance.rule, instance.objects))


def _can_hold(required: Requirement, possible: Possible, universe: Universe) -> bool:
    return all(values & _values(key, possible, universe) for key, values in required.items())


def _values(key: Key, possible: Possible, universe: Universe) -> frozenset[Value]:
    return possible.get(key) or frozenset({universe.initial(key)})


def _simplified(instance: Instance, possible: Possible) -> Instance:
    """Without literals that always hold, and without effects that assign what is there anyway."""
    required = {
        key: values & possible[key]
        for key, values in instance.required.items()
        if key in possible and not possible[key] <= values
    }
    changes = tuple(
        {key: values for key, values in change.items() if key in possible and required.get(key) != values}
        for change in instance.changes
    )
    return replace(instance, required=required, changes=changes)


def _without_idle_actions(found: Sequence[Instance], domain: Domain) -> list[Instance]:
    """The instances of those actions that can change something by at least one of their rules."""

    def action(instance: Instance) -> tuple[str, tuple[str, ...]]:
        return domain.rules[instance.rule].action, instance.objects

    useful = {action(instance) for instance in found if any(instance.changes)}
    return [instance for instance in found if action(instance) in useful]


@dataclass(frozen=True, slots=True)
class _Place:
    """Where a key went: its variable's index and, per value, the value's index."""

    variable: int
    value: Mapping[Value, int]


class Numbering:
    """Numbers for the keys that can change and for their values, sorted by symbol and objects."""

    def __init__(self, possible: Possible, universe: Universe) -> None:
        self.universe, self.possible = universe, possible
        keys = sorted(possible)
        self.variables = tuple(
            StateVariable(*key, tuple(v for v in universe.symbols[key[0]].values if v in possible[key]))
            for key in keys
        )
        self._places = {
            key: _Place(index, {value: place for place, value in enumerate(variable.values)})
            for index, (key, variable) in enumerate(zip(keys, self.variables, strict=True))
        }
        self.initial = tuple(self._places[key].value[universe.initial(key)] for key in keys)

    def condition(self, required: Requirement) -> GroundCondition:
        """A simplified requirement in numbers."""
        places = ((self._places[key], values) for key, values in required.items())
        numbered = ((place.variable, frozenset(place.value[v] for v in values)) for place, values in places)
        return tuple(sorted(numbered, key=lambda pair: pair[0]))

    def effects(self, changes: Mapping[Key, frozenset[Value]]) -> tuple[tuple[int, int], ...]:
        """An outcome's changes in numbers."""
        places = ((self._places[key], values) for key, values in changes.items())
        return tuple(sorted((place.variable, place.value[v]) for place, values in places for v in values))

    def counted(self, count: Count) -> tuple[GroundCondition, ...]:
        """What each binding of the count asks for; bindings that can never satisfy it are left out."""
        found = []
        for binding in self.universe.extensions(count.variables, count.condition, {}):
            required = requirement(count.condition, binding, self.universe)
            if required is not None and _can_hold(required, self.possible, self.universe):
                simplified = _simplified(Instance(0, (), required, ()), self.possible)
                found.append(self.condition(simplified.required))
        return tuple(sorted(found, key=condition_order))


def _overlaps(domain: Domain, found: Sequence[Instance], numbering: Numbering) -> Iterator[Diagnostic]:
    """E603 for each pair of rules that cover one state of an action, with what such a state has in common."""
    reported = set()
    by_action: dict[tuple[str, tuple[str, ...]], list[Instance]] = {}
    for instance in found:
        by_action.setdefault((domain.rules[instance.rule].action, instance.objects), []).append(instance)
    for (action, objects), rivals in sorted(by_action.items()):
        for first, second in itertools.combinations(rivals, 2):
            pair = (first.rule, second.rule)
            shared = _both(first.required, second.required)
            if shared is not None and pair not in reported:
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
    keys = sorted({*first, *second})
    shared = [frozenset.intersection(*(r[key] for r in (first, second) if key in r)) for key in keys]
    if not all(shared):
        return None
    return {key: frozenset({min(values, key=str)}) for key, values in zip(keys, shared, strict=True)}


def _task(domain: Domain, problem: Problem, found: Sequence[Instance], numbering: Numbering) -> Task:
    actions = _ground_actions(domain, found)
    position = {(action.name, action.objects): index for index, action in enumerate(actions)}
    rules = [
        GroundRule(
            instance.rule,
            position[domain.rules[instance.rule].action, instance.objects],
            numbering.condition(instance.required),
            _outcomes(domain, instance, numbering),
        )
        for instance in found
    ]
    counts = {count.name: numbering.counted(count) for count in domain.counts}
    counted = counts[domain.reward]
    return Task(
        variables=numbering.variables,
        initial=numbering.initial,
        actions=actions,
        rules=tuple(sorted(rules, key=lambda rule: (rule.action, rule.rule))),
        counted=tuple(condition for condition in counted if condition),
        counted_always=sum(not condition for condition in counted),
        horizon=_horizon(problem.horizon or Horizon(1, domain.reward), counts, numbering),
        discount=problem.discount,
    )


def _ground_actions(domain: Domain, found: Iterable[Instance]) -> tuple[GroundAction, ...]:
    durations = {action.name: action.duration for action in domain.actions}
    names = sorted({(domain.rules[instance.rule].action, instance.objects) for instance in found})
    return tuple(GroundAction(name, objects, durations[name]) for name, objects in names)


def _outcomes(domain: Domain, instance: Instance, numbering: Numbering) -> tuple[GroundOutcome, ...]:
    ground_outcomes = []
    for outcome, changes in zip(domain.rules[instance.rule].outcomes, instance.changes, strict=True):
        effects = numbering.effects(changes)
        kind = outcome.kind if effects or outcome.kind is OutcomeKind.NOISE else OutcomeKind.NOTHING
        ground_outcomes.append(GroundOutcome(float(outcome.probability), kind, effects))
    return tuple(ground_outcomes)


def _horizon(
    horizon: Horizon, counts: Mapping[str, tuple[GroundCondition, ...]], numbering: Numbering
) -> int:
    """The plan length (§4.2.2): a constant, plus how much the named count is in the initial state."""
    conditions = counts[horizon.count] if horizon.count is not None else ()
    return horizon.constant + sum(holds(condition, numbering.initial) for condition in conditions)
