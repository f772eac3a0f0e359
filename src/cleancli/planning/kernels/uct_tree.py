"""UCT's episodes, compiled: which action each node tries next, and what an episode teaches its nodes.

A node is a state with the number of the step that it is seen at; one that several ways lead to is one node.
The meaning of actions and rewards is that of compiler/semantics.py. Guaranteed by `lower_process`: at most
one rule of an action covers a state.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Floats, Ints, Words
from cleancli.compiler.lowering.state_tables import Process
from cleancli.compiler.semantics import idle_worth
from cleancli.compiler.task import GroundState
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.kernels.jit import njit
from cleancli.planning.kernels.rng import GOLDEN, mixed, split, uniform
from cleancli.planning.kernels.state_graph import change, digit, enter, find
from cleancli.planning.kernels.transitions import choosable, draw, rewarded, step


class Tree(NamedTuple):
    """Room for N nodes with M choices, of which those of a node stand together; the first
    stops.

    The choices of a node that is still to come start at its place in `choice_start`.
    """

    states: Ints  # (N, V + 1) the state, and the step at which it is seen
    hashes: Words  # (N,)
    table: Ints  # (2^k,) nodes in the places of their hashes; -1 where free
    decreasing: Floats  # (N,) what is paid for its decrease in the state
    standing: Floats  # (N,) what a step that ends in the state is paid
    visits: Ints  # (N,)
    choice_start: Ints  # (N + 1,)
    action: Ints  # (M,) -1 for nothing
    rule: Ints  # (M,) the rule that covers the state; -1 for nothing
    tried: Ints  # (M,) episodes that took the choice
    total: Floats  # (M,) sum of what they returned, discounted from the choice's step on
    low: Floats  # (H,) least and greatest return seen from each step on
    high: Floats  # (H,)
    unit: Floats  # (1,) most that one reward condition pays: returns are taken to differ by no less


@njit(cache=True, nogil=True)
def add(p: Process, t: Tree, number: int, h: np.uint64) -> None:
    """Makes a node of the row that stands in its place, with choices to try."""
    states, rule, action = t.states, t.rule, t.action
    t.hashes[number] = h
    t.table[find(t.table, t.hashes, states, h, number)] = number
    t.decreasing[number], t.standing[number], _ = rewarded(p, states[number])
    choices = int(t.choice_start[number])
    action[choices] = rule[choices] = -1
    choices += 1
    for a in range(len(p.cost)):
        r = choosable(p, states[number], a)
        if r >= 0:
            action[choices], rule[choices] = a, r
            choices += 1
    t.choice_start[number + 1] = choices


@njit(cache=True, nogil=True)
def _choose(t: Tree, node: int, exploration: float, uniform: float) -> int:
    """An untried choice of a node, or the one with the greatest upper bound (UCB1)."""
    tried, total, first, last = t.tried, t.total, int(t.choice_start[node]), int(t.choice_start[node + 1])
    untried = last - first - t.visits[node]
    if untried > 0:
        skip = int(uniform * untried)
        for choice in range(first, last):
            if tried[choice] == 0:
                if skip == 0:
                    return choice
                skip -= 1
    at = t.states[node, t.states.shape[1] - 1]
    scale = exploration * max(t.high[at] - t.low[at], t.unit[0])
    logarithm = math.log(t.visits[node])
    best, best_bound = -1, -math.inf
    for choice in range(first, last):
        bound = total[choice] / tried[choice] + scale * math.sqrt(logarithm / tried[choice])
        if bound > best_bound:
            best, best_bound = choice, bound
    return best


@njit(cache=True, nogil=True)
def _some_action(p: Process, state: Ints, stream: np.uint64) -> int:
    """One of the actions that are choices in a state, each as likely; -1 where there is none."""
    actions = len(p.cost)
    for i in range(actions):
        action = int(uniform(stream + np.uint64(i) * GOLDEN) * actions)
        if choosable(p, state, action) >= 0:
            return action
    chosen, found = -1, 0
    for action in range(actions):  # few or none fit: the n-th found replaces the one before in 1 of n cases
        if choosable(p, state, action) >= 0:
            found += 1
            if uniform(stream + np.uint64(actions + action) * GOLDEN) * found < 1.0:
                chosen = action
    return chosen


@njit(cache=True, nogil=True)
def _rollout(p: Process, state: Ints, standing: float, idle: Floats, left: int, stream: np.uint64) -> float:
    """Discounted reward of actions drawn until the end, or until none is left; changes the state."""
    value, factor, payment, discount = 0.0, 1.0, p.payment, p.discount
    while left > 0:
        stream = mixed(stream + GOLDEN)
        action = _some_action(p, state, stream)
        if action < 0:
            break
        paid, rise, _ = step(p, state, action, uniform(stream ^ GOLDEN))
        standing += rise
        value += factor * payment[action] * (paid + standing)
        factor *= discount[action]
        left -= 1
    return float(value + factor * standing * idle[left])


@njit(cache=True, nogil=True)
def _follow(p: Process, t: Tree, number: int, node: int, choice: int, uniform: float) -> tuple[int, float]:
    """The node after a choice, which is `number` if it is new, and the reward of the step."""
    states, last = t.states, t.states.shape[1] - 1
    outcome, at = draw(p, int(t.rule[choice]), uniform), int(states[node, last])
    h = change(
        p.effect_start, p.effect_variable, p.effect_value, states, node, number, outcome, t.hashes[node]
    )
    states[number, last] = at + 1
    h ^= digit(last, at) ^ digit(last, at + 1)
    after = int(t.table[find(t.table, t.hashes, states, h, number)])
    if after < 0:
        after = number
        add(p, t, number, h)
    reward = t.decreasing[node] - t.decreasing[after] + t.standing[after]
    return after, reward - p.cost[t.action[choice]]


@njit(cache=True, nogil=True)
def _episode(p: Process, t: Tree, number: int, idle: Floats, exploration: float, stream: np.uint64) -> int:
    """Plays an episode from node 0 and enters what it returned; returns the number of nodes after it."""
    horizon, depth, nodes, stopped = len(idle) - 1, 0, number, False
    node = int(np.int64(0))  # a plain 0 has a type of its own, for which all that is called compiles again
    choices, paid, kept = np.empty(horizon, dtype=np.int64), np.empty(horizon), np.empty(horizon)
    path = np.empty(horizon, dtype=np.int64)
    while depth < horizon and nodes == number and not stopped:
        stream = mixed(stream + GOLDEN)
        choice = _choose(t, node, exploration, uniform(stream))
        path[depth], choices[depth], action = node, choice, int(t.action[choice])
        if action < 0:
            paid[depth], kept[depth], stopped = t.standing[node] * idle[horizon - depth], 0.0, True
        else:
            node, reward = _follow(p, t, number, node, choice, uniform(stream ^ GOLDEN))
            paid[depth], kept[depth] = p.payment[action] * reward, p.discount[action]
            nodes = max(nodes, node + 1)
        depth += 1
    value = 0.0
    if not stopped:
        value = _rollout(p, t.states[node].copy(), t.standing[node], idle, horizon - depth, stream)
    for at in range(depth - 1, -1, -1):
        value = paid[at] + kept[at] * value
        t.visits[path[at]] += 1
        t.tried[choices[at]] += 1
        t.total[choices[at]] += value
        t.low[at], t.high[at] = min(t.low[at], value), max(t.high[at], value)
    return nodes


@njit(cache=True, nogil=True)
def episodes(
    p: Process,
    t: Tree,
    number: int,
    idle: Floats,
    exploration: float,
    seed: np.uint64,
    first: int,
    last: int,
) -> tuple[int, int]:
    """Plays the numbered episodes; returns the number of nodes, and the episode that had no room any more.

    `idle` (horizon + 1,) is what a reward of 1 in each of so many last steps is worth at their start.
    """
    actions = len(p.cost)
    for i in range(first, last):
        if number + 2 > len(t.states) or t.choice_start[number] + actions + 1 > len(t.action):
            return number, i
        number = _episode(p, t, number, idle, exploration, split(seed, np.uint64(i)))
    return number, last


class Search:
    """A tree that grows from the initial state of a task by episodes; what episode i draws depends on the
    seed and i, and on what those before it have taught."""

    def __init__(self, prepared: Prepared, exploration: float, seed: int) -> None:
        task, self._process = prepared.task, prepared.process
        horizon = max(task.horizon, 0)
        self.played = 0
        self._nodes, self._exploration, self._seed = 1, exploration, np.uint64(seed % 2**64)
        self._idle = idle_worth(task.discount, horizon)
        choices = len(task.actions) + 1
        self._tree = _room(len(task.variables) + 1, 256, 256 + 2 * choices, horizon)
        paying = (*self._process.decrease, *self._process.state)
        self._tree.unit[0] = max(map(abs, paying), default=0.0)
        self._tree.states[0, :-1] = task.initial
        add(self._process, self._tree, 0, np.uint64(0))

    def run(self, until: int) -> None:
        """Plays episodes until there are so many."""
        while self.played < until:
            self._nodes, self.played = episodes(
                self._process,
                self._tree,
                self._nodes,
                self._idle,
                self._exploration,
                self._seed,
                self.played,
                until,
            )
            if self.played < until:
                self._tree = _grown(self._tree, self._nodes, len(self._process.cost) + 1)

    def value(self) -> float:
        """The mean return of the choice that was taken most often in the initial state."""
        if not self._tree.visits[0]:  # nothing can be done
            return float(self._tree.standing[0] * self._idle[-1])
        choice = self._best(0)
        return float(self._tree.total[choice] / self._tree.tried[choice])

    def choose(self, step: int, assignment: GroundState) -> int | None:
        """The action taken most often in a state; None where that is nothing, or some choice was never
        tried."""
        t, key = self._tree, [*assignment, step]
        (found,) = np.nonzero((t.states[: self._nodes] == key).all(axis=1))
        if not found.size:
            return None
        node = int(found[0])
        known = t.visits[node] >= t.choice_start[node + 1] - t.choice_start[node]
        if not (known or (node == 0 and t.visits[node])):
            return None
        action = int(t.action[self._best(node)])
        return action if action >= 0 else None

    def _best(self, node: int) -> int:
        """The choice taken most often; of equals the one that returned most, then the first."""
        t = self._tree
        choices = range(t.choice_start[node], t.choice_start[node + 1])
        return max(choices, key=lambda c: (int(t.tried[c]), float(t.total[c]) / max(int(t.tried[c]), 1)))


def _grown(old: Tree, nodes: int, choices: int) -> Tree:
    """The tree with twice as much of what has become short."""
    states, actions = len(old.states), len(old.action)
    states *= 1 + (nodes + 2 > states)
    actions *= 1 + (int(old.choice_start[nodes]) + choices > actions)
    tree = _room(old.states.shape[1], states, actions, len(old.low))
    for name in Tree._fields:
        if name != "table":
            before: NDArray[Any] = getattr(old, name)
            getattr(tree, name)[: len(before)] = before
    enter(tree.table, tree.hashes, nodes)
    return tree


def _room(variables: int, nodes: int, choices: int, horizon: int) -> Tree:
    """An empty tree with room for so much."""
    return Tree(
        states=np.zeros((nodes, variables), dtype=np.int32),
        hashes=np.zeros(nodes, dtype=np.uint64),
        table=np.full(1 << (2 * nodes).bit_length(), -1, dtype=np.int32),
        decreasing=np.zeros(nodes),
        standing=np.zeros(nodes),
        visits=np.zeros(nodes, dtype=np.int32),
        choice_start=np.zeros(nodes + 1, dtype=np.int32),
        action=np.zeros(choices, dtype=np.int32),
        rule=np.zeros(choices, dtype=np.int32),
        tried=np.zeros(choices, dtype=np.int32),
        total=np.zeros(choices),
        low=np.full(horizon, np.inf),
        high=np.full(horizon, -np.inf),
        unit=np.zeros(1),
    )
