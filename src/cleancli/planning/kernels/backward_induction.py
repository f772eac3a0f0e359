"""The best policy over the states that can be reached within a horizon, compiled (Bellman 1957).

The meaning is that of compiler/semantics.py.
"""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Floats, Ints
from cleancli.compiler.lowering.state_tables import Process
from cleancli.compiler.semantics import idle_worth
from cleancli.planning.kernels.jit import better, njit, standing_earliness
from cleancli.planning.kernels.state_graph import Graph


@njit(cache=True, nogil=True)
def _stage(
    g: Graph,
    payment: Floats,
    discount: Floats,
    idle: float,
    left: int,
    later: Floats,
    now: Floats,
    best: Ints,
) -> None:
    """One step of backward induction with so many steps left, for as many states as `now` (2, n) and `best`
    have. `now` and `later` are values and their earliness (planning/preference.py)."""
    choice_start, choice_action, choice_reward = g.choice_start, g.choice_action, g.choice_reward
    edge_start, edge_successor, edge_probability = g.edge_start, g.edge_successor, g.edge_probability
    standing, choice_progress = g.standing, g.choice_progress
    for s in range(len(best)):
        chosen, value = -1, standing[s] * idle
        most, earliness = value, standing[s] * standing_earliness(left)
        for choice in range(choice_start[s], choice_start[s + 1]):
            expected, early = 0.0, left * choice_progress[choice]
            for e in range(edge_start[choice], edge_start[choice + 1]):
                expected += edge_probability[e] * later[0, edge_successor[e]]
                early += edge_probability[e] * later[1, edge_successor[e]]
            action = choice_action[choice]
            total = payment[action] * choice_reward[choice] + discount[action] * expected
            if better(total, early, most, earliness):
                chosen, value, earliness = action, total, early
            most = max(most, total)
        now[0, s], now[1, s], best[s] = value, earliness, chosen


def backward(graph: Graph, process: Process, discount: float, horizon: int) -> tuple[Floats, Ints]:
    """Optimal values (horizon + 1, N) and actions (horizon, N) per step and state, by backward induction.

    Row t holds what follows from step t on, for the states that can be reached by then, which come first (0
    and -1 for the others). The graph must reach `horizon` steps, or as far as states go. An action of -1
    stops for good, which is always allowed. Rewards and discounts are those of `exact_value`
    (compiler/semantics.py).
    """
    number = len(graph.states)
    values, idle = np.zeros((horizon + 1, number)), idle_worth(discount, horizon)
    later, now = np.zeros((2, 2, number))
    best = np.full((horizon, number), -1, dtype=np.int32)
    for step in reversed(range(horizon)):
        known = int(graph.within[min(step, len(graph.within) - 1)])
        _stage(
            graph,
            process.payment,
            process.discount,
            idle[horizon - step],
            horizon - step,
            later,
            now,
            best[step, :known],
        )
        values[step, :known] = now[0, :known]
        later, now = now, later
    return values, best
