"""`cleancli scene`: what a scene holds, how it looks, and what its robot reaches."""

from __future__ import annotations

import json
import os
import sys
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import MissingPart
from cleancli.cli.inputs import open_scene
from cleancli.execution.seeds import Stream, derived
from cleancli.recording.overlay import reach_map
from cleancli.recording.pictures import write_png
from cleancli.scene.model import Dirt, Group, Ink, Scattered, Scene
from cleancli.scene.robots import ARMS
from cleancli.world.reach_map import missed, reach
from cleancli.world.table import PybulletTable


@command_of("scene")
@click.option("--out", type=options.FILE, help="Write a PNG picture: what the camera sees, beside the room.")
@click.option("--reach", "reached", type=options.FILE, help="Write a PNG map of where the robot reaches.")
@click.option(
    "--robot", type=click.Choice(list(ARMS)), help="The robot that stands there. [default: the scene's]"
)
@options.seed("where dirt lies")
@click.option("--gui", is_flag=True, help="Show the table in a window until that is closed.")
@options.as_json("Print it as JSON.")
def command(
    scene: str,
    out: Path | None,
    reached: Path | None,
    robot: str | None,
    seed: int | None,
    gui: bool,
    as_data: bool,
) -> None:
    """Say what SCENE holds and which share of its surface the robot reaches; `perceive` says what is seen."""
    if gui and not has_display():
        raise MissingPart("--gui needs a display, and there is none here; --out writes a picture instead")
    _, setting = open_scene(scene)
    setting = setting if robot is None else replace(setting, robot=robot)
    seed = setting.seed if seed is None else seed
    with closing(PybulletTable(setting, derived(seed, Stream.WORLD), gui)) as table:
        if out is not None:
            seen = table.observe().colour
            height = len(seen)
            write_png(out, np.hstack([seen, table.picture(height * 4 // 3, height)]))
        places, able = reach(setting)
        if reached is not None:
            write_png(reached, reach_map(setting, places, able))
        truth = table.truth()
        lying = np.concatenate((truth.left[:, :2], truth.ink[:, :2]))
        found = Reached(float(able.mean()), len(lying), missed(lying, setting, table.can_follow))
        said = json.dumps(_described(setting, found), indent=2) if as_data else _printed(setting, found)
        echo(said)
        table.show()


@dataclass(frozen=True, slots=True)
class Reached:
    """The share of the surface that the robot reaches; pieces of dirt on it, and how many of them it can't
    clean away. A piece of ink is a cell of it."""

    share: float
    pieces: int
    missed: int


def has_display() -> bool:
    """Whether a window can be opened here."""
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY"))
    return True


def _described(setting: Scene, found: Reached) -> dict[str, object]:
    """Lengths in metres, angles in radians."""
    surface, container = setting.surface, setting.container
    return {
        "scene": setting.name,
        "surface": {
            "width": surface.width,
            "depth": surface.depth,
            "friction": surface.friction,
            "tilt": list(surface.tilt),
        },
        "container": {"edge": container.edge, "offset": container.offset, "width": container.width},
        "robot": {"drive": setting.robot, "reaches": found.share, "misses": found.missed},
        "rag": {"grasp": setting.rag.grasp.name, "width": setting.rag.width},
        "dirt": [_dirt(dirt) for dirt in setting.dirt],
    }


def _dirt(dirt: Dirt) -> dict[str, object]:
    match dirt:
        case Group(count, centre, radius, of):
            return {"count": count, "of": of, "at": list(centre), "radius": radius}
        case Scattered(count, low, high, of):
            return {"count": count, "of": of, "from": list(low), "to": list(high)}
        case Ink(along, width):
            return {"of": "ink", "along": [list(point) for point in along], "width": width}


def _printed(setting: Scene, found: Reached) -> str:
    surface, container = setting.surface, setting.container
    lines = [
        f"{setting.name}: a surface of {_cm(surface.width)} x {_cm(surface.depth)} cm, friction"
        f" {surface.friction:g}; a container {_cm(container.width)} cm wide at the {container.edge} edge",
        f"robot: {setting.robot}, reaches {found.share:.0%} of the surface;"
        f" rag: {_cm(setting.rag.width)} cm wide, grasp {setting.rag.grasp.name}",
        f"dirt: {', '.join(map(_named, setting.dirt))}",
    ]
    if found.missed:
        lines.append(f"out of reach: {found.missed} of {found.pieces} pieces of dirt")
    return "\n".join(lines)


def _named(dirt: Dirt) -> str:
    return "a line of ink" if isinstance(dirt, Ink) else f"{dirt.count} {dirt.of}"


def _cm(metres: float) -> str:
    return f"{metres * 100:.1f}".removesuffix(".0")
