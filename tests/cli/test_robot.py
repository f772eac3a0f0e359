"""`cleancli robot`: the simulated table in a process of its own, and what a person says to a driver."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import pytest

from cleancli.cli.main import run
from cleancli.execution.seeds import Stream, derived
from cleancli.motion.path import Interpolation, along
from cleancli.remote.client import Client, Refusal
from cleancli.scene.address import Address, address_of
from cleancli.world.robot import Status, finish
from cleancli.world.table import PybulletTable
from support.shipped import shipped_scene
from support.toy_driver import Toy, path, served

STROKE = along(((0.1, 0.0, 0.0), (0.2, 0.05, 0.0)), 0.2, Interpolation.STRAIGHT)


@contextmanager
def serving(*words: str) -> Iterator[tuple[subprocess.Popen[str], Address]]:
    """`robot serve` in a process of its own, and where it listens."""
    command = [sys.executable, "-m", "cleancli", "robot", "serve", *words, "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            told = re.search(r"listens at (\S+),", process.stdout.readline())
            assert told is not None
            yield process, address_of(told[1])
        finally:
            process.kill()


def trace(client: Client, motion: int | Refusal) -> list[tuple[float, float, float, float]]:
    """Clock and tool after each poll of a motion."""
    assert isinstance(motion, int), motion
    found = []
    while client.poll(motion).status is Status.RUNNING:
        found.append((client.state.clock, *client.state.tool))
    return found


@pytest.mark.needs_pybullet
def test_in_lockstep_the_table_moves_as_without_a_socket() -> None:
    with serving("two_groups", "--seed", "3") as (process, address), Client(address) as client:
        found = trace(client, client.start(STROKE))
        depth = client.observe().depth
        client.close()
        process.send_signal(signal.SIGINT)
        said, wrong = process.communicate(timeout=20)
    assert (process.returncode, wrong) == (0, "")
    assert said.splitlines() == ["a client has control", "the client has gone"]
    scene = replace(shipped_scene("two_groups"), seed=3)
    table = PybulletTable(scene, derived(3, Stream.WORLD))
    table.start(STROKE)
    alone = []
    while table.poll() is Status.RUNNING:
        alone.append((table.clock, *table.tool))
    assert found == alone
    assert (table.observe().depth == depth).all()
    table.close()


@pytest.mark.needs_pybullet
def test_in_real_time_motions_go_on_by_themselves_and_last_as_long() -> None:
    with serving("two_groups", "--seed", "3", "--real-time") as (_, address), Client(address) as client:
        clocks = [clock for clock, *_ in trace(client, client.start(STROKE))]
        ended = client.state.clock
        assert isinstance(client.withdraw(), int)
        assert client.description.robot == "simulated gantry"
    table = PybulletTable(shipped_scene("two_groups"), derived(3, Stream.WORLD))
    table.start(STROKE)
    finish(table)
    assert ended == table.clock
    assert clocks == sorted(clocks)
    table.close()


@pytest.mark.needs_pybullet
def test_a_table_is_served_on_where_nobody_reads_what_it_says() -> None:
    with serving("two_groups") as (process, address):
        assert process.stdout is not None
        process.stdout.close()
        for _ in range(2):
            with Client(address) as client:
                assert client.state.trip == ""
        process.send_signal(signal.SIGTERM)
        assert process.stderr is not None
        assert (process.stderr.read(), process.wait(timeout=20)) == ("", 5), "its lines could not be written"


@pytest.mark.needs_pybullet
def test_a_port_that_is_taken_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with served(Toy()) as server:
        port = server.address.port
        assert run(["robot", "serve", "two_groups", "--port", str(port)]) == 5
    told = f"error: port {port} is in use; say another one by `--port`, or 0 for one that is free\n"
    assert capsys.readouterr().err == told


def test_a_person_re_arms(capsys: pytest.CaptureFixture[str]) -> None:
    with served(Toy()) as server:
        address = str(server.address)
        assert run(["robot", "rearm", address]) == 0
        assert capsys.readouterr().out == "toy has not tripped\n"
        server.guard.trip("somebody stood in the way")
        assert run(["robot", "rearm", address]) == 0
        assert capsys.readouterr().out == "toy may move again; it had tripped: somebody stood in the way\n"
        assert isinstance(server.guard.start(path((0.0, 0.0, 0.1))), int)
    assert run(["robot", "rearm", address]) == 6
    assert f"no driver answers at {address}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "Missing command"),
        (["rearm"], "Missing argument"),
        (["rearm", "10.1.2.3:7420"], "ssh -N -L 7420:127.0.0.1:7420 10.1.2.3"),
        (["rearm", "7420"], "a host and a port"),
        (["serve", "two_groups", "--lease", "0.01"], "--lease"),
        (["serve", "two_groups", "--port", "70000"], "--port"),
    ],
)
def test_what_makes_no_sense_is_told(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["robot", *words]) == 2
    assert said in capsys.readouterr().err


def test_waiting_for_a_driver_is_told(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Slow(Toy):
        @property
        def clock(self) -> float:
            time.sleep(0.1)
            return super().clock

    monkeypatch.setenv("CLEANCLI_PROGRESS_AFTER", "0.05")
    with served(Slow()) as server:
        assert run(["robot", "rearm", str(server.address)]) == 0
        assert capsys.readouterr().err == f"waiting for the driver at {server.address} ...\n"
        assert run(["robot", "check", "--still", "--json", str(server.address)]) == 0
        assert capsys.readouterr().err == f"checking the driver at {server.address} ...\n"
