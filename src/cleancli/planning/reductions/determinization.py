"""Determinized tasks: what an action does is certain, or is chosen (Yoon, Fern and Givan 2007)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from cleancli.compiler.task import GroundOutcome, GroundRule, Task


def likeliest_outcomes(task: Task) -> tuple[Task, tuple[int, ...]]:
    """The task where each rule has its likeliest outcome alone, and the action that each of its actions is.

    Of equals it is the first that changes something. A rule whose likeliest outcome changes nothing is
    dropped, unless waiting is a choice and it pays or the rule has no other.
    """
    rules = [(rule, rule.action, _likeliest(rule)) for rule in task.rules]
    return _determinized(task, range(len(task.actions)), rules)


def all_outcomes(task: Task) -> tuple[Task, tuple[int, ...]]:
    """The task where each outcome that can happen is an action of its own, and the action that each is.

    Outcomes that change nothing are left out, unless waiting is a choice and they pay or the rule has no
    others.
    """
    origins: list[int] = []
    rules: list[tuple[GroundRule, int, GroundOutcome]] = []
    of_action: list[list[GroundRule]] = [[] for _ in task.actions]
    for rule in task.rules:
        of_action[rule.action].append(rule)
    for action, own in enumerate(of_action):
        for place in range(max((len(rule.outcomes) for rule in own), default=0)):
            chosen = [(rule, rule.outcomes[place]) for rule in own if place < len(rule.outcomes)]
            rules += [(rule, len(origins), outcome) for rule, outcome in chosen if outcome.probability]
            origins.append(action)
    return _determinized(task, origins, rules)


def by_chance(task: Task) -> tuple[Task, tuple[int, ...]]:
    """The task where each outcome of each rule is an action of its own, and the action that each is; what
    comes of it is discounted by its probability, given that something changes.

    So a sequence is worth what it pays as long as all goes as it hopes, where tries that change nothing cost
    no more than time. Outcomes that change nothing are left out.
    """
    origins: list[int] = []
    rules: list[tuple[GroundRule, int, GroundOutcome]] = []
    discounts: list[float] = []
    for rule in task.rules:
        changing = [each for each in rule.outcomes if each.effects and each.probability]
        together = sum(each.probability for each in changing)
        for outcome in changing:
            rules.append((rule, len(origins), outcome))
            origins.append(rule.action)
            discounts.append(task.discounts[rule.action] * float(outcome.probability / together))
    made, origin = _determinized(task, origins, rules)
    return replace(made, discounts=tuple(discounts)), origin


def _likeliest(rule: GroundRule) -> GroundOutcome:
    return max(rule.outcomes, key=lambda outcome: (outcome.probability, bool(outcome.effects)))


def _determinized(
    task: Task, origins: Sequence[int], rules: Sequence[tuple[GroundRule, int, GroundOutcome]]
) -> tuple[Task, tuple[int, ...]]:
    """The task with an action for each origin, and of the rules those whose one outcome counts."""
    certain = tuple(
        GroundRule(rule.rule, action, rule.condition, (replace(outcome, probability=Fraction(1)),))
        for rule, action, outcome in rules
        if outcome.effects
        or (task.waiting and (outcome.cost or not any(each.effects for each in rule.outcomes)))
    )
    made = replace(
        task,
        actions=tuple(task.actions[origin] for origin in origins),
        discounts=tuple(task.discounts[origin] for origin in origins),
        rules=certain,
    )
    return made, tuple(origins)
