"""Goals and counts that no action can ever bring about, with the literals that never come to hold.

Guaranteed by the checker: domain and problem fit together. The relaxed fixpoint of `Reach` lets everything
happen that could, so what it never reaches is never reached; what it reaches may still be impossible.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from cleancli.compiler.column_join import ColumnJoin
from cleancli.compiler.fluents import Fluent
from cleancli.compiler.ground_formula import Formula, Known, restricted
from cleancli.compiler.grounding_size import count_groundings, refuse_too_many
from cleancli.compiler.instances import instances
from cleancli.compiler.partial_evaluation import ClosureTooLargeError, Conditions
from cleancli.compiler.relaxed_reachability import Reach
from cleancli.compiler.static_join import Universe
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import (
    Count,
    Domain,
    Literal,
    Object,
    Problem,
    Symbol,
    Value,
    wanted_decreased,
)
from cleancli.language.printing.printer import print_condition, print_literal, symbols_of

_MOST_GROUNDINGS = 5_000
"""Of larger problems nothing is said, so that checking them takes no longer. Chosen: a second."""


@dataclass(frozen=True, slots=True)
class Unreached:
    """The goal (`count` is None) that can't be reached, or the count that can't fall to 0.

    `never` are the literals that would have to hold and never do, as a file writes them; empty where parts of
    the goal exclude each other, or where what is counted does not change at all.
    """

    count: str | None
    never: tuple[str, ...]


def unreached(domain: Domain, problem: Problem) -> tuple[Unreached, ...]:
    """The goal, or without one the count that the reward wants decreased, where no action can bring it about.

    Nothing is said of problems with many groundings, and of those that can't be grounded.
    """
    if sum(each.count for each in count_groundings(domain, problem)) > _MOST_GROUNDINGS:
        return ()
    universe = Universe(domain, problem)
    join = ColumnJoin(universe)
    try:
        if any(refuse_too_many(domain, problem, join)):
            return ()
        conditions = Conditions(universe)
        known = Reach(instances(domain, conditions, join), universe).known
        if problem.goal:
            return tuple(_goal(problem, conditions, known, symbols_of(domain)))
        wanted = wanted_decreased(domain)
        counts = (count for count in domain.counts if count.name == wanted)
        return tuple(each for count in counts for each in _count(count, conditions, known))
    except (Refused, ClosureTooLargeError):
        return ()


def _goal(
    problem: Problem, conditions: Conditions, known: Known, symbols: Mapping[str, Symbol]
) -> Iterator[Unreached]:
    whole = conditions.formula(problem.goal, {})
    if whole is not None and restricted(whole, known) is not None:
        return
    never: list[str] = []
    for part in problem.goal:
        formula = conditions.formula((part,), {})
        if formula is not None and restricted(formula, known) is not None:
            continue
        if formula is None or (isinstance(part, Literal) and part.symbol not in conditions.universe.derived):
            never.append(print_condition((part,), symbols))
        else:
            never += _missing(formula, known, conditions)
    yield Unreached(None, tuple(dict.fromkeys(never)))


def _missing(formula: Formula, known: Known, conditions: Conditions) -> Iterator[str]:
    """The literals of a formula that never hold; of alternatives that all fail, those of each."""
    failing = [(key, values) for key, values in formula.required.items() if not values & known(key)]
    if failing:
        yield from (_text(key, values, conditions) for key, values in failing)
        return
    for choice in formula.choices:
        if all(restricted(member, known) is None for member in choice):
            for member in choice:
                yield from _missing(member, known, conditions)
            return


def _count(count: Count, conditions: Conditions, known: Known) -> Iterator[Unreached]:
    never: list[str] = []
    stays = False
    for _, formula in conditions.extensions(count.variables, count.condition, {}):
        left = restricted(formula, known)
        if left is not None and left.always:
            stays = True
            opposites = (
                (key, conditions.all_values(key) - values) for key, values in formula.required.items()
            )
            never += [_text(key, values, conditions) for key, values in opposites]
    if stays:
        yield Unreached(count.name, tuple(dict.fromkeys(never)))


def _text(key: Fluent, values: frozenset[Value], conditions: Conditions) -> str:
    symbols = conditions.universe.symbols
    return print_literal(Literal(key[0], tuple(Object(name, "") for name in key[1]), values), symbols)
