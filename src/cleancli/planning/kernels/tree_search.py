"""A search in policies from outside: the tree of policy_tree.py, grown, asked and given more room."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Ints
from cleancli.compiler.semantics import idle_worth
from cleancli.compiler.task import GroundState
from cleancli.planning.compiled_task import Prepared
from cleancli.planning.kernels.base_policies import RETRIED, STOP, TAIL, Bases, next_choice
from cleancli.planning.kernels.policy_tree import (
    NODES,
    PASSED,
    UNTRIED,
    Manner,
    Tree,
    descents,
    needed,
    policy_mean,
)
from cleancli.planning.kernels.relaxed import relaxed
from cleancli.planning.kernels.state_graph import enter
from cleancli.planning.kernels.transitions import rewarded
from cleancli.planning.policy import Course, Place, Policy
from cleancli.planning.trajectory import followed


class Node(NamedTuple):
    """A node as it is looked at from outside."""

    value: float
    worth: dict[int, float]  # of the actions that were tried


class Search:
    """A tree that grows from the initial state of a task by descents. What it finds depends on the sequence,
    the seed and the number of descents."""

    def __init__(
        self,
        prepared: Prepared,
        sequence: Sequence[int],
        *,
        exploration: float,
        seed: int,
        runs: int = 0,
        greedy: int = 0,
        hope: float = 0.0,
    ) -> None:
        self._task, self._process = prepared.task, prepared.process
        task, horizon, variables = self._task, max(self._task.horizon, 0), len(self._task.variables)
        self._bases = bases_of(prepared, sequence)
        paying = (*self._process.decrease, *self._process.state)
        unit = max(map(abs, paying), default=0.0) or 1.0
        prize = -self._process.decrease[self._process.goal].min(initial=0.0)
        seeded = np.uint64(seed % 2**64)
        self._manner = Manner(runs, greedy, float(exploration), unit, seeded, float(hope), float(prize))
        self._outcomes = int(np.diff(self._process.outcome_start).max(initial=1))
        choices = (self._outcomes + 2) * len(task.actions)
        self._tree = _room(variables + 1, 256 + self._outcomes, 1024 + choices, 1024, horizon)
        self._tree.states[0, :-1] = task.initial
        self.played = 0
        self._descend(0)

    @property
    def solved(self) -> bool:
        """Whether the value is no estimate any more."""
        return bool(self._tree.known[0])

    @property
    def value(self) -> float:
        """What the tree takes the initial state to be worth."""
        return float(self._tree.value[0])

    def run(self, number: int) -> None:
        """Does so many descents more, or fewer where the value is known before."""
        until = self.played + number
        while self.played < until and not self.solved:
            self.played += self._descend(until - self.played)
            if self.played < until and not self.solved:
                self._tree = _grown(self._tree, self._outcomes, len(self._process.cost))

    def _descend(self, number: int) -> int:
        """Does so many descents while there is room; returns how many."""
        return int(descents(self._process, self._tree, self._bases, self._manner, number, self._outcomes))

    def mean(self, runs: int, seed: int) -> tuple[float, float]:
        """What the policy is worth, and its earliness: over so many runs, or exactly where that is known."""
        if self.solved:
            return float(self._tree.value[0]), float(self._tree.early[0])
        return self.sampled(runs, seed)

    def sampled(self, runs: int, seed: int) -> tuple[float, float]:
        """The same, by runs in any case."""
        found: tuple[float, float] = policy_mean(
            self._process, self._tree, self._bases, runs, np.uint64(seed % 2**64)
        )
        return found

    def node(self, state: GroundState, step: int) -> Node | None:
        """What is known of a state at a step; None where it is not in the tree."""
        t, number = self._tree, self._number(state, step)
        if number is None:
            return None
        choices = slice(t.choice_start[number], t.choice_stop[number])
        tried = zip(t.action[choices].tolist(), t.worth[choices].tolist(), t.tried[choices], strict=True)
        worth = {action: worth for action, worth, times in tried if times}
        return Node(float(t.value[number]), worth)

    def _number(self, state: GroundState, step: int) -> int | None:
        rows = self._tree.states[: self._tree.used[NODES]]
        (found,) = np.nonzero((rows == [*state, step]).all(axis=1))
        return int(found[0]) if found.size else None

    def last_descent(self) -> list[tuple[GroundState, int, int]]:
        """The states, steps and actions that the last descent went through."""
        t, passed = self._tree, list[tuple[GroundState, int, int]]()
        for node, choice in t.path.T[: t.used[PASSED]].tolist():
            *state, step = t.states[node].tolist()
            passed.append((tuple(state), step, int(t.action[choice])))
        return passed

    def policy(self) -> Policy:
        """What the tree says, and beyond it the base policies of its nodes: a place's memory is the node, -1
        beyond the tree, the base policy, and the place in its sequence."""
        return Policy(self._at_node(0), self._after, self._course)

    def course(self) -> Course:
        """The likeliest course of the policy."""
        return self._course(self._at_node(0))

    def _course(self, at: Place) -> Course:
        """The course from a place on, up to where the policy stops."""
        actions, states = list[int](), list[GroundState]()
        while at.action >= 0:
            actions.append(at.action)
            states.append(followed(self._task, at.state, at.action, partial(self._repeats, at)))
            at = self._after(at, states[-1])
        return Course(tuple(actions), tuple(states))

    def _repeats(self, at: Place) -> bool:
        """Whether the policy does the same again where it has changed nothing."""
        return self._after(at, at.state).action == at.action

    def _after(self, at: Place, state: GroundState) -> Place:
        """Where the policy is when its action has led to a state."""
        t, (node, base, place) = self._tree, at.memory
        choice = -1 if node < 0 else int(t.best[node])
        if choice < 0:
            onward = base == TAIL or state != at.state
            return self._beyond(-1, state, at.step + 1, base, place + int(onward))
        nodes = t.successor[t.edge_start[choice] : t.edge_stop[choice]]
        (found,) = np.nonzero((t.states[nodes, :-1] == state).all(axis=1))
        return self._at_node(int(nodes[found[0]]))

    def _at_node(self, node: int) -> Place:
        t, best = self._tree, int(self._tree.best[node])
        *state, step = t.states[node].tolist()
        if best >= 0:
            return Place(tuple(state), int(t.action[best]), step, (node, STOP, step))
        base = STOP if best == -1 else int(t.base[node])
        return self._beyond(node, tuple(state), step, base, int(t.place[node]) if base == RETRIED else step)

    def _beyond(self, node: int, state: GroundState, step: int, base: int, place: int) -> Place:
        """Where a base policy goes on."""
        left, action = len(self._bases.idle) - 1 - step, -1
        if left > 0:
            row = np.array(state, dtype=np.int32)
            place, action = next_choice(self._process, self._bases, row, base, place, left)
        return Place(state, int(action), step, (node, base, int(place)))


def base_mean(
    prepared: Prepared, sequence: Sequence[int], base: int, runs: int, seed: int
) -> tuple[float, float]:
    """What a base policy of a sequence is worth over so many runs of a seed, and its earliness: those of a
    tree that has not grown."""
    process, task, horizon = prepared.process, prepared.task, max(prepared.task.horizon, 0)
    tree = _room(len(task.variables) + 1, 1, 1, 1, horizon)
    tree.states[0, :-1], tree.base[0], tree.best[0] = task.initial, base, UNTRIED
    tree.standing[0] = rewarded(process, tree.states[0, :-1])[1]
    start = np.uint64(seed % 2**64)
    found: tuple[float, float] = policy_mean(process, tree, bases_of(prepared, sequence), runs, start)
    return found


def bases_of(prepared: Prepared, sequence: Sequence[int]) -> Bases:
    """The base policies of a sequence."""
    task = prepared.task
    return Bases(
        np.array(sequence, dtype=np.int32),
        np.array(tuple(dict.fromkeys(sequence)), dtype=np.int32),
        idle_worth(task.discount, max(task.horizon, 0)),
        np.zeros((2, len(task.variables)), dtype=np.int32),
        relaxed(prepared.process),
    )


def _grown(old: Tree, outcomes: int, actions: int) -> Tree:
    """The tree with twice as much of what has become short."""
    sizes = [len(old.states), len(old.action), len(old.chance)]
    wanted = needed(old.used, outcomes, actions)
    nodes, choices, edges = (s * (1 + int(need > s)) for s, need in zip(sizes, wanted, strict=True))
    tree = _room(old.states.shape[1], nodes, choices, edges, old.path.shape[1] - 1)
    for name in Tree._fields:
        if name != "table":
            before: NDArray[Any] = getattr(old, name)
            getattr(tree, name)[: len(before)] = before
    enter(tree.table, tree.hashes, int(old.used[NODES]))
    return tree


def _room(variables: int, nodes: int, choices: int, edges: int, horizon: int) -> Tree:
    """An empty tree with room for so much."""

    def whole(*shape: int) -> Ints:
        return np.zeros(shape, dtype=np.int32)

    return Tree(
        states=whole(nodes, variables),
        hashes=np.zeros(nodes, dtype=np.uint64),
        table=np.full(1 << (2 * nodes).bit_length(), -1, dtype=np.int32),
        decreasing=np.zeros(nodes),
        standing=np.zeros(nodes),
        ahead=np.zeros(nodes),
        value=np.zeros(nodes),
        early=np.zeros(nodes),
        visits=whole(nodes),
        known=np.zeros(nodes, dtype=np.bool_),
        base=whole(nodes),
        place=whole(nodes),
        best=whole(nodes),
        choice_start=whole(nodes),
        choice_stop=whole(nodes),
        action=whole(choices),
        rule=whole(choices),
        rank=np.zeros(choices),
        tried=whole(choices),
        worth=np.zeros(choices),
        soon=np.zeros(choices),
        reward=np.zeros(choices),
        progress=np.zeros(choices),
        closed=np.zeros(choices, dtype=np.bool_),
        edge_start=whole(choices),
        edge_stop=whole(choices),
        successor=whole(edges),
        chance=np.zeros(edges),
        seen=whole(edges),
        used=np.zeros(4, dtype=np.int64),
        path=np.zeros((2, horizon + 1), dtype=np.int64),
    )
