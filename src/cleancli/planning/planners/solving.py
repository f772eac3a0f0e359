"""Whether to solve a task or to search: by what either costs until the episode ends.

A task that is solved costs its transitions once, and every later plan of the episode is looked up. A search
costs its samples, or its time, in each plan. So as many transitions are enumerated as the searches of the
episode would take time for. What is known after each step tells how many there will be, and enumerating is
given up as soon as they will clearly be too many. That is found out once an episode: later states are tried
again when so few steps are left that the first ones found few enough within as many.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cleancli.compiler.memory import most_bytes
from cleancli.planning import kernels
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options
from cleancli.planning.planners import exact

PER_SECOND, PER_SAMPLE = 4_000_000, 40
"""Transitions that are enumerated and valued in a second, and while a search tries a sequence. Chosen, as
measured where there are millions of them (of fewer, twice as many a second)."""

STATE_WORTH = 8
"""Transitions that take as long as a state does, whose row is copied and found again. Measured with
benchmarks/large_instances.py."""

LEAST = 200_000
"""Transitions that are few enough beside any search. Chosen: some hundredths of a second."""

GLANCE = 0.1
"""The share of a plan's own search that a state is worth which is expected not to be solved. Chosen."""

TELLING, PATIENCE, STEEPEST = 5_000, 3.0, 10.0
"""Growth tells something once so many transitions are found; they are too many where there will be so many
times more than may be; and no growth is greater than the last (its logarithm). Chosen."""

WIDE, FIRST = 2, 64
"""How many transitions each of so many first steps has, which may be very wide, is told by so many of its
states. Chosen."""

TRANSITION_BYTES, STATE_BYTES = 108, 156
"""What a transition with its choice takes at most while room for them grows, and a state without its values:
each three times, in the old room and in twice as much. By planning/kernels/state_graph.py."""

MOST_BYTES = 2 << 30
"""Memory that solving takes at most, however long the horizon is. Chosen."""

_GIVEN_UP = "given up"
"""What `GivenUp` is called among the solutions of a task."""


@dataclass(frozen=True, slots=True)
class Limits:
    """How much may be enumerated to solve a task, and of what is expected to be too much."""

    states: int
    transitions: int
    glance: int


@dataclass(frozen=True, slots=True)
class GivenUp:
    """The first state of an episode that had too many transitions: its horizon, and how many each step had,
    the last one by what a part of it had."""

    horizon: int
    layers: tuple[float, ...]

    def expected(self, steps: int) -> float:
        """Transitions within so many steps."""
        return projected(self.layers[:steps], max(steps - len(self.layers), 0))


def limits(prepared: Prepared, options: Options, share: float) -> Limits:
    """What costs `share` times as much as the searches from the first state of the episode on; less where
    the memory is less."""
    task, given_up = prepared.task, _given_up(prepared)
    horizon = max(task.horizon if given_up is None else given_up.horizon, 0)
    limit = options.time_limit
    plan = PER_SAMPLE * options.samples if limit is None else PER_SECOND * limit
    half, values = min(most_bytes(), MOST_BYTES) // 2, 12 * (len(task.variables) + horizon + 1)
    transitions = int(min(max(share * plan * horizon, LEAST), half // TRANSITION_BYTES))
    states = min(transitions // STATE_WORTH, half // (STATE_BYTES + values))
    return Limits(states, transitions, int(min(GLANCE * max(share * plan, LEAST), transitions)))


def solution(prepared: Prepared, limits: Limits) -> exact.Solution | None:
    """The best policy; None where that takes more than the limits allow."""
    known = exact.kept(prepared, limits.states, limits.transitions)
    if known is not None:
        return known
    given_up, horizon, most = _given_up(prepared), max(prepared.task.horizon, 0), limits
    if given_up is not None and 2 * given_up.expected(horizon) > limits.transitions:
        most = Limits(limits.states, limits.glance, limits.glance)
    found = within_reach(prepared, most, WIDE)  # before time is spent on what could be forgotten
    if not isinstance(found, GivenUp):
        found = within_reach(prepared.forgetful, most)
    if not isinstance(found, GivenUp):
        return exact.solved(prepared, found)
    if given_up is None:
        prepared.solutions[_GIVEN_UP] = found
    return None


def _given_up(prepared: Prepared) -> GivenUp | None:
    known: GivenUp | None = prepared.solutions.get(_GIVEN_UP)
    return known


def within_reach(prepared: Prepared, limits: Limits, steps: int | None = None) -> Any | GivenUp:
    """The enumeration (kernels.state_graph.Enumeration) of all states that can be reached within so many
    steps, or within the horizon; what was found where they have too many transitions, or where within the
    horizon there will be too many by what the first steps say."""
    process, task, most = prepared.process, prepared.task, limits.transitions
    horizon, layers = max(task.horizon, 0), list[float]()
    enumeration = kernels.state_graph.Enumeration(process, task.initial, limits.states, edges=most)
    bound = math.prod(process.sizes.tolist()) * enumeration.most
    while enumeration.frontier and len(layers) < min(horizon, horizon if steps is None else steps):
        states, expanded, before = len(enumeration.frontier), enumeration.expanded, enumeration.transitions
        layers.append(0.0)
        few = min(FIRST, states) if len(layers) <= WIDE else 0
        for part in filter(None, (few, states - few)):
            room, found = enumeration.expand(part), enumeration.transitions
            layers[-1] = (found - before) * states / max(enumeration.expanded - expanded, 1)
            ahead = min(projected(layers, horizon - len(layers)), bound) if found >= TELLING else 0.0
            if not room or ahead > most * max(PATIENCE, math.sqrt(most / max(found, 1))):
                return GivenUp(horizon, tuple(layers))
    return enumeration


def projected(layers: Sequence[float], steps: int) -> float:
    """How many transitions there will be in all after so many more steps, by those that each step so far has
    found. Their growth is taken to fall on as it did: by the same share from step to step, where it has
    fallen. Of what the last steps say one by one, in pairs, and in threes, the least."""
    known, guesses = [1.0, *layers], list[float]()
    for stride in (1, 2, 3):
        if len(known) > 2 * stride and min(known[-1 - 2 * stride :]) > 0:
            last, middle, first = (math.log(known[-1 - i * stride]) for i in range(3))
            growth, before = (last - middle) / stride, (middle - first) / stride
            falling = (growth / before) ** (1 / stride) if 0 < growth < before else 1.0
            guesses.append(_continued(layers, growth, falling, steps))
    return min(guesses, default=float(sum(layers)))


def _continued(layers: Sequence[float], growth: float, falling: float, steps: int) -> float:
    total, layer = float(sum(layers)), float(layers[-1])
    for _ in range(steps):
        growth *= falling
        layer *= math.exp(min(growth, STEEPEST))
        total += layer
    return total
