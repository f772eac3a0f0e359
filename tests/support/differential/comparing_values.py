"""Compares values: of sequences, of the best that can be done, and of what is planned."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

from support.differential import product
from support.differential.comparison import Comparison
from support.differential.interpreter import Call, State
from support.differential.product import Grounded
from support.differential.worth import STOP, Worth

ASKED = 0.45
"""The share of domains that the command line is asked about; what it calls is asked about all of them."""


def compare_values(
    comparison: Comparison, folder: Path, grounded: Grounded, worth: Worth, whole: bool, random: Random
) -> None:
    timed = all(action.duration for action in worth.meaning.domain.actions) and worth.discount > 0
    by_time = Worth(worth.meaning, by_time=True) if timed and moves(worth) else None
    try:
        if worth.calls:
            if random.random() < ASKED:
                compare_asked_sequence(comparison, folder, worth, random)
            if by_time is not None and random.random() < ASKED / 2:
                compare_sequence_by_time(comparison, folder, by_time, random)
        for scale in (worth, by_time):
            if scale is not None and worth.calls:
                compare_sequences(comparison, grounded, scale, random)
            if scale is not None and whole:
                compare_optimum(comparison, folder, grounded, scale, random)
    except product.NoAnswer as refused:
        comparison.differ("command", str(refused))


def moves(worth: Worth) -> bool:
    """Whether any outcome sets anything, so that time has a scale."""
    return any(outcome.effects for rule in worth.meaning.domain.rules for outcome in rule.outcomes)


def drawn_sequence(worth: Worth, random: Random) -> list[Call]:
    """Mostly of actions that a rule covers in a state that may be reached; perhaps beyond the horizon."""
    state, sequence = worth.meaning.initial(), list[Call]()
    for _ in range(random.randint(1, 5)):
        choices = worth.covered(state) if random.random() < 0.85 else worth.calls
        asked = random.choice(choices or worth.calls)
        sequence.append(asked)
        state = random.choice(list(worth.after(state, asked)))
    return sequence


def compare_sequences(comparison: Comparison, grounded: Grounded, worth: Worth, random: Random) -> None:
    """`exact_value`, as the interpreter counts."""
    horizon = worth.horizon(worth.meaning.initial())
    for _ in range(3):
        sequence = drawn_sequence(worth, random)[: max(horizon, 0)]
        value = grounded.value(sequence, timed=worth.by_time)
        if value is not None:
            comparison.same("exact value", worth.of_sequence(sequence), value, f"{sequence} {worth.by_time}")


def compare_asked_sequence(comparison: Comparison, folder: Path, worth: Worth, random: Random) -> None:
    """`plan --evaluate --explain`."""
    sequence = drawn_sequence(worth, random)
    said = product.evaluated(folder, sequence)
    value = worth.of_sequence(sequence)
    comparison.same("horizon", worth.horizon(worth.meaning.initial()), said["horizon"])
    comparison.same("sequence", value, said["exact"], str(sequence))
    sampled = said["sampled"]
    comparison.compared["sampled value"] += 1
    if abs(sampled["value"] - float(value)) > 7 * sampled["error"] + 1e-9:
        comparison.differ("sampled value", f"{sequence}: expected {float(value)}, got {sampled}")
    compare_forecast(comparison, worth, sequence, said["explained"]["steps"])


def compare_sequence_by_time(comparison: Comparison, folder: Path, worth: Worth, random: Random) -> None:
    sequence = drawn_sequence(worth, random)
    said = product.evaluated(folder, sequence, timed=True)
    comparison.same("sequence by time", worth.of_sequence(sequence), said["exact"], str(sequence))


def compare_forecast(
    comparison: Comparison, worth: Worth, sequence: list[Call], steps: list[dict[str, Any]]
) -> None:
    """`plan --explain`: which rules cover each step, what may come of it, and what it is paid."""
    meaning = worth.meaning
    distribution = {meaning.initial(): Fraction(1)}
    if steps:
        compare_first_step(comparison, worth, sequence[0], steps[0])
    for asked, said in zip(sequence, steps, strict=False):
        place = f"{asked} of {sequence}"
        rules: dict[str, Fraction] = {}
        noise = changing = setting = Fraction(0)
        for state, chance in distribution.items():
            covering = meaning.covering(asked, state)
            if covering is None:
                continue
            rule, binding = covering
            rules[rule.name] = rules.get(rule.name, Fraction(0)) + chance
            for outcome in rule.outcomes:
                share = chance * outcome.probability
                noise += share * (outcome.idle == "noise")
                setting += share * bool(outcome.effects)
                if share and meaning.after(outcome, binding, state) != state:
                    changing += share
        reward = sum((p * worth.expected(state, asked) for state, p in distribution.items()), Fraction(0))
        comparison.same("forecast: reward", reward, said["reward"], place)
        comparison.same("forecast: covered", sum(rules.values(), Fraction(0)), said["covered"], place)
        named = {each["rule"]: each["probability"] for each in said["rules"]}
        comparison.same("forecast: rules", sorted(rules), sorted(named), place)
        for name in rules.keys() & named.keys():
            comparison.same("forecast: rules", rules[name], named[name], f"{name}, {place}")
        kinds = Counter[str]()
        for each in said["outcomes"]:
            kinds[each["kind"]] += each["probability"]
        comparison.same("forecast: noise", noise, kinds["noise"], place)
        comparison.same("forecast: sum", sum(rules.values(), Fraction(0)), sum(kinds.values()) + 0.0, place)
        # What sets only what is there already is a change or nothing, as one likes.
        if not changing - Fraction(1, 10**9) <= kinds["change"] <= setting + Fraction(1, 10**9):
            text = f"{place}: {kinds['change']} is not from {changing} to {setting}"
            comparison.differ("forecast: change", text)
        distribution = worth.spread(distribution, asked)


def compare_first_step(comparison: Comparison, worth: Worth, asked: Call, said: dict[str, Any]) -> None:
    """The effects that are told of the first step lead to the states that may follow."""
    start = worth.meaning.initial()
    found: dict[State, float] = {start: 1.0 - said["covered"]}
    for each in said["outcomes"]:
        after = product.changed(worth.meaning, start, each["effects"])
        found[after] = found.get(after, 0.0) + each["probability"]
    for state in {*found, *worth.after(start, asked)}:
        expected = worth.after(start, asked).get(state, Fraction(0))
        comparison.same("forecast: effects", expected, found.get(state, 0.0), f"{asked}: {said['outcomes']}")


def compare_optimum(
    comparison: Comparison, folder: Path, grounded: Grounded, worth: Worth, random: Random
) -> None:
    """The value of acting best, and that the plan is a likeliest course of a best policy."""
    start = worth.meaning.initial()
    horizon = max(worth.horizon(start), 0)
    best = worth.choice(start, horizon)
    what = "optimum by time" if worth.by_time else "optimum"
    ways = [("exact", "rational"), (random.choice(("exact", "prada+")), "float")]
    for planner, arithmetic in ways[worth.by_time :]:
        asked = random.random() < ASKED / 6
        plan, value = (
            product.planned(folder, planner, arithmetic, timed=worth.by_time)
            if asked
            else grounded.plan(planner, arithmetic, timed=worth.by_time)
        )
        name = f"{planner} {arithmetic}"
        if comparison.same(what, best.value, value, f"{name} says {plan}, best are {best.equals}"):
            compare_course(comparison, worth, plan, horizon, name)


def compare_course(comparison: Comparison, worth: Worth, plan: list[Call], horizon: int, name: str) -> None:
    """Each action is one of the best where it is done, and at the end stopping is best.

    The state follows the likeliest result where that is more likely than all others together, and where that
    changes nothing and the action is then done again, one that changes something (docs/planning.md);
    otherwise any that may come, since planners may forget what no longer matters, and so join results.
    """
    states = {worth.meaning.initial()}
    certain = True
    for step, asked in enumerate((*plan, STOP)):
        left = horizon - step
        comparison.compared["course"] += 1
        fitting = {state for state in states if asked in worth.choice(state, left).equals}
        if not fitting:
            best = {worth.choice(state, left).equals for state in states}
            comparison.differ("course", f"{name}: {plan}: step {step} is {asked}, best are {best}")
            return
        if asked is STOP:
            break
        states = set()
        for state in fitting:
            after = worth.after(state, asked)
            likely = {there for there, chance in after.items() if chance > Fraction(1, 2)}
            changed = after.keys() - {state}
            again = worth.choice(state, left - 1).equals
            if state in likely and changed and asked in again:
                # What fails and is tried again stands there once; of equals the policy may try another.
                likely = changed | (likely if len(again) > 1 else set())
            states |= likely or set(after)
            certain = certain and len(after) == 1
    if certain:
        value = worth.choice(worth.meaning.initial(), horizon).value
        comparison.same("value of the plan", value, worth.of_sequence(plan), f"{name}: {plan}")
