"""Compares the Gymnasium environment of a domain and a problem: what it draws, pays and calls over."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from pathlib import Path
from random import Random

import numpy as np

from support.differential import product
from support.differential.comparing_loops import succeeded
from support.differential.comparing_states import compare_frequencies
from support.differential.comparison import Comparison, shown
from support.differential.interpreter import Call, State
from support.differential.product import Grounded, near
from support.differential.worth import Worth

EPISODES = 200
"""So many side by side, as many as draws of which frequencies are compared."""
ACTIONS = 2


def compare_environment(
    comparison: Comparison, folder: Path, grounded: Grounded, worth: Worth, random: Random
) -> None:
    """All episodes begin with one action and go on with any; one that is over is looked at no more."""
    env = product.environment(folder, EPISODES, ACTIONS)
    if env is None:
        return
    env.reset(seed=comparison.seed)
    calls = [(action.name, action.objects) for action in env.task.actions]
    episodes = {place: worth.meaning.initial() for place in range(EPISODES)}
    first = random.randrange(len(calls))
    for step in range(ACTIONS):
        chosen = [random.randrange(len(calls)) if step else first for _ in range(EPISODES)]
        observations, rewards, ended, _, _ = env.step(np.array(chosen))
        after = {place: grounded.state(env.task, tuple(observations[place].tolist())) for place in episodes}
        for place, there in after.items():
            asked = calls[chosen[place]]
            is_over = succeeded(worth, there) or not {*worth.covered(there)} & {*calls}
            left = ACTIONS - step - 1 if is_over else 0
            paid = rewards[place] - float(left * worth.standing(there))
            if not may_come(worth, episodes[place], asked, there, paid):
                here, came = (shown(worth.meaning, state) for state in (episodes[place], there))
                comparison.differ("environment", f"{asked} in {here}: {came}, {paid}")
                return
            comparison.same("environment: over", is_over, bool(ended[place]), shown(worth.meaning, there))
        if step == 0:
            drawn = Counter(after.values())
            compare_frequencies(comparison, worth.after(worth.meaning.initial(), calls[first]), drawn, "")
        comparison.compared["environment"] += len(after)
        episodes = {place: there for place, there in after.items() if not ended[place]}


def may_come(worth: Worth, state: State, asked: Call, there: State, paid: float) -> bool:
    """Whether an action may lead from one state to another and be paid so much."""
    found: set[Fraction] = {due for _, after, due in worth.results(state, asked) if after == there}
    return any(near(due, paid) for due in found)
