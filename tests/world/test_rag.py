"""The rag's flaps: how fast they can make what they touch."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path
from cleancli.scene.grasps import SHIPPED
from cleancli.scene.model import Rag
from cleancli.world import constants as par
from cleancli.world.robot import Status
from cleancli.world.robots.arm_drive import TOOL
from cleancli.world.table import PybulletTable
from support.tables import scene

LINK, FORCE = 3, 9  # of a contact, as the engine tells it


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


@pytest.mark.parametrize(("robot", "first_flap"), [("gantry", 4), ("reem", TOOL + 1)])
@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_a_pressed_rag_gives_way_and_the_tool_stays_on_its_way(
    robot: str, first_flap: int, name: str
) -> None:
    """§7: pressing against the surface with force. No cloth is a strut that lifts an arm and lets it jump."""
    grasp = SHIPPED[name]
    setting = replace(scene(edge="west", robot=robot, size=(0.50, 0.40)), rag=Rag(grasp, grasp.width))
    areas = Ellipse((-0.03, -0.12), (0.04, 0.02), 1.3), Ellipse((-0.15, -0.07), (0.03, 0.01), 1.1)
    for seed in range(2):
        with closing(PybulletTable(setting, seed)) as table:
            engine, drive = table._engine, table._drive
            arm: Any = getattr(drive, "_right", drive)
            body = arm._body
            table.start(tool_path("join2", areas, setting))
            strays, forces = [], []
            while table.poll() is Status.RUNNING:
                strays.append(drive.stray())
                touching = engine.getContactPoints(body)
                forces.append(sum(c[FORCE] for c in touching if c[LINK] >= first_flap))
            assert table.failure == ""
        assert max(strays) < 2e-3
        assert 1.0 < np.percentile(forces, 95) < 60.0
