"""Domains that speak of more than areas are legal, and told as far as they are seen."""

from __future__ import annotations

import pytest

from cleancli.environment.observation import observation_space, observed
from cleancli.environment.slots import choices
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Fact
from cleancli.perception.area import Area
from cleancli.perception.symbols import symbolize
from support.shipped import shipped_scene

SCENE = shipped_scene("two_groups")
AREAS = [
    Area(Ellipse((-0.1, 0.05), (0.02, 0.01), 0.3), 1e-3, "a1"),
    Area(Ellipse((0.0, 0.05), (0.02, 0.01), 0.3), 1e-3, "a2"),
]
TEXT = """domain tools {
  types { place; area - place; container - place; tool; bowl - container }
  constants { bin - container  cup - bowl  rag mop - tool  spot - area }
  predicates {
    dirt(?a - area)
    traversal(?a - area, ?c - container, ?m - area)
    holds(?t - tool)
    fits(?t - tool, ?a - area)
    beside(?p ?q - place) [symmetric]
  }
  derived { dirty := count ?a - area: dirt(?a) }
  actions { wipe(?a - area)  take(?t - tool)  use(?t - tool, ?a - area)  pause()  push(?p ?q - place) }
  rule wiped: wipe(?a) { when dirt(?a) then 0.5: not dirt(?a) rest: nothing }
  reward { decrease(dirty) }
}"""


@pytest.fixture(scope="module")
def domain() -> Domain:
    return load_domain(Source("tools.nid", TEXT))


def test_pushes_lead_to_containers_and_to_no_other_constant(domain: Domain) -> None:
    _, state = symbolize(AREAS, SCENE, domain)
    told = {fact.objects for fact in state if fact.symbol == "traversal"}
    assert told == {("a1", name, "a2") for name in ("bin", "cup")}


def test_arrays_have_a_row_for_each_constant_of_the_type(domain: Domain) -> None:
    space = observation_space(domain, SCENE, 2, image=False)
    state = frozenset(
        {
            Fact("dirt", ("a1",)),
            Fact("dirt", ("spot",)),
            Fact("holds", ("mop",)),
            Fact("fits", ("rag", "a2")),
            Fact("fits", ("rag", "elsewhere")),
            Fact("beside", ("a1", "spot")),
        }
    )
    arrays = observed(domain, ("a1", "a2"), AREAS, state, space)
    assert space.contains(arrays)
    assert arrays["symbol_dirt"].tolist() == [1, 0, 1]
    assert arrays["symbol_holds"].tolist() == [0, 1]
    assert arrays["symbol_fits"].tolist() == [[0, 1, 0], [0, 0, 0]]
    beside = arrays["symbol_beside"]
    assert beside.shape == (5, 5)
    assert beside.sum() == 2
    assert (beside == beside.T).all()


def test_choices_are_those_of_actions_on_areas_alone(domain: Domain) -> None:
    assert choices(domain, 2) == (
        ("wipe", (0,)),
        ("wipe", (1,)),
        ("pause", ()),
        ("push", (0, 1)),
        ("push", (1, 0)),
    )
