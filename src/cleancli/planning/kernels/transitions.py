"""A task's process, compiled: covering rules, drawn and listed transitions, and rewards of exact states.

The meaning is that of compiler/semantics.py, of which this is the fast form. A state is (V,) value indices.
Guaranteed by `lower_process`: indices are in range, and at most one rule of an action covers a state.
"""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Bools, Floats, Ints
from cleancli.compiler.lowering.state_tables import Process
from cleancli.planning.kernels.jit import compiled, inlined, njit
from cleancli.planning.kernels.rng import GOLDEN, split, uniform


@inlined
def _holds(start: Ints, variable: Ints, row: Ints, allowed: Bools, state: Ints, condition: int) -> bool:
    for i in range(start[condition], start[condition + 1]):  # noqa: SIM110 (compiled)
        if not allowed[row[i] + state[variable[i]]]:
            return False
    return True


@compiled
def holds(p: Process, state: Ints, condition: int) -> bool:
    """Whether a condition (a rule's, or one that is asked) holds."""
    return _holds(p.literal_start, p.literal_variable, p.literal_row, p.allowed, state, condition)


@compiled
def covering(p: Process, state: Ints, action: int) -> int:
    """The rule of the action that covers the state; -1 where the default rule does."""
    start, variable, row, allowed = p.literal_start, p.literal_variable, p.literal_row, p.allowed
    for rule in range(p.rule_start[action], p.rule_start[action + 1]):
        if _holds(start, variable, row, allowed, state, rule):
            return rule
    return -1


@compiled
def choosable(p: Process, state: Ints, action: int) -> int:
    """The rule of the action that covers the state, if the action is a choice there: it may change the state,
    or waiting is a choice; -1 otherwise."""
    rule = covering(p, state, action)
    if rule < 0 or p.waiting[0]:
        return rule
    for outcome in range(p.outcome_start[rule], p.outcome_start[rule + 1]):
        if p.probability[outcome] > 0.0:
            for i in range(p.effect_start[outcome], p.effect_start[outcome + 1]):
                if state[p.effect_variable[i]] != p.effect_value[i]:
                    return rule
    return -1


@compiled
def draw(p: Process, rule: int, uniform: float) -> int:
    """The outcome (a row of `probability`) of a rule for a number in [0, 1)."""
    outcome, last, cumulated = int(p.outcome_start[rule]), p.outcome_start[rule + 1] - 1, p.cumulated
    while outcome < last and uniform >= cumulated[outcome]:
        outcome += 1
    return outcome


@compiled
def apply(p: Process, state: Ints, outcome: int) -> None:
    """Changes the state as the outcome says."""
    variable, value = p.effect_variable, p.effect_value
    for i in range(p.effect_start[outcome], p.effect_start[outcome + 1]):
        state[variable[i]] = value[i]


@compiled
def rewarded(p: Process, state: Ints) -> tuple[float, float, float]:
    """What is paid for its decrease (#dirt of eq. 2), what a step that ends in the state is paid, and whose
    decrease is progress."""
    start, variable, row, allowed = p.literal_start, p.literal_variable, p.literal_row, p.allowed
    rules, decreasing, standing, ahead = len(p.outcome_start) - 1, 0.0, p.constant[0], 0.0
    for c in range(len(p.decrease)):
        if _holds(start, variable, row, allowed, state, rules + c):
            decreasing += p.decrease[c]
            standing += p.state[c]
            ahead += p.advance[c]
    return decreasing, standing, ahead


@compiled
def at_goal(p: Process, state: Ints) -> bool:
    """Whether the problem's goal holds, where it does not always do."""
    start, variable, row, allowed = p.literal_start, p.literal_variable, p.literal_row, p.allowed
    rules = len(p.outcome_start) - 1
    for c in range(len(p.goal)):
        if p.goal[c] and _holds(start, variable, row, allowed, state, rules + c):
            return True
    return False


@compiled
def touched(p: Process, state: Ints, action: int) -> tuple[float, float, float]:
    """The share of `rewarded` that the action can change."""
    start, variable, row, allowed = p.literal_start, p.literal_variable, p.literal_row, p.allowed
    rules, decrease, standing, advance = len(p.outcome_start) - 1, p.decrease, p.state, p.advance
    decreasing, paid, ahead, conditions = 0.0, 0.0, 0.0, p.touched_reward
    for i in range(p.touched_reward_start[action], p.touched_reward_start[action + 1]):
        c = conditions[i]
        if _holds(start, variable, row, allowed, state, rules + c):
            decreasing += decrease[c]
            paid += standing[c]
            ahead += advance[c]
    return decreasing, paid, ahead


@compiled
def carry_out(p: Process, state: Ints, action: int, outcome: int) -> tuple[float, float, float]:
    """Changes the state as an outcome of the action says (none where it is -1); returns what the action pays
    (eq. 2, less what it costs), the rise of what doing nothing is paid from then on, and the decrease that is
    progress."""
    if outcome < 0:
        return -p.cost[action], 0.0, 0.0
    spent = p.cost[action] + p.outcome_cost[outcome]
    if p.effect_start[outcome] == p.effect_start[outcome + 1]:
        return -spent, 0.0, 0.0
    decreasing, standing, ahead = touched(p, state, action)
    apply(p, state, outcome)
    left, after, still = touched(p, state, action)
    return decreasing - left - spent, after - standing, ahead - still


@compiled
def mean_cost(p: Process, rule: int) -> float:
    """What the reward of a step loses on average by which outcome of a rule happens."""
    mean = 0.0
    for outcome in range(p.outcome_start[rule], p.outcome_start[rule + 1]):
        mean += p.probability[outcome] * p.outcome_cost[outcome]
    return mean


@compiled
def step(p: Process, state: Ints, action: int, uniform: float) -> tuple[float, float, float]:
    """Draws a transition by an action and changes the state; returns what `carry_out` does."""
    rule = covering(p, state, action)
    return carry_out(p, state, action, -1 if rule < 0 else draw(p, rule, uniform))


@njit(cache=True, nogil=True)
def sequence_value(
    p: Process, initial: Ints, actions: Ints, idle: Floats, samples: int, seed: np.uint64
) -> tuple[float, float]:
    """Mean discounted reward of a sequence over rollouts from a state, and the mean of its square.

    After the sequence nothing is done: `idle[k]` is what a reward of 1 in each of k last steps is worth at
    their start; the last k is the horizon. Run i depends on the seed and i alone, so sequences are compared
    on the same draws.
    """
    return _sequence_value(p, initial, np.empty_like(initial), actions, idle, samples, seed)


@compiled
def _sequence_value(
    p: Process, initial: Ints, state: Ints, actions: Ints, idle: Floats, samples: int, seed: np.uint64
) -> tuple[float, float]:
    standing = rewarded(p, initial)[1]
    total, squares = 0.0, 0.0
    rest = max(len(idle) - 1 - len(actions), 0)
    for sample in range(samples):
        for v in range(len(initial)):
            state[v] = initial[v]
        stream = split(seed, np.uint64(sample))
        value, factor, now = 0.0, 1.0, standing
        for place in range(len(actions)):
            stream += GOLDEN
            paid, rise, _ = step(p, state, actions[place], uniform(stream))
            now += rise
            value += factor * p.payment[actions[place]] * (paid + now)
            factor *= p.discount[actions[place]]
        value += factor * now * idle[rest]
        total += value
        squares += value * value
    return total / samples, squares / samples
