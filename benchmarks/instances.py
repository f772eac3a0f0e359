"""Small random problems for benchmarks: tables with dirt, and the domains of benchmarks/domains."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path

import numpy as np

from cleancli.language.find import find
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Domain, Fact, Horizon, Object, Problem, Rule
from planning import DOMAIN as CLEANING
from planning import layout

FOLDER = Path(__file__).parent / "domains"
KEPT = 12.0
"""How near drawn probabilities are to those of the file: the sum of a Dirichlet distribution's weights."""

Rng = np.random.Generator


@dataclass(frozen=True, slots=True)
class Instance:
    """A problem of some family, and the number of steps that are to be played."""

    family: str
    domain: Domain
    problem: Problem
    steps: int


def instance(seed: int) -> Instance:
    """The instance of a seed: families take turns, everything else is drawn."""
    rng = np.random.default_rng(seed)
    family = sorted(FAMILIES)[seed % len(FAMILIES)]
    domain, problem = FAMILIES[family](rng)
    assert isinstance(problem.horizon, Horizon)
    return Instance(family, shaken(domain, rng), problem, problem.horizon.constant)


def shaken(domain: Domain, rng: Rng) -> Domain:
    """The domain with other probabilities, in thousandths; what is impossible or certain stays so."""
    return replace(domain, rules=tuple(_shaken(rule, rng) for rule in domain.rules))


def _shaken(rule: Rule, rng: Rng) -> Rule:
    possible = [outcome for outcome in rule.outcomes if outcome.probability > 0]
    drawn = rng.dirichlet([KEPT * float(outcome.probability) for outcome in possible])
    thousandths = [max(int(1000 * share), 1) for share in drawn]
    thousandths[int(np.argmax(thousandths))] += 1000 - sum(thousandths)
    chances = iter(Fraction(share, 1000) for share in thousandths)
    outcomes = tuple(
        replace(outcome, probability=next(chances)) if outcome.probability > 0 else outcome
        for outcome in rule.outcomes
    )
    return replace(rule, outcomes=outcomes)


def read(name: str) -> Domain:
    return _loaded(FOLDER / f"{name}.nid")


@functools.cache
def _loaded(path: Path) -> Domain:
    return load_domain(read_source(path))


def _problem(domain: Domain, objects: Mapping[str, Sequence[str]], facts: set[Fact], steps: int) -> Problem:
    """Objects are given by type."""
    listed = tuple(Object(name, type_) for type_, names in objects.items() for name in names)
    return Problem("random", domain.name, listed, frozenset(facts), Horizon(steps))


def named(letter: str, number: int) -> list[str]:
    return [f"{letter}{index}" for index in range(number)]


def _linked(symbol: str, names: Sequence[str], rng: Rng, more: int) -> set[Fact]:
    """Pairs of a symmetric predicate that connect all names, and some more."""
    pairs = {tuple(sorted((names[i], names[int(rng.integers(i))]))) for i in range(1, len(names))}
    others = sorted(set(itertools.combinations(sorted(names), 2)) - pairs)
    pairs |= {others[i] for i in rng.permutation(len(others))[:more].tolist()}
    return {Fact(symbol, pair) for pair in pairs}


def cleaning(rng: Rng) -> tuple[Domain, Problem]:
    """The tables of planning.py, with two to four areas."""
    problem = layout(int(rng.integers(2, 5)), int(rng.integers(1_000_000)))
    return CLEANING, replace(problem, horizon=Horizon(2 + len(problem.objects)))


def shipped(rng: Rng) -> tuple[Domain, Problem]:
    """The same under the rules of the shipped domain, which knows nothing of `aligned`."""
    domain = _loaded(find("cleaning", "domains"))
    return domain, as_shipped(cleaning(rng)[1], domain)


def as_shipped(problem: Problem, domain: Domain) -> Problem:
    """A table of planning.py as the shipped domain speaks of it."""
    facts = frozenset(fact for fact in problem.state if fact.symbol != "aligned")
    return replace(problem, domain=domain.name, state=facts)


def blocks(rng: Rng) -> tuple[Domain, Problem]:
    """Three or four blocks in random piles, and a random tower that is wanted."""
    names = named("b", int(rng.integers(3, 5)))
    facts, order = set(), rng.permutation(names).tolist()
    for position, name in enumerate(order):
        below = position > 0 and rng.random() < 0.6
        facts.add(Fact("on", (name, order[position - 1])) if below else Fact("table", (name,)))
    tower = rng.permutation(names).tolist()
    facts |= {Fact("wants", pair) for pair in itertools.pairwise(tower)}
    return (domain := read("blocks")), _problem(domain, {"block": names}, facts, len(names) + 3)


def delivery(rng: Rng) -> tuple[Domain, Problem]:
    """Four places, half of the corridors slippery, and one or two parcels."""
    places, parcels = named("p", 4), named("o", int(rng.integers(1, 3)))
    corridors = _linked("corridor", places, rng, 1)
    facts = corridors | {Fact("here", (str(rng.choice(places)),))}
    facts |= {Fact("slippery", fact.objects) for fact in sorted(corridors, key=str) if rng.random() < 0.5}
    for parcel in parcels:
        start, end = rng.choice(places, size=2, replace=False).tolist()
        facts |= {Fact("lies", (parcel, start)), Fact("wanted", (parcel, end))}
    if rng.random() < 0.5:
        facts.add(Fact("raining", ("sky",)))
    domain = read("delivery")
    return domain, _problem(domain, {"place": places, "parcel": parcels}, facts, 5 + 3 * len(parcels))


def machines(rng: Rng) -> tuple[Domain, Problem]:
    """Two or three machines, new or worn, and three to five jobs that fit some of them."""
    names, jobs = named("m", int(rng.integers(2, 4))), named("j", int(rng.integers(3, 6)))
    facts = {Fact("health", (name,), int(rng.integers(3))) for name in names}
    for job in jobs:
        fitting = rng.permutation(names)[: int(rng.integers(1, 3))].tolist()
        facts |= {Fact("fits", (name, job)) for name in fitting}
    domain = read("machines")
    return domain, _problem(domain, {"machine": names, "job": jobs}, facts, len(jobs) + 3)


def keys(rng: Rng) -> tuple[Domain, Problem]:
    """Five rooms, some locked or with a pit, and two keys."""
    rooms, held = named("r", 5), named("k", 2)
    doors = sorted(_linked("door", rooms, rng, 1), key=str)
    facts = {*doors, Fact("here", ("r0",)), Fact("visited", ("r0",))}
    facts |= {Fact("locked", door.objects) for door in doors if rng.random() < 0.5}
    facts |= {Fact("pit", (room,)) for room in rooms[1:] if rng.random() < 0.2}
    for key in held:
        facts.add(Fact("lies", (key, rooms[int(rng.integers(2))])))
        facts |= {Fact("opens", (key, room)) for room in rng.choice(rooms, size=3).tolist()}
    domain = read("keys")
    return domain, _problem(domain, {"room": rooms, "key": held}, facts, 8)


FAMILIES: Mapping[str, Callable[[Rng], tuple[Domain, Problem]]] = {
    "blocks": blocks,
    "cleaning": cleaning,
    "delivery": delivery,
    "keys": keys,
    "machines": machines,
    "shipped": shipped,
}
