"""The rag: a row of spring-hinged flaps below a holder, to be mounted on the last link of any drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cleancli.array_types import Floats
from cleancli.scene.model import Grasp, Rag
from cleancli.world import constants as par
from cleancli.world.multibody import Link
from cleancli.world.physics import Engine


@dataclass(frozen=True, slots=True)
class Cloth:
    """Flaps as `links` of a body, `rests` (n,) the angles their hinges spring back to, radians."""

    links: tuple[Link, ...]
    rests: Floats
    grasp: Grasp


def hang(engine: Engine, rag: Rag, mount: int, rng: np.random.Generator) -> Cloth:
    """Flaps below link `mount`, whose frame is that of the tool: origin at the rag's lower middle, x where it
    pushes to, z up."""
    grasp = rag.grasp
    offsets = flap_offsets(rag)
    gaps, rests = flap_errors(rag, rng)
    half = [par.FLAP_THICKNESS / 2, rag.width / len(offsets) / 2 * 0.96, par.FLAP_HEIGHT / 2]
    below = (0.0, 0.0, -par.FLAP_HEIGHT / 2)
    flap = engine.createCollisionShape(engine.GEOM_BOX, halfExtents=half, collisionFramePosition=below)
    colour = [*(c / 255 for c in par.RAG_COLOUR), 1]
    cloth = engine.createVisualShape(
        engine.GEOM_BOX, halfExtents=half, rgbaColor=colour, visualFramePosition=below
    )
    lead, drop = par.FLAP_HEIGHT * np.sin(par.FLAP_LEAN), par.FLAP_HEIGHT * np.cos(par.FLAP_LEAN)
    links = tuple(
        Link(
            parent=mount,
            joint=engine.JOINT_REVOLUTE,
            axis=(0, 1, 0),
            mass=par.FLAP_MASS,
            position=(x + lead, y, drop + gap),
            orientation=engine.getQuaternionFromEuler([0, 0, turn]),
            middle=below,
            touched=flap,
            seen=cloth,
        )
        for (x, y, turn), gap in zip(offsets, gaps, strict=True)
    )
    return Cloth(links, rests, grasp)


def spring(engine: Engine, body: int, first: int, cloth: Cloth) -> None:
    """Give the flaps their friction, give and springs, once `body` is assembled; `first` is the first's
    link."""
    for link, rest in enumerate(cloth.rests, first):
        engine.changeDynamics(
            body,
            link,
            lateralFriction=par.FLAP_FRICTION,
            rollingFriction=0,
            spinningFriction=0,
            contactStiffness=par.CLOTH_STIFFNESS * cloth.grasp.flap,
            contactDamping=par.CLOTH_DAMPING * cloth.grasp.flap,
        )
        engine.setJointMotorControl2(
            body,
            link,
            engine.POSITION_CONTROL,
            targetPosition=rest,
            positionGain=cloth.grasp.gain,
            force=cloth.grasp.torque,
        )


def flap_middles(engine: Engine, body: int, first: int) -> Floats:
    """(n, 3) middles of the flaps, which are the links of `body` from `first` on, metres."""
    links = range(first, engine.getNumJoints(body))
    return np.array([engine.getLinkState(body, link)[0] for link in links])


def flap_offsets(rag: Rag) -> Floats:
    """(n, 3) where each flap stands in its row: forward and sideways of the tool's middle, and its turn.

    The row is bowed, then both its halves are swept back, then all of it is turned by the skew.
    """
    grasp = rag.grasp
    count = max(1, round(rag.width / grasp.flap))
    half = rag.width / 2
    aside = (np.arange(count) + 0.5) * rag.width / count - half
    back = np.tan(grasp.sweep)
    forward = grasp.bow * (aside / half) ** 2 - back * np.abs(aside)
    turn = -np.arctan(2 * grasp.bow * aside / half**2 - back * np.sign(aside)) + grasp.skew
    cos, sin = np.cos(grasp.skew), np.sin(grasp.skew)
    return np.stack((cos * forward - sin * aside, sin * forward + cos * aside, turn), axis=1)


def flap_errors(rag: Rag, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """How each flap of this cloth hangs, (n,) each: how much too high its hinge is, metres, and the angle
    that it springs back to, radians."""
    count, grasp = len(flap_offsets(rag)), rag.grasp
    gaps = grasp.gap_spread * rng.standard_normal(count)
    return gaps, par.FLAP_LEAN + grasp.angle_spread * rng.standard_normal(count)


def edge_heights(rag: Rag, rng: np.random.Generator) -> Floats:
    """(n,) how far above the tool's height the lower edge of each flap is, metres."""
    gaps, rests = flap_errors(rag, rng)
    edges: Floats = gaps + par.FLAP_HEIGHT * (np.cos(par.FLAP_LEAN) - np.cos(rests))
    return edges


def holder(engine: Engine, rag: Rag, post: float) -> int:
    """The bar that clamps the cloth and the post, so high, that carries it, in the tool's frame: seen by the
    cameras, touched by nothing."""
    bar = [par.HOLDER_SIZE[0] / 2, rag.width / 2, par.HOLDER_SIZE[1] / 2]
    shape: int = engine.createVisualShapeArray(
        shapeTypes=[engine.GEOM_BOX, engine.GEOM_BOX],
        halfExtents=[bar, [par.POST_RADIUS, par.POST_RADIUS, post / 2]],
        rgbaColors=[[*(c / 255 for c in par.HOLDER_COLOUR), 1]] * 2,
        visualFramePositions=[
            [0, 0, par.FLAP_HEIGHT + bar[2]],
            [0, 0, par.FLAP_HEIGHT + par.HOLDER_SIZE[1] + post / 2],
        ],
    )
    return shape
