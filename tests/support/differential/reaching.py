"""Goals without a horizon: what docs/planning.md says of them once more, by linear programs over the states
that the interpreter reaches, and random problems of that kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from random import Random
from typing import Any

import networkx as nx
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_array

from support.differential.abstract import (
    Action,
    Comparison,
    Domain,
    Outcome,
    Payment,
    Price,
    Problem,
    Rule,
    SetValue,
    Symbol,
    Truth,
)
from support.differential.drawing import draw
from support.differential.interpreter import Call, Meaning, State, TwoRules, TwoValues

UNLIMITED = (None, "unlimited")
TOLERANCE = 1e-9
Values = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Choice:
    """An action that a rule covers in a state, what it costs, and the states that may follow, by number."""

    state: int
    call: Call
    cost: float
    after: dict[int, float]


@dataclass(frozen=True, slots=True)
class Reachable:
    """All states that can be reached, up to those in which the goal holds, which have no choices."""

    states: tuple[State, ...]
    goal: tuple[bool, ...]
    choices: tuple[Choice, ...]


# ---- problems


def machine(seed: int) -> tuple[Domain, Problem]:
    """A domain of one number, whose rules lead from anywhere to anywhere."""
    random = Random(seed)
    prices = Random(f"prices of {seed}")
    number = random.randint(4, 11)
    names = [f"do{index}" for index in range(random.randint(2, 3))]
    actions = tuple(
        Action(name, (), f"{random.randint(1, 9)} s", Price(Fraction(random.choice(("0", "0", "2.5")))))
        for name in names
    )
    rules = [
        Rule(f"r{at}_{name}", name, (), _where(at), (), _chances(random, at, number, prices))
        for at in range(number)
        for name in names
        if random.random() < 0.6
    ]
    here = random.randrange(number - 1)
    for at, to in ((here, here + 1), (here + 1, here)):  # to and fro, for nothing
        turned = (Outcome(Fraction(1), "1", "", (SetValue("at", (), to),)),)
        rules.append(Rule(f"turn{at}", "turn", (), _where(at), (), turned))
    actions = (*actions, Action("turn", (), "1 s", Price()))
    domain = Domain(
        "drawn", (("thing", None),), (), (Symbol("at", (), tuple(range(number))),), (), (), (),
        actions, tuple(rules), None, (Payment(Fraction(1), "goal"),),
    )  # fmt: skip
    goal = Comparison("at", (), random.choice(("=", ">=")), random.randrange(number // 2, number))
    facts = ((("at", ()), random.randrange(number // 2)),)
    return domain, Problem("drawn_problem", (), facts, (goal,), UNLIMITED, None)


def _where(at: int) -> tuple[Comparison]:
    return (Comparison("at", (), "=", at),)


def _chances(random: Random, state: int, number: int, prices: Random) -> tuple[Outcome, ...]:
    paid = prices.choice(((Fraction(0),), (Fraction(0), Fraction(3, 2), Fraction(1, 3))))
    near = random.random() < 0.7
    pool = [s for s in range(number) if not near or abs(s - state) <= 2]
    targets = random.sample(pool, min(random.choice((1, 2, 2, 3, 3)), len(pool)))
    parts = [random.randint(1, 9) for _ in targets]
    shares = [Fraction(part, sum(parts)) for part in parts]
    return tuple(
        Outcome(share, str(share), "", (SetValue("at", (), target),), cost=Price(prices.choice(paid)))
        for share, target in zip(shares, targets, strict=True)
    )


def drawn(seed: int) -> tuple[Domain, Problem] | None:
    """A drawn domain with a goal that some facts of a state with others hold; None where nothing changes."""
    domain, problem = draw(seed)
    random = Random(seed)
    meaning = Meaning(domain, problem)
    state, steps = meaning.initial(), 0
    while steps < 6:
        try:
            after = [s for call in meaning.calls() for s in meaning.successors(call, state)]
        except (TwoRules, TwoValues):
            return None
        state, steps = random.choice(after) if after else state, steps + 1
    different = [
        (key, value)
        for key, value, before in zip(meaning.keys, state, meaning.initial(), strict=True)
        if value != before
    ]
    if not different:
        return None
    asked = random.sample(different, min(len(different), random.choice((1, 1, 2))))
    goal = tuple(
        Truth(name, terms, value) if isinstance(value, bool) else Comparison(name, terms, "=", value)
        for (name, terms), value in asked
    )
    return domain, replace(problem, goal=goal, horizon=UNLIMITED)


# ---- states


def reachable(meaning: Meaning, cost: Mapping[Call, float], most: int, by_outcome: bool) -> Reachable | None:
    """The states of a problem, found breadth first; None where they are more than so many, or a rule is
    refused in one of them. `cost` is that of each action, `by_outcome` tells whether outcomes cost more."""
    calls = meaning.calls()
    states, number = [meaning.initial()], {meaning.initial(): 0}
    goal, choices = list[bool](), list[Choice]()
    for at, state in enumerate(states):  # which grows
        goal.append(meaning.all_hold(meaning.problem.goal, state, {}))
        for call in () if goal[-1] else calls:
            try:
                covering = meaning.covering(call, state)
                if covering is None:
                    continue
                chances = meaning.successors(call, state)
            except (TwoRules, TwoValues):
                return None
            for after in chances:
                if after not in number:
                    number[after] = len(states)
                    states.append(after)
            after_by_number = {number[after]: float(chance) for after, chance in chances.items()}
            rule, binding = covering
            dearer = ((o.probability, meaning.price(o.cost, state, binding)) for o in rule.outcomes)
            more = sum((chance * price for chance, price in dearer if by_outcome), Fraction(0))
            choices.append(Choice(at, call, cost[call] + float(more), after_by_number))
        if len(states) > most:
            return None
    return Reachable(tuple(states), tuple(goal), tuple(choices))


# ---- values


def probabilities(model: Reachable) -> Values:
    """The greatest probability of the goal from each state: the least numbers that no choice could raise."""
    fixed = [(1.0, 1.0) if goal else (0.0, 1.0) for goal in model.goal]
    rows = _rows(model, model.choices)
    return _best(np.ones(len(fixed)), -rows, np.zeros(len(model.choices)), fixed)


def lossless(model: Reachable, probability: Values) -> list[Choice]:
    """The choices that lose no probability, where there is some."""
    return [
        choice
        for choice in model.choices
        if probability[choice.state] > TOLERANCE
        and abs(_expected(choice, probability) - probability[choice.state]) < TOLERANCE
    ]


def costs(model: Reachable, probability: Values) -> Values:
    """The least expected costs until the goal, or until it is out of reach, by choices that lose no
    probability: the greatest numbers that no choice undercuts."""
    kept = lossless(model, probability)
    fixed = [
        (0.0, 0.0) if goal or chance < TOLERANCE else (0.0, None)
        for goal, chance in zip(model.goal, probability, strict=True)
    ]
    return _best(-np.ones(len(fixed)), _rows(model, kept), np.array([each.cost for each in kept]), fixed)


def _expected(choice: Choice, values: Values) -> float:
    return float(sum(chance * values[after] for after, chance in choice.after.items()))


def _rows(model: Reachable, choices: Sequence[Choice]) -> Any:
    """A row for each choice: the value of its state less what is expected after it."""
    rows = np.zeros((len(choices), len(model.states)))
    for row, choice in enumerate(choices):
        rows[row, choice.state] += 1.0
        for after, chance in choice.after.items():
            rows[row, after] -= chance
    return csr_array(rows)


def _best(weights: Values, rows: Any, most: Values, fixed: Sequence[tuple[float, float | None]]) -> Values:
    """The numbers of least weight with `rows` times them at most `most`."""
    exact = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    if not rows.shape[0]:
        return np.array([low for low, _ in fixed])
    found = linprog(weights, A_ub=rows, b_ub=most, bounds=fixed, method="highs", options=exact)
    assert found.status == 0, found.message
    values: Values = found.x
    return values


def end_components(choices: list[Choice]) -> list[set[int]]:
    """The maximal end components of some choices (de Alfaro 1997), by networkx."""
    while True:
        graph = nx.DiGraph((choice.state, after) for choice in choices for after in choice.after)
        of = {state: i for i, part in enumerate(nx.strongly_connected_components(graph)) for state in part}
        acting = {choice.state for choice in choices}
        kept = [
            choice
            for choice in choices
            if all(of[after] == of[choice.state] and after in acting for after in choice.after)
        ]
        if len(kept) == len(choices):
            parts: dict[int, set[int]] = {}
            for choice in choices:
                parts.setdefault(of[choice.state], set()).add(choice.state)
            return list(parts.values())
        choices = kept
