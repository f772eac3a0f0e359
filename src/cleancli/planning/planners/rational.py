"""The optimal policy in exact arithmetic: fractions from the rule file to the value, in plain Python."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from cleancli.compiler.semantics import covering_rule, idle_earliness, reaches_goal
from cleancli.compiler.task import GroundState, Task, holds
from cleancli.planning.plan import TooManyStatesError
from cleancli.planning.trajectory import Choose


@dataclass(frozen=True, slots=True)
class _Choice:
    """An action (an index), what its step pays, its progress, and what may follow."""

    action: int
    reward: Fraction
    progress: Fraction
    after: tuple[tuple[GroundState, Fraction], ...]


_Worth = tuple[Fraction, Fraction]
"""A value and its earliness (planning/preference.py)."""

_NOTHING: _Worth = Fraction(0), Fraction(0)


@dataclass(frozen=True, slots=True)
class _State:
    """What a step that ends in the state is paid, and the choices in it."""

    standing: Fraction
    choices: tuple[_Choice, ...]


def optimum(task: Task, limit: int) -> tuple[Fraction, Choose]:
    """The optimal value of the initial state, and the policy, as planning/kernels/state_graph.py has them in
    floats.

    A discount, which is a float, is taken for the decimal number that it is printed as. Raises
    `TooManyStatesError` where more than `limit` states can be reached within the horizon.
    """
    layers = _layers(task, limit)
    discount, discounts = Fraction(repr(task.discount)), [Fraction(repr(d)) for d in task.discounts]
    payments = [d / discount if discount else Fraction(1) for d in discounts]
    later: dict[GroundState, _Worth] = {}
    policy: list[dict[GroundState, int | None]] = []
    for left, layer in enumerate(reversed(layers), start=1):
        now: dict[GroundState, _Worth] = {}
        best: dict[GroundState, int | None] = {}
        idle = sum((discount**step for step in range(left)), Fraction(0))
        for state, known in layer.items():
            now[state], best[state] = (known.standing * idle, known.standing * idle_earliness(left)), None
            for choice in known.choices:
                after = [(p, *later.get(s, _NOTHING)) for s, p in choice.after]
                value = payments[choice.action] * choice.reward
                value += discounts[choice.action] * sum(p * worth for p, worth, _ in after)
                earliness = left * choice.progress + sum(p * early for p, _, early in after)
                if (value, earliness) > now[state]:
                    now[state], best[state] = (value, earliness), choice.action
        policy.append(best)
        later = now
    policy.reverse()
    return later.get(task.initial, _NOTHING)[0], lambda step, state: policy[step][state]


def _layers(task: Task, limit: int) -> list[dict[GroundState, _State]]:
    """For each step the states that can be reached by then."""
    known: dict[GroundState, _State] = {}
    layers: list[dict[GroundState, _State]] = []
    frontier = {task.initial: None}
    for _ in range(task.horizon):
        reached = dict.fromkeys(frontier)
        frontier = {}
        for state in reached:
            known[state] = _state(task, state)
            frontier |= {s: None for choice in known[state].choices for s, _ in choice.after}
            frontier = {s: None for s in frontier if s not in known}
            if len(known) + len(frontier) > limit:
                raise TooManyStatesError(len(known) + len(frontier), limit)
        layers.append(dict(known))
    return layers


def _state(task: Task, state: GroundState) -> _State:
    decreasing, standing = _paid(task, state)
    reached, choices = reaches_goal(task, state), []
    for action in range(len(task.actions)):
        after = successors(task, state, action)
        if after and (task.waiting or list(after) != [state]):
            reward, progress = -task.actions[action].cost, Fraction(0)
            for successor, probability in after.items():
                left, paid = _paid(task, successor)
                reward += probability * (decreasing - left + paid)
                progress += probability * (decreasing - left + paid + reaches_goal(task, successor) - reached)
            choices.append(_Choice(action, reward, progress, tuple(after.items())))
    return _State(standing, tuple(choices))


def successors(task: Task, state: GroundState, action: int) -> dict[GroundState, Fraction]:
    """The states that may follow, with their probabilities; none where no rule covers the state."""
    rule = covering_rule(task, state, action)
    found: dict[GroundState, Fraction] = {}
    for outcome in () if rule is None else rule.outcomes:
        if outcome.probability:
            effects = dict(outcome.effects)
            successor = tuple(effects.get(variable, value) for variable, value in enumerate(state))
            found[successor] = found.get(successor, Fraction(0)) + outcome.probability
    return found


def _paid(task: Task, state: GroundState) -> tuple[Fraction, Fraction]:
    """What is paid for its decrease, and what a step that ends in the state is paid."""
    held = [reward for reward in task.rewards if holds(reward.condition, state)]
    decreasing = sum((reward.decrease for reward in held), Fraction(0))
    return decreasing, sum((reward.state for reward in held), task.constant_reward)
