"""Compares what many steps come to: closed loops of the simulation, and numbers that are learned."""

from __future__ import annotations

import json
import math
from collections import Counter
from fractions import Fraction
from pathlib import Path
from random import Random

from support.differential import product
from support.differential.abstract import Rule
from support.differential.comparison import Comparison
from support.differential.interpreter import Binding, Call, Meaning, State, TwoValues
from support.differential.product import Loaded, near
from support.differential.worth import STOP, Worth

EPISODES = 40
ACTIONS = 4
TRANSITIONS = 20
FAR = 6.0
"""A mean so many standard errors from what is expected is a difference."""


class Undecided(Exception):
    """Several actions are equally good, so that the loop may go either way."""


def compare_loop(comparison: Comparison, folder: Path, worth: Worth, planner: str) -> None:
    """`simulate`: every return is one that can come, and their mean is the expected one."""
    try:
        expected = returns(worth, worth.meaning.initial(), 0, {})
    except Undecided:
        return
    numbers = ("--episodes", str(EPISODES), "--max-actions", str(ACTIONS))
    try:
        said = product.command(folder, "simulate", "--planner", planner, *numbers)
    except product.NoAnswer as refused:
        comparison.differ("command", str(refused))
        return
    row = said["planners"][0]
    for found in {each["discounted"] for each in row["rows"]}:
        comparison.compared["return"] += 1
        if not any(near(found, known, 1e-8) for known in expected):
            comparison.differ("return", f"{planner}: {found} cannot come, but {sorted(map(float, expected))}")
            return
    mean = sum(float(value) * float(chance) for value, chance in expected.items())
    spread = sum(float(chance) * (float(value) - mean) ** 2 for value, chance in expected.items())
    comparison.compared["mean return"] += 1
    if abs(row["discounted"]["mean"] - mean) > FAR * math.sqrt(spread / EPISODES) + 1e-8:
        comparison.differ("mean return", f"{planner}: expected {mean}, got {row['discounted']}")


Returns = dict[Fraction, Fraction]


def returns(worth: Worth, state: State, done: int, known: dict[tuple[State, int], Returns]) -> Returns:
    """The returns that may come from a state on, with their probabilities.

    An episode ends where it has succeeded, after `ACTIONS` actions, and where stopping is best.
    """
    if (state, done) not in known:
        known[state, done] = returns_of_step(worth, state, done, known)
    return known[state, done]


def returns_of_step(
    worth: Worth, state: State, done: int, known: dict[tuple[State, int], Returns]
) -> Returns:
    stopped = {Fraction(worth.stopped(state, ACTIONS - done)): Fraction(1)}
    if done == ACTIONS or succeeded(worth, state):
        return stopped
    equals = worth.choice(state, max(worth.horizon(state), 0)).equals
    if len(equals) > 1:
        raise Undecided
    if equals[0] is STOP:
        return stopped
    found: Returns = {}
    for chance, there, paid in worth.results(state, equals[0]):
        for later, share in returns(worth, there, done + 1, known).items():
            value = paid + Fraction(worth.discount) * later
            found[value] = found.get(value, Fraction(0)) + chance * share
    return found


def succeeded(worth: Worth, state: State) -> bool:
    """The goal holds; without one, nothing is left of the count that is to fall."""
    if worth.meaning.problem.goal:
        return worth.goal_seen(state)
    falling = [each for each in worth.meaning.domain.reward if each.kind == "decrease" and each.weight > 0]
    return bool(falling) and worth.meaning.counted(falling[0].count, state) == 0


def compare_learned(
    comparison: Comparison, loaded: Loaded, worth: Worth, states: tuple[State, ...], random: Random
) -> None:
    """How often each outcome was seen, in transitions that exactly one outcome explains."""
    meaning = worth.meaning
    seen: Counter[tuple[str, int]] = Counter()
    lines = []
    for _ in range(TRANSITIONS):
        state = random.choice(states)
        covered = worth.covered(state)
        if not covered:
            continue
        asked = random.choice(covered)
        covering = meaning.covering(asked, state)
        assert covering is not None
        drawn = explained(meaning, *covering, state, random)
        if drawn is not None:
            seen[covering[0].name, drawn[0]] += 1
            lines.append(line(meaning, asked, state, drawn[1]))
    if lines:
        found = product.learned(loaded, "\n".join([*lines, ""]))
        for rule in meaning.domain.rules:
            for index in range(len(rule.outcomes)):
                place = f"{rule.name}, outcome {index}"
                comparison.same("learned", seen[rule.name, index], found.get((rule.name, index), 0), place)


def explained(
    meaning: Meaning, rule: Rule, binding: Binding, state: State, random: Random
) -> tuple[int, State] | None:
    """A drawn outcome that can be told from all others by the state after it, and that state."""
    fitting: dict[State, list[int]] = {}
    noise = None
    for index, outcome in enumerate(rule.outcomes):
        if outcome.idle == "noise":
            noise = index
            continue
        try:
            fitting.setdefault(meaning.after(outcome, binding, state), []).append(index)
        except TwoValues:
            return None
    choices = [(indices[0], after) for after, indices in fitting.items() if len(indices) == 1]
    if noise is not None and state not in fitting:
        choices.append((noise, state))
    return random.choice(choices) if choices else None


def line(meaning: Meaning, asked: Call, before: State, after: State) -> str:
    """A transition as a line of experience."""
    name, objects = asked
    record = {
        "action": name,
        "arguments": objects,
        "objects": {each.name: each.kind for each in meaning.problem.objects},
        "before": facts(meaning, before),
        "after": facts(meaning, after),
    }
    return json.dumps(record)


def facts(meaning: Meaning, state: State) -> list[list[object]]:
    return [
        [symbol, objects, value]
        for (symbol, objects), value in zip(meaning.keys, state, strict=True)
        if value is not False
    ]
