"""Compares what the product says of a drawn domain with what the interpreter says, and lists differences."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from random import Random

from support.differential import product
from support.differential.abstract import Domain, Problem
from support.differential.comparing_environment import compare_environment
from support.differential.comparing_loops import compare_learned, compare_loop
from support.differential.comparing_rules import compare_rules
from support.differential.comparing_states import compare_draws, compare_explanations, compare_states
from support.differential.comparing_values import compare_values
from support.differential.comparison import Comparison
from support.differential.drawing import draw
from support.differential.interpreter import Meaning, State, TwoRules, TwoValues
from support.differential.judging import judge_check, judge_ground
from support.differential.product import Grounded
from support.differential.worth import Worth

SOLVED = 150
"""An optimum is compared where no more states are reached within the horizon."""
LOOPS = 0.1
"""The share of domains that are simulated."""
ENVIRONMENTS = 0.4
"""The share of domains that are compared as environments for Gymnasium."""


@dataclass(frozen=True, slots=True)
class Explored:
    """States that are reached, in the order of their distance, and whether they are all that the horizon's
    steps reach; `refusals` are the codes of mistakes that were met."""

    states: tuple[State, ...]
    whole: bool
    refusals: frozenset[str]


def explore(worth: Worth) -> Explored:
    """Breadth first, up to the horizon's steps, and up to `SOLVED` states."""
    start = worth.meaning.initial()
    steps = max(worth.horizon(start), 3)
    found, frontier, refusals = {start: 0}, [start], set[str]()
    while frontier and len(found) <= SOLVED:
        here = frontier.pop(0)
        for asked in worth.calls if found[here] < steps else ():
            try:
                for there in worth.after(here, asked):
                    if there not in found:
                        found[there] = found[here] + 1
                        frontier.append(there)
            except TwoValues:
                refusals.add("E602")
            except TwoRules:
                refusals.add("E603")
    return Explored(tuple(found), not frontier and len(found) <= SOLVED, frozenset(refusals))


def compare(seed: int, folder: Path) -> Comparison:
    """All comparisons of the seed's domain, whose files are left in the folder."""
    domain, problem = draw(seed)
    return compare_these(domain, problem, seed, folder)


def compare_these(domain: Domain, problem: Problem, seed: int, folder: Path) -> Comparison:
    product.write(folder, domain, problem, seed)
    comparison, meaning, random = Comparison(seed), Meaning(domain, problem), Random(seed)
    loaded, said = product.load(folder, meaning)
    if loaded is None:
        errors = [diagnostic for diagnostic in said if diagnostic.code.startswith("E")]
        comparison.refused = tuple(sorted({diagnostic.code for diagnostic in errors}))
        judge_check(comparison, meaning, errors, random)
        return comparison
    worth = Worth(meaning)
    explored = explore(worth)
    grounded = product.grounded(loaded)
    if not isinstance(grounded, Grounded):
        comparison.refused = grounded
        judge_ground(comparison, meaning, grounded, explored.refusals, random)
        return comparison
    comparison.same("refusals", frozenset(), explored.refusals)
    if explored.refusals:
        return comparison
    compare_states(comparison, grounded, worth, explored.states)
    compare_explanations(comparison, loaded, worth, explored.states, random)
    compare_draws(comparison, grounded, worth, explored.states, random)
    compare_values(comparison, folder, grounded, worth, explored.whole, random)
    compare_learned(comparison, loaded, worth, explored.states, random)
    if explored.whole and random.random() < LOOPS:
        compare_loop(comparison, folder, worth, random.choice(("exact", "prada+")))
    compare_rules(comparison, loaded, worth, explored.states, random)
    if random.random() < ENVIRONMENTS:
        compare_environment(comparison, folder, grounded, worth, random)
    return comparison
