"""What outcomes pay by functions: the same in each way that rules are grounded."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy import stats

from cleancli.compiler.explain import explain
from cleancli.compiler.ground import ground
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain, Problem
from cleancli.simulation.symbolic_world import do, world_of

DOMAIN = """domain fishing {{
  types      {{ pond; boat }}
  predicates {{ stocked(?p - pond)  at(?b - boat ?p - pond)  torn() }}
  functions  {{ size(?p - pond): 0..99 [static]  wear(?b - boat ?p - pond): 0..9 [static] }}
  actions    {{ cast(?p - pond) [cost = 1 + 1/2 * size(?p)] }}
  rule cast_it: cast(?p) {{
    when stocked(?p), not torn()
{reference}    then 0.5: {effect}, reward += 2 + 3 * size(?p), reward -= 1/4 * size(?p)
         0.25: torn(), cost += 1/3 + {more}
         rest: nothing
  }}
  reward {{ - 2 * cost }}
}}
"""
KINDS = {
    "plain": ("", "not stocked(?p)", "size(?p)"),
    "reference": ("    with ?b - boat: at(?b, ?p)\n", "not stocked(?p)", "wear(?b, ?p)"),
    "conditional": ("", "not stocked(?p), if torn() => not torn()", "size(?p)"),
}


def _models(kind: str, ponds: int) -> tuple[Domain, Problem]:
    reference, effect, more = KINDS[kind]
    domain = load_domain(Source("d.nid", DOMAIN.format(reference=reference, effect=effect, more=more)))
    names = [f"p{number}" for number in range(ponds)]
    facts = [f"stocked({name}) size({name}) = {3 * place}" for place, name in enumerate(names)]
    facts += [f"at(b{place % 2}, {name})" for place, name in enumerate(names)]
    facts += [
        f"wear({boat}, {name}) = {place % 7}" for boat in ("b0", "b1") for place, name in enumerate(names)
    ]
    text = f"problem p {{ domain = fishing objects {{ {' '.join(names)} - pond b0 b1 - boat }}"
    text += f" init {{ {' '.join(facts)} }} horizon = 3 }}"
    return domain, load_problem(Source("p.nid", text), domain)


@pytest.mark.parametrize("ponds", [3, 30])
@pytest.mark.parametrize("kind", KINDS)
def test_each_grounding_pays_by_its_objects(kind: str, ponds: int) -> None:
    """Few objects are grounded one after the other, and many by columns."""
    domain, problem = _models(kind, ponds)
    task = ground(domain, problem)
    seen = set()
    for rule in task.rules:
        action = task.actions[rule.action]
        place = int(action.objects[0][1:])
        size, more = 3 * place, place % 7 if kind == "reference" else 3 * place
        earned, worn = 2 + 3 * size - Fraction(size, 4), Fraction(1, 3) + more
        assert action.declared_cost == 1 + Fraction(size, 2)
        assert action.cost == 2 * action.declared_cost
        paid = {(outcome.cost, outcome.declared_cost) for outcome in rule.outcomes}
        assert paid == {(-earned, 0), (2 * worn, worn), (0, 0)}
        seen.add(place)
    assert seen == set(range(ponds))


@pytest.mark.parametrize("kind", KINDS)
def test_an_explanation_says_what_is_paid_here(kind: str) -> None:
    domain, problem = _models(kind, 5)
    covering = explain(domain, problem, "cast", ["p4"]).covering
    assert covering is not None
    worn, nothing = Fraction(1, 3) + (4 if kind == "reference" else 12), Fraction(0)
    wanted = [(Fraction(35), nothing), (nothing, worn), (nothing, nothing)]
    assert [(each.reward, each.cost) for each in covering.outcomes] == wanted


def test_episodes_pay_what_is_drawn() -> None:
    """A cast at a pond of size 12 costs 7, which count twice, and what its outcome pays."""
    world, rng = world_of(*_models("plain", 5)), np.random.default_rng(8)
    cast = next(action for action in world.task.actions if action.objects == ("p4",))
    worn = Fraction(1, 3) + 12
    declared = {(21.0, 7.0): 0.5, (float(-14 - 2 * worn), float(7 + worn)): 0.25, (-14.0, 7.0): 0.25}
    seen = [do(world, world.task.initial, cast, rng)[0] for _ in range(2000)]
    counts = [
        sum((step.reward, step.cost) == pytest.approx(each, abs=1e-9) for step in seen) for each in declared
    ]
    assert sum(counts) == 2000
    assert stats.chisquare(counts, [2000 * share for share in declared.values()]).pvalue > 1e-4
