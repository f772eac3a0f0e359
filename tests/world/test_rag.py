"""The rag's flaps: how fast they can make what they touch."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from cleancli.scene.grasps import SHIPPED
from cleancli.scene.model import Rag
from cleancli.world import constants as par
from cleancli.world.table import PybulletTable
from support.tables import scene


@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_a_bent_flap_springs_back_no_faster_than_its_gain_says(name: str) -> None:
    """docs/world.md: so fast may a lentil be that a flap flicks, and no faster than that and the tool."""
    grasp = SHIPPED[name]
    setting = replace(scene(), rag=Rag(grasp, grasp.width))
    with closing(PybulletTable(setting, 1)) as table:
        engine, body = table._engine, table._drive._body  # type: ignore[attr-defined]
        flaps = range(4, engine.getNumJoints(body))
        rests = [engine.getJointState(body, flap)[0] for flap in flaps]
        for flap, rest in zip(flaps, rests, strict=True):
            engine.resetJointState(body, flap, rest + pi / 2)
        speeds = []
        for _ in range(60):
            engine.stepSimulation()
            speeds.append([abs(engine.getJointState(body, flap)[1]) * par.FLAP_HEIGHT for flap in flaps])
        left = [
            abs(engine.getJointState(body, flap)[0] - rest) for flap, rest in zip(flaps, rests, strict=True)
        ]
    fastest = np.max(speeds)
    limit = pi / 2 * grasp.gain / par.STEP * par.FLAP_HEIGHT
    assert limit / 2 < fastest < 1.01 * limit
    assert max(left) < 0.1, "all have sprung back"
