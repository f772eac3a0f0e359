"""Links as data, and the pybullet multibody that is built of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cleancli.world.physics import Engine

_Triple = tuple[float, float, float]
_Quaternion = tuple[float, float, float, float]

UPRIGHT: _Quaternion = (0, 0, 0, 1)
NOTHING = -1  # the shape of what can't be touched or seen


@dataclass(frozen=True, slots=True)
class Link:
    """One link and the joint that carries it; `parent` is the number of a link of the body, -1 the base.

    `position` (m) and `orientation` are those of the link in its parent's frame, `middle` (m) is where its
    mass is in its own; `joint` is one of the engine's JOINT_ numbers, moving along or about `axis`.
    """

    parent: int
    joint: int
    axis: _Triple
    mass: float
    position: _Triple = (0, 0, 0)
    orientation: _Quaternion = UPRIGHT
    middle: _Triple = (0, 0, 0)
    touched: int = NOTHING
    seen: int = NOTHING


def assemble(engine: Engine, links: Sequence[Link], seen: int = NOTHING) -> int:
    """One body on a base that stands still at the origin and looks like `seen`; links are numbered in
    order."""
    body: int = engine.createMultiBody(
        baseMass=0,
        baseVisualShapeIndex=seen,
        linkMasses=[link.mass for link in links],
        linkCollisionShapeIndices=[link.touched for link in links],
        linkVisualShapeIndices=[link.seen for link in links],
        linkPositions=[link.position for link in links],
        linkOrientations=[link.orientation for link in links],
        linkInertialFramePositions=[link.middle for link in links],
        linkInertialFrameOrientations=[UPRIGHT for _ in links],
        linkParentIndices=[link.parent + 1 for link in links],
        linkJointTypes=[link.joint for link in links],
        linkJointAxis=[link.axis for link in links],
    )
    return body
