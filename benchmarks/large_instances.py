"""Random problems of some 10,000 to 500,000 states: tables, coins, exploding blocks, elevators, a car with
flat tires, a ferry."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from instances import Instance, Rng, named, read, shaken

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_problem
from cleancli.language.model import Domain, Horizon, Problem
from planning import DOMAIN as CLEANING
from planning import layout


def large_instance(seed: int) -> Instance:
    """The instance of a seed: families take turns, everything else is drawn."""
    rng = np.random.default_rng([seed, 1])
    family = sorted(LARGE)[seed % len(LARGE)]
    domain, problem = LARGE[family](rng)
    assert isinstance(problem.horizon, Horizon)
    return Instance(family, shaken(domain, rng), problem, problem.horizon.constant)


def problem_for(
    name: str,
    objects: Mapping[str, Sequence[str]],
    facts: Iterable[str],
    steps: int,
    goal: Iterable[str] = (),
    more: str = "",
) -> tuple[Domain, Problem]:
    """A domain of benchmarks/domains and a problem for it, of objects by type, and of facts and what `more`
    it says as they are written."""
    domain = read(name)
    listed = " ".join(f"{' '.join(names)} - {kind}" for kind, names in objects.items())
    wanted = f"goal {{ {', '.join(goal)} }}" if goal else ""
    inside = f"objects {{ {listed} }} init {{ {', '.join(facts)} }} {wanted} horizon = {steps} {more}"
    text = f"problem random {{ domain = {name} {inside} }}"
    return domain, load_problem(Source("random.nid", text), domain)


def some(rng: Rng, share: float, facts: Iterable[str]) -> list[str]:
    """Each of the facts with the same probability."""
    return [fact for fact in facts if rng.random() < share]


def tables(rng: Rng) -> tuple[Domain, Problem]:
    """The tables of planning.py, with five or six areas."""
    areas = int(rng.integers(5, 7))
    return CLEANING, replace(layout(areas, int(rng.integers(1_000_000))), horizon=Horizon(areas + 3))


def coins(rng: Rng) -> tuple[Domain, Problem]:
    """Fourteen coins, of which most show heads."""
    names = named("c", 14)
    heads = some(rng, 0.7, (f"heads({name})" for name in names))
    return problem_for("coins", {"coin": names}, heads, int(rng.integers(6, 11)))


def exploding(rng: Rng) -> tuple[Domain, Problem]:
    """Five or six blocks in random piles, most of them armed, and a tower of two to four that is wanted."""
    names = named("b", int(rng.integers(5, 7)))
    facts = some(rng, 0.8, (f"armed({name})" for name in names))
    order = rng.permutation(names).tolist()
    for position, name in enumerate(order):
        below = position > 0 and rng.random() < 0.6
        facts.append(f"on({name}, {order[position - 1]})" if below else f"table({name})")
    tower = rng.permutation(names).tolist()[: int(rng.integers(2, 5))]
    goal = [f"on({upper}, {lower})" for upper, lower in itertools.pairwise(tower)]
    return problem_for("exploding", {"block": names}, facts, 2 * len(names) + 2, goal)


def elevators(rng: Rng) -> tuple[Domain, Problem]:
    """Five floors of three places, three elevators, six or seven coins."""
    floors, places = named("f", 5), named("p", 3)
    cars, lost = named("e", 3), named("c", int(rng.integers(6, 8)))
    facts = ["first(f0, p0)", "here(f0, p0)"]
    facts += [f"beside({p}, {q})" for p, q in (["p0", "p1"], ["p1", "p0"], ["p1", "p2"], ["p2", "p1"])]
    facts += [f"shaft({car}, {rng.choice(places)})" for car in cars]
    facts += [f"level({car}, {rng.choice(floors)})" for car in cars]
    facts += some(rng, 0.4, (f"gate({floor}, {place})" for floor in floors[1:] for place in places))
    for coin in lost:
        facts += [f"lies({coin})", f"at({coin}, {rng.choice(floors[1:])}, {rng.choice(places)})"]
    objects = {"floor": floors, "place": places, "elevator": cars, "coin": lost}
    return problem_for("elevators", objects, facts, int(rng.integers(12, 19)))


def tireworld(rng: Rng) -> tuple[Domain, Problem]:
    """A triangle of places with roads to the next ones, most of them one way, and spare tires at many."""
    side = int(rng.integers(5, 7))
    name = {(row, column): f"p{row}{column}" for row in range(side) for column in range(side - row)}
    facts, goal = ["here(p00)"], f"here(p0{side - 1})"
    for (row, column), place in name.items():
        for other in ((row + 1, column), (row, column + 1), (row + 1, column - 1)):
            if other in name:
                facts.append(f"road({place}, {name[other]})")
                facts += some(rng, 0.7, [f"road({name[other]}, {place})"])
    facts += some(rng, 0.7, (f"spare({place})" for place in name.values()))
    facts += some(rng, 0.6, (f"rough({place})" for place in name.values()))
    return problem_for("tireworld", {"place": list(name.values())}, facts, int(rng.integers(14, 19)), [goal])


def river(rng: Rng) -> tuple[Domain, Problem]:
    """Seven or eight goods, some precious, some that eat others."""
    goods = named("g", int(rng.integers(7, 9)))
    facts = [*(f"near({good})" for good in goods), f"water() = {rng.integers(3)}"]
    facts += some(rng, 0.4, (f"precious({good})" for good in goods))
    facts += some(rng, 0.1, (f"eats({one}, {other})" for one, other in itertools.permutations(goods, 2)))
    return problem_for("river", {"good": goods}, facts, int(rng.integers(16, 25)))


LARGE: Mapping[str, Callable[[Rng], tuple[Domain, Problem]]] = {
    "coins": coins,
    "elevators": elevators,
    "exploding": exploding,
    "river": river,
    "tables": tables,
    "tireworld": tireworld,
}
