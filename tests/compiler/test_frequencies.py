"""Every rule of every shipped domain is drawn as often as it declares, in a state that it covers."""

from __future__ import annotations

import itertools
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
from numba import njit
from numpy.typing import NDArray
from scipy import stats

from cleancli.array_types import Ints
from cleancli.compiler.ground import ground
from cleancli.compiler.lowering.state_tables import Process, lower_process
from cleancli.compiler.semantics import covering_rule, sample
from cleancli.compiler.task import GroundRule, GroundState, Task
from cleancli.language.model import Domain, Fact, Horizon, Object, Problem
from cleancli.planning.kernels import transitions
from cleancli.planning.kernels.rng import split, uniform
from cleancli.resources import shipped_names
from support.shipped import shipped_domain

DRAWS, SLOW_DRAWS, SEED = 100_000, 2_000, 5
LEVEL = 1e-4
"""Of all the tests of this file together: each is passed at a share of it (Bonferroni)."""
OBJECTS = 3
"""Per type, beside the constants."""

DOMAINS = {name: shipped_domain(name) for name in shipped_names("domains")}
RULES = [(name, index) for name, domain in DOMAINS.items() for index in range(len(domain.rules))]


def crowded(domain: Domain, seed: int) -> Problem:
    """A problem with some objects of each type, and half of the facts that they can make."""
    rng = np.random.default_rng(seed)
    objects = tuple(Object(f"{t.name}{i}", t.name) for t in domain.types for i in range(OBJECTS))
    facts = set()
    for symbol in domain.symbols:
        fitting = [
            [o.name for o in (*objects, *domain.constants) if domain.is_a(o.type, variable.type)]
            for variable in symbol.parameters
        ]
        for names in itertools.product(*fitting):
            value = symbol.values[int(rng.integers(len(symbol.values)))]
            if value is not False and symbol.canonical(names) == names:
                facts.add(Fact(symbol.name, names, value))
    return Problem("crowded", domain.name, objects, frozenset(facts), Horizon(1))


@cache
def crowded_task(name: str, seed: int) -> Task:
    return ground(DOMAINS[name], crowded(DOMAINS[name], seed))


def covered(name: str, rule: int) -> tuple[Task, GroundRule, GroundState]:
    """The first task in which a rule has a grounding, that grounding, and a state that it covers."""
    task, found = next(
        (task, each)
        for task in (crowded_task(name, seed) for seed in range(20))
        for each in task.rules
        if each.rule == rule
    )
    state = list(task.initial)
    for variable, allowed in found.condition:
        state[variable] = min(allowed)
    return task, found, tuple(state)


@njit(cache=True)
def drawn_states(p: Process, state: Ints, action: int, afters: Ints, draws: int, seed: np.uint64) -> Ints:
    """How often a step from the state led to each of `afters` (N, V), and at last to none of them."""
    counts, now = np.zeros(len(afters) + 1, dtype=np.int32), np.empty_like(state)
    for draw in range(draws):
        now[:] = state
        transitions.step(p, now, action, uniform(split(seed, np.uint64(draw))))
        place = 0
        while place < len(afters) and not np.all(afters[place] == now):
            place += 1
        counts[place] += 1
    return counts


def declared_afters(
    domain: Domain, rule: GroundRule, state: GroundState
) -> tuple[tuple[GroundState, ...], list[Fraction]]:
    """The states that may follow and the sum of what the domain declares of the outcomes that lead there."""
    shares: dict[GroundState, Fraction] = {}
    for outcome, declared in zip(rule.outcomes, domain.rules[rule.rule].outcomes, strict=True):
        effects = dict(outcome.effects)
        after = tuple(effects.get(variable, value) for variable, value in enumerate(state))
        shares[after] = shares.get(after, Fraction(0)) + declared.probability
    return tuple(shares), list(shares.values())


def fits(counts: NDArray[np.integer[Any]], shares: list[Fraction]) -> float:
    """The p-value of counts for declared shares; 0 where something was drawn that has none."""
    possible = np.array([share > 0 for share in shares])
    if counts[~possible].any():
        return 0.0
    expected = np.array([float(share) for share in shares]) * counts.sum()
    if possible.sum() == 1:
        return 1.0
    return float(stats.chisquare(counts[possible], expected[possible]).pvalue)


def compiled_fit(name: str, rule: int, domain: Domain) -> float:
    """How well drawn steps fit what `domain`, the named one but for its probabilities, says of a rule."""
    task, grounded, state = covered(name, rule)
    afters, shares = declared_afters(domain, grounded, state)
    counts = drawn_states(
        lower_process(task),
        np.array(state, dtype=np.int32),
        grounded.action,
        np.array(afters, dtype=np.int32),
        DRAWS,
        np.uint64(SEED),
    )
    return 0.0 if counts[-1] else fits(counts[:-1], shares)


@pytest.mark.parametrize(("name", "rule"), RULES)
def test_compiled_steps_come_as_often_as_declared(name: str, rule: int) -> None:
    assert compiled_fit(name, rule, DOMAINS[name]) > LEVEL / len(RULES)


@pytest.mark.parametrize(("name", "rule"), RULES)
def test_outcomes_come_as_often_as_declared(name: str, rule: int) -> None:
    (task, grounded, state), rng = covered(name, rule), np.random.default_rng([SEED, rule])
    assert covering_rule(task, state, grounded.action) == grounded
    drawn = [sample(task, state, grounded.action, rng)[0] for _ in range(SLOW_DRAWS)]
    shares = [outcome.probability for outcome in DOMAINS[name].rules[rule].outcomes]
    counts = np.bincount(np.array(drawn), minlength=len(shares))
    assert fits(counts, shares) > LEVEL / len(RULES)


@pytest.mark.parametrize("name", DOMAINS)
def test_two_hundredths_of_a_wrong_probability_are_seen(name: str) -> None:
    """In most rules; not where both outcomes lead to one state."""
    domain, found = DOMAINS[name], []
    for number, rule in enumerate(domain.rules):
        first, *between, last = rule.outcomes
        moved = (
            replace(first, probability=first.probability - Fraction(1, 50)),
            *between,
            replace(last, probability=last.probability + Fraction(1, 50)),
        )
        wrong = replace(
            domain, rules=tuple(replace(r, outcomes=moved) if r is rule else r for r in domain.rules)
        )
        found.append(compiled_fit(name, number, wrong) <= LEVEL / len(RULES))
    assert sum(found) > 0.9 * len(found)
