"""What perception tells of the table, as arrays of a fixed size: a row per slot, zeros where it is empty."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from math import cos, hypot, sin
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from cleancli.environment.slots import Slots
from cleancli.language.model import Domain, State, Symbol
from cleancli.perception.area import Area
from cleancli.perception.symbols import AREA
from cleancli.scene.model import Scene

Arrays = dict[str, Any]


def observation_space(domain: Domain, scene: Scene, slots: int, image: bool) -> spaces.Dict:
    """`areas` (slots, 7), `present` (slots,), `symbol_NAME` for every symbol of the domain that is said of
    objects, and, if asked for, the camera's `image` (height, width, 3). docs/gym.md has the units."""
    width, depth = scene.surface.width, scene.surface.depth
    longest = hypot(width, depth)
    high = np.array((width, depth, longest, longest, 1, 1, width * depth), np.float32)
    low = np.array((-width, -depth, 0, 0, -1, -1, 0), np.float32)
    parts: dict[str, spaces.Space[Any]] = {
        "areas": spaces.Box(np.tile(low, (slots, 1)), np.tile(high, (slots, 1)), dtype=np.float32),
        "present": spaces.MultiBinary(slots),
    }
    for symbol in _told(domain):
        shape = tuple(len(objects) for objects in _arguments(symbol, domain, (None,) * slots))
        most = 1 if symbol.is_predicate else len(symbol.values)
        parts[f"symbol_{symbol.name}"] = spaces.Box(0, most, shape, np.uint8)
    if image:
        size = (scene.camera.image_height, scene.camera.image_width, 3)
        parts["image"] = spaces.Box(0, 255, size, np.uint8)
    return spaces.Dict(parts)


def observed(
    domain: Domain,
    slots: Slots,
    areas: Sequence[Area],
    state: State,
    space: spaces.Dict,
) -> Arrays:
    """The arrays of `observation_space` but for the image, new ones at every call."""
    by_name = {area.name: area for area in areas}
    rows = [_row(by_name[name]) if name is not None else (0.0,) * 7 for name in slots]
    box = space["areas"]
    assert isinstance(box, spaces.Box)
    arrays: Arrays = {
        "areas": np.clip(np.array(rows, np.float32), box.low, box.high),
        "present": np.array([name is not None for name in slots], np.int8),
    }
    for symbol in _told(domain):
        arrays[f"symbol_{symbol.name}"] = _values(symbol, domain, slots, state)
    return arrays


def _row(area: Area) -> tuple[float, ...]:
    """An ellipse is the same after half a turn, so the angle stands there doubled."""
    ellipse = area.ellipse
    turn = 2 * ellipse.angle
    return (*ellipse.centre, *ellipse.axes, cos(turn), sin(turn), area.covered)


def _told(domain: Domain) -> tuple[Symbol, ...]:
    return tuple(symbol for symbol in domain.symbols if symbol.parameters)


def _arguments(symbol: Symbol, domain: Domain, slots: Slots) -> list[list[str | None]]:
    """What each argument may be: the slots, if it may be an area, and then the domain's constants."""
    return [
        [
            *(slots if domain.is_a(AREA, parameter.type) else ()),
            *(constant.name for constant in domain.constants if domain.is_a(constant.type, parameter.type)),
        ]
        for parameter in symbol.parameters
    ]


def _values(symbol: Symbol, domain: Domain, slots: Slots, state: State) -> NDArray[np.uint8]:
    """1 where a predicate holds; for a function, 1 + the number of its value, as declared."""
    arguments = _arguments(symbol, domain, slots)
    array = np.zeros([len(objects) for objects in arguments], np.uint8)
    for fact in (fact for fact in state if fact.symbol == symbol.name):
        number = 1 if symbol.is_predicate else 1 + symbol.values.index(fact.value)
        orders = permutations(fact.objects) if symbol.symmetric else (fact.objects,)
        for place in filter(None, (_place(names, arguments) for names in orders)):
            array[place] = number
    return array


def _place(names: Sequence[str], arguments: Sequence[Sequence[str | None]]) -> tuple[int, ...] | None:
    """Where the names stand among what each argument may be; None where one of them does not."""
    pairs = list(zip(names, arguments, strict=True))
    if not all(name in objects for name, objects in pairs):
        return None
    return tuple(objects.index(name) for name, objects in pairs)
