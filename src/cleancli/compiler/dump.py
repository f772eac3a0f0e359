"""A task as stable text, for people and for golden tests."""

from __future__ import annotations

from collections.abc import Iterator

from cleancli.compiler.task import GroundCondition, GroundOutcome, GroundRule, Task, literal_text


def dump(task: Task) -> str:
    """All of the task, one item a line, in its own order; rules by their number in the domain, from 0."""
    return "\n".join(_lines(task)) + "\n"


def as_data(task: Task) -> dict[str, object]:
    """All of the task for JSON, in its own order; rules by number in the domain, actions by place."""
    return {
        "horizon": task.horizon,
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
            {"name": action.name, "objects": list(action.objects), "duration": action.duration}
            for action in task.actions
        ],
        "rules": [_rule_data(task, rule) for rule in task.rules],
        "counted": [_condition(task, condition) for condition in task.counted],
        "counted_always": task.counted_always,
    }


def _rule_data(task: Task, rule: GroundRule) -> dict[str, object]:
    outcomes = [
        {"probability": outcome.probability, "effects": _effects(task, outcome)} for outcome in rule.outcomes
    ]
    when = _condition(task, rule.condition)
    return {"rule": rule.rule, "action": rule.action, "when": when, "outcomes": outcomes}


def _lines(task: Task) -> Iterator[str]:
    yield f"horizon {task.horizon}"
    yield f"discount {task.discount:g}"
    for variable, value in zip(task.variables, task.initial, strict=True):
        values = " | ".join(_value(v) for v in variable.values)
        name = f"{variable.symbol}({', '.join(variable.objects)})"
        yield f"variable {name}: {values} = {_value(variable.values[value])}"
    for index, action in enumerate(task.actions):
        yield f"action {action}" + ("" if action.duration is None else f" [{action.duration:g} s]")
        for rule in task.rules:
            if rule.action == index:
                yield f"  rule {rule.rule} when {_condition(task, rule.condition)}"
                yield from (f"    {o.probability:.6g}: {_effects(task, o)}" for o in rule.outcomes)
    yield from (f"counted {_condition(task, condition)}" for condition in task.counted)
    yield f"counted always {task.counted_always}"


def _condition(task: Task, condition: GroundCondition) -> str:
    return ", ".join(literal_text(task.variables[v], allowed) for v, allowed in condition) or "anything"


def _effects(task: Task, outcome: GroundOutcome) -> str:
    effects = ", ".join(
        literal_text(task.variables[variable], (value,)).replace(" = ", " := ")
        for variable, value in outcome.effects
    )
    return effects or outcome.kind.value


def _value(value: bool | str) -> str:
    return str(value).lower() if isinstance(value, bool) else value
