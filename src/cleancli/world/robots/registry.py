"""The table of robots: a scene's `robot` is the name of a row."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from cleancli.array_types import Bools, Floats
from cleancli.motion.joint_path import reached
from cleancli.scene.model import Scene
from cleancli.world.physics import Engine
from cleancli.world.robots import constants, wam
from cleancli.world.robots.arm_drive import ArmDrive, arm_extent, rag_for
from cleancli.world.robots.drive import Drive
from cleancli.world.robots.gantry import Gantry, gantry_extent, within_reach
from cleancli.world.robots.reem import Reem, build_for
from cleancli.world.robots.reem import arm_for as reem_arm


@dataclass(frozen=True, slots=True)
class RobotType:
    """How a robot is built, and which tool poses (n, 4) it can bring the rag to. A picture for people holds
    the points (n, 3) of its `extent`, seen from an `aspect`: an angle from the container's side, radians."""

    build: Callable[[Engine, Scene, np.random.Generator], Drive]
    reaches: Callable[[Floats, Scene], Bools]
    extent: Callable[[Scene], Floats]
    aspect: float


def _wam(engine: Engine, scene: Scene, rng: np.random.Generator) -> Drive:
    arm = wam.arm_for(scene)
    return ArmDrive(engine, arm, wam.BUILD, rag_for(engine, arm, scene.rag, rng))


def _wam_reaches(points: Floats, scene: Scene) -> Bools:
    return reached(wam.arm_for(scene), points)


def _reem_reaches(points: Floats, scene: Scene) -> Bools:
    return reached(reem_arm(scene, 1), points)


def _wam_extent(scene: Scene) -> Floats:
    return arm_extent(wam.arm_for(scene), wam.BUILD)


def _reem_extent(scene: Scene) -> Floats:
    return np.concatenate([arm_extent(reem_arm(scene, side), build_for(side)) for side in (1, -1)])


ROBOTS: Mapping[str, RobotType] = MappingProxyType(
    {
        "gantry": RobotType(Gantry, within_reach, gantry_extent, constants.GANTRY_ASPECT),
        "wam": RobotType(_wam, _wam_reaches, _wam_extent, constants.WAM_ASPECT),
        "reem": RobotType(Reem, _reem_reaches, _reem_extent, constants.REEM_ASPECT),
    }
)
