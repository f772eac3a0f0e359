"""The one place where pybullet is imported: an engine of its own for each table, or a clear refusal."""

from __future__ import annotations

import os
import sys
from functools import partial
from typing import Any

from cleancli.world import constants as par
from cleancli.world.errors import MissingPhysics


class Engine:
    """One pybullet client, perhaps with a window: the module's functions, with the client already chosen."""

    def __init__(self, window: bool = False) -> None:
        self._pybullet = _import_pybullet()
        mode = self._pybullet.GUI if window else self._pybullet.DIRECT
        self._client: int = self._pybullet.connect(mode)
        self.setGravity(0, 0, par.GRAVITY)
        self.setPhysicsEngineParameter(
            fixedTimeStep=par.STEP,
            numSolverIterations=par.SOLVER_ITERATIONS,
            contactBreakingThreshold=par.CONTACT_BREAKING,
            deterministicOverlappingPairs=1,
        )

    def __getattr__(self, name: str) -> Any:
        attribute = getattr(self._pybullet, name)
        if callable(attribute):
            attribute = partial(attribute, physicsClientId=self._client)
        self.__dict__[name] = attribute  # found once: a motion makes thousands of calls
        return attribute

    def close(self) -> None:
        """Disconnect; the engine can't be used afterwards."""
        self._pybullet.disconnect(self._client)


def _import_pybullet() -> Any:
    """pybullet, imported without the build time it prints from C, past Python's own streams."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = os.dup(1), os.dup(2)
    quiet = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        import pybullet
    except ImportError as error:
        raise MissingPhysics from error
    finally:
        os.dup2(kept[0], 1)
        os.dup2(kept[1], 2)
        for descriptor in (*kept, quiet):
            os.close(descriptor)
    return pybullet
