"""`cleancli scene`: what a scene holds, how it looks, and what its robot reaches."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import MissingPart
from cleancli.cli.inputs import open_simulated
from cleancli.execution.seeds import Stream, derived
from cleancli.language.diagnostics.plural import plural
from cleancli.motion.actions import WIPES
from cleancli.recording.overlay import reach_map
from cleancli.recording.pictures import write_png
from cleancli.scene.model import Dirt, Group, Ink, Scattered, Scene
from cleancli.scene.robots import ARMS
from cleancli.world.reach_map import cleaning_of, missed, reach
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
    setting = open_simulated(scene, robot)
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
        found = Reached(
            float(able.mean()),
            missed(truth.left[:, :2], cleaning_of(setting.robot), setting, table.can_follow),
            missed(truth.ink[:, :2], WIPES[0], setting, table.can_follow),
            len(truth.left),
            len(truth.ink),
        )
        said = json.dumps(_described(setting, found), indent=2) if as_data else _printed(setting, found)
        echo(said)
        table.show()


@dataclass(frozen=True, slots=True)
class Reached:
    """The share of the surface that the robot reaches; how many `particles` on it, and how many cells of
    `ink`, and how many of each the robot can't clean away."""

    share: float
    missed_particles: int
    missed_ink: int
    particles: int
    ink: int


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
        "zone": None
        if setting.zone is None
        else {"at": list(setting.zone.centre), "side": setting.zone.side, "turn": setting.zone.turn},
        "robot": {
            "drive": setting.robot,
            "reaches": found.share,
            "misses": found.missed_particles + found.missed_ink,
        },
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
        f"robot: {setting.robot}, reaches {found.share:z.0%} of the surface;"
        f" rag: {_cm(setting.rag.width)} cm wide, grasp {setting.rag.grasp.name}",
        f"dirt: {', '.join(_named(setting.dirt))}",
    ]
    if setting.zone is not None:
        x, y = setting.zone.centre
        lines.append(f"zone: {_cm(setting.zone.side)} cm wide, its middle at ({_cm(x)}, {_cm(y)}) cm")
    if found.missed_particles:
        lines.append(f"out of reach: {found.missed_particles} of {found.particles} pieces of dirt")
    if found.missed_ink:
        lines.append(f"out of reach: {found.missed_ink / found.ink:z.1%} of the ink")
    return "\n".join(lines)


def _named(dirt: Sequence[Dirt]) -> Iterator[str]:
    yield from (f"{each.count} {each.of}" for each in dirt if not isinstance(each, Ink))
    lines = sum(isinstance(each, Ink) for each in dirt)
    if lines:
        yield f"{plural(lines, 'line')} of ink"


def _cm(metres: float) -> str:
    return f"{metres * 100:z.1f}".removesuffix(".0")
