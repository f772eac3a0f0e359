"""One draw of many results, as several that are independent of one another."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from pathlib import Path
from random import Random

import numpy as np
import pytest

import cleancli
from cleancli.conversion.export.draws import Draw, independent
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from support.exported_rddl import Simulated, chance_of, expected
from support.round_trips import disagreements, through_ppddl


def multiplied(draws: tuple[Draw[str], ...]) -> dict[frozenset[str], Fraction]:
    """All results of several draws together, by definition."""
    found: dict[frozenset[str], Fraction] = {}
    for chosen in product(*(draw.items() for draw in draws)):
        result = frozenset[str]().union(*(each for each, _ in chosen))
        chance = Fraction(1)
        for _, one in chosen:
            chance *= one
        found[result] = found.get(result, Fraction(0)) + chance
    return found


def drawn(rng: Random, names: list[str]) -> dict[frozenset[str], Fraction]:
    """A draw at random of sets of some names."""
    sets = list({frozenset(n for n in names if rng.random() < 0.5) for _ in range(rng.randint(1, 4))})
    weights = [rng.randint(1, 6) for _ in sets]
    return {each: Fraction(w, sum(weights)) for each, w in zip(sets, weights, strict=True)}


@pytest.mark.parametrize("seed", range(30))
def test_a_product_of_draws_is_found_again(seed: int) -> None:
    rng = Random(seed)
    given = tuple(drawn(rng, [f"{group}{n}" for n in range(3)]) for group in "abc")
    whole = multiplied(given)
    parts = sorted(part for part in frozenset[str]().union(*whole))
    found = independent(whole, parts)
    assert multiplied(found) == whole
    assert sum(len(draw) > 1 for draw in found) >= sum(len(draw) > 1 for draw in given)


def test_two_coins_are_two_draws() -> None:
    coins = ({frozenset("a"): Fraction(1, 3), frozenset(): Fraction(2, 3)},)
    other = ({frozenset("bc"): Fraction(1, 2), frozenset("d"): Fraction(1, 2)},)
    whole = multiplied((*coins, *other))
    assert len(whole) == 4
    assert independent(whole, list("abcd")) == (*coins, *other)


def test_what_is_independent_by_twos_alone_stays_one_draw() -> None:
    """Two coins, and whether they show the same."""
    quarter = Fraction(1, 4)
    whole = dict.fromkeys(map(frozenset, ("abc", "a", "b", "c")), quarter)
    assert independent(whole, list("abc")) == (whole,)


COINS = """
domain coins {
  types      { coin }
  constants  { c1 c2 c3 c4 c5 c6 c7 c8 c9 c10 - coin }
  predicates { heads(?c - coin)  thrown() }
  actions    { throw() }
  rule throw_all: throw() {
    when not thrown()
    then OUTCOMES
  }
  reward { goal }
}
"""


def coins(count: int) -> str:
    """A domain in which so many coins are thrown, of which the first shows heads more often."""
    outcomes = []
    for sides in product((True, False), repeat=count):
        chance = Fraction(2 if sides[0] else 1, 3) / 2 ** (count - 1)
        effects = [f"{'' if side else 'not '}heads(c{n})" for n, side in enumerate(sides, 1)]
        outcomes.append(f"{chance}: {', '.join([*effects, 'thrown()'])}")
    return COINS.replace("OUTCOMES", "\n         ".join(outcomes))


def test_coins_are_thrown_side_by_side_in_ppddl() -> None:
    made = cleancli.convert(coins(3), to="ppddl")
    assert (
        "    :effect (and\n"
        "      (probabilistic 2/3 (heads c1) 1/3 (not (heads c1)))\n"
        "      (probabilistic 0.5 (heads c2) 0.5 (not (heads c2)))\n"
        "      (probabilistic 0.5 (heads c3) 0.5 (not (heads c3)))\n"
        "      (thrown))"
    ) in made.domain


def test_coins_come_back() -> None:
    domain = load_domain(Source("coins.nid", coins(4)))
    goal = "problem p { domain = coins goal { heads(c1), heads(c4) } horizon = 2 }"
    problem = load_problem(Source("p.nid", goal), domain)
    back = through_ppddl(domain, problem)
    assert list(disagreements(domain, problem, back, 20, np.random.default_rng(0))) == []


def test_coins_are_thrown_side_by_side_in_rddl(tmp_path: Path) -> None:
    pytest.importorskip("pyRDDLGym")
    domain = load_domain(Source("coins.nid", coins(3)))
    problem = load_problem(Source("p.nid", "problem p { domain = coins horizon = 2 }"), domain)
    made = cleancli.convert(coins(3), "problem p { domain = coins horizon = 2 }", to="rddl")
    assert "throw_all_1_drawn = Discrete(throw_all_1_outcome, @throw_all_1_1: 2.0 / 3.0" in made.domain
    assert made.domain.count("Discrete(") == 3
    likely = expected(domain, problem, "throw", ())
    found, _ = Simulated(domain, problem, tmp_path, 2).drawn("throw", (), 200, seed=1)
    assert len(likely) == 8
    assert chance_of(found, likely) > 0.001


def test_a_thousand_results_are_ten_coins() -> None:
    third = Fraction(1, 3)
    ten = tuple({frozenset(side): third, frozenset(): 1 - third} for side in "abcdefghij")
    assert independent(multiplied(ten), list("abcdefghij")) == ten
