"""The simulated table as a driver in real time, on a table without physics."""

from __future__ import annotations

import threading
import time
from typing import cast

import pytest

from cleancli.motion.path import ToolPath
from cleancli.remote.simulated import PERIOD, SimulatedDriver
from cleancli.world.robot import Status, finish
from cleancli.world.table import PybulletTable
from support.toy_driver import path

HOP = path((0.0, 0.0, 0.1))


class Endless:
    """A table on which a motion goes on until it is stopped, or until a poll fails."""

    def __init__(self) -> None:
        self.polls, self.fails = 0, False
        self.tool = (0.0, 0.0, 0.1)

    @property
    def clock(self) -> float:
        """Seconds of its motions."""
        return self.polls * PERIOD

    def start(self, path: ToolPath) -> None:
        """Nothing to plan."""

    def poll(self) -> Status:
        """One period more."""
        if self.fails:
            raise RuntimeError("the engine is gone")
        self.polls += 1
        return Status.RUNNING

    def stop(self) -> None:
        """Nothing to raise."""


@pytest.fixture
def table() -> Endless:
    return Endless()


@pytest.fixture
def driver(table: Endless) -> SimulatedDriver:
    return SimulatedDriver(cast(PybulletTable, table), real_time=True)


def movers() -> int:
    return sum(thread.name == "motion" for thread in threading.enumerate())


def test_a_motion_that_follows_a_stop_at_once_goes_no_faster(driver: SimulatedDriver) -> None:
    """Else what moved the table before would move it along."""
    before = movers()
    for _ in range(3):
        driver.start(HOP)
        driver.stop()
    driver.start(HOP)
    patient_until = time.monotonic() + 10
    while movers() > before + 1 and time.monotonic() < patient_until:
        time.sleep(PERIOD)
    assert movers() == before + 1
    assert driver.poll() is Status.RUNNING
    driver.stop()
    assert driver.poll() is Status.DONE


def test_what_fails_while_the_table_moves_by_itself_is_raised_to_who_polls(
    driver: SimulatedDriver, table: Endless
) -> None:
    """The guard then trips; a motion that hangs for ever would tell nobody why."""
    table.fails = True
    driver.start(HOP)
    with pytest.raises(RuntimeError, match="the engine is gone"):
        finish(driver)
