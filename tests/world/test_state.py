"""A table that is saved: in another process it goes on as the one that was never interrupted, bit for bit."""

from __future__ import annotations

import hashlib
import io
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from cleancli.geometry.ellipse import Ellipse
from cleancli.motion.actions import tool_path
from cleancli.scene.model import Group, Ink, Scene
from cleancli.world.robot import Status
from cleancli.world.state import TableState, bodies, from_arrays
from cleancli.world.table import PybulletTable
from support.tables import scene

PUSH = "moveToContainerStraight"


@dataclass(frozen=True)
class Trial:
    """Actions on a table, each upon an ellipse; its state is saved after so many control periods of the last
    one of `before`, None: at its end."""

    scene: Scene
    before: tuple[tuple[str, Ellipse], ...]
    after: tuple[tuple[str, Ellipse], ...]
    periods: int | None = None


def finish(table: PybulletTable, periods: int | None = None) -> None:
    while table.poll() is Status.RUNNING and periods != 0:
        periods = None if periods is None else periods - 1


def act(table: PybulletTable, scene: Scene, action: str, ellipse: Ellipse) -> None:
    table.start(tool_path(action, (ellipse,), scene))
    finish(table)
    assert not table.failure
    table.withdraw()
    finish(table)


def go_on(table: PybulletTable, trial: Trial) -> str:
    """What the table comes to by the trial's further actions, and all that is seen then, as a fingerprint."""
    finish(table)
    for action, ellipse in trial.after:
        act(table, trial.scene, action, ellipse)
    frame = table.observe()
    found = [*bodies(table._engine, table._particles), frame.colour, frame.depth, table.truth().ink]
    digest = hashlib.sha256(repr(table.clock).encode())
    for array in found:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def go_on_elsewhere(trial: Trial, written: bytes) -> str:
    """`go_on` for a table built from a state in a process of its own."""
    with np.load(io.BytesIO(written)) as arrays:
        state = from_arrays(dict(arrays))
    with closing(PybulletTable(trial.scene, 5, state=state)) as table:
        return go_on(table, trial)


def written(state: TableState) -> bytes:
    file, arrays = io.BytesIO(), dict[str, Any](state.arrays())
    np.savez(file, **arrays)
    return file.getvalue()


FIRST, SECOND = Ellipse((-0.10, 0.05), (0.03, 0.025), 0.3), Ellipse((0.10, -0.15), (0.03, 0.025), 0.3)
DIRT = Group(8, FIRST.centre, 0.025), Group(8, SECOND.centre, 0.025, "peas")
LINE = Ink(((-0.12, 0.05), (-0.08, 0.05)), 0.008)


def trial(name: str) -> Trial:
    match name:
        case "reem":
            middle = Ellipse((0.05, -0.02), (0.03, 0.03), 0.0)
            dirt = Group(8, middle.centre, 0.025)
            setting = scene(dirt, edge="south", robot="reem", size=(0.50, 0.40))
            return Trial(setting, (("pickUp", middle),), ((PUSH, middle),))
        case "in the middle of a stroke":
            return Trial(scene(LINE, *DIRT), ((PUSH, FIRST),), (), periods=250)
        case robot:
            return Trial(scene(*DIRT, robot=robot), ((PUSH, FIRST),), ((PUSH, SECOND),))


@pytest.mark.parametrize("name", ["gantry", "wam", "reem", "in the middle of a stroke"])
def test_it_goes_on_the_same_in_another_process(name: str) -> None:
    made = trial(name)
    with closing(PybulletTable(made.scene, 5)) as table:
        for action, ellipse in made.before:
            table.start(tool_path(action, (ellipse,), made.scene))
            finish(table, made.periods)
            assert not table.failure
            if made.periods is None:
                table.withdraw()
                finish(table)
            else:
                assert table.poll() is Status.RUNNING
        clock, places = table.clock, table.truth().positions
        state = table.save()
        assert table.clock == clock
        np.testing.assert_array_equal(table.truth().positions, places)
        here = go_on(table, made)
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        there = pool.submit(go_on_elsewhere, made, written(state)).result(timeout=120)
    assert here == there


def test_saving_hardly_moves_what_rests() -> None:
    with closing(PybulletTable(scene(*DIRT), 5)) as table:
        before = table.truth().positions
        table.save()
        for _ in range(480):
            table._engine.stepSimulation()
        moved = np.linalg.norm(table.truth().positions - before, axis=1)
    # Two seconds alone let one in a heap creep as far; perception is right to millimetres.
    assert moved.max() < 3e-4
    assert np.median(moved) < 1e-5


def test_a_state_of_another_table_is_refused() -> None:
    with closing(PybulletTable(scene(*DIRT), 5)) as table:
        state = table.save()
    with pytest.raises(ValueError, match="of another table"):
        PybulletTable(scene(DIRT[0]), 5, state=state)
    with pytest.raises(ValueError, match="of another table"):
        PybulletTable(scene(*DIRT, robot="wam"), 5, state=state)


def test_saving_often_keeps_no_engine() -> None:
    with closing(PybulletTable(scene(DIRT[0]), 5)) as table:
        client = table._engine._client
        for _ in range(5):
            table.save()
        assert table._engine._client == client
