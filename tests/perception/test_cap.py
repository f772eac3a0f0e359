"""A limit to what is planned for: which areas are left out."""

from __future__ import annotations

from dataclasses import replace

from cleancli.geometry.ellipse import Ellipse
from cleancli.perception.area import Area
from cleancli.perception.cap import left_out
from cleancli.scene.model import Scene
from support import synthetic


def area(name: str, x: float, covered: float) -> Area:
    return Area(Ellipse((x, 0.0), (0.02, 0.02), 0.0), covered, name)


AREAS = (area("a1", -0.3, 5e-4), area("a2", -0.1, 1e-4), area("a3", 0.1, 3e-4), area("a4", 0.3, 2e-4))


def scene(most: int, leave_out: str) -> Scene:
    """The container stands in the east."""
    plain = synthetic.scene()
    return replace(plain, symbols=replace(plain.symbols, most=most, leave_out=leave_out))


def test_the_smallest_or_the_farthest_are_left_out() -> None:
    assert left_out(AREAS, scene(2, "smallest")) == ("a2", "a4")
    assert left_out(AREAS, scene(2, "farthest")) == ("a1", "a2")
    assert left_out(AREAS, scene(4, "farthest")) == ()
    assert left_out((), scene(1, "smallest")) == ()


def test_what_is_left_out_comes_back_when_there_is_room() -> None:
    assert left_out(AREAS[:3], scene(2, "smallest")) == ("a2",)
    assert left_out(AREAS[:2], scene(2, "smallest")) == ()
