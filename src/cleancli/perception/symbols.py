"""From geometry to symbols (§3.3.1): named areas become the objects and the state that rules speak of.

docs/perception.md defines every symbol. A domain need not declare all of them; a predicate that it does not
declare, or declares for other types, is left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from itertools import chain, combinations, permutations
from math import atan2, dist, hypot, radians, remainder, tau

from cleancli.geometry.ellipse import Ellipse, extent, gap, reach
from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Fact, Object, State, Symbol
from cleancli.motion.actions import PICK_UP, TO_ZONE, can_execute
from cleancli.motion.pick_up import to_pan
from cleancli.motion.way_out import way_out
from cleancli.motion.wiping import strokes_over
from cleancli.motion.zone import way_in
from cleancli.perception.area import Area
from cleancli.scene.model import Scene, SymbolThresholds

AREA = "area"
CONTAINER = "container"
ZONE = "zone"
SIZES = ("small", "medium", "big")
GREATEST_TURN = 90.0
"""Degrees by which a stroke may turn at an area on its way: measured, up to that the rag loses nothing there
(python benchmarks/stand_in.py --part turn)."""

Point = tuple[float, float]


def symbolize(areas: Sequence[Area], scene: Scene, domain: Domain) -> tuple[tuple[Object, ...], State]:
    """One object per named area, and all that is true of them.

    Raises Refused (E514, E515, E518) for a domain that perception cannot tell what it needs.
    """
    _refuse_what_is_not_seen(domain, scene)
    facts = chain(
        (Fact("dirt", (area.name,)) for area in areas),
        _scattered(areas, domain, scene.symbols),
        _size(areas, domain, scene.symbols),
        _near(areas, domain, scene.symbols),
        _traversal(areas, domain, scene.symbols),
        _traversal_to_container(areas, domain, scene),
        _traversal_to_zone(areas, domain, scene),
        _onward(areas, domain, scene),
        _to_dustpan(areas, domain, scene),
        _at_rim(areas, domain, scene),
        _covers(areas, domain, scene),
    )
    return tuple(Object(name, AREA) for name in sorted(area.name for area in areas)), frozenset(facts)


def _refuse_what_is_not_seen(domain: Domain, scene: Scene) -> None:
    """A state gives every function a value for every area, and cleaning is about dirt."""
    mistakes = []
    if not _declared(domain, "dirt", AREA):
        message = f"the domain `{domain.name}` declares no `dirt(?a - area)`, which a scene needs"
        mistakes.append(Diagnostic("E514", message, None, help="add it to `predicates`"))
    for symbol in domain.symbols:
        is_size = symbol.name == "size" and _takes(symbol, domain, AREA) and set(SIZES) <= set(symbol.values)
        if not symbol.is_predicate and not is_size:
            message = f"perception gives the function `{symbol.name}` of the domain `{domain.name}` no value"
            advice = "a scene can tell `size(?a - area): small < medium < big`, and no other function"
            mistakes.append(Diagnostic("E515", message, None, help=advice))
    if scene.zone is None and any(action.name in TO_ZONE for action in domain.actions):
        message = f"the domain `{domain.name}` pushes into a zone, and the scene `{scene.name}` has none"
        advice = "add `zone { at = (0 cm, 0 cm) }` to the scene"
        mistakes.append(Diagnostic("E518", message, None, help=advice))
    if mistakes:
        raise Refused(mistakes)


def remembered(before: State, gone: Set[str]) -> State:
    """What to keep of areas that are seen no more: all that was known of them but that they are dirty.

    So a state after an action differs from the one before it in nothing that was not seen to change.
    """
    return frozenset(fact for fact in before if not gone.isdisjoint(fact.objects) and fact.symbol != "dirt")


def size_of(area: Area, thresholds: SymbolThresholds) -> str:
    """The size by the longest diameter of the ellipse."""
    diameter = 2 * area.ellipse.axes[0]
    if diameter <= thresholds.small:
        return "small"
    return "medium" if diameter <= thresholds.medium else "big"


def is_scattered(area: Area, thresholds: SymbolThresholds) -> bool:
    """Whether dirt covers a smaller share of the ellipse than `density`."""
    return area.covered < thresholds.density * extent(area.ellipse)


def are_near(first: Ellipse, second: Ellipse, thresholds: SymbolThresholds) -> bool:
    """Whether the gap between two ellipses is at most `near`."""
    return gap(first, second) <= thresholds.near


def lies_between(area: Ellipse, start: Point, end: Point, half_width: float) -> bool:
    """Whether an area's middle is strictly between two places along their line, and none of the area is more
    than `half_width` beside it."""
    along_x, along_y = end[0] - start[0], end[1] - start[1]
    length = hypot(along_x, along_y)
    if length == 0:
        return False
    from_x, from_y = area.centre[0] - start[0], area.centre[1] - start[1]
    along = (from_x * along_x + from_y * along_y) / length
    beside = abs(from_x * along_y - from_y * along_x) / length
    beside += reach(area, (along_y / length, -along_x / length))
    return 0 < along < length and beside <= half_width


def place_at_mouth(point: Point, scene: Scene) -> Point:
    """Where a push from `point` leads: the nearest point of the mouth with room for the whole rag."""
    (x0, y0), (x1, y1) = scene.mouth()
    margin = min(scene.rag.width, scene.container.width) / 2
    if x0 == x1:
        return x0, min(max(point[1], y0 + margin), y1 - margin)
    return min(max(point[0], x0 + margin), x1 - margin), y0


def reaches_rim(place: Point, scene: Scene) -> bool:
    """Whether a rag whose middle goes over `place` can reach beyond an edge where no container stands."""
    (x, y), surface, container = place, scene.surface, scene.container
    margins = {
        "east": surface.width / 2 - x,
        "west": surface.width / 2 + x,
        "north": surface.depth / 2 - y,
        "south": surface.depth / 2 + y,
    }
    along = y if container.edge in ("east", "west") else x
    if abs(along - container.offset) <= container.width / 2:
        del margins[container.edge]
    return min(margins.values()) < scene.rag.width / 2


def _declared(domain: Domain, name: str, *types: str) -> bool:
    """Whether the domain has a predicate of the name that can be said of objects of these types."""
    symbol = _symbol(domain, name)
    return symbol is not None and symbol.is_predicate and _takes(symbol, domain, *types)


def _symbol(domain: Domain, name: str) -> Symbol | None:
    return next((symbol for symbol in domain.symbols if symbol.name == name), None)


def _takes(symbol: Symbol, domain: Domain, *types: str) -> bool:
    """Whether the symbol can be said of objects of these types."""
    known = {declared.name for declared in domain.types}
    return len(symbol.parameters) == len(types) and all(
        name in known and domain.is_a(name, parameter.type)
        for name, parameter in zip(types, symbol.parameters, strict=True)
    )


def _scattered(areas: Sequence[Area], domain: Domain, thresholds: SymbolThresholds) -> Iterator[Fact]:
    if _declared(domain, "scattered", AREA):
        yield from (Fact("scattered", (area.name,)) for area in areas if is_scattered(area, thresholds))


def _size(areas: Sequence[Area], domain: Domain, thresholds: SymbolThresholds) -> Iterator[Fact]:
    if _symbol(domain, "size") is not None:
        yield from (Fact("size", (area.name,), size_of(area, thresholds)) for area in areas)


def _near(areas: Sequence[Area], domain: Domain, thresholds: SymbolThresholds) -> Iterator[Fact]:
    symbol = _symbol(domain, "near")
    if symbol is None or not _declared(domain, "near", AREA, AREA):
        return
    for first, second in combinations(areas, 2):
        if are_near(first.ellipse, second.ellipse, thresholds):
            pair = first.name, second.name
            # A domain that does not declare `near` symmetric is told both ways round.
            yield from (Fact(symbol.name, symbol.canonical(names)) for names in (pair, pair[::-1]))


def _traversal(areas: Sequence[Area], domain: Domain, thresholds: SymbolThresholds) -> Iterator[Fact]:
    if not _declared(domain, "traversal", AREA, AREA, AREA):
        return
    for start, end, middle in permutations(areas, 3):
        ends = start.ellipse.centre, end.ellipse.centre
        if lies_between(middle.ellipse, *ends, thresholds.traversal):
            yield Fact("traversal", (start.name, end.name, middle.name))


def _traversal_to_container(areas: Sequence[Area], domain: Domain, scene: Scene) -> Iterator[Fact]:
    """What a push of each area takes along, on the way that the skill goes (motion/way_out.py); a scene has
    one container, so every container constant means that one."""
    if not _declared(domain, "traversal", AREA, CONTAINER, AREA):
        return
    for area in areas:
        others = {other.ellipse: other.name for other in areas if other is not area}
        taken = way_out(area.ellipse.centre, scene, others).takes
        yield from _taken_along(area, CONTAINER, (others[each] for each in taken), domain)


def _traversal_to_zone(areas: Sequence[Area], domain: Domain, scene: Scene) -> Iterator[Fact]:
    """The same of pushes into the zone (motion/zone.py), which a scene has one of at most."""
    if scene.zone is None or not _declared(domain, "traversal", AREA, ZONE, AREA):
        return
    for area in areas:
        others = {other.ellipse: other.name for other in areas if other is not area}
        taken = way_in(area.ellipse, scene, others).takes
        yield from _taken_along(area, ZONE, (others[each] for each in taken), domain)


def _taken_along(area: Area, kind: str, taken: Iterable[str], domain: Domain) -> Iterator[Fact]:
    """That areas lie between one and each constant of a type."""
    ends = [constant.name for constant in domain.constants if domain.is_a(constant.type, kind)]
    for middle in sorted(taken):
        yield from (Fact("traversal", (area.name, name, middle)) for name in ends)


def _onward(areas: Sequence[Area], domain: Domain, scene: Scene) -> Iterator[Fact]:
    """Which areas a stroke that comes from another one may take up on its way into the container."""
    if not _declared(domain, "onward", AREA, AREA):
        return
    for second in areas:
        middle = second.ellipse.centre
        others = [area for area in areas if area is not second]
        way = way_out(middle, scene, (area.ellipse for area in others)).corners
        on = _direction(middle, way[1])
        for first in _leading(others, second, on, scene):
            yield Fact("onward", (first.name, second.name))


def _to_dustpan(areas: Sequence[Area], domain: Domain, scene: Scene) -> Iterator[Fact]:
    """Which areas a stroke that comes from another one may take up on its way to the dustpan, which waits on
    the left of the second (motion/pick_up.py); nothing where the robot has none."""
    if not _declared(domain, "to_dustpan", AREA, AREA) or not can_execute(PICK_UP, 1, scene.arms):
        return
    x, y = to_pan(scene)
    for second in areas:
        others = [area for area in areas if area is not second]
        for first in _leading(others, second, atan2(y, x), scene):
            yield Fact("to_dustpan", (first.name, second.name))


def _leading(firsts: Sequence[Area], second: Area, on: float, scene: Scene) -> Iterator[Area]:
    """Those from which a stroke may go over the second area and on from there in the direction `on`,
    radians."""
    for first in firsts:
        apart = dist(first.ellipse.centre, second.ellipse.centre)
        turn = abs(remainder(on - _direction(first.ellipse.centre, second.ellipse.centre), tau))
        if apart <= scene.symbols.onward and turn <= radians(GREATEST_TURN):
            yield first


def _at_rim(areas: Sequence[Area], domain: Domain, scene: Scene) -> Iterator[Fact]:
    if _declared(domain, "at_rim", AREA):
        yield from (Fact("at_rim", (a.name,)) for a in areas if reaches_rim(a.ellipse.centre, scene))


def _covers(areas: Sequence[Area], domain: Domain, scene: Scene) -> Iterator[Fact]:
    """Which areas the strokes over each one wipe as well, by the way that they go (motion/wiping.py)."""
    if not _declared(domain, "covers", AREA, AREA):
        return
    for area in areas:
        others = {other.ellipse: other.name for other in areas if other is not area}
        for ellipse in strokes_over(area.ellipse, scene, others).covers:
            yield Fact("covers", (area.name, others[ellipse]))


def _direction(begin: Point, end: Point) -> float:
    return atan2(end[1] - begin[1], end[0] - begin[0])
