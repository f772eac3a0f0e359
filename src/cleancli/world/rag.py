"""The gantry and the rag it drags: joints x, y, z, yaw, and a row of spring-hinged flaps below a holder."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cleancli.scene.model import Rag
from cleancli.world import parameters as par
from cleancli.world.physics import Engine

_DRIVES = (0, 1, 2, 3)  # joint numbers of x, y, z, yaw
_UPRIGHT = [0, 0, 0, 1]


class Gantry:
    """The driven tool. Its pose is (x, y, z, yaw) of the rag's lower middle, as in a `Waypoint`."""

    def __init__(self, engine: Engine, rag: Rag, rng: np.random.Generator) -> None:
        self._engine = engine
        grasp = par.GRASPS[rag.grasp]
        offsets = flap_offsets(rag, grasp)
        gaps = grasp.gap_spread * rng.standard_normal(len(offsets))
        self._body = _assemble(engine, rag, grasp, offsets, gaps)
        self._configure(grasp, par.FLAP_LEAN + grasp.angle_spread * rng.standard_normal(len(offsets)))

    def place(self, pose: NDArray[np.float64]) -> None:
        """Stand at `pose` (4,) at once; only before the clock starts."""
        for joint, value in zip(_DRIVES, pose, strict=True):
            self._engine.resetJointState(self._body, joint, value)
        self.command(pose)

    def command(self, pose: NDArray[np.float64]) -> None:
        """Be at `pose` (4,) after the next step, as far as the joints' forces allow."""
        self._engine.setJointMotorControlArray(
            self._body,
            _DRIVES,
            self._engine.POSITION_CONTROL,
            targetPositions=pose.tolist(),
            forces=par.JOINT_FORCE,
            positionGains=(1.0, 1.0, 1.0, 1.0),
            velocityGains=(1.0, 1.0, 1.0, 1.0),
        )

    def pose(self) -> NDArray[np.float64]:
        """Where the joints are, (4,)."""
        return np.array([state[0] for state in self._engine.getJointStates(self._body, _DRIVES)])

    def flaps(self) -> NDArray[np.float64]:
        """(n, 3) middles of the flaps, metres."""
        count = self._engine.getNumJoints(self._body) - len(_DRIVES)
        links = range(len(_DRIVES), len(_DRIVES) + count)
        return np.array([self._engine.getLinkState(self._body, link)[0] for link in links])

    def _configure(self, grasp: par.Grasp, rest: NDArray[np.float64]) -> None:
        engine = self._engine
        for joint in _DRIVES:
            engine.changeDynamics(
                self._body, joint, localInertiaDiagonal=[par.CARRIAGE_INERTIA] * 3, linearDamping=0
            )
        for number, angle in enumerate(rest):
            link = len(_DRIVES) + number
            engine.changeDynamics(
                self._body, link, lateralFriction=par.FLAP_FRICTION, rollingFriction=0, spinningFriction=0
            )
            engine.setJointMotorControl2(
                self._body,
                link,
                engine.POSITION_CONTROL,
                targetPosition=angle,
                positionGain=grasp.gain,
                force=grasp.torque,
            )


def flap_offsets(rag: Rag, grasp: par.Grasp) -> NDArray[np.float64]:
    """(n, 3) where each flap stands in the bow: forward and sideways of the tool's middle, and its turn."""
    count = max(1, round(rag.width / grasp.flap_width))
    half = rag.width / 2
    aside = (np.arange(count) + 0.5) * rag.width / count - half
    forward = grasp.bow * (aside / half) ** 2
    turn = -np.arctan(2 * grasp.bow * aside / half**2)
    return np.stack((forward, aside, turn), axis=1)


def _assemble(
    engine: Engine, rag: Rag, grasp: par.Grasp, offsets: NDArray[np.float64], gaps: NDArray[np.float64]
) -> int:
    """One multibody on a fixed base: carriages for x, y, z, the turning holder, then the flaps."""
    count = len(offsets)
    half = [par.FLAP_THICKNESS / 2, rag.width / count / 2 * 0.96, par.FLAP_HEIGHT / 2]
    hang = [0, 0, -par.FLAP_HEIGHT / 2]
    flap = engine.createCollisionShape(engine.GEOM_BOX, halfExtents=half, collisionFramePosition=hang)
    colour = [*(c / 255 for c in par.RAG_COLOUR), 1]
    cloth = engine.createVisualShape(
        engine.GEOM_BOX, halfExtents=half, rgbaColor=colour, visualFramePosition=hang
    )
    prismatic, revolute = engine.JOINT_PRISMATIC, engine.JOINT_REVOLUTE
    lead, drop = par.FLAP_HEIGHT * np.sin(par.FLAP_LEAN), par.FLAP_HEIGHT * np.cos(par.FLAP_LEAN)
    hinges = [[x + lead, y, drop + gap] for (x, y, _), gap in zip(offsets, gaps, strict=True)]
    turns = [engine.getQuaternionFromEuler([0, 0, turn]) for turn in offsets[:, 2]]
    body: int = engine.createMultiBody(
        baseMass=0,
        linkMasses=[*par.CARRIAGE_MASS, *[par.FLAP_MASS] * count],
        linkCollisionShapeIndices=[-1] * 4 + [flap] * count,
        linkVisualShapeIndices=[-1, -1, -1, _holder(engine, rag), *[cloth] * count],
        linkPositions=[[0, 0, 0]] * 4 + hinges,
        linkOrientations=[_UPRIGHT] * 4 + turns,
        linkInertialFramePositions=[[0, 0, 0]] * 4 + [hang] * count,
        linkInertialFrameOrientations=[_UPRIGHT] * (4 + count),
        linkParentIndices=[0, 1, 2, 3] + [4] * count,
        linkJointTypes=[prismatic, prismatic, prismatic, revolute] + [revolute] * count,
        linkJointAxis=[[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1]] + [[0, 1, 0]] * count,
    )
    return body


def _holder(engine: Engine, rag: Rag) -> int:
    """The bar that clamps the cloth and the post that carries it: seen by the cameras, touched by nothing."""
    bar = [par.HOLDER_SIZE[0] / 2, rag.width / 2, par.HOLDER_SIZE[1] / 2]
    shape: int = engine.createVisualShapeArray(
        shapeTypes=[engine.GEOM_BOX, engine.GEOM_BOX],
        halfExtents=[bar, [par.POST_RADIUS, par.POST_RADIUS, par.POST_HEIGHT / 2]],
        rgbaColors=[[*(c / 255 for c in par.HOLDER_COLOUR), 1]] * 2,
        visualFramePositions=[
            [0, 0, par.FLAP_HEIGHT + bar[2]],
            [0, 0, par.FLAP_HEIGHT + par.HOLDER_SIZE[1] + par.POST_HEIGHT / 2],
        ],
    )
    return shape
