"""A smaller problem where too much is left to do: some of what the reward counts is ignored (§4.2.1).

Guaranteed by the checker: a count that the reward names is declared.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from cleancli.compiler.lifted_state import StateView
from cleancli.language.model import (
    Condition,
    Count,
    Domain,
    Equality,
    Literal,
    Object,
    Problem,
    Unlimited,
    wanted_decreased,
    without_objects,
)


@dataclass(frozen=True, slots=True)
class Fewer:
    """The problem to plan for, and the names of the objects that it leaves out."""

    problem: Problem
    ignored: tuple[str, ...] = ()


def fewer(domain: Domain, problem: Problem, most: int) -> Fewer:
    """The problem with at most `most` of the objects that the count to decrease counts (eq. 2) now.

    Those stay that share most facts with other objects: what depends on nothing else costs the same later. Of
    equals the first declared stay. Objects that the goal names stay, as do counts of several objects at once,
    and without a horizon all: what is left out could be what the goal asks for.
    """
    count = None if isinstance(problem.horizon, Unlimited) else _decreasing(domain)
    if count is None or len(count.variables) != 1 or len(problem.objects) <= most:
        return Fewer(problem)
    view = StateView(domain, problem.objects, problem.state)
    (variable,) = count.variables
    counted = [binding[variable] for binding in view.extensions((variable,), count.condition, {})]
    kept = {*(constant.name for constant in domain.constants), *_named(problem.goal)}
    shared = Counter(
        name for fact in problem.state if len(set(fact.objects)) > 1 for name in set(fact.objects)
    )
    candidates = [name for name in reversed(counted) if name not in kept]
    ranked = sorted(candidates, key=lambda name: shared[name])
    dropped = set(ranked[: max(len(counted) - most, 0)])
    return Fewer(without_objects(problem, dropped), tuple(name for name in counted if name in dropped))


def _decreasing(domain: Domain) -> Count | None:
    """The count that the reward wants decreased."""
    name = wanted_decreased(domain)
    return next((count for count in domain.counts if count.name == name), None)


def _named(condition: Condition) -> Iterator[str]:
    """The objects that a condition names."""
    for part in condition:
        match part:
            case Literal(terms=terms):
                yield from (term.name for term in terms if isinstance(term, Object))
            case Equality(left, right):
                yield from (term.name for term in (left, right) if isinstance(term, Object))
            case _:
                yield from _named(part.condition)
