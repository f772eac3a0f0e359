"""Search in policies, compiled: a tree of states and steps that grows where the policy so far is uncertain.

Trial-based heuristic tree search (Keller and Helmert 2013) with explicit outcomes: a node is a state with the
number of the step that it is seen at, shared by all ways to it. A descent goes from the initial state, by the
choice with the greatest upper bound (UCB1) and to the outcome that was seen least for its probability. It
tries one new choice, all of whose outcomes become nodes, and each of these is worth what the best of its base
policies is (base_policies.py). On the way back Bellman's equation holds for every choice and node that was
passed. Nodes whose value is known are labelled and not entered any more. The choices of a node are listed
when a descent first comes to it, because most nodes are never entered.

The meaning of actions and rewards is that of compiler/semantics.py. Guaranteed by `lower_process`: at most
one rule of an action covers a state.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Ints, Longs, Words
from cleancli.compiler.lowering.state_tables import Process
from cleancli.planning.kernels.base_policies import (
    FIRST_ROLLOUT,
    GREEDY,
    LAST_ROLLOUT,
    RETRIED,
    STOP,
    Bases,
    chosen,
    mean_rollout,
    next_place,
    one_step,
    rollout,
)
from cleancli.planning.kernels.jit import better, compiled, inlined, inner, standing_earliness
from cleancli.planning.kernels.relaxed import goal_distance, relaxed_plan
from cleancli.planning.kernels.rng import GOLDEN, mixed, split, uniform
from cleancli.planning.kernels.state_graph import change, digit, find
from cleancli.planning.kernels.transitions import choosable, mean_cost, rewarded

NODES, CHOICES, EDGES, PASSED = 0, 1, 2, 3
"""What is counted in `Tree.used`."""

WIDENING, HOPEFUL = 0.5, 0.25
"""A node that was visited n times tries 1 + n^WIDENING choices at most; where it hopes, the fewer exponent.
Chosen."""

UNTRIED = -2
"""The best choice of a node where none was tried."""

SUGGESTED, LISTED, CHANCE = 2.0, 1.0, 0.01
"""What an action gains in the order in which a node's choices are tried: for being what a base policy does
there, for standing in the sequence, and by chance at most, which orders those that nothing else does. Chosen;
what the next step pays adds up to about 1."""


class Tree(NamedTuple):
    """Room for N nodes, M choices of an action, and E transitions; what belongs to one stands together."""

    states: Ints  # (N, V + 1) the state, and the step at which it is seen
    hashes: Words  # (N,)
    table: Ints  # (2^k,) nodes in the places of their hashes; -1 where free
    decreasing: Floats  # (N,) what is paid for its decrease in the state
    standing: Floats  # (N,) what a step that ends in the state is paid
    ahead: Floats  # (N,) whose decrease is progress
    value: Floats  # (N,)
    early: Floats  # (N,) the value's earliness
    visits: Ints  # (N,) descents that went through
    known: Bools  # (N,) whether the value is not an estimate
    base: Ints  # (N,) the best base policy
    place: Ints  # (N,) where the retried sequence is
    best: Ints  # (N,) the best choice that was tried; -1 to stop, UNTRIED where none was tried
    choice_start: Ints  # (N,) -1 while the choices are not listed
    choice_stop: Ints  # (N,)
    action: Ints  # (M,) ascending within a node
    rule: Ints  # (M,) the rule that covers the state
    rank: Floats  # (M,) choices of higher rank are tried first
    tried: Ints  # (M,) descents that took the choice
    worth: Floats  # (M,) what follows from the choice
    soon: Floats  # (M,) its earliness
    reward: Floats  # (M,) expected reward of the step, with what it costs, without its `payment`
    progress: Floats  # (M,) expected progress of the step
    closed: Bools  # (M,) whether all that the choice leads to is known
    edge_start: Ints  # (M,) of choices that were tried
    edge_stop: Ints  # (M,)
    successor: Ints  # (E,)
    chance: Floats  # (E,)
    seen: Ints  # (E,) descents that went this way
    used: Longs  # (4,) nodes, choices and transitions so far, and choices on the path
    path: Longs  # (2, H + 1) nodes and choices of the descent


class Manner(NamedTuple):
    """How a search goes about it."""

    runs: int  # that value each base policy of the sequence in a new node
    greedy: int  # that value the greedy policy there
    exploration: float  # the upper bounds' weight, as a share of what a node gains over stopping
    unit: float  # what a node gains is taken to be no less
    seed: np.uint64
    hope: float  # the power of e that a relaxed plan of all steps that are left takes from a new node; or 0
    prize: float  # what the goal pays


@inner
def _place(t: Tree, node: int, base: int) -> int:
    """How far in its sequence a base policy is that goes on from a node."""
    return int(t.place[node]) if base == RETRIED else int(t.states[node, t.states.shape[1] - 1])


@inner
def _appraise(p: Process, t: Tree, b: Bases, m: Manner, node: int) -> None:
    """Values a new node by the base policies of the sequence; where there is none, by what its choices are
    worth alone, and by the greedy policy."""
    last, horizon = t.states.shape[1] - 1, len(b.idle) - 1
    state, at = t.states[node, :last], int(t.states[node, last])
    left, standing = horizon - at, t.standing[node]
    value, early, best = standing * b.idle[left], standing * standing_earliness(left), STOP
    stream = mixed(m.seed ^ t.hashes[node])
    if left > 0 and len(b.sequence):
        t.place[node] = next_place(p, b, state, int(t.place[node]))
        for base in range(FIRST_ROLLOUT, LAST_ROLLOUT + 1):
            place = _place(t, node, base)
            if m.runs > 0 and chosen(p, b, state, base, place, left, standing) >= 0:
                paid, soon = mean_rollout(p, b, state, base, place, left, m.runs, stream)
                if better(paid, soon, value, early):
                    value, early, best = paid, soon, base
    t.value[node], t.early[node], t.base[node] = value, early, best
    t.choice_start[node], t.best[node], t.visits[node], t.known[node] = -1, UNTRIED, 0, left == 0
    if m.hope > 0.0:
        if left > 0:
            _hope(p, t, b, m, node, left)
    elif left > 0 and not len(b.sequence):
        _list(p, t, b, m, node)
        if t.base[node] == GREEDY and m.greedy:
            paid, soon = mean_rollout(p, b, state, GREEDY, at, left, m.greedy, stream)
            if better(paid, soon, t.value[node], t.early[node]):
                t.value[node], t.early[node] = paid, soon


@inner
def _hope(p: Process, t: Tree, b: Bases, m: Manner, node: int, left: int) -> None:
    """Values a new node by how far the goal is; where it holds, or is out of reach, nothing more comes."""
    cost, early = goal_distance(p, b.relaxed, t.states[node, : t.states.shape[1] - 1])
    if cost == 0.0 or early > left:
        t.known[node] = True
    else:
        t.value[node] += m.prize * math.exp(-m.hope * relaxed_plan(p, b.relaxed) / left)


@inner
def _list(p: Process, t: Tree, b: Bases, m: Manner, node: int) -> None:
    """Lists the choices of a node, in which steps are left, and ranks them. What the best of them is worth
    alone may be more than what the node was taken to be worth."""
    last, horizon, first = t.states.shape[1] - 1, len(b.idle) - 1, int(t.used[CHOICES])
    state, at = t.states[node, :last], int(t.states[node, last])
    left, standing, count = horizon - at, t.standing[node], first
    stopping, suggestion = standing * b.idle[left], -1
    value, early, stream = t.value[node], t.early[node], mixed(m.seed ^ t.hashes[node])
    for action in range(len(p.cost)):
        rule = choosable(p, state, action)
        if rule < 0:
            continue
        gained, soon = one_step(p, b, state, action, rule, left, standing)
        t.action[count], t.rule[count], t.tried[count], t.closed[count] = action, rule, 0, False
        t.rank[count] = (gained - stopping) / m.unit + CHANCE * uniform(stream + np.uint64(count) * GOLDEN)
        if better(gained, soon, value, early):
            value, early, suggestion = gained, soon, action
        count += 1
    t.choice_start[node], t.choice_stop[node], t.used[CHOICES] = first, count, count
    t.known[node] = count == first
    if suggestion >= 0:
        t.value[node], t.early[node], t.base[node] = value, early, GREEDY
    elif t.base[node] != STOP:
        base = int(t.base[node])
        suggestion = chosen(p, b, state, base, _place(t, node, base), left, standing)
    _rank(t, first, count, suggestion, 2 * SUGGESTED)
    for base in range(FIRST_ROLLOUT, LAST_ROLLOUT + 1):
        suggestion = chosen(p, b, state, base, _place(t, node, base), left, standing)
        _rank(t, first, count, suggestion, SUGGESTED)
    for i in range(len(b.priority)):
        _rank(t, first, count, int(b.priority[i]), LISTED)
    if m.hope > 0.0:
        goal_distance(p, b.relaxed, state)
        relaxed_plan(p, b.relaxed)
        for c in range(first, count):
            if b.relaxed.helpful[t.rule[c]]:
                t.rank[c] += SUGGESTED


@inner
def _rank(t: Tree, first: int, last: int, action: int, more: float) -> None:
    """Raises the rank of an action among the choices of a node, if it is one of them."""
    stop = last
    while first < last:
        middle = (first + last) // 2
        if t.action[middle] < action:
            first = middle + 1
        else:
            last = middle
    if first < stop and t.action[first] == action:
        t.rank[first] += more


@inner
def _enter(p: Process, t: Tree, b: Bases, m: Manner, h: np.uint64, place: int) -> int:
    """The node of the row that stands in its place, made if there was none."""
    number = int(t.used[NODES])
    slot = find(t.table, t.hashes, t.states, h, number)
    node = int(t.table[slot])
    if node >= 0:
        return node
    t.hashes[number], t.table[slot], t.place[number] = h, number, place
    decreasing, standing, ahead = rewarded(p, t.states[number])
    t.decreasing[number], t.standing[number], t.ahead[number] = decreasing, standing, ahead
    t.used[NODES] = number + 1
    _appraise(p, t, b, m, number)
    return number


@inner
def _expand(p: Process, t: Tree, b: Bases, m: Manner, node: int, choice: int) -> None:
    """Makes nodes of all outcomes of a choice."""
    last, rule, action = t.states.shape[1] - 1, int(t.rule[choice]), int(t.action[choice])
    at, begin = int(t.states[node, last]), int(t.used[EDGES])
    place, edges = int(t.place[node]), begin
    follows = place < len(b.sequence) and b.sequence[place] == action
    reward, progress = -p.cost[action], 0.0
    for outcome in range(p.outcome_start[rule], p.outcome_start[rule + 1]):
        chance, row = p.probability[outcome], int(t.used[NODES])
        if chance == 0.0:
            continue
        h = change(
            p.effect_start, p.effect_variable, p.effect_value, t.states, node, row, outcome, t.hashes[node]
        )
        t.states[row, last] = at + 1
        h ^= digit(last, at) ^ digit(last, at + 1)
        changed = p.effect_start[outcome] < p.effect_start[outcome + 1]
        after = _enter(p, t, b, m, h, place + 1 if follows and changed else place)
        paid = t.decreasing[node] - t.decreasing[after] + t.standing[after] - p.outcome_cost[outcome]
        reward += chance * paid
        progress += chance * (t.ahead[node] - t.ahead[after] + t.standing[after])
        e = begin
        while e < edges and t.successor[e] != after:
            e += 1
        if e == edges:
            t.successor[e], t.chance[e], t.seen[e] = after, 0.0, 0
            edges += 1
        t.chance[e] += chance
    t.edge_start[choice], t.edge_stop[choice], t.used[EDGES] = begin, edges, edges
    t.reward[choice], t.progress[choice] = reward, progress


@inner
def _back_up(p: Process, t: Tree, b: Bases, node: int, choice: int) -> None:
    """Bellman's equation for a choice that was tried and for its node."""
    last, action = t.states.shape[1] - 1, int(t.action[choice])
    left = len(b.idle) - 1 - int(t.states[node, last])
    expected, early, closed = 0.0, left * t.progress[choice], True
    for e in range(t.edge_start[choice], t.edge_stop[choice]):
        after = t.successor[e]
        expected += t.chance[e] * t.value[after]
        early += t.chance[e] * t.early[after]
        closed = closed and t.known[after]
    t.worth[choice] = p.payment[action] * t.reward[choice] + p.discount[action] * expected
    t.soon[choice], t.closed[choice] = early, closed
    t.tried[choice] += 1
    t.visits[node] += 1
    _settle(t, b, node, left)


@inner
def _settle(t: Tree, b: Bases, node: int, left: int) -> None:
    """The best of stopping and of a node's tried choices."""
    value, early = t.standing[node] * b.idle[left], t.standing[node] * standing_earliness(left)
    most, best, known = value, -1, True
    for c in range(t.choice_start[node], t.choice_stop[node]):
        known = known and t.closed[c]
        if t.tried[c]:
            if better(t.worth[c], t.soon[c], most, early):
                best, value, early = c, t.worth[c], t.soon[c]
            most = max(most, t.worth[c])
    t.value[node], t.early[node], t.best[node], t.known[node] = value, early, best, known


@inner
def _select(t: Tree, b: Bases, m: Manner, node: int) -> int:
    """An untried choice of the highest rank, while a node may widen; else the open one of the greatest upper
    bound."""
    first, last, at = int(t.choice_start[node]), int(t.choice_stop[node]), t.states.shape[1] - 1
    untried, tried, bound, bounded = -1, 0, -math.inf, -1
    left = len(b.idle) - 1 - int(t.states[node, at])
    gain = t.value[node] - t.standing[node] * b.idle[left]
    scale, visits = m.exploration * max(gain, m.unit), max(t.visits[node], 1)
    logarithm = math.log(visits)
    for c in range(first, last):
        if t.tried[c] == 0:
            if untried < 0 or t.rank[c] > t.rank[untried]:
                untried = c
            continue
        tried += 1
        if not t.closed[c]:
            upper = t.worth[c] + scale * math.sqrt(logarithm / t.tried[c])
            if upper > bound:
                bound, bounded = upper, c
    if untried >= 0 and (bounded < 0 or tried < 1.0 + visits ** (HOPEFUL if m.hope > 0.0 else WIDENING)):
        return untried
    return bounded


@inner
def _branch(t: Tree, choice: int) -> int:
    """The transition of a choice, to a node whose value is not known, that was seen least for its chance."""
    best, most = -1, -1.0
    for e in range(t.edge_start[choice], t.edge_stop[choice]):
        share = t.chance[e] / (1.0 + t.seen[e])
        if share > most and not t.known[t.successor[e]]:
            best, most = e, share
    return best


@inner
def _descend(p: Process, t: Tree, b: Bases, m: Manner) -> None:
    """Goes down from the first node, tries a new choice, and backs up what it is worth."""
    node, depth, ended = int(np.int64(0)), 0, False
    while not ended:
        if t.choice_start[node] < 0:
            _list(p, t, b, m, node)
            if t.known[node]:
                break
        choice = _select(t, b, m, node)
        t.path[0, depth], t.path[1, depth] = node, choice
        depth += 1
        if t.tried[choice] == 0:
            _expand(p, t, b, m, node, choice)
            ended = True
            continue
        e = _branch(t, choice)
        ended = e < 0  # other descents have found all of its values
        if not ended:
            t.seen[e] += 1
            node = int(t.successor[e])
    t.used[PASSED] = depth
    for i in range(depth - 1, -1, -1):
        _back_up(p, t, b, int(t.path[0, i]), int(t.path[1, i]))


def needed(used: Longs, outcomes: int, actions: int) -> tuple[int, int, int]:
    """Nodes, choices and transitions for which there must be room before a descent, where a rule has at most
    so many outcomes."""
    most = outcomes + 1  # nodes that become new, and nodes whose choices are listed
    return used[NODES] + most, used[CHOICES] + most * actions, used[EDGES] + outcomes


_needed = inlined(needed)


@compiled
def descents(p: Process, t: Tree, b: Bases, m: Manner, number: int, outcomes: int) -> int:
    """Does so many descents, after making the first node of the row that stands in its place if there is
    none; returns how many it did, before there was no room any more, or the value was known. A rule has at
    most so many `outcomes`."""
    if t.used[NODES] == 0:
        _enter(p, t, b, m, np.uint64(0), 0)
    for i in range(number):
        nodes, choices, edges = _needed(t.used, outcomes, len(p.cost))
        full = nodes > len(t.states) or choices > len(t.action) or edges > len(t.chance)
        if full or t.known[0]:
            return i
        _descend(p, t, b, m)
    return number


@inner
def _run(p: Process, t: Tree, b: Bases, state: Ints, stream: np.uint64) -> tuple[float, float]:
    """Discounted reward of the tree's policy in a run, and its earliness: in nodes where nothing was tried,
    that of their best base policy. Leaves the state anywhere."""
    value, early, factor, last = 0.0, 0.0, 1.0, t.states.shape[1] - 1
    node, left = int(np.int64(0)), len(b.idle) - 1
    while t.best[node] >= 0:
        choice = int(t.best[node])
        stream += GOLDEN
        drawn, e = uniform(stream), int(t.edge_start[choice])
        while e < t.edge_stop[choice] - 1 and drawn >= t.chance[e]:
            drawn -= t.chance[e]
            e += 1
        after, action = int(t.successor[e]), int(t.action[choice])
        paid = t.decreasing[node] - t.decreasing[after] + t.standing[after]
        paid -= p.cost[action] + mean_cost(p, int(t.rule[choice]))
        value += factor * p.payment[action] * paid
        early += left * (t.ahead[node] - t.ahead[after] + t.standing[after])
        factor *= p.discount[action]
        left -= 1
        node = after
    for v in range(last):
        state[v] = t.states[node, v]
    base = STOP if t.best[node] == -1 else int(t.base[node])
    paid, soon = rollout(p, b, state, base, _place(t, node, base), left, t.standing[node], stream)
    return value + factor * paid, early + soon


@compiled
def policy_mean(p: Process, t: Tree, b: Bases, runs: int, seed: np.uint64) -> tuple[float, float]:
    """Means of `_run`'s value and earliness over runs of a seed."""
    value, early = 0.0, 0.0
    for i in range(runs):
        paid, soon = _run(p, t, b, b.scratch[1], split(seed, np.uint64(i)))
        value += paid
        early += soon
    return value / runs, early / runs
