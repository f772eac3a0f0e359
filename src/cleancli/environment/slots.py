"""A fixed number of places for areas that come and go, so that arrays and actions keep their meaning.

Guaranteed by tracking: areas have names, and keep them from look to look.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations

from cleancli.language.model import Domain
from cleancli.perception.area import Area
from cleancli.perception.symbols import AREA

Slots = tuple[str | None, ...]
"""For each slot the name of the area in it, or None."""

Choice = tuple[str, tuple[int, ...]]
"""An action's name and the slots of its areas."""


def filled(slots: Slots, areas: Sequence[Area]) -> Slots:
    """The slots after a look: an area stays where it is, and free slots take those that have none, the one
    with most dirt first. Areas for which no slot is left are ignored for now (§4.2.1)."""
    seen = {area.name for area in areas}
    kept = tuple(name if name in seen else None for name in slots)
    waiting = iter(sorted((a for a in areas if a.name not in kept), key=lambda a: (-a.covered, a.name)))
    return tuple(next((a.name for a in waiting), None) if name is None else name for name in kept)


def choices(domain: Domain, number: int) -> tuple[Choice, ...]:
    """Every action of the domain with every choice of different slots, of which there are `number`; sorted
    as the domain declares its actions. An action that takes anything but areas is left out."""
    return tuple(
        (action.name, places)
        for action in domain.actions
        if all(domain.is_a(AREA, parameter.type) for parameter in action.parameters)
        for places in permutations(range(number), len(action.parameters))
    )
