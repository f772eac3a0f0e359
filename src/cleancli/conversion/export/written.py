"""What all writers share: the files that they make, what may become of noise, and what problems come to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from cleancli.language.model import Domain, Fact, Problem

NOISE = ("unchanged", "predicate")
"""What may become of noise: it changes nothing, or makes a predicate true."""


@dataclass(frozen=True, slots=True)
class Written:
    """The texts of a domain and its problems by the names of their files, what has to be told of them, and
    the names that could not stay."""

    texts: Mapping[str, str]
    notes: tuple[str, ...]
    names: Mapping[str, str]


def closure_of(state: Iterable[Fact], symbol: str, symmetric: bool) -> frozenset[tuple[str, str]]:
    """The pairs that one or more steps of a predicate lead from the first of to the second."""
    steps: dict[str, set[str]] = {}
    for fact in state:
        if fact.symbol == symbol:
            one, other = fact.objects
            steps.setdefault(one, set()).add(other)
            if symmetric:
                steps.setdefault(other, set()).add(one)
    found = set()
    for start in steps:
        waiting, met = list(steps[start]), set[str]()
        while waiting:
            if (here := waiting.pop()) not in met:
                met.add(here)
                waiting += steps.get(here, ())
        found |= {(start, each) for each in met}
    return frozenset(found)


def counted(domain: Domain, problem: Problem) -> Mapping[str, int]:
    """How many objects a problem has of each type."""
    things = (*domain.constants, *problem.objects)
    return {kind.name: sum(domain.is_a(o.type, kind.name) for o in things) for kind in domain.types}
