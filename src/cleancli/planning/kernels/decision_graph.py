"""Choices with chances as arrays, whatever they are of: strongly connected components, end components, and
smaller graphs in which each end component is one state. Compiled; each function is linear, or as said.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Ints
from cleancli.planning.kernels.jit import compiled


class DecisionGraph(NamedTuple):
    """N states, M choices, and E transitions. The choices of a state lie together, as do the transitions of a
    choice, which go to different states with probabilities above 0 that sum to 1."""

    choice_start: Ints  # (N + 1,) choices in each state
    edge_start: Ints  # (M + 1,) transitions of each choice
    successor: Ints  # (E,)
    probability: Floats  # (E,)
    cost: Floats  # (M,)


class Entering(NamedTuple):
    """The transitions of a graph backwards."""

    start: Ints  # (N + 1,) transitions that lead to each state
    choice: Ints  # (E,) the choice that each belongs to
    state: Ints  # (M,) the state of each choice


class Components(NamedTuple):
    """Strongly connected components of a part of a graph, each before those that lead to it."""

    number: int
    of: Ints  # (N,) the component of each state, -1 outside the part
    start: Ints  # (number + 1,) states of each component
    states: Ints  # (n,) by components


class Quotient(NamedTuple):
    """A graph of B blocks of states of another one, with fixed states behind them that have no choices.

    A choice that may stay in its block is taken until it has left it: its cost and its chances are those of
    leaving. Choices that cannot leave are not there."""

    graph: DecisionGraph
    origin: Ints  # (M',) the choice of the other graph


def entering(graph: DecisionGraph) -> Entering:
    """The transitions backwards; those of a state in the order of their choices."""
    number = len(graph.choice_start) - 1
    start = np.zeros(number + 1, dtype=np.int32)
    start[1:] = np.cumsum(np.bincount(graph.successor, minlength=number))
    choice = np.empty(len(graph.successor), dtype=np.int32)
    _turn(graph, start[:-1].copy(), choice)
    state = np.repeat(np.arange(number, dtype=np.int32), np.diff(graph.choice_start))
    return Entering(start, choice, state)


@compiled
def _turn(g: DecisionGraph, place: Ints, choice: Ints) -> None:
    edge_start, successor = g.edge_start, g.successor
    for c in range(len(edge_start) - 1):
        for e in range(edge_start[c], edge_start[c + 1]):
            after = successor[e]
            choice[place[after]] = c
            place[after] += 1


def reaching(back: Entering, targets: Bools) -> tuple[Bools, Ints]:
    """The states from which some choices lead to a target with a chance above 0, and the same listed, the
    nearest first."""
    reached, queue = targets.copy(), np.empty(len(targets), dtype=np.int32)
    return reached, queue[: _reach(back, reached, queue)]


@compiled
def _reach(back: Entering, reached: Bools, queue: Ints) -> int:
    start, choice, state = back.start, back.choice, back.state
    last = 0
    for s in range(len(reached)):
        if reached[s]:
            queue[last] = s
            last += 1
    first = 0
    while first < last:
        for i in range(start[queue[first]], start[queue[first] + 1]):
            s = state[choice[i]]
            if not reached[s]:
                reached[s] = True
                queue[last] = s
                last += 1
        first += 1
    return last


def solving_order(graph: DecisionGraph, fixed: int) -> Components:
    """The components of all states but the last, which are `fixed`, and within each the states that are
    nearest to those first: so one sweep carries values far."""
    number = len(graph.choice_start) - 1
    part = np.arange(number) < number - fixed
    found = components(graph, part, np.ones(len(graph.cost), dtype=np.bool_))
    nearest = reaching(entering(graph), ~part)[1]
    states = np.empty_like(found.states)
    _sort(found.of, nearest[part[nearest]], found.start[:-1].copy(), states)
    return found._replace(states=states)


def components(graph: DecisionGraph, part: Bools, opened: Bools) -> Components:
    """The strongly connected components of the states in the `part` by choices that are `opened` (Tarjan
    1972)."""
    number = len(part)
    of = np.full(number, -1, dtype=np.int32)
    left = np.empty(number, dtype=np.int32)
    room = np.empty((6, number), dtype=np.int32)
    found, count = _tarjan(graph, part, opened, of, left, room)
    start = np.zeros(found + 1, dtype=np.int32)
    start[1:] = np.cumsum(np.bincount(of[left[:count]], minlength=found))
    states = np.empty(count, dtype=np.int32)
    _sort(of, left[:count], start[:-1].copy(), states)
    return Components(found, of, start, states)


@compiled
def _tarjan(
    g: DecisionGraph, part: Bools, opened: Bools, of: Ints, left: Ints, room: Ints
) -> tuple[int, int]:
    """Fills the component of each state, and the states as they are left; returns how many of both."""
    choice_start, edge_start, successor = g.choice_start, g.edge_start, g.successor
    met, low, choice, edge, path, open_states = room[0], room[1], room[2], room[3], room[4], room[5]
    for s in range(len(part)):
        met[s] = -1
    found, count, time, waiting = 0, 0, 0, 0
    for root in range(len(part)):
        if not part[root] or met[root] >= 0:
            continue
        depth, entered = 0, root
        while depth >= 0:
            if entered >= 0:
                s = entered
                path[depth], open_states[waiting] = s, s
                met[s], low[s] = time, time
                choice[s] = choice_start[s]
                edge[s] = edge_start[choice_start[s]]
                time, waiting, entered = time + 1, waiting + 1, -1
            s = path[depth]
            while choice[s] < choice_start[s + 1] and entered < 0:
                if not opened[choice[s]] or edge[s] == edge_start[choice[s] + 1]:
                    choice[s] += 1
                    edge[s] = edge_start[choice[s]]
                    continue
                after = successor[edge[s]]
                edge[s] += 1
                if part[after]:
                    if met[after] < 0:
                        entered = after
                    elif of[after] < 0:
                        low[s] = min(low[s], met[after])
            if entered >= 0:
                depth += 1
                continue
            left[count] = s
            count += 1
            if low[s] == met[s]:
                while of[s] < 0:
                    waiting -= 1
                    of[open_states[waiting]] = found
                found += 1
            depth -= 1
            if depth >= 0:
                low[path[depth]] = min(low[path[depth]], low[s])
    return found, count


def renumbered(graph: DecisionGraph, states: Ints) -> DecisionGraph:
    """The same graph whose first states are these, in their order, and the others after them as they were: so
    that whoever goes through them so reads memory in its order."""
    number = len(graph.choice_start) - 1
    rest = np.ones(number, dtype=np.bool_)
    rest[states] = False
    before = np.concatenate([states, np.flatnonzero(rest).astype(np.int32)])
    now = np.empty(number, dtype=np.int32)
    now[before] = np.arange(number, dtype=np.int32)
    made = DecisionGraph(*map(np.empty_like, graph))
    _copy(graph, before, now, made)
    return made


@compiled
def _copy(g: DecisionGraph, before: Ints, now: Ints, made: DecisionGraph) -> None:
    """Fills a graph whose states are numbered anew. `before` and `now` are each other's inverse."""
    choice_start, edge_start, successor, probability = (
        g.choice_start,
        g.edge_start,
        g.successor,
        g.probability,
    )
    cost, to_choice, to_edge = g.cost, made.choice_start, made.edge_start
    to, chance, price = made.successor, made.probability, made.cost
    choices, edges = 0, 0
    to_choice[0], to_edge[0] = 0, 0
    for i in range(len(before)):
        for c in range(choice_start[before[i]], choice_start[before[i] + 1]):
            for e in range(edge_start[c], edge_start[c + 1]):
                to[edges], chance[edges] = now[successor[e]], probability[e]
                edges += 1
            price[choices] = cost[c]
            choices += 1
            to_edge[choices] = edges
        to_choice[i + 1] = choices


@compiled
def _sort(of: Ints, left: Ints, place: Ints, states: Ints) -> None:
    for i in range(len(left)):
        s = left[i]
        states[place[of[s]]] = s
        place[of[s]] += 1


def end_components(graph: DecisionGraph, back: Entering, part: Bools, opened: Bools) -> tuple[Ints, Bools]:
    """The maximal end components of the states in the `part` by choices that are `opened`: sets of states in
    which one can stay for ever, from each to each of them (de Alfaro 1997).

    Returns for each state the number of its component, -1 where it is in none, and for each choice whether it
    stays in one. As many rounds of linear time as components fall apart one inside another.
    """
    part, opened = part.copy(), opened.copy()
    queue = np.empty(len(part), dtype=np.int32)
    left = np.zeros(len(part), dtype=np.int32)
    within = np.zeros(len(part), dtype=np.int32)
    _closed(graph, back, part, opened, within, left, queue)
    while True:
        within = components(graph, part, opened).of
        if not _closed(graph, back, part, opened, within, left, queue):
            return within, opened


@compiled
def _closed(
    g: DecisionGraph, back: Entering, part: Bools, opened: Bools, within: Ints, left: Ints, queue: Ints
) -> bool:
    """Closes the choices that may leave the part or their component, and takes states without choices out of
    the part, again and again; whether something was changed."""
    choice_start, edge_start, successor = g.choice_start, g.edge_start, g.successor
    start, choice, state = back.start, back.choice, back.state
    last, changed = 0, False
    for s in range(len(part)):
        left[s] = 0
        for c in range(choice_start[s], choice_start[s + 1]):
            stays = opened[c] and part[s]
            e = edge_start[c]
            while stays and e < edge_start[c + 1]:
                stays = part[successor[e]] and within[successor[e]] == within[s]
                e += 1
            changed = changed or (opened[c] and part[s] and not stays)
            opened[c] = stays
            left[s] += stays
        if part[s] and left[s] == 0:
            queue[last] = s
            last += 1
    first = 0
    while first < last:
        s = queue[first]
        part[s], changed, first = False, True, first + 1
        for i in range(start[s], start[s + 1]):
            c = choice[i]
            if opened[c]:
                opened[c] = False
                left[state[c]] -= 1
                if left[state[c]] == 0:
                    queue[last] = state[c]
                    last += 1
    return changed


def quotient(graph: DecisionGraph, block: Ints, blocks: int, kept: Bools, fixed: int) -> Quotient:
    """The graph of so many blocks by choices that are `kept`. `block` says of each state which it is in, and
    from `blocks` on, which of the `fixed` states it stands for."""
    inside = np.flatnonzero(block < blocks).astype(np.int32)
    start = np.zeros(blocks + 1, dtype=np.int32)
    start[1:] = np.cumsum(np.bincount(block[inside], minlength=blocks))
    members = np.empty(len(inside), dtype=np.int32)
    _sort(block, inside, start[:-1].copy(), members)
    choices, edges = _count(graph, block, blocks, kept)
    made = DecisionGraph(
        np.zeros(blocks + fixed + 1, dtype=np.int32),
        np.zeros(choices + 1, dtype=np.int32),
        np.empty(edges, dtype=np.int32),
        np.empty(edges),
        np.empty(choices),
    )
    origin = np.empty(choices, dtype=np.int32)
    edges = _merge(graph, block, start, members, kept, made, origin)
    made.choice_start[blocks:] = choices
    return Quotient(
        made._replace(successor=made.successor[:edges], probability=made.probability[:edges]), origin
    )


@compiled
def _count(g: DecisionGraph, block: Ints, blocks: int, kept: Bools) -> tuple[int, int]:
    """How many kept choices can leave their block, and how many transitions these have at most."""
    choice_start, edge_start, successor = g.choice_start, g.edge_start, g.successor
    choices, edges = 0, 0
    for s in range(len(block)):
        if block[s] >= blocks:
            continue
        for c in range(choice_start[s], choice_start[s + 1]):
            leaving = 0
            for e in range(edge_start[c], edge_start[c + 1]):
                leaving += block[successor[e]] != block[s]
            if kept[c] and leaving > 0:
                choices += 1
                edges += leaving
    return choices, edges


@compiled
def _merge(
    g: DecisionGraph, block: Ints, start: Ints, members: Ints, kept: Bools, made: DecisionGraph, origin: Ints
) -> int:
    """Fills a quotient; returns the number of its transitions, of which some that were two are one."""
    choice_start, edge_start, successor, probability = (
        g.choice_start,
        g.edge_start,
        g.successor,
        g.probability,
    )
    cost, to, chance = g.cost, made.successor, made.probability
    choices, edges = 0, 0
    for b in range(len(start) - 1):
        made.choice_start[b] = choices
        for m in range(start[b], start[b + 1]):
            for c in range(choice_start[members[m]], choice_start[members[m] + 1]):
                if not kept[c]:
                    continue
                begin, leaving = edges, 0.0
                for e in range(edge_start[c], edge_start[c + 1]):
                    after = block[successor[e]]
                    if after == b:
                        continue
                    leaving += probability[e]
                    at = begin
                    while at < edges and to[at] != after:
                        at += 1
                    if at == edges:
                        to[at], chance[at] = after, 0.0
                        edges += 1
                    chance[at] += probability[e]
                if edges == begin:
                    continue
                if edge_start[c + 1] - edge_start[c] > edges - begin:  # some stay, or have become one
                    for at in range(begin, edges):
                        chance[at] /= leaving
                made.cost[choices] = cost[c] / leaving if leaving < 1.0 else cost[c]
                origin[choices] = c
                choices += 1
                made.edge_start[choices] = edges
    return edges
