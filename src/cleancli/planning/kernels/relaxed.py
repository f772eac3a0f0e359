"""How far a goal is if variables keep all values that they have had, compiled (delete relaxation; Bonet and
Geffner 2001).

A slot is a variable with one of its values. What a slot costs is the least, over the outcomes that set it, of
the tries that its probability asks for, and of what the literals of the rule cost together (h_add). How
early it can be had is the same with one try, and the latest of the literals (h_max): no policy can have it
earlier.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Ints
from cleancli.compiler.lowering.state_tables import Process
from cleancli.planning.kernels.jit import compiled, inner
from cleancli.planning.kernels.transitions import apply, choosable


class Relaxed(NamedTuple):
    """Room for S slots and R rules."""

    cost: Floats  # (S,)
    early: Floats  # (S,) steps after which each can be had
    support: Ints  # (S,) the rule that sets it at its cost
    tries: Floats  # (S,) that its outcome takes
    helpful: Bools  # (R,) rules of the relaxed plan
    open: Ints  # (S,) slots whose rules are still to be looked at
    asking_start: Ints  # (S + 1,) rules that ask for each slot
    asking: Ints  # (n,)
    news: Bools  # (R,) whether something that a rule asks for has become cheaper


def relaxed(process: Process) -> Relaxed:
    """Room for a process."""
    slots, rules = int(process.slot_start[-1]), len(process.outcome_start) - 1
    return Relaxed(
        np.zeros(slots),
        np.zeros(slots),
        np.zeros(slots, dtype=np.int32),
        np.zeros(slots),
        np.zeros(rules, dtype=np.bool_),
        np.zeros(slots, dtype=np.int32),
        *_asking(process),
        np.zeros(rules, dtype=np.bool_),
    )


def _asking(process: Process) -> tuple[Ints, Ints]:
    """The rules that ask for each slot, those of one slot together, and where they begin."""
    rules, slots = len(process.outcome_start) - 1, int(process.slot_start[-1])
    literals = int(process.literal_start[rules])
    asked = np.arange(rules, dtype=np.int32).repeat(np.diff(process.literal_start[: rules + 1]))
    rule = asked.repeat(np.diff(process.literal_slot_start[: literals + 1]))
    slot = process.literal_slot[: process.literal_slot_start[literals]]
    start = np.searchsorted(np.sort(slot), np.arange(slots + 1)).astype(np.int32)
    return start, rule[np.argsort(slot, kind="stable")]


@inner
def cheapest(p: Process, r: Relaxed, literal: int) -> int:
    """The slot by which a literal is had at the least cost."""
    best = int(p.literal_slot[p.literal_slot_start[literal]])
    for i in range(p.literal_slot_start[literal] + 1, p.literal_slot_start[literal + 1]):
        if r.cost[p.literal_slot[i]] < r.cost[best]:
            best = int(p.literal_slot[i])
    return best


@inner
def _had(p: Process, r: Relaxed, condition: int) -> tuple[float, float]:
    """What a condition costs, and how early it can hold."""
    cost, early = 0.0, 0.0
    for literal in range(p.literal_start[condition], p.literal_start[condition + 1]):
        least, soonest = math.inf, math.inf
        for i in range(p.literal_slot_start[literal], p.literal_slot_start[literal + 1]):
            least = min(least, r.cost[p.literal_slot[i]])
            soonest = min(soonest, r.early[p.literal_slot[i]])
        cost += least
        early = max(early, soonest)
        if least == math.inf:
            break
    return cost, early


@inner
def _use(p: Process, r: Relaxed, rule: int) -> bool:
    """Lowers what the slots cost that a rule sets, and how early they can be had; whether that is news to
    other rules."""
    told = False
    cost, early = _had(p, r, rule)
    if cost == math.inf:
        return told
    for outcome in range(p.outcome_start[rule], p.outcome_start[rule + 1]):
        if p.probability[outcome] == 0.0:
            continue
        tries = 1.0 / p.probability[outcome]
        for e in range(p.effect_start[outcome], p.effect_start[outcome + 1]):
            slot = p.slot_start[p.effect_variable[e]] + p.effect_value[e]
            lowered = early + 1.0 < r.early[slot]
            r.early[slot] = min(r.early[slot], early + 1.0)
            if cost + tries < r.cost[slot]:
                r.cost[slot], r.support[slot], r.tries[slot] = cost + tries, rule, tries
                lowered = True
            if lowered:
                told = True
                for i in range(r.asking_start[slot], r.asking_start[slot + 1]):
                    r.news[r.asking[i]] = True
    return told


@compiled
def goal_distance(p: Process, r: Relaxed, state: Ints) -> tuple[float, float]:
    """What the goal costs from a state on, and the least number of steps; infinite where it cannot be had."""
    rules, told = len(p.outcome_start) - 1, True
    r.cost[:], r.early[:], r.news[:] = math.inf, math.inf, True
    for v in range(len(state)):
        slot = p.slot_start[v] + state[v]
        r.cost[slot], r.early[slot] = 0.0, 0.0
    while told:
        told = False
        for rule in range(rules):
            if r.news[rule]:
                r.news[rule] = False
                told = _use(p, r, rule) or told
    least, soonest = math.inf, math.inf
    for c in range(len(p.goal)):
        if p.goal[c]:
            cost, early = _had(p, r, rules + c)
            least, soonest = min(least, cost), min(soonest, early)
    return least, soonest


@compiled
def relaxed_plan(p: Process, r: Relaxed) -> float:
    """Marks the rules by which the goal is had at its cost, after `goal_distance`; returns the tries that
    they take together, each rule once."""
    r.helpful[:], rules, goal, least, length = False, len(p.outcome_start) - 1, -1, math.inf, 0.0
    for c in range(len(p.goal)):
        cost = _had(p, r, rules + c)[0] if p.goal[c] else math.inf
        if cost < least:
            goal, least = rules + c, cost
    waiting = _add(p, r, goal, 0) if goal >= 0 else 0
    while waiting > 0:
        waiting -= 1
        slot = r.open[waiting]
        rule = int(r.support[slot])
        if not r.helpful[rule]:
            r.helpful[rule] = True
            length += r.tries[slot]
            waiting = _add(p, r, rule, waiting)
    return length


@inner
def _add(p: Process, r: Relaxed, condition: int, waiting: int) -> int:
    """Adds the slots by which a condition is had to those that wait; each only once, since then its cost is
    nothing."""
    for literal in range(p.literal_start[condition], p.literal_start[condition + 1]):
        slot = cheapest(p, r, literal)
        if r.cost[slot] > 0.0:
            r.open[waiting], r.cost[slot] = slot, 0.0
            waiting += 1
    return waiting


@compiled
def promising(
    p: Process, r: Relaxed, other: Relaxed, state: Ints, after: Ints, action: Ints, tries: Floats, far: Floats
) -> int:
    """The states that the outcomes of helpful actions lead to, as many as there is room for: which, by which
    action, the tries that the outcome takes, and the length of the relaxed plan from there (infinite where
    there is none). Works in both rooms."""
    found = 0
    if goal_distance(p, r, state)[0] == math.inf:
        return found
    relaxed_plan(p, r)
    for chosen in range(len(p.cost)):
        rule = choosable(p, state, chosen)
        if rule < 0 or not r.helpful[rule]:
            continue
        for outcome in range(p.outcome_start[rule], p.outcome_start[rule + 1]):
            chance = p.probability[outcome]
            if chance == 0.0 or p.effect_start[outcome] == p.effect_start[outcome + 1] or found == len(after):
                continue
            for v in range(len(state)):
                after[found, v] = state[v]
            apply(p, after[found], outcome)
            cost, _ = goal_distance(p, other, after[found])
            action[found], tries[found] = chosen, 1.0 / chance
            far[found] = relaxed_plan(p, other) if cost < math.inf else math.inf
            found += 1
    return found
