"""Compares single steps: transitions, rewards, what `explain` says, and what the symbolic world draws."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from random import Random

from scipy.special import bdtr, bdtrc

from support.differential.comparison import Comparison, shown
from support.differential.interpreter import State
from support.differential.product import Grounded, Loaded
from support.differential.worth import Worth

STATES = 40
"""States whose transitions are compared, of those that are reached."""
DRAWS = 200
RARE = 1e-9
"""A drawn frequency less likely than this is a difference."""


def compare_states(
    comparison: Comparison, grounded: Grounded, worth: Worth, states: tuple[State, ...]
) -> None:
    """Successors with their exact probabilities, the covering rule, and what is paid."""
    meaning, numbers = worth.meaning, grounded.numbers
    for state in states[:STATES]:
        place = shown(meaning, state)
        assignment = grounded.assignment(grounded.task, state)
        if assignment is None:
            comparison.differ("transition", f"{place} is no state of the task")
            continue
        comparison.same("goal", worth.goal_seen(state), grounded.goal(assignment), place)
        comparison.same("standing", worth.standing(state), grounded.standing(assignment), place)
        for asked in worth.calls:
            expected = worth.after(state, asked)
            if asked not in numbers:
                comparison.same("dropped", {state: Fraction(1)}, expected, f"{asked} in {place}")
                comparison.same("dropped", Fraction(0), worth.paid_by_outcome(state, asked), f"{asked}")
                continue
            covering = meaning.covering(asked, state)
            rule, actual = grounded.successors(assignment, numbers[asked])
            comparison.same("transition", expected, actual, f"{asked} in {place}")
            paid = -grounded.outcome_cost(assignment, numbers[asked])
            comparison.same("paid", worth.paid_by_outcome(state, asked), paid, f"{asked} in {place}")
            if expected != {state: Fraction(1)}:
                comparison.same("rule", covering and covering[0].name, rule, f"{asked} in {place}")
            for there in expected:
                after = grounded.assignment(grounded.task, there)
                if after is not None:
                    paid = grounded.reward(assignment, numbers[asked], after)
                    comparison.same("reward", worth.reward(state, asked, there), paid, f"{asked} in {place}")


def compare_explanations(
    comparison: Comparison, loaded: Loaded, worth: Worth, states: tuple[State, ...], random: Random
) -> None:
    """`explain` in the initial state and in some others: the rule, its outcomes and what they change."""
    meaning = worth.meaning
    chosen = [states[0], *random.sample(states, min(2, len(states)))]
    for state in dict.fromkeys(chosen):
        for asked in random.sample(worth.calls, min(6, len(worth.calls))):
            said = loaded.explanation(state, asked)
            covering = meaning.covering(asked, state)
            place = f"{asked} in {shown(meaning, state)}"
            name = None if said.covering is None else said.covering.name
            if not comparison.same("explain", covering and covering[0].name, name, place):
                continue
            if covering is None or said.covering is None:
                others = sum(rule.action == asked[0] for rule in meaning.domain.rules)
                comparison.same("explain", others, len(said.attempts), place)
                continue
            rule, binding = covering
            expected = [
                (
                    outcome.probability,
                    outcome.idle or "change",
                    tuple(meaning.price(each, state, binding) for each in (outcome.reward, outcome.cost)),
                    {
                        (*meaning.key(symbol, objects), value)
                        for (symbol, objects), value in meaning.changes(outcome, binding, state).items()
                        if value != state[meaning.place[symbol, objects]]
                    },
                )
                for outcome in rule.outcomes
                if outcome.probability
            ]
            actual = [
                (
                    outcome.probability,
                    outcome.kind.value,
                    (outcome.reward, outcome.cost),
                    {
                        (*meaning.key(each.fact.symbol, each.fact.objects), each.fact.value)
                        for each in outcome.changes
                    },
                )
                for outcome in said.covering.outcomes
                if outcome.probability
            ]
            comparison.same("explain", expected, actual, place)


def compare_draws(
    comparison: Comparison, grounded: Grounded, worth: Worth, states: tuple[State, ...], random: Random
) -> None:
    """How often the symbolic world draws each result, and what it pays for it."""
    meaning = worth.meaning
    pairs = [
        (state, asked)
        for state in random.sample(states[:STATES], min(6, len(states[:STATES])))
        for asked in worth.calls
        if len(worth.after(state, asked)) > 1 or random.random() < 0.1
    ]
    for state, asked in random.sample(pairs, min(3, len(pairs))):
        place = f"{asked} in {shown(meaning, state)}"
        expected = worth.after(state, asked)
        drawn: Counter[State] = Counter()
        for step, after in grounded.draws(state, asked, DRAWS, comparison.seed):
            drawn[after] += 1
            if after not in expected:
                comparison.differ("draw", f"{place}: {shown(meaning, after)} cannot follow")
                break
            if drawn[after] == 1:
                paid = [each for _, there, each in worth.results(state, asked) if there == after]
                closest = min(paid, key=lambda each: abs(float(each) - step.reward))
                comparison.same("drawn reward", closest, step.reward, place)
        else:
            compare_frequencies(comparison, expected, drawn, place)


def tail_of(count: int, share: float) -> float:
    """How probable so few or so many of `DRAWS` are, whichever is less."""
    above = bdtrc(count - 1, DRAWS, share) if count else 1.0
    return float(min(bdtr(count, DRAWS, share), above))


def compare_frequencies(
    comparison: Comparison, expected: dict[State, Fraction], drawn: Counter[State], place: str
) -> None:
    for after, probability in expected.items():
        share, count = float(probability), drawn[after]
        comparison.compared["frequency"] += 1
        tail = tail_of(count, share)
        if tail < RARE:
            comparison.differ("frequency", f"{place}: {count} of {DRAWS} at {probability}")
    likely = [(drawn[after], float(share) * DRAWS) for after, share in expected.items()]
    if len(likely) > 1 and all(mean >= 5 for _, mean in likely):
        comparison.chi += sum((count - mean) ** 2 / mean for count, mean in likely)
        comparison.freedom += len(likely) - 1
