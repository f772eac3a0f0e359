"""Symbols against the geometry that docs/perception.md defines them by."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from math import pi

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Fact, Object, Symbol, Type, Variable
from cleancli.motion.actions import tool_path
from cleancli.perception.area import Area
from cleancli.perception.symbols import lies_between, place_at_mouth, reaches_rim, remembered, symbolize
from cleancli.perception.tracking import Stroke
from support import synthetic


def symbol(name: str, *types: str, **more: object) -> Symbol:
    return Symbol(name, tuple(Variable(f"x{i}", t) for i, t in enumerate(types)), **more)  # type: ignore[arg-type]


SIZE = symbol("size", "area", values=("small", "medium", "big"))
SYMBOLS = (
    symbol("dirt", "area"),
    symbol("scattered", "area"),
    symbol("near", "area", "area", symmetric=True),
    symbol("traversal", "place", "place", "place"),
    symbol("onward", "area", "area"),
    symbol("to_dustpan", "area", "area"),
    symbol("at_rim", "area"),
    symbol("covers", "area", "area"),
    SIZE,
)


def domain(*symbols: Symbol) -> Domain:
    types = (Type("place"), Type("area", "place"), Type("container", "place"))
    return Domain("test", types, (Object("bin", "container"),), symbols or SYMBOLS, (), (), (), (), ())


def area(name: str, x: float, y: float, long: float = 0.02, short: float = 0.02, share: float = 1.0) -> Area:
    return Area(Ellipse((x, y), (long, short), 0.0), share * pi * long * short, name)


def facts(
    *areas: Area, of: Domain | None = None, edge: str = "east", offset: float = 0.0
) -> dict[str, set[tuple[str, ...]]]:
    """Symbol -> the objects it holds for."""
    _, state = symbolize(areas, synthetic.scene(edge, offset), of or domain())
    return {name: {f.objects for f in state if f.symbol == name} for name in {f.symbol for f in state}}


def test_objects_are_the_areas_and_all_are_dirty() -> None:
    objects, state = symbolize([area("a2", 0, 0), area("a1", 0.3, 0.3)], synthetic.scene(), domain())
    assert objects == (Object("a1", "area"), Object("a2", "area"))
    assert {Fact("dirt", ("a1",)), Fact("dirt", ("a2",))} <= state
    assert symbolize([], synthetic.scene(), domain()) == ((), frozenset())


def test_at_the_rim_is_what_is_nearer_to_an_edge_than_half_a_rag_but_not_before_the_mouth() -> None:
    scene = synthetic.scene()
    half, reach = scene.surface.depth / 2, scene.rag.width / 2
    east = scene.surface.width / 2 - reach / 2
    beside = scene.container.width / 2 + 0.01
    places = {
        "inside": (0.0, half - reach - 0.001),
        "north": (0.0, half - reach + 0.001),
        "south": (0.0, -half + 0.01),
        "west": (-east, 0.0),
        "mouth": (east, 0.0),
        "beside": (east, beside),
    }
    found = facts(*(area(name, *place) for name, place in places.items()))["at_rim"]
    assert found == {("north",), ("south",), ("west",), ("beside",)}
    north = facts(area("a", 0.0, half - 0.01), area("b", east, 0.0), edge="north")["at_rim"]
    assert north == {("b",)}


@pytest.mark.parametrize(
    ("diameter", "size"),
    [(0.006, "small"), (0.05, "small"), (0.051, "medium"), (0.10, "medium"), (0.101, "big"), (0.4, "big")],
)
def test_size_is_the_longest_diameter(diameter: float, size: str) -> None:
    _, state = symbolize([area("a1", 0, 0, diameter / 2, 0.003)], synthetic.scene(), domain())
    assert {f for f in state if f.symbol == "size"} == {Fact("size", ("a1",), size)}


def test_scattered_is_thinly_covered() -> None:
    found = facts(area("a1", 0, 0, share=0.29), area("a2", 0.3, 0, share=0.31))
    assert found["scattered"] == {("a1",)}


def test_near_is_the_gap_between_ellipses_and_listed_once() -> None:
    found = facts(area("a2", 0, 0), area("a1", 0.239, 0), area("a3", -0.241, 0))
    assert found["near"] == {("a1", "a2")}
    both_ways = domain(symbol("dirt", "area"), symbol("near", "area", "area"))
    assert facts(area("a2", 0, 0), area("a1", 0.239, 0), of=both_ways)["near"] == {("a1", "a2"), ("a2", "a1")}


def test_traversal_holds_for_what_lies_in_the_strip_between() -> None:
    found = facts(area("a1", -0.3, 0.3), area("a2", 0.3, 0.3), area("a3", 0.0, 0.261), area("a4", 0.0, 0.259))
    between = {objects for objects in found["traversal"] if "bin" not in objects}
    assert ("a1", "a2", "a4") not in between
    assert {("a1", "a2", "a3"), ("a2", "a1", "a3")} <= between


def test_traversal_to_the_bin_follows_the_push() -> None:
    """The mouth is at x = 0.45, |y| <= 0.16; the rag, 12 cm wide, passes it at |y| <= 0.10. Of a1's ways the
    shortest passes a2; one that is a little longer takes a3 and a5 along as well."""
    found = facts(
        *(
            area(name, x, y, 0.003, 0.003)
            for name, x, y in (("a1", -0.2, 0.3), ("a2", 0.25, 0.12), ("a3", 0.42, 0.02), ("a4", -0.3, 0.33))
        ),
        area("a5", 0.0, 0.16, 0.003, 0.003),
        area("a6", 0.1, 0.14, 0.07, 0.07),
    )
    to_bin = {(a, m) for a, b, m in found["traversal"] if b == "bin"}
    assert {m for a, m in to_bin if a == "a1"} == {"a2", "a3", "a5"}
    assert {m for a, m in to_bin if a == "a2"} == {"a3"}, "it swerves to take a3 along"
    assert not {a for a, m in to_bin if m == "a6"}, "wider than the rag"
    assert not {m for a, m in to_bin if a == "a3"}
    assert {"a1", "a2"} <= {m for a, m in to_bin if a == "a4"}


def test_a_stroke_goes_onward_where_it_turns_little() -> None:
    """The mouth is at x = 0.45: not from there, nor from the side, nor from more than 45 cm away."""
    places = {
        "a1": (0.0, 0.0),
        "a2": (-0.3, 0.0),
        "a3": (0.1, 0.3),
        "a4": (-0.2, 0.25),
        "a5": (-0.36, 0.0),
        "a6": (-0.42, 0.27),
        "a7": (0.1, -0.1),
    }
    found = facts(*(area(name, *place) for name, place in places.items()))["onward"]
    assert {first for first, second in found if second == "a1"} == {"a2", "a4", "a5"}
    assert ("a1", "a2") not in found
    assert ("a5", "a2") in found, "6 cm apart"


def test_strokes_over_a_line_cover_a_mark_beside_it_and_not_the_other_way_round() -> None:
    """The rag is 12 cm wide, of which 10 are relied upon."""
    line, mark, far = area("a1", 0, 0, 0.1, 0.005), area("a2", 0.05, 0.07), area("a3", -0.05, 0.09)
    assert facts(line, mark, far)["covers"] == {("a1", "a2")}


@pytest.mark.parametrize("seed", range(10))
def test_what_is_onward_is_what_a_sweep_can_turn_by(seed: int) -> None:
    """The fact and the skill are asked about one table: the turn at the second area is that of the path."""
    rng = np.random.default_rng(seed)
    scene = synthetic.scene(str(rng.choice(["north", "east", "south", "west"])))
    places = rng.uniform((-0.4, -0.3), (0.4, 0.3), (8, 2))
    areas = tuple(area(f"a{n}", x, y, 0.002, 0.002) for n, (x, y) in enumerate(places))
    told = facts(*areas, edge=scene.container.edge).get("onward", set())
    for one, other in permutations(areas, 2):
        rest = [each.ellipse for each in areas if each not in (one, other)]
        path = tool_path("sweep2", (one.ellipse, other.ellipse), scene, rest)
        yaws = np.unwrap([w.yaw for w in path.waypoints if w.z <= 0])
        apart = np.hypot(*np.subtract(one.ellipse.centre, other.ellipse.centre))
        turn = np.degrees(abs(yaws[4] - yaws[1]))
        if abs(turn - 90) > 1.5 and abs(apart - 0.45) > 0.003:
            assert ((one.name, other.name) in told) == (turn < 90 and apart < 0.45), (turn, apart)


@pytest.mark.parametrize("seed", range(10))
def test_what_goes_to_the_dustpan_is_what_picking_two_up_can_turn_by(seed: int) -> None:
    """As above, with the turn to where the dustpan waits; a robot without one has no such stroke."""
    rng = np.random.default_rng(seed)
    places = rng.uniform((-0.4, -0.3), (0.4, 0.3), (8, 2))
    areas = tuple(area(f"a{n}", x, y, 0.03, 0.01) for n, (x, y) in enumerate(places))
    one_arm = synthetic.scene(str(rng.choice(["north", "east", "south", "west"])))
    scene = replace(one_arm, robot="reem")
    _, state = symbolize(areas, scene, domain())
    told = {fact.objects for fact in state if fact.symbol == "to_dustpan"}
    assert "to_dustpan" not in {fact.symbol for fact in symbolize(areas, one_arm, domain())[1]}
    for one, other in permutations(areas, 2):
        path = tool_path("pickUp2", (one.ellipse, other.ellipse), scene)
        yaws = np.unwrap([w.yaw for w in path.waypoints if w.z <= 0])
        apart = np.hypot(*np.subtract(one.ellipse.centre, other.ellipse.centre))
        turn = np.degrees(abs(yaws[4] - yaws[1]))
        if abs(turn - 90) > 1.5 and abs(apart - 0.45) > 0.003:
            assert ((one.name, other.name) in told) == (turn < 90 and apart < 0.45), (turn, apart)
    assert told, "some do"


@pytest.mark.parametrize("seed", range(20))
def test_what_a_push_takes_along_lies_on_its_path(seed: int) -> None:
    """The fact and the skill are asked about one table, and say the same."""
    rng = np.random.default_rng(seed)
    scene = synthetic.scene(str(rng.choice(["north", "east", "south", "west"])))
    places = rng.uniform((-0.4, -0.3), (0.4, 0.3), (12, 2))
    areas = tuple(area(f"a{n}", x, y, 0.01, 0.01) for n, (x, y) in enumerate(places))
    told = facts(*areas, edge=scene.container.edge)["traversal"]
    for one in areas:
        others = [other for other in areas if other is not one]
        path = tool_path("moveToContainerFast", (one.ellipse,), scene, [o.ellipse for o in others])
        corners = [(w.x, w.y) for w in path.waypoints if w.z <= 0]
        swept = Stroke((one.name,), tuple(corners), scene.symbols.traversal - 0.01)
        middles = np.array([other.ellipse.centre for other in others])
        along = {other.name for other, over in zip(others, swept.swept(middles, -0.002), strict=True) if over}
        wider = {other.name for other, over in zip(others, swept.swept(middles, 0.025), strict=True) if over}
        taken = {objects[2] for objects in told if objects[:2] == (one.name, "bin")}
        behind = {o.name for o in others if np.hypot(*np.subtract(o.ellipse.centre, corners[0])) < 0.09}
        assert along - behind <= taken <= wider


@pytest.mark.parametrize(
    ("edge", "offset", "place"),
    [
        ("east", 0.0, (0.45, 0.10)),
        ("west", 0.2, (-0.45, 0.25)),
        ("north", 0.0, (-0.10, 0.35)),
        ("south", -0.3, (-0.20, -0.35)),
    ],
)
def test_a_push_leads_to_the_nearest_place_with_room_for_the_rag(
    edge: str, offset: float, place: tuple[float, float]
) -> None:
    start = (-0.2, 0.25) if edge != "west" else (0.1, 0.25)
    assert place_at_mouth(start, synthetic.scene(edge, offset)) == pytest.approx(place)


def test_a_rag_wider_than_the_mouth_goes_to_its_middle() -> None:
    scene = synthetic.scene("east", 0.05)
    wide = replace(scene, rag=replace(scene.rag, width=0.5))
    assert place_at_mouth((0.0, 0.3), wide) == pytest.approx((0.45, 0.05))


def test_between_excludes_the_ends() -> None:
    def between(x: float, y: float, length: float = 1.0) -> bool:
        return lies_between(Ellipse((x, y), (0.04, 0.02), 0.0), (0, 0), (length, 0), 0.1)

    assert between(0.5, 0.079)
    assert not between(0.5, 0.081), "an end of it sticks out"
    assert not between(0.0, 0.0)
    assert not between(1.0, 0.0)
    assert not between(-0.1, 0.0)
    assert not between(0.5, 0.0, 0.0)


def test_what_the_domain_does_not_declare_is_left_out() -> None:
    areas = (area("a1", -0.1, 0, share=0.1), area("a2", 0, 0), area("a3", 0.1, 0))
    assert set(facts(*areas, of=domain(symbol("dirt", "area")))) == {"dirt"}
    odd = domain(
        symbol("dirt", "area"),
        symbol("near", "area"),
        symbol("scattered", "container"),
        symbol("traversal", "area", "area", "area"),
    )
    found = facts(*areas, of=odd)
    assert set(found) == {"dirt", "traversal"}
    assert not any("bin" in objects for objects in found["traversal"])


@pytest.mark.parametrize(
    "symbols", [(SIZE,), (symbol("dirt", "container"),), (symbol("dirt", "area", values=("much", "little")),)]
)
def test_a_domain_without_dirt_is_refused(symbols: tuple[Symbol, ...]) -> None:
    with pytest.raises(Refused, match=r"E514.*dirt\(\?a - area\)"):
        facts(area("a1", 0, 0), of=domain(*symbols))


@pytest.mark.parametrize(
    "odd",
    [symbol("size", "area", values=("tiny", "huge")), symbol("weight", "area", values=("light", "heavy"))],
)
def test_a_function_that_cannot_be_seen_is_refused(odd: Symbol) -> None:
    with pytest.raises(Refused, match="E515"):
        facts(area("a1", 0, 0), of=domain(symbol("dirt", "area"), odd))


def test_gone_areas_are_remembered_as_they_were_but_clean() -> None:
    before = frozenset(
        {
            Fact("dirt", ("a1",)),
            Fact("dirt", ("a2",)),
            Fact("size", ("a1",), "small"),
            Fact("size", ("a2",), "big"),
            Fact("near", ("a1", "a2")),
        }
    )
    assert remembered(before, {"a1"}) == {Fact("size", ("a1",), "small"), Fact("near", ("a1", "a2"))}
    assert remembered(before, set()) == frozenset()


@pytest.mark.parametrize(("x", "y"), [(1, 0), (-1, 0), (0, 1), (0, -1)])
def test_a_rag_reaches_beyond_the_rim_from_less_than_half_its_width(x: int, y: int) -> None:
    """Not from half its width, and not where the container stands. Lengths are those that a float holds."""
    given = synthetic.scene()
    width, depth = 1.0, 0.5
    setting = replace(
        given,
        surface=replace(given.surface, width=width, depth=depth),
        container=replace(given.container, edge="east", offset=0.0),
        rag=replace(given.rag, width=0.25),
    )
    for near, reaches in ((0.125, False), (0.124, True)):
        place = (x * (width / 2 - near), y * (depth / 2 - near))
        assert reaches_rim(place, setting) == (reaches and (x, y) != (1, 0))
