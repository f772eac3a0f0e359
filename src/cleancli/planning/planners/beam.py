"""The best sequence of a process without chance: layer by layer, and only the best of a wide layer."""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Floats
from cleancli.compiler.lowering.state_tables import Process
from cleancli.compiler.semantics import idle_worth
from cleancli.compiler.task import GroundState
from cleancli.planning import kernels


def best_sequence(
    process: Process, initial: GroundState, discount: float, *, steps: int, width: int
) -> tuple[int, ...]:
    """The actions that pay most, discounted, within so many steps, up to where stopping is preferred.

    Each rule of the process has one outcome. The sequence is the best of all if no step reaches more than
    `width` new states; of more, those are followed that have been paid most on some way to them, with what
    they are paid if nothing is done any more (of equals the first).
    """
    enumeration = kernels.state_graph.Enumeration(process, initial, kernels.state_graph.EDGE_LIMIT)
    idle = idle_worth(discount, steps)
    paid, factor = np.zeros(1), np.ones(1)
    for step in range(steps):
        layer = enumeration.frontier
        if not layer or not enumeration.expand():
            break
        graph = enumeration.graph()
        paid, factor = _ways(process, graph, layer, paid, factor)
        if len(paid) > width and step < steps - 1:
            new = np.asarray(enumeration.frontier)
            worth = paid + factor * graph.standing[new] * idle[steps - step - 1]
            kept = np.sort(np.argsort(-worth, kind="stable")[:width])
            enumeration.keep(layer, new[kept])
            paid, factor = paid[kept], factor[kept]
    graph = enumeration.graph()
    best = kernels.backward_induction.backward(graph, process, discount, steps)[1]
    sequence: list[int] = []
    state = 0
    for step in range(steps):
        action = best[step, state]
        if action < 0:
            break
        choices = range(graph.choice_start[state], graph.choice_start[state + 1])
        state = next(graph.edge_successor[c] for c in choices if graph.choice_action[c] == action)
        sequence.append(int(action))
    return tuple(sequence)


def _ways(
    process: Process, graph: kernels.state_graph.Graph, layer: range, paid: Floats, factor: Floats
) -> tuple[Floats, Floats]:
    """What the best way to each state after a layer has been paid, and what comes then is worth; both are
    given for the layer's states."""
    start = graph.choice_start[layer.start : layer.stop + 1]
    choices = slice(start[0], start[-1])
    action, after = graph.choice_action[choices], graph.edge_successor[choices] - layer.stop
    source = np.repeat(np.arange(len(layer)), np.diff(start))
    value = paid[source] + factor[source] * process.payment[action] * graph.choice_reward[choices]
    order = np.lexsort((-np.arange(len(value)), value))
    order = order[after[order] >= 0]
    new_paid, new_factor = np.zeros((2, len(graph.states) - layer.stop))
    new_paid[after[order]] = value[order]  # the last that is written stays: the best
    new_factor[after[order]] = (factor[source] * process.discount[action])[order]
    return new_paid, new_factor
