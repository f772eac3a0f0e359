"""The layouts of Fig. 6: what the paper tells of them, and that all three robots have them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cleancli.scene.model import Group, Ink, Scattered, Scene
from support.shipped import shipped_scene as scene

PREFIXES = {"": "gantry", "wam_": "wam", "reem_": "reem"}


def _lentils(table: Scene) -> int:
    assert not any(isinstance(dirt, Ink) for dirt in table.dirt)
    return sum(dirt.count for dirt in table.dirt if isinstance(dirt, (Group, Scattered)))


@pytest.mark.parametrize(("prefix", "robot"), PREFIXES.items())
@pytest.mark.parametrize("letter", "abcdef")
def test_each_robot_has_each_layout_with_as_many_lentils(prefix: str, robot: str, letter: str) -> None:
    table = scene(f"{prefix}layout_{letter}")
    assert table.robot == robot
    assert _lentils(table) == _lentils(scene(f"layout_{letter}"))


def test_layouts_are_as_the_paper_tells() -> None:
    """Section 6: two groups in the simplest, up to forty scattered in the hardest, and in f thirty in small
    groups and spread."""
    for prefix in PREFIXES:
        simplest, hardest, learned = (scene(f"{prefix}layout_{letter}") for letter in "aef")
        assert [type(dirt) for dirt in simplest.dirt] == [Group, Group]
        assert [type(dirt) for dirt in hardest.dirt] == [Scattered]
        assert _lentils(hardest) == 40
        assert {type(dirt) for dirt in learned.dirt} == {Group, Scattered}
        assert _lentils(learned) == 30


def test_layout_e_is_scattered_40() -> None:
    assert replace(scene("layout_e"), name="scattered_40") == scene("scattered_40")
