"""How long plans expect actions to take, against how long the robots' own motions take."""

from __future__ import annotations

from contextlib import closing, suppress

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import ARITIES, PICK_UPS, TO_ZONE, tool_path
from cleancli.motion.duration import expected_seconds
from cleancli.motion.path import Unreachable
from cleancli.world import constants as par
from cleancli.world.table import PybulletTable
from support.shipped import shipped_scene


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [("two_groups", 0.93, 1.2), ("wam_groups", 0.95, 1.35), ("reem_pick_up", 1.0, 1.5)],
)
def test_what_is_expected_is_about_what_the_robot_takes(name: str, least: float, most: float) -> None:
    """docs/execution.md: within a few hundredths on the gantry, a little less than arms take."""
    scene, rng, shares = shipped_scene(name), np.random.default_rng(3), []
    half = np.array((scene.surface.width, scene.surface.depth)) / 2 - 0.06
    with closing(PybulletTable(scene, 1)) as table:
        x, y, *_ = table._drive.tool().tolist()
        for action, arity in ARITIES.items():
            for _ in range(0 if action in (*PICK_UPS, *TO_ZONE) else 3):
                middles = rng.uniform(-half, half, (arity, 2))
                areas = tuple(Ellipse((float(a), float(b)), (0.03, 0.02), 0.3) for a, b in middles)
                path = tool_path(action, areas, scene)
                with suppress(Unreachable):
                    steps = len(table._drive.follow(path, np.zeros(4)))
                    shares.append(steps * par.STEP / expected_seconds(path, (x, y)))
    assert len(shares) > 8
    assert least < min(shares) <= max(shares) < most
