"""A task as stable text, for people and for golden tests, and as data."""

from __future__ import annotations

from collections.abc import Iterator

from cleancli.compiler.task import (
    GroundAction,
    GroundCondition,
    GroundOutcome,
    Task,
    horizon_text,
    literal_text,
)
from cleancli.language.model import Value


def dump(task: Task) -> str:
    """All of the task, one item a line, in its own order; rules by their number in the domain, from 0."""
    return "\n".join(_lines(task)) + "\n"


def as_data(task: Task) -> dict[str, object]:
    """All of the task as dictionaries, lists, texts and numbers, for JSON.

    Literals are written as in rule files. A rule's `rule` is its number in the domain, from 0, and its
    `action` an index into the actions.
    """
    return {
        "horizon": task.steps,
        "discount": task.discount,
        "variables": [
            {
                "symbol": variable.symbol,
                "objects": list(variable.objects),
                "values": list(variable.values),
                "initial": variable.values[value],
            }
            for variable, value in zip(task.variables, task.initial, strict=True)
        ],
        "actions": [
            {"name": a.name, "objects": list(a.objects), "duration": a.duration, "cost": float(a.cost)}
            for a in task.actions
        ],
        "rules": [
            {
                "rule": rule.rule,
                "action": rule.action,
                "when": _literals(task, rule.condition),
                "outcomes": [
                    {
                        "probability": float(o.probability),
                        "kind": o.kind.value,
                        "effects": _assignments(task, o),
                        "cost": float(o.cost),
                    }
                    for o in rule.outcomes
                ],
            }
            for rule in task.rules
        ],
        "rewards": [
            {"when": _literals(task, r.condition), "decrease": float(r.decrease), "state": float(r.state)}
            for r in task.rewards
        ],
        "constant_reward": float(task.constant_reward),
        "goal": [_literals(task, condition) for condition in task.goal],
    }


def _lines(task: Task) -> Iterator[str]:
    yield f"horizon {horizon_text(task.steps)}"
    yield f"discount {task.discount:g}"
    for variable, value in zip(task.variables, task.initial, strict=True):
        values = " | ".join(_value(v) for v in variable.values)
        name = f"{variable.symbol}({', '.join(variable.objects)})"
        yield f"variable {name}: {values} = {_value(variable.values[value])}"
    for index, action in enumerate(task.actions):
        yield f"action {action}{_marks(action)}"
        for rule in task.rules:
            if rule.action == index:
                yield f"  rule {rule.rule} when {_condition(task, rule.condition)}"
                yield from (f"    {float(o.probability):.6g}: {_effects(task, o)}" for o in rule.outcomes)
    yield from _reward_lines(task)
    yield from (f"goal {_condition(task, condition)}" for condition in task.goal)


def _marks(action: GroundAction) -> str:
    marks = [] if action.duration is None else [f"{action.duration:g} s"]
    marks += [f"cost {float(action.cost):g}"] if action.cost else []
    return f" [{', '.join(marks)}]" if marks else ""


def _reward_lines(task: Task) -> Iterator[str]:
    for reward in task.rewards:
        condition = _condition(task, reward.condition)
        if reward.decrease > 0:
            yield f"reward {float(reward.decrease):g} when {condition} ends"
        if reward.decrease < 0:
            yield f"reward {-float(reward.decrease):g} when {condition} begins"
        if reward.state:
            yield f"reward {float(reward.state):g} while {condition}"
    if task.constant_reward:
        yield f"reward {float(task.constant_reward):g} always"


def _condition(task: Task, condition: GroundCondition) -> str:
    return ", ".join(_literals(task, condition)) or "anything"


def _literals(task: Task, condition: GroundCondition) -> list[str]:
    return [literal_text(task.variables[v], allowed) for v, allowed in condition]


def _effects(task: Task, outcome: GroundOutcome) -> str:
    said = ", ".join(_assignments(task, outcome)) or outcome.kind.value
    return said + (f" [cost {float(outcome.cost):g}]" if outcome.cost else "")


def _assignments(task: Task, outcome: GroundOutcome) -> list[str]:
    return [
        literal_text(task.variables[variable], (value,)).replace(" = ", " := ")
        for variable, value in outcome.effects
    ]


def _value(value: Value) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
