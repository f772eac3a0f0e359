"""State abstraction: a task that forgets what no longer matters, so that fewer states tell the same.

A cleaned area still has a size, which no rule and no reward asks for as long as it is clean. If it stays so,
states that differ in that size alone are worth the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from cleancli.compiler.task import GroundCondition, GroundRule, GroundState, Task, asked

Forget = Callable[[GroundState], GroundState]
"""A state with what has lost its meaning in it forgotten."""


def forgetting(task: Task) -> tuple[Task, Forget]:
    """The same task, with the same actions and values, where what has lost its meaning for good takes its
    first value; and how to say so of a state from which it starts (that of the task is as it was).

    A variable has lost it where all conditions that ask for it also ask another one for values that it can
    never take again, and no rule can set it from then on: what is forgotten of a state then does not hang on
    how it was reached.
    """
    forgotten = _forgotten(task)

    def forget(effects: tuple[tuple[int, int], ...]) -> tuple[tuple[int, int], ...]:
        kept: set[int] = set()
        lost: set[int] = set()
        for guard, value in sorted(effects):
            if guard not in lost:  # two that guard each other can't both be forgotten
                found = set(forgotten.get((guard, value), ())) - kept
                kept |= {guard} if found else set()
                lost |= found
        return tuple(sorted((dict(effects) | dict.fromkeys(lost, 0)).items()))

    rules = tuple(
        replace(rule, outcomes=tuple(replace(o, effects=forget(o.effects)) for o in rule.outcomes))
        for rule in task.rules
    )

    def forget_state(assignment: GroundState) -> GroundState:
        return tuple(value for _, value in forget(tuple(enumerate(assignment))))

    return replace(task, rules=rules), forget_state


def _forgotten(task: Task) -> dict[tuple[int, int], list[int]]:
    """For a variable and its value the variables that lose their meaning when it takes the value."""
    conditions = [*(rule.condition for rule in task.rules), *(each.condition for each in asked(task))]
    asking: list[list[GroundCondition]] = [[] for _ in task.variables]
    for condition in conditions:
        for variable, _ in condition:
            asking[variable].append(condition)
    later = [_later(task, variable) for variable in range(len(task.variables))]
    forgotten: dict[tuple[int, int], list[int]] = {}
    for lost, own in enumerate(asking):
        setting = _setting(task, lost)
        for guard, wanted in _common(own).items():
            for value, values in enumerate(later[guard]):
                if guard != lost and not values & wanted and not _is_set(setting, guard, values):
                    forgotten.setdefault((guard, value), []).append(lost)
    return forgotten


_Setting = Sequence[tuple[dict[int, frozenset[int]], frozenset[int]]]
"""The conditions of rules that may set a variable, and what else is set then."""


def _setting(task: Task, variable: int) -> _Setting:
    found = []
    for rule in task.rules:
        for outcome in rule.outcomes:
            changed = frozenset(each for each, _ in outcome.effects)
            if outcome.probability and variable in changed:
                found.append((dict(rule.condition), changed - {variable}))
    return found


def _is_set(setting: _Setting, guard: int, values: frozenset[int]) -> bool:
    """Whether a variable may be set while another one, which stays as it is, has one of these values."""
    return any(
        guard not in changed and condition.get(guard, values) & values for condition, changed in setting
    )


def _common(conditions: Sequence[GroundCondition]) -> dict[int, frozenset[int]]:
    """The variables that all conditions ask for, with all values that one of them allows."""
    if not conditions:
        return {}
    literals = [dict(condition) for condition in conditions]
    shared = set(literals[0]).intersection(*literals)
    return {variable: frozenset().union(*(own[variable] for own in literals)) for variable in sorted(shared)}


def _later(task: Task, variable: int) -> list[frozenset[int]]:
    """For each value of a variable those that it may have from then on."""
    steps: list[set[int]] = [{value} for value in range(len(task.variables[variable].values))]
    for rule in task.rules:
        set_by_rule = _values_set(rule, variable)
        for before in dict(rule.condition).get(variable, range(len(steps))):
            steps[before] |= set_by_rule
    return _closed(steps)


def _values_set(rule: GroundRule, variable: int) -> set[int]:
    """The values that outcomes of the rule which can happen give the variable."""
    effects = (effect for outcome in rule.outcomes if outcome.probability for effect in outcome.effects)
    return {value for changed, value in effects if changed == variable}


def _closed(steps: Sequence[set[int]]) -> list[frozenset[int]]:
    """The transitive closure of `steps`, which has for each value those one step away (Warshall)."""
    reached = [set(targets) for targets in steps]
    for middle, targets in enumerate(reached):
        for before in reached:
            if middle in before:
                before |= targets
    return list(map(frozenset, reached))
