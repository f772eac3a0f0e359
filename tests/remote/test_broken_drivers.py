"""Whatever a driver does wrong, `execute` ends in time and with a reason."""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest

import cleancli
from cleancli.execution.events import Event, Failed
from cleancli.remote.messages import FramePair
from cleancli.world.camera import overhead
from cleancli.world.errors import RobotError
from support.broken_drivers import FAULTS, broken
from support.scripted_robot import painted
from support.shipped import shipped_scene
from support.toy_driver import TOY, Toy

SCENE = shipped_scene("two_groups")
TOLD = {
    "stamp-past": "before it was asked for",
    "stamp-future": "after it came",
    "unpaired": "s apart",
    "clock-back": "its clock runs back",
    "wrong-sizes": "`depth` is float32 of 3 x 4",
    "garbage": "a message begins with",
}
"""Those that a run cannot go on with."""
FAILED = {"never-ends": "the motion does not end", "ends-at-once": "cm from its end"}
"""Those that make motions fail."""


class Seeing(Toy):
    """A toy that sees a table with two dirty spots, whatever it does."""

    pace = 20.0

    def observe(self) -> FramePair:
        camera, surface = overhead(SCENE.camera), SCENE.surface
        frame = painted(camera, surface.width, surface.depth, ((-0.2, 0.1), (0.1, -0.15)), None)
        now, focal = (self.clock, self.clock), (camera.focal, camera.focal)
        return FramePair(frame.colour, frame.depth, *now, focal, camera.centre, camera.pose)


@pytest.fixture(autouse=True)
def _hurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Motions of the toy take at most some seconds of its clock; its limits are wide enough for strokes, and
    its lease for a busy machine."""
    limits = replace(TOY.limits, low=(-1.0, -1.0, -0.1), high=(1.0, 1.0, 1.0))
    monkeypatch.setattr("support.broken_drivers.TOY", replace(TOY, limits=limits, lease=30.0))
    monkeypatch.setattr("cleancli.world.robot.LONGEST", 20.0)


@pytest.mark.parametrize("fault", FAULTS)
def test_execute_ends(fault: str, tmp_path: Path) -> None:
    scene = tmp_path / "lab.nid"
    events: list[Event] = []
    began = time.monotonic()
    with broken(fault, Seeing) as address:
        scene.write_text(f'scene lab {{ robot {{ drive = remote  address = "{address}" }} }}')
        asked = partial(cleancli.execute, "cleaning", scene, strategy="reactive", max_actions=2)
        if fault in TOLD:
            with pytest.raises(RobotError, match=TOLD[fault]):
                asked(runs=tmp_path / "runs")
        else:
            done = asked(runs=tmp_path / "runs", on_event=events.append)
            told = [done.reason, *(event.reason for event in events if isinstance(event, Failed))]
            assert not done.clean
            assert any(reason in each for each in told for reason in FAILED.values()) == (fault in FAILED)
            assert any(FAILED.get(fault, "") in each for each in told)
    assert time.monotonic() - began < 60
