"""What lies in a zone is no dirty area, and is told apart from it even where it is seen beside its place."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from math import radians

import numpy as np
import pytest

from cleancli.motion.zone import inwards
from cleancli.perception.look import FRAMES_PER_LOOK
from cleancli.perception.perceive import Observation, perceive
from cleancli.scene.model import Group, Scene, Zone
from cleancli.world.table import PybulletTable
from support.shipped import shipped_scene


def looked(scene: Scene, seed: int = 1) -> tuple[Observation, PybulletTable]:
    with closing(PybulletTable(scene, seed)) as table:
        frames = [table.observe() for _ in range(FRAMES_PER_LOOK)]
        return perceive(frames, scene, np.random.default_rng(seed)), table


def with_blocks(zone: Zone, *places: tuple[float, float]) -> Scene:
    return replace(
        shipped_scene("piles"), zone=zone, dirt=tuple(Group(1, place, 1e-4, "blocks") for place in places)
    )


@pytest.mark.parametrize("east", [-0.38, 0.0, 0.38])
def test_blocks_in_the_zone_are_no_areas_wherever_it_lies(east: float) -> None:
    """Far from below the camera a block is seen up to 4 mm beside its place."""
    zone = Zone((east, 0.15), 0.12, radians(20))
    inside = [(east - 0.03, 0.15), (east + 0.03, 0.16), (east, 0.12)]
    outside = [(east - 0.10, 0.15), (east + 0.02, 0.05)]
    found, _ = looked(with_blocks(zone, *inside, *outside))
    assert len(found.areas) == 2
    seen = sorted(area.ellipse.centre for area in found.areas)
    assert np.abs(np.array(seen) - sorted(outside)).max() < 0.006
    assert found.arrived == pytest.approx(3 / 5, abs=0.04)


@pytest.mark.parametrize("east", [-0.38, 0.38])
@pytest.mark.parametrize("side", [-1, 1])
def test_a_block_at_the_border_is_told_by_its_place(east: float, side: int) -> None:
    """By its depth: half a centimetre within the border it is gone, and as far beyond it an area."""
    zone = Zone((east, 0.0), 0.12, 0.0)
    border = east + side * 0.06
    within, _ = looked(with_blocks(zone, (border - side * 0.008, 0.0)))
    assert within.areas == ()
    beyond, _ = looked(with_blocks(zone, (border + side * 0.008, 0.0)))
    assert len(beyond.areas) == 1


def test_without_a_zone_all_dirt_is_in_areas_and_nothing_has_arrived() -> None:
    scene = replace(with_blocks(Zone((0.0, 0.0), 0.12, 0.0), (0.0, 0.0)), zone=None)
    found, _ = looked(scene)
    assert (len(found.areas), found.arrived) == (1, None)


def test_the_truth_counts_blocks_by_their_middles_and_each_once() -> None:
    scene = replace(shipped_scene("piles"), zone=Zone((0.0, 0.0), 0.12, 0.4))
    with closing(PybulletTable(scene, 2)) as table:
        truth = table.truth()
    places = truth.positions[:, :2]
    assert truth.in_zone == int((inwards(scene.zone or Zone((9, 9), 0, 0), places) >= 0).sum()) > 5
    assert truth.in_zone + truth.on_table == truth.total == 50
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + np.eye(50)
    assert apart.min() > 0.01, "blocks lie beside each other"
    assert (truth.positions[:, 2] < 0.006).all()
