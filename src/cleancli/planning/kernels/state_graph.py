"""The states that can be reached from one, and their transitions, compiled.

The meaning is that of compiler/semantics.py. States are numbered as they are found, breadth first and by
actions in their order, so equal tasks give equal graphs. Guaranteed by `lower_process`: at most one rule of
an action covers a state.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cleancli.array_types import Bools, Floats, Ints, Longs, Words
from cleancli.compiler.lowering.state_tables import Process
from cleancli.compiler.task import GroundState
from cleancli.planning.kernels.jit import compiled, njit
from cleancli.planning.kernels.rng import mixed, split
from cleancli.planning.kernels.transitions import at_goal, covering, rewarded

EDGE_LIMIT = 20_000_000
"""Most transitions that are kept (240 MB). Chosen."""


class Graph(NamedTuple):
    """N states, M choices of an action, and E transitions.

    An action is a choice where a rule covers the state and may change it; if waiting is a choice, wherever a
    rule covers. State 0 is the initial one. States that were found in the last step have no choices. A
    choice's transitions go to different states, one of them perhaps its own, with probabilities that sum to
    1."""

    states: Ints  # (N, V)
    within: Ints  # (steps + 1,) how many states are found within so many steps
    decreasing: Floats  # (N,) what is paid for its decrease in each state
    standing: Floats  # (N,) what a step that ends in each state is paid
    ahead: Floats  # (N,) whose decrease is progress
    choice_start: Ints  # (N + 1,) choices in each state
    choice_action: Ints  # (M,) ascending within a state
    choice_rule: Ints  # (M,) the rule that covers the state
    choice_reward: Floats  # (M,) expected reward of the step, with what it costs, without its `payment`
    choice_progress: Floats  # (M,) expected progress of the step (compiler/semantics.py)
    edge_start: Ints  # (M + 1,) transitions of each choice
    edge_successor: Ints  # (E,)
    edge_probability: Floats  # (E,)


class _Room(NamedTuple):
    """What `_expand` fills: as in `Graph` with room to spare, and the hash table of the states."""

    states: Ints
    hashes: Words
    decreasing: Floats
    standing: Floats
    ahead: Floats
    choice_start: Ints
    choice_action: Ints
    choice_rule: Ints
    choice_reward: Floats
    choice_progress: Floats
    edge_start: Ints
    edge_successor: Ints
    edge_probability: Floats
    table: Ints  # (2^k,) states in the places of their hashes; -1 where free


@njit(cache=True, nogil=True, forceinline=True)
def digit(variable: int, value: int) -> np.uint64:
    """A variable's share of its state's hash, which is the exclusive or of all."""
    return mixed(split(np.uint64(variable + 1), np.uint64(value)))


@njit(cache=True, nogil=True, forceinline=True)
def same(states: Ints, one: int, other: int) -> bool:
    """Whether two rows are equal."""
    for variable in range(states.shape[1]):  # noqa: SIM110 (compiled)
        if states[one, variable] != states[other, variable]:
            return False
    return True


@njit(cache=True, nogil=True)
def enter(table: Ints, hashes: Words, number: int) -> None:
    """Enters the first states into an empty table."""
    mask = np.uint64(len(table) - 1)
    for state in range(number):
        place = hashes[state] & mask
        while table[place] >= 0:
            place = (place + np.uint64(1)) & mask
        table[place] = state


@njit(cache=True, nogil=True, forceinline=True)
def find(table: Ints, hashes: Words, states: Ints, h: np.uint64, row: int) -> np.uint64:
    """The place in the table of a state with the hash h that is equal to a row, or the free place for it."""
    mask = np.uint64(len(table) - 1)
    place = h & mask
    while table[place] >= 0 and not (hashes[table[place]] == h and same(states, table[place], row)):
        place = (place + np.uint64(1)) & mask
    return place


@compiled
def _index(table: Ints, hashes: Words, states: Ints, state: Ints) -> int:
    """The number of a state; -1 where it is not in the table. Hashes differ from the first state's by what is
    different in it."""
    mask, h = np.uint64(len(table) - 1), hashes[0]
    for v in range(len(state)):
        if state[v] != states[0, v]:
            h ^= digit(v, int(states[0, v])) ^ digit(v, int(state[v]))
    place = h & mask
    while table[place] >= 0:
        number, v = table[place], 0
        while v < len(state) and states[number, v] == state[v]:
            v += 1
        if v == len(state):
            return int(number)
        place = (place + np.uint64(1)) & mask
    return -1


@compiled
def _goals(p: Process, states: Ints, found: Bools) -> None:
    """Fills in where the goal holds."""
    for s in range(len(found)):
        found[s] = at_goal(p, states[s])


@njit(cache=True, nogil=True, forceinline=True)
def change(
    start: Ints, variable: Ints, value: Ints, states: Ints, s: int, to: int, outcome: int, h: np.uint64
) -> np.uint64:
    """Writes to a row what an outcome makes of state s; returns its hash, given that of s."""
    for v in range(states.shape[1]):  # assigning the row would compile for seconds
        states[to, v] = states[s, v]
    for e in range(start[outcome], start[outcome + 1]):
        changed, old, new = int(variable[e]), int(states[s, variable[e]]), int(value[e])
        if old != new:
            h ^= digit(changed, old) ^ digit(changed, new)
            states[to, changed] = new
    return h


@njit(cache=True, nogil=True)
def _choices(p: Process, room: _Room, used: Longs, s: int) -> None:
    """Adds the choices in a state and its successors."""
    states, hashes, decreasing, standing = room.states, room.hashes, room.decreasing, room.standing
    ahead, choice_rule, choice_progress = room.ahead, room.choice_rule, room.choice_progress
    choice_action, choice_reward, edge_start = room.choice_action, room.choice_reward, room.edge_start
    edge_successor, edge_probability, table = room.edge_successor, room.edge_probability, room.table
    outcome_start, probability, cost, outcome_cost = p.outcome_start, p.probability, p.cost, p.outcome_cost
    effect_start, effect_variable, effect_value = p.effect_start, p.effect_variable, p.effect_value
    number, choices, edges = used[0], used[1], used[2]
    for action in range(len(cost)):
        rule = covering(p, states[s], action)
        if rule < 0:
            continue
        begin, reward, progress = edges, -cost[action], 0.0
        for outcome in range(outcome_start[rule], outcome_start[rule + 1]):
            if probability[outcome] == 0.0:
                continue
            h = change(effect_start, effect_variable, effect_value, states, s, number, outcome, hashes[s])
            place = find(table, hashes, states, h, number)
            after = int(table[place])
            if after < 0:
                after, number = number, number + 1
                table[place], hashes[after] = after, h
                decreasing[after], standing[after], ahead[after] = rewarded(p, states[after])
            paid = decreasing[s] - decreasing[after] + standing[after] - outcome_cost[outcome]
            reward += probability[outcome] * paid
            progress += probability[outcome] * (ahead[s] - ahead[after] + standing[after])
            e = begin
            while e < edges and edge_successor[e] != after:
                e += 1
            if e == edges:
                edge_successor[e], edge_probability[e] = after, 0.0
                edges += 1
            edge_probability[e] += probability[outcome]
        if edges == begin + 1 and edge_successor[begin] == s and not p.waiting[0]:
            edges = begin
            continue
        choice_action[choices], choice_rule[choices] = action, rule
        choice_reward[choices], choice_progress[choices] = reward, progress
        choices += 1
        edge_start[choices] = edges
    used[0], used[1], used[2] = number, choices, edges


@njit(cache=True, nogil=True)
def _expand(
    p: Process, room: _Room, used: Longs, first: int, last: int, most: int, limits: Longs, ends: bool
) -> int:
    """Adds choices and successors of the states from `first` on, but not where the goal `ends` all; returns
    where it stopped: before `last` if the room may not do (a state has at most `most` transitions), or there
    are more states or transitions than the `limits` (2,)."""
    states, choices, edges = len(room.states), len(room.choice_action), len(room.edge_successor)
    for s in range(first, last):
        short = used[0] + most > states or used[1] + len(p.cost) > choices or used[2] + most > edges
        if short or used[0] > limits[0] or used[2] > limits[1]:
            return s
        if not (ends and at_goal(p, room.states[s])):
            _choices(p, room, used, s)
        room.choice_start[s + 1] = used[1]
    return last


class Enumeration:
    """A graph that grows by one step at a time from an initial state, up to a `limit` of states and one of
    transitions (`edges`); where the goal `ends` all, states in which it holds have no choices. A state has
    fewer transitions than `most`."""

    def __init__(
        self,
        process: Process,
        initial: GroundState,
        limit: int,
        ends: bool = False,
        edges: int = EDGE_LIMIT,
    ) -> None:
        self._process, self._ends = process, ends
        self._limits = np.array([limit, edges], dtype=np.int64)
        outcomes = np.diff(process.outcome_start)
        rules = zip(process.rule_start[:-1], process.rule_start[1:], strict=True)
        self.most = int(sum(outcomes[a:b].max(initial=0) for a, b in rules)) + 1
        self._used = np.array([1, 0, 0], dtype=np.int64)
        self._within = [1]
        self._expanded, self._layer = 0, 1
        self._room = _room(len(process.sizes), 512 + self.most, len(process.cost) + 1024, 4096 + self.most)
        state = np.asarray(initial, dtype=np.int32)
        assert state.shape == process.sizes.shape
        assert ((state >= 0) & (state < process.sizes)).all()
        self._room.states[0] = state
        room = self._room
        room.decreasing[0], room.standing[0], room.ahead[0] = rewarded(process, state)
        enter(self._room.table, self._room.hashes, 1)

    @property
    def number(self) -> int:
        """States found so far."""
        return int(self._used[0])

    @property
    def transitions(self) -> int:
        """Transitions found so far."""
        return int(self._used[2])

    @property
    def expanded(self) -> int:
        """States that have their choices."""
        return self._expanded

    @property
    def frontier(self) -> range:
        """The states of the last step that have no choices yet."""
        return range(self._expanded, self._layer)

    def expand(self, states: int | None = None) -> bool:
        """Adds the successors of the frontier, or of so many of its states; whether all had room. The step is
        done, and what was found is the frontier, when all states have theirs."""
        first, last = self._expanded, self._layer
        if states is not None:
            last = min(first + states, last)
        while True:
            first = _expand(
                self._process, self._room, self._used, first, last, self.most, self._limits, self._ends
            )
            full = bool((self._used[[0, 2]] > self._limits).any())
            if first == last or full:
                break
            self._grow()
        self._expanded = first
        if first == self._layer:
            self._within.append(self.number)
            self._layer = self.number
        return not full

    def reach(self, steps: int) -> bool:
        """Expands so many steps, or as far as states go; whether all had room."""
        return all(self.expand() for _ in range(steps) if self.frontier)

    def exhaust(self) -> bool:
        """Expands as far as states go; whether all had room."""
        while self.frontier:
            if not self.expand():
                return False
        return True

    def index(self, state: GroundState) -> int:
        """The number of a state; -1 where it was not found."""
        room, row = self._room, np.asarray(state, dtype=np.int32)
        return int(_index(room.table, room.hashes, room.states, row))

    def state(self, number: int) -> GroundState:
        """A state by its number."""
        return tuple(self._room.states[number].tolist())

    def goals(self) -> Bools:
        """Whether the goal holds in each of the states."""
        found = np.zeros(self.number, dtype=np.bool_)
        _goals(self._process, self._room.states, found)
        return found

    def keep(self, layer: range, kept: Ints) -> None:
        """Forgets the frontier but for some of its states (ascending), and choices that lead to the others.

        `layer` are the states that were expanded last. Each choice has one transition.
        """
        room, (number, choices, edges) = self._room, self._used.tolist()
        assert choices == edges
        renumbered = np.full(number, -1, dtype=np.int32)
        renumbered[: layer.stop] = np.arange(layer.stop)
        renumbered[kept] = layer.stop + np.arange(len(kept))
        last = slice(room.choice_start[layer.start], choices)
        after = renumbered[room.edge_successor[last]]
        stays = after >= 0
        room.edge_successor[last.start : last.start + stays.sum()] = after[stays]
        for array in (room.choice_action, room.choice_rule, room.choice_reward, room.choice_progress):
            array[last.start : last.start + stays.sum()] = array[last][stays]
        before = np.concatenate([[0], np.cumsum(stays)])
        starts = room.choice_start[layer.start : layer.stop + 1]
        starts[:] = last.start + before[starts - last.start]
        for rows in (room.states, room.hashes, room.decreasing, room.standing, room.ahead):
            rows[layer.stop : layer.stop + len(kept)] = rows[kept]
        self._used[:] = layer.stop + len(kept), starts[-1], starts[-1]
        self._within[-1] = self._layer = self.number
        room.table[:] = -1
        enter(room.table, room.hashes, self.number)

    def graph(self) -> Graph:
        """What has been found, valid until the next expansion."""
        room, (number, choices, edges) = self._room, self._used.tolist()
        room.choice_start[self._expanded : number + 1] = choices
        return Graph(
            room.states[:number],
            np.array(self._within, dtype=np.int32),
            room.decreasing[:number],
            room.standing[:number],
            room.ahead[:number],
            room.choice_start[: number + 1],
            room.choice_action[:choices],
            room.choice_rule[:choices],
            room.choice_reward[:choices],
            room.choice_progress[:choices],
            room.edge_start[: choices + 1],
            room.edge_successor[:edges],
            room.edge_probability[:edges],
        )

    def _grow(self) -> None:
        """Doubles what has become short."""
        old, (number, choices, edges) = self._room, self._used.tolist()
        sizes = [
            size * (1 + (used + need > size))
            for used, need, size in (
                (number, self.most, len(old.states)),
                (choices, len(self._process.cost), len(old.choice_action)),
                (edges, self.most, len(old.edge_successor)),
            )
        ]
        self._room = _room(old.states.shape[1], *sizes)
        kept: tuple[NDArray[Any], ...] = old[:-1]
        room: tuple[NDArray[Any], ...] = self._room[:-1]
        for before, after in zip(kept, room, strict=True):
            after[: len(before)] = before
        enter(self._room.table, self._room.hashes, number)


def reachable(process: Process, initial: GroundState, limit: int, steps: int) -> Graph | None:
    """The states within so many steps of one; None where they are more than `limit`, or their transitions
    more than `EDGE_LIMIT`."""
    enumeration = Enumeration(process, initial, limit)
    return enumeration.graph() if enumeration.reach(steps) else None


def _room(variables: int, states: int, choices: int, edges: int) -> _Room:
    """Empty room for so many states, choices and transitions."""
    slots = 1 << (2 * states).bit_length()
    return _Room(
        np.zeros((states, variables), dtype=np.int32),
        np.zeros(states, dtype=np.uint64),
        np.zeros(states),
        np.zeros(states),
        np.zeros(states),
        np.zeros(states + 1, dtype=np.int32),
        np.zeros(choices, dtype=np.int32),
        np.zeros(choices, dtype=np.int32),
        np.zeros(choices),
        np.zeros(choices),
        np.zeros(choices + 1, dtype=np.int32),
        np.zeros(edges, dtype=np.int32),
        np.zeros(edges),
        np.full(slots, -1, dtype=np.int32),
    )
