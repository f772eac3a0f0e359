"""`cleancli scene`: what a scene holds, how it looks, and what its robot reaches."""

from __future__ import annotations

import json
import os
import sys
from contextlib import closing
from pathlib import Path

import click
import numpy as np

from cleancli.cli.completion import problems
from cleancli.cli.exit_codes import MissingPart
from cleancli.cli.inputs import open_scene
from cleancli.execution.overlay import reach_map
from cleancli.execution.pictures import step_picture, write_png
from cleancli.execution.seeds import Purpose, derived
from cleancli.execution.state import Situation
from cleancli.perception.area import Area
from cleancli.perception.frame import Frame
from cleancli.perception.perceive import BadFrame, perceive
from cleancli.perception.recorded import BadRecording, load_frames, save_frames
from cleancli.perception.surface import NoSurface
from cleancli.perception.symbols import is_scattered, size_of
from cleancli.perception.tracking import track
from cleancli.scene.model import Dirt, Group, Ink, Scattered, Scene
from cleancli.world.reach import reach
from cleancli.world.table import PybulletTable

FRAMES = 3
"""As many as a look of `execute` takes."""

_FILE = click.Path(path_type=Path, dir_okay=False)
_FOLDER = click.Path(path_type=Path, file_okay=False)


@click.command("scene", short_help="What a scene holds, how it looks, what its robot reaches.")
@click.argument("scene", shell_complete=problems)
@click.option("--out", type=_FILE, help="Write a PNG picture: what is seen, beside the room.")
@click.option("--reach", "reached", type=_FILE, help="Write a PNG map of where the robot reaches.")
@click.option("--save-frames", "saved", type=_FOLDER, help="Write the camera's frames into this folder.")
@click.option("--frames", "recorded", type=_FOLDER, help="Look at the frames in this folder instead.")
@click.option("--seed", type=click.IntRange(min=0), help="Seed of where dirt lies. [default: the scene's]")
@click.option("--gui", is_flag=True, help="Show the table in a window until that is closed.")
@click.option("--json", "as_data", is_flag=True, help="Print it as JSON.")
def command(
    scene: str,
    out: Path | None,
    reached: Path | None,
    saved: Path | None,
    recorded: Path | None,
    seed: int | None,
    gui: bool,
    as_data: bool,
) -> None:
    """Say what SCENE holds, what perception sees of it, and which share of its surface the robot reaches."""
    if gui and not has_display():
        raise MissingPart("--gui needs a display, and there is none here; --out writes a picture instead")
    _, setting = open_scene(scene)
    seed = setting.seed if seed is None else seed
    with closing(PybulletTable(setting, derived(seed, Purpose.WORLD), gui)) as table:
        frames = load_frames(recorded) if recorded else tuple(table.observe() for _ in range(FRAMES))
        areas = _seen(frames, setting, seed, recorded)
        if out is not None:
            situation = Situation(areas, (), frozenset())
            write_png(out, step_picture(frames[-1], situation, None, table.picture()))
        if saved is not None:
            save_frames(frames, saved)
        if reached is not None:
            write_png(reached, reach_map(setting, *reach(setting)))
        said = json.dumps(_described(setting, areas), indent=2) if as_data else _printed(setting, areas)
        click.echo(said)
        table.show()


def has_display() -> bool:
    """Whether a window can be opened here."""
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY"))
    return True


def _seen(frames: tuple[Frame, ...], setting: Scene, seed: int, recorded: Path | None) -> tuple[Area, ...]:
    rng = np.random.default_rng(derived(seed, Purpose.PERCEPTION))
    try:
        return track((), perceive(frames, setting, rng).areas, None, 1)
    except (BadFrame, NoSurface) as error:
        raise BadRecording(f"{recorded or 'the camera'}: {error}") from error


def _described(setting: Scene, areas: tuple[Area, ...]) -> dict[str, object]:
    """Lengths in metres, angles in radians."""
    surface, container = setting.surface, setting.container
    _, reached = reach(setting)
    return {
        "scene": setting.name,
        "surface": {
            "width": surface.width,
            "depth": surface.depth,
            "friction": surface.friction,
            "tilt": list(surface.tilt),
        },
        "container": {"edge": container.edge, "offset": container.offset, "width": container.width},
        "robot": {"drive": setting.robot, "reaches": float(reached.mean())},
        "rag": {"grasp": setting.rag.grasp.name, "width": setting.rag.width},
        "dirt": [_dirt(dirt) for dirt in setting.dirt],
        "seen": [
            {
                "area": area.name,
                "at": [round(place, 4) for place in area.ellipse.centre],
                "diameters": [round(2 * axis, 4) for axis in area.ellipse.axes],
                "covered": round(area.covered, 6),
                "size": size_of(area, setting.symbols),
                "scattered": is_scattered(area, setting.symbols),
            }
            for area in areas
        ],
    }


def _dirt(dirt: Dirt) -> dict[str, object]:
    match dirt:
        case Group(count, centre, radius, of):
            return {"count": count, "of": of, "at": list(centre), "radius": radius}
        case Scattered(count, low, high, of):
            return {"count": count, "of": of, "from": list(low), "to": list(high)}
        case Ink(along, width):
            return {"of": "ink", "along": [list(point) for point in along], "width": width}


def _printed(setting: Scene, areas: tuple[Area, ...]) -> str:
    surface, container = setting.surface, setting.container
    _, reached = reach(setting)
    lines = [
        f"{setting.name}: a surface of {_cm(surface.width)} x {_cm(surface.depth)} cm, friction"
        f" {surface.friction:g}; a container {_cm(container.width)} cm wide at the {container.edge} edge",
        f"robot: {setting.robot}, reaches {reached.mean():.0%} of the surface;"
        f" rag: {_cm(setting.rag.width)} cm wide, grasp {setting.rag.grasp.name}",
        f"dirt: {', '.join(map(_named, setting.dirt))}",
        f"seen: {len(areas)} area{'' if len(areas) == 1 else 's'}",
    ]
    for area in areas:
        (x, y), axes = area.ellipse.centre, area.ellipse.axes
        scattered = ", scattered" if is_scattered(area, setting.symbols) else ""
        lines.append(
            f"  {area.name}: at ({_cm(x)}, {_cm(y)}) cm, {_cm(2 * axes[0])} x {_cm(2 * axes[1])} cm,"
            f" {size_of(area, setting.symbols)}{scattered}"
        )
    return "\n".join(lines)


def _named(dirt: Dirt) -> str:
    return "a line of ink" if isinstance(dirt, Ink) else f"{dirt.count} {dirt.of}"


def _cm(metres: float) -> str:
    return f"{metres * 100:.1f}".removesuffix(".0")
