"""Goals in four families of three sizes each: a tower of blocks that explode, coins on floors with elevators,
a triangle of roads where tires go flat, and a ferry in high water. Nothing is paid but for the goal."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from instances import Rng, named, read
from large_instances import problem_for, some

from cleancli.language.model import Domain, Problem

SIZES = ("small", "middle", "large")
UNDISCOUNTED = "discount = 1"


@dataclass(frozen=True, slots=True)
class GoalInstance:
    """A problem of a family and a size, to be done within the problem's horizon."""

    family: str
    size: str
    domain: Domain
    problem: Problem


def goal_instances(seed: int) -> list[GoalInstance]:
    """All families in all sizes, as a seed draws them; probabilities are those of the files."""
    found = list[GoalInstance]()
    for (number, family), (size, how) in itertools.product(enumerate(sorted(GOALS)), enumerate(SIZES)):
        domain, problem = GOALS[family](np.random.default_rng([seed, 2, number, size]), size)
        found.append(GoalInstance(family, how, replace(domain, reward=read("exploding").reward), problem))
    return found


def exploding(rng: Rng, size: int) -> tuple[Domain, Problem]:
    """Five, six or ten armed blocks in piles of up to three; three, four or six are wanted as a tower."""
    number, high = (5, 6, 10)[size], (3, 4, 6)[size]
    names = named("b", number)
    facts = [f"armed({name})" for name in names]
    order = rng.permutation(names).tolist()
    for position, name in enumerate(order):
        facts.append(f"on({name}, {order[position - 1]})" if position % 3 else f"table({name})")
    tower = rng.permutation(names).tolist()[:high]
    goal = [f"on({upper}, {lower})" for upper, lower in itertools.pairwise(tower)]
    return problem_for("exploding", {"block": names}, facts, 2 * number + 4, goal, UNDISCOUNTED)


def elevators(rng: Rng, size: int) -> tuple[Domain, Problem]:
    """Four, five or seven floors of three places, with two or three elevators; three, six or ten coins."""
    floors, places = named("f", (4, 5, 7)[size]), named("p", 3)
    cars, lost = named("e", (2, 3, 3)[size]), named("c", (3, 6, 10)[size])
    facts = ["first(f0, p0)", "here(f0, p0)"]
    facts += [f"beside({p}, {q})" for p, q in (["p0", "p1"], ["p1", "p0"], ["p1", "p2"], ["p2", "p1"])]
    facts += [f"shaft({car}, {place})" for car, place in zip(cars, ["p0", "p2", "p1"], strict=False)]
    facts += [f"level({car}, {rng.choice(floors)})" for car in cars]
    facts += some(rng, 0.4, (f"gate({floor}, {place})" for floor in floors[1:] for place in places))
    for coin in lost:
        facts += [f"lies({coin})", f"at({coin}, {rng.choice(floors[1:])}, {rng.choice(places)})"]
    objects = {"floor": floors, "place": places, "elevator": cars, "coin": lost}
    goal = [f"not lies({coin})" for coin in lost]
    return problem_for("elevators", objects, facts, (14, 24, 44)[size], goal, UNDISCOUNTED)


def tireworld(rng: Rng, size: int) -> tuple[Domain, Problem]:
    """A triangle of places, all of them rough. One side leads straight to the goal, and has no spare tires;
    there are some on the way round, over the other two sides, and at many places within."""
    side = (5, 6, 12)[size]
    places = [(row, column) for row in range(side) for column in range(side - row)]
    facts = ["here(p0_0)", *(f"rough({_place(*place)})" for place in places)]
    for row, column in places:
        for other in ((row + 1, column), (row, column + 1), (row + 1, column - 1), (row - 1, column + 1)):
            if other in places:
                facts.append(f"road({_place(row, column)}, {_place(*other)})")
        round_about = column == 0 or row + column == side - 1
        if row and (round_about or rng.random() < 0.4):
            facts.append(f"spare({_place(row, column)})")
    objects = {"place": [_place(*place) for place in places]}
    goal = [f"here({_place(0, side - 1)})"]
    return problem_for("tireworld", objects, facts, 6 * side, goal, UNDISCOUNTED)


def _place(row: int, column: int) -> str:
    return f"p{row}_{column}"


def river(rng: Rng, size: int) -> tuple[Domain, Problem]:
    """Four, six or eleven goods, some of which eat others."""
    goods = named("g", (4, 6, 11)[size])
    facts = [*(f"near({good})" for good in goods), "water() = 1"]
    facts += some(rng, 0.2, (f"eats({one}, {other})" for one, other in itertools.permutations(goods, 2)))
    goal = [f"over({good})" for good in goods]
    return problem_for("river", {"good": goods}, facts, 6 * len(goods), goal, UNDISCOUNTED)


GOALS: Mapping[str, Callable[[Rng, int], tuple[Domain, Problem]]] = {
    "elevators": elevators,
    "exploding": exploding,
    "river": river,
    "tireworld": tireworld,
}
