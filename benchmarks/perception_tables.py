"""Random tables for perception.py: what lies on them, how they look, are lit, and are looked at."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, replace
from math import cos, pi, radians, sin

import numpy as np

from cleancli.geometry.rgbd import Frame
from cleancli.motion.joint_path import nearest_pose
from cleancli.motion.path import Unreachable
from cleancli.perception import geometry
from cleancli.perception.calibrate import NotClean, calibrate
from cleancli.scene.grasps import WIDE
from cleancli.scene.model import (
    CameraSetup,
    Container,
    Dirt,
    Group,
    Ink,
    Light,
    Rag,
    Scattered,
    Scene,
    Surface,
    SymbolThresholds,
)
from cleancli.world import camera as world_camera
from cleancli.world import constants as par
from cleancli.world.robot import finish
from cleancli.world.robots.arm_drive import ArmDrive
from cleancli.world.robots.gantry import Gantry
from cleancli.world.robots.wam import arm_for
from cleancli.world.table import PybulletTable

SURFACES = {
    "beige": (205, 198, 184),
    "white": (232, 232, 228),
    "grey": (140, 142, 146),
    "wood": (170, 130, 90),
    "dark": (78, 70, 64),
    "blue": (96, 120, 160),
    "green": (120, 150, 120),
}
COLOURS = ((150, 40, 40), (30, 60, 120), (60, 100, 40), (235, 225, 190), (40, 36, 34), (170, 120, 40))
LEAST_CONTRAST = 0.25
"""Dirt is drawn in colours that differ from the surface's by at least this share of its brightness."""
CALIBRATION_FRAMES = 5


@dataclass(frozen=True)
class Condition:
    """What a table was drawn to be, in words, for the tables."""

    kind: str
    colour: str
    texture: str
    light: str
    noise: str
    tilt: str
    tool: str


def drawn(seed: int) -> tuple[Scene, Condition, float]:
    """A scene that the checker accepts, its condition, and the extra noise of colour."""
    rng = np.random.default_rng([seed, 0])
    name = str(rng.choice(list(SURFACES)))
    kind = str(rng.choice(("lentils", "rice", "peas", "ink"), p=(0.4, 0.2, 0.2, 0.2)))
    texture, gradient = float(rng.choice((0.0, 0.0, 0.015, 0.03))), float(rng.choice((0.0, 0.0, 0.15, 0.3)))
    degrees, extra = (0.0, float(rng.uniform(5, 30)))[int(rng.random() < 0.6)], float(rng.choice((0.0, 3.0)))
    tool = {0: "arm", 3: "gantry"}.get(seed % 6, "away")
    top = Surface(0.8, 0.6, 0.45, SURFACES[name], texture=texture, grain=float(rng.uniform(0.01, 0.03)))
    light = Light(rng.uniform(-pi, pi), radians(rng.uniform(45, 85)), rng.uniform(0.5, 0.8), gradient)
    scene = Scene(
        f"table_{seed}",
        top,
        Container("east", 0.0, 0.3, 0.16),
        "wam" if tool == "arm" else "gantry",
        Rag(WIDE, 0.12),
        CameraSetup(0.9, 640, 480, 525),
        layout(kind, top, rng),
        SymbolThresholds(0.05, 0.06, 0.12, 0.14, 0.20, 0.05),
        seed,
        light=light,
    )
    scene = placed(scene, radians(degrees), rng.uniform(-pi, pi))
    lit = "gradient" if gradient else "even"
    slant = "0" if not degrees else "5-18" if degrees < 18 else "18-30"
    texture_word = f"{texture:g}" if texture else "none"
    return scene, Condition(kind, str(name), texture_word, lit, "4.2" if extra else "3", slant, tool), extra


def layout(kind: str, top: Surface, rng: np.random.Generator) -> tuple[Dirt, ...]:
    """One to four groups, and some scattered, of one kind and colour; or lines of ink, and a few lentils."""
    colour = colour_against(kind, top.colour, rng)
    high = top.width / 2 - 0.06, top.depth / 2 - 0.06
    low = -high[0], -high[1]
    if kind == "ink":
        lines = []
        for _ in range(rng.integers(1, 4)):
            start = rng.uniform(low, high)
            end = np.clip(start + rng.uniform(-0.12, 0.12, 2), low, high)
            lines.append(Ink((tuple(start), tuple(end)), float(rng.uniform(0.005, 0.01)), colour))
        return tuple(lines)
    dirt: list[Dirt] = [
        Group(int(rng.integers(4, 16)), tuple(rng.uniform(low, high)), rng.uniform(0.015, 0.04), kind, colour)
        for _ in range(rng.integers(1, 5))
    ]
    if rng.random() < 0.6:
        dirt.append(Scattered(int(rng.integers(3, 20)), low, high, kind, colour))
    return tuple(dirt)


def colour_against(kind: str, ground: tuple[int, int, int], rng: np.random.Generator) -> tuple[int, int, int]:
    """A colour of the kind's own, or another, that can be told from the surface's."""
    own = (par.INK_COLOUR,) if kind == "ink" else par.PARTICLES[kind].colours
    able = [c for c in (*own, *COLOURS) if contrast(c, ground) >= LEAST_CONTRAST]
    return able[int(rng.integers(len(able)))]


def contrast(colour: tuple[int, int, int], ground: tuple[int, int, int]) -> float:
    """As a share of the ground's brightness, root of the mean square of the channels."""
    return float(np.sqrt(np.mean(np.subtract(colour, ground) ** 2)) / np.mean(ground))


def placed(scene: Scene, tilt: float, azimuth: float) -> Scene:
    """The scene with its camera tilted, as near as it sees the whole surface."""
    signs = np.array([(-1, -1), (-1, 1), (1, -1), (1, 1)])
    corners = signs * (scene.surface.width, scene.surface.depth) / 2
    for distance in np.arange(0.85, 3.0, 0.05):
        side = distance * sin(tilt)
        at = (side * cos(azimuth), side * sin(azimuth))
        camera = replace(scene.camera, height=distance * cos(tilt), at=at)
        pixels = geometry.project(world_camera.overhead(camera), corners)
        if (pixels >= 0).all() and (pixels <= (camera.image_width, camera.image_height)).all():
            return replace(scene, camera=camera)
    raise ValueError("no place for the camera")


def calibrated(scene: Scene, seed: int, extra: float, rng: np.random.Generator) -> Scene:
    """The scene with thresholds from its surface without dirt."""
    with closing(PybulletTable(replace(scene, dirt=()), seed)) as table:
        withdrawn(table)
        frames = look(table, scene, CALIBRATION_FRAMES, extra, rng)
    try:
        return replace(scene, calibration=calibrate(frames, scene, "drawn", rng).calibration)
    except NotClean:
        return scene


def in_view(table: PybulletTable, scene: Scene, rng: np.random.Generator) -> None:
    """The robot with its tool on the surface, or up to 10 cm above it, wherever it reaches."""
    while True:
        x, y = rng.uniform((-0.25, -0.2), (0.25, 0.2))
        point = np.array((x, y, rng.uniform(0.0, 0.1), rng.uniform(-pi, pi)))
        try:
            joints = point if scene.robot == "gantry" else nearest_pose(arm_for(scene), point)
        except Unreachable:
            continue
        drive = table._drive
        assert isinstance(drive, Gantry | ArmDrive)
        drive.stand(joints)
        return


def withdrawn(table: PybulletTable) -> None:
    table.withdraw()
    finish(table)


def look(
    table: PybulletTable, scene: Scene, number: int, extra: float, rng: np.random.Generator
) -> list[Frame]:
    """So many frames, each with noise of its own: that of the simulated camera, and `extra` of colour."""
    colour, depth = world_camera.render(table._engine, table._camera, scene.light, table._finish)
    frames = []
    for clock in range(number):
        seen = world_camera.noisy_colour(colour, rng)
        if extra:
            noise = extra * rng.standard_normal(seen.shape, dtype=np.float32)
            seen = np.clip(np.round(seen + noise), 0, 255).astype(np.uint8)
        frames.append(Frame(seen, world_camera.noisy_depth(depth, rng), table._camera, float(clock)))
    return frames
