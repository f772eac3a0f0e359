"""A zone in a scene: read, checked, printed."""

from __future__ import annotations

from math import radians

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.scene.check import load_scene
from cleancli.scene.format import print_scene
from cleancli.scene.model import Scene, Zone

DIRT = "dirt { group { count = 3  at = (0 cm, 0 cm)  radius = 2 cm } }"


def scene(zone: str) -> Scene:
    return load_scene(Source("s.nid", f"scene s {{ {zone} {DIRT} }}"))


def test_a_zone_is_read_and_printed_and_there_is_none_by_default() -> None:
    assert scene("").zone is None
    found = scene("zone { at = (10 cm, -5 cm)  side = 9 cm  turn = 30 deg }")
    assert found.zone == Zone((0.1, -0.05), 0.09, radians(30))
    assert load_scene(Source("s.nid", print_scene(found))) == found
    assert scene("zone { at = (0 cm, 0 cm) }").zone == Zone((0.0, 0.0), 0.12, 0.0)


def test_a_turned_zone_reaches_as_far_as_its_corners() -> None:
    scene("zone { at = (38.9 cm, 0 cm) }")
    scene("zone { at = (36.5 cm, 0 cm)  turn = 45 deg }")
    for wrong in ("zone { at = (39.1 cm, 0 cm) }", "zone { at = (36.6 cm, 0 cm)  turn = -45 deg }"):
        with pytest.raises(Refused, match="E508"):
            scene(wrong)
