"""`robot check` against drivers that break the protocol in one way each, and against one that keeps to it."""

from __future__ import annotations

import json
import time
from dataclasses import replace

import pytest

from cleancli.cli.main import run
from cleancli.remote import conformance as steps
from cleancli.remote.client import Client
from cleancli.remote.conformance import HELLO, MOVING_STEPS, STILL_STEPS, conformance
from cleancli.world.robot import Status
from support.broken_drivers import BROKEN, FAULTS, broken
from support.toy_driver import TOY, Toy, path, served

LEASE = "stops when nobody polls"


@pytest.fixture(autouse=True)
def _hurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """A toy that has arrived is over at once."""
    monkeypatch.setattr(steps, "ARRIVED", 0.3)


def test_a_driver_that_keeps_to_the_protocol_has_no_fault() -> None:
    with served(Toy()) as server:
        found = list(conformance(server.address))
        assert [each.step for each in found] == [HELLO, *STILL_STEPS, *MOVING_STEPS]
        assert [each.fault for each in found] == [""] * len(found)
        assert server.guard.state.trip == "", "it is left as it was found"


def test_a_motion_that_is_over_before_its_lease_is_no_reason_to_trip(monkeypatch: pytest.MonkeyPatch) -> None:
    """The motion that nobody polls must outlast the lease, also from the middle, where ways are short."""
    monkeypatch.setattr(steps, "MOVING_STEPS", {LEASE: MOVING_STEPS[LEASE]})
    toy = Toy()
    toy.start(path((0.0, 0.0, 0.1), speed=100.0))
    with served(toy, lease=1.0) as server:
        trip = server.guard.trip

        def trips_in_motion(reason: str) -> None:
            if toy.clock < toy.ends:
                trip(reason)
            server.guard._due = None

        monkeypatch.setattr(server.guard, "trip", trips_in_motion)
        assert [each.fault for each in conformance(server.address) if each.step == LEASE] == [""]


@pytest.mark.parametrize("fault", ["", "never-ends"])
def test_a_busy_machine_is_no_fault_of_a_driver(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lease runs out between two polls, and the robot trips as it must."""
    monkeypatch.setattr(steps, "SLOW", 5.0)
    stalls = iter([False] * 3 + [True, False, True])

    class Stalled(BROKEN[fault][0] if fault else Toy):  # type: ignore[misc]
        def poll(self) -> Status:
            if next(stalls, False):
                time.sleep(2 * TOY.lease)
            return Status(super().poll())

    monkeypatch.setattr(steps, "MOVING_STEPS", dict(list(MOVING_STEPS.items())[:1]))
    with served(Stalled()) as server:
        assert [each.fault for each in conformance(server.address) if each.step not in STILL_STEPS] == [
            "",
            fault,
        ]
    assert next(stalls, None) is None, "it has stalled as often as it should"


@pytest.mark.parametrize("fault", FAULTS)
def test_a_broken_driver_fails_by_its_name(
    fault: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(steps, "SLOW", 5.0)  # a busy machine is no fault of a driver
    began = time.monotonic()
    with broken(fault) as address:
        assert run(["robot", "check", str(address), "--json"]) == 6
    found = {each["fault"] for each in json.loads(capsys.readouterr().out)["steps"]}
    assert fault in found
    assert time.monotonic() - began < 60, "nothing hangs"


def test_a_robot_that_is_not_to_move_does_not(capsys: pytest.CaptureFixture[str]) -> None:
    toy = Toy()
    before = toy.tool
    with served(toy) as server:
        assert run(["robot", "check", str(server.address), "--still"]) == 0
    assert capsys.readouterr().out.splitlines() == [f"{step}: yes" for step in (HELLO, *STILL_STEPS)]
    assert (toy.tool[0], toy.tool[1]) == before[:2]


def test_a_robot_that_another_client_controls_is_not_checked(capsys: pytest.CaptureFixture[str]) -> None:
    """Its driver has no fault."""
    with served(Toy()) as server, Client(server.address):
        assert run(["robot", "check", str(server.address)]) == 6
        out, err = capsys.readouterr()
        assert (out, "another client has control" in err) == ("", True)


def test_a_workspace_that_begins_higher_is_moved_in(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its driver refuses what is below."""
    monkeypatch.setattr(steps, "MOVING_STEPS", {"carries a motion out": MOVING_STEPS["carries a motion out"]})
    high = replace(TOY.limits, low=(-0.5, -0.4, 0.15))
    with served(Toy(), limits=high) as server:
        assert {each.fault for each in conformance(server.address)} == {""}


def test_a_robot_that_has_tripped_is_not_checked(capsys: pytest.CaptureFixture[str]) -> None:
    with served(Toy()) as server:
        server.guard.trip("somebody came in")
        assert run(["robot", "check", str(server.address)]) == 6
        assert "somebody came in" in capsys.readouterr().err
        assert server.guard.state.trip
