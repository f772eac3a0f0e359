"""`cleancli robot`: a robot at the end of a socket (docs/protocol.md)."""

from __future__ import annotations

import errno
import json
from contextlib import closing, suppress
from dataclasses import asdict
from typing import Any

import click

from cleancli.cli import options
from cleancli.cli.command_table import group_of
from cleancli.cli.completion import problems
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.inputs import open_simulated
from cleancli.cli.progress import counted, working
from cleancli.execution.seeds import Stream, derived
from cleancli.remote.client import Client
from cleancli.scene.address import PORT, Address, address_of
from cleancli.scene.robots import ARMS


class _AddressOf(click.ParamType[Address]):
    """A port of this machine."""

    name = "address"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Address:
        if isinstance(value, Address):
            return value
        try:
            return address_of(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)


@group_of("robot")
def command() -> None:
    """A robot at the end of a socket: its driver is a program of its own, which a scene names by
    `robot { drive = remote  address = "127.0.0.1:7420" }`.
    """


@command.command("serve", short_help="Put the simulated table of a scene behind the protocol.")
@click.argument("scene", shell_complete=problems)
@click.option("--robot", type=click.Choice(list(ARMS)), help="The robot that acts. [default: the scene's]")
@click.option(
    "--port",
    type=click.IntRange(0, (1 << 16) - 1),
    default=PORT,
    show_default=True,
    help="Port of this machine to listen at; 0 takes one that is free.",
)
@click.option("--real-time", is_flag=True, help="Motions go on by themselves, as long as they take.")
@click.option(
    "--lease",
    type=click.FloatRange(0.1, 60),
    default=1.0,
    show_default=True,
    help="Seconds without a poll after which a motion is stopped and the robot trips.",
)
@options.seed("where dirt lies, and of all noise")
def serve(scene: str, robot: str | None, port: int, real_time: bool, lease: float, seed: int | None) -> None:
    """Put the simulated table of SCENE behind the protocol, and say what its clients do, until Ctrl-C.

    In lockstep the table moves while it is polled, so that a run is the same as without a socket.
    """
    # Other commands here need no engine.
    from cleancli.remote.server import Server
    from cleancli.remote.simulated import SimulatedDriver, description
    from cleancli.world.table import PybulletTable

    setting = open_simulated(scene, robot)
    with closing(
        PybulletTable(setting, derived(setting.seed if seed is None else seed, Stream.WORLD))
    ) as table:
        driver = SimulatedDriver(table, real_time)
        try:
            listening = Server(driver, description(setting, lease), Address("127.0.0.1", port), echo)
        except OSError as error:
            raise OSError(_no_port(port, error)) from None
        with closing(listening) as server:
            how = "in real time" if real_time else "in lockstep"
            echo(f"the {setting.robot} of {setting.name} listens at {server.address}, {how}; Ctrl-C ends it")
            with suppress(KeyboardInterrupt):
                server.serve()


def _no_port(port: int, error: OSError) -> str:
    """Why there is nothing to listen at, and what to do."""
    why = "is in use" if error.errno == errno.EADDRINUSE else f"cannot be had: {error.strerror}"
    return f"port {port} {why}; say another one by `--port`, or 0 for one that is free"


@command.command("rearm", short_help="Let a robot that has tripped move again.")
@click.argument("address", type=_AddressOf())
def rearm(address: Address) -> None:
    """Let the robot at ADDRESS move again after it has tripped.

    Look first whether the robot, the table and the people around it are ready: from then on whoever has
    control can move it.
    """
    with working(f"waiting for the driver at {address}"), Client(address, control=False) as client:
        why = client.state.trip
        client.rearm()
        robot = client.description.robot
    echo(f"{robot} may move again; it had tripped: {why}" if why else f"{robot} has not tripped")


@command.command("check", short_help="Whether a driver keeps to the protocol, step by step.")
@click.argument("address", type=_AddressOf())
@click.option("--still", is_flag=True, help="Leave out the steps that move the robot.")
@options.as_json("Print the steps and what they found as JSON.")
def check(address: Address, still: bool, as_data: bool) -> int:
    """Check step by step whether the driver at ADDRESS keeps to the protocol, and name what it does wrong.

    The robot moves some centimetres above the middle of its workspace, at half of its highest speed, trips on
    purpose and is re-armed: take the rag off, and keep the emergency stop within reach. Exit code 6 if
    anything is wrong.
    """
    from cleancli.remote.conformance import conformance, number_of_steps

    found, steps = [], conformance(address, moves=not still)
    for each in counted(f"checking the driver at {address}", steps, number_of_steps(moves=not still)):
        found.append(each)
        if not as_data:
            echo(f"{each.step}: " + (f"{each.fault}: {each.what}" if each.fault else "yes"))
    if as_data:
        click.echo(json.dumps({"address": str(address), "steps": [asdict(each) for each in found]}, indent=2))
    return ExitCode.ROBOT if any(each.fault for each in found) else ExitCode.DONE
