"""Areas keep their slots, and arrays say what the state says."""

from __future__ import annotations

import numpy as np
import pytest

from cleancli.environment.observation import observation_space, observed
from cleancli.environment.pushes import ends, rectangle
from cleancli.environment.slots import choices, filled
from cleancli.geometry.ellipse import Ellipse
from cleancli.perception.area import Area
from cleancli.perception.symbols import symbolize
from support.shipped import shipped_domain, shipped_scene

SCENE = shipped_scene("two_groups")
DOMAIN = shipped_domain("cleaning")


def area(name: str, x: float, covered: float, half: float = 0.02) -> Area:
    return Area(Ellipse((x, 0.05), (half, 0.01), 0.3), covered, name)


def test_an_area_keeps_its_slot_and_a_free_one_takes_the_dirtiest() -> None:
    first = filled((None, None, None), [area("a1", 0, 1e-4), area("a2", 0.1, 3e-4)])
    assert first == ("a2", "a1", None)
    later = filled(first, [area("a1", 0, 1e-4), area("a3", 0.1, 1e-5), area("a4", 0.2, 5e-5)])
    assert later == ("a4", "a1", "a3")


def test_areas_without_a_slot_are_left_out() -> None:
    assert filled((None,), [area("a1", 0, 1e-5), area("a2", 0, 2e-5)]) == ("a2",)


def test_choices_are_all_ways_to_put_different_slots_into_actions() -> None:
    names = [action.name for action in DOMAIN.actions]
    found = choices(DOMAIN, 3)
    arities = {action.name: len(action.parameters) for action in DOMAIN.actions}
    assert len(found) == len(set(found))
    assert sum(name == "join2" for name, _ in found) == 6
    assert sum(name == "join3" for name, _ in found) == 6
    assert all(len(set(places)) == arities[name] for name, places in found)
    assert [name for name, _ in found] == sorted((n for n, _ in found), key=names.index)


def test_arrays_say_what_the_state_says() -> None:
    areas = [area("a1", -0.1, 1e-3), area("a2", 0.0, 1e-6, half=0.09)]
    _, state = symbolize(areas, SCENE, DOMAIN)
    space = observation_space(DOMAIN, SCENE, 3, image=False)
    arrays = observed(DOMAIN, ("a2", None, "a1"), areas, state, space)
    assert space.contains(arrays)
    assert arrays["present"].tolist() == [1, 0, 1]
    assert arrays["symbol_dirt"].tolist() == [1, 0, 1]
    assert arrays["symbol_scattered"].tolist() == [1, 0, 0]
    assert arrays["symbol_size"].tolist() == [3, 0, 1], "1 + the value's number: big, none, small"
    assert arrays["symbol_near"].tolist() == [[0, 0, 1], [0, 0, 0], [1, 0, 0]], "symmetric"
    assert arrays["symbol_traversal"].shape == (4, 4, 4), "three slots and the bin"
    assert arrays["symbol_traversal"][2, 3, 0] == 1, "a2 lies between a1 and the bin"
    assert arrays["symbol_traversal"].sum() == 1
    x, y, half_length, half_width, cos, sin, covered = arrays["areas"][2].tolist()
    assert (x, y, half_length, half_width) == pytest.approx((-0.1, 0.05, 0.02, 0.01))
    assert np.arctan2(sin, cos) / 2 == pytest.approx(0.3)
    assert covered == pytest.approx(1e-3)
    assert not arrays["areas"][1].any()


def test_a_push_covers_the_surface_and_the_whole_rag_over_the_edge() -> None:
    low, high = rectangle(SCENE)
    assert low.tolist() == pytest.approx([-0.45, -0.35])
    assert high.tolist() == pytest.approx([0.45 + 0.08, 0.35])
    start, end = ends((-1, -1, 1, 1), SCENE)
    assert start == pytest.approx((-0.45, -0.35))
    assert end == pytest.approx((0.53, 0.35))
    start, _ = ends((1, 0, 0, 0), SCENE)
    assert start[0] == pytest.approx(0.45), "a push starts on the surface"


@pytest.mark.parametrize("wrong", [(0, 0, 0), (0, 0, 0, float("nan")), ((0, 0), (0, 0))])
def test_what_is_no_push_is_refused(wrong: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="four numbers"):
        ends(wrong, SCENE)
