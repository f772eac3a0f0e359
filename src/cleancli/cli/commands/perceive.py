"""`cleancli perceive`: what is seen on a scene's table or in recorded frames, step by step."""

from __future__ import annotations

import json
import re
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np

from cleancli.cli.completion import domains, problems
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import MissingPart
from cleancli.cli.inputs import open_domain, open_scene
from cleancli.execution.seeds import Stream, derived
from cleancli.geometry.rgbd import Frame
from cleancli.language.diagnostics.plural import plural
from cleancli.language.load import located_in
from cleancli.language.model import Domain, State
from cleancli.perception.area import Area
from cleancli.perception.cap import left_out
from cleancli.perception.occlusion import Known, remember
from cleancli.perception.perceive import BadFrame, perceive
from cleancli.perception.pictures import contact_sheet, draw
from cleancli.perception.recorded import CAMERA, BadRecording, load_frames, save_frames
from cleancli.perception.rerun_file import Look, MissingRerun, find_rerun, write_recording
from cleancli.perception.surface import NoSurface
from cleancli.perception.symbols import symbolize
from cleancli.recording.pictures import write_png
from cleancli.scene.model import Scene

FRAMES = 3
"""As many as a look of `execute` takes."""

TOLD = 12
"""Facts of one symbol up to which a person is told each; of 26 areas, 700 lie between two others."""

_FILE = click.Path(path_type=Path, dir_okay=False)
_FOLDER = click.Path(path_type=Path, file_okay=False)


@dataclass(frozen=True)
class _Seen:
    """A look, where its frames come from, and what is known from it and from those before."""

    source: str
    look: Look
    known: Known
    left_out: tuple[str, ...]


class _Told:
    """Says what each look shows as it comes, and keeps the `last` alone: a long recording is larger than
    memory."""

    last: Look

    def __init__(self, seen: Iterator[_Seen], as_data: bool) -> None:
        self._seen, self._as_data = seen, as_data
        self.said: list[object] = []

    def looks(self) -> Iterator[Look]:
        """Each look, after it was told."""
        for each in self._seen:
            self.said += [_described(each)] if self._as_data else _printed(each)
            self.last = each.look
            yield each.look


@click.command("perceive", short_help="What is seen of a scene, or in recorded frames, step by step.")
@click.argument("scene_or_folder", metavar="SCENE|FOLDER", shell_complete=problems)
@click.option("--out", type=_FILE, help="Write a PNG contact sheet: what each step left, and the ellipses.")
@click.option("--drawn", type=_FILE, help="Write a PNG of the colour image with ellipses, names and symbols.")
@click.option("--rrd", "recording", type=_FILE, help="Write a Rerun recording of every step.")
@click.option("--save-frames", "saved", type=_FOLDER, help="Write the camera's frames into this folder.")
@click.option(
    "--scene",
    "setting_of",
    default="two_groups",
    show_default=True,
    shell_complete=problems,
    help="Whose surface and thresholds a FOLDER is understood with.",
)
@click.option("--domain", shell_complete=domains, help="Whose symbols are told. [default: the scene's]")
@click.option("--seed", type=click.IntRange(min=0), help="Seed of where dirt lies. [default: the scene's]")
@click.option("--json", "as_data", is_flag=True, help="Print it as JSON, in metres on the surface.")
def command(
    scene_or_folder: str,
    out: Path | None,
    drawn: Path | None,
    recording: Path | None,
    saved: Path | None,
    setting_of: str,
    domain: str | None,
    seed: int | None,
    as_data: bool,
) -> None:
    """Say what perception sees of the table of SCENE, or in the frames of FOLDER.

    A FOLDER holds the frames of one look (camera.json and PNG pictures), or one such folder for each look:
    then names go from each to the next, and pictures show the last.
    """
    if recording is not None:
        _find_rerun()
    folder = Path(scene_or_folder)
    is_folder = folder.is_dir()
    _, setting = open_scene(setting_of if is_folder else scene_or_folder)
    _, sources, model = open_domain(domain or setting.domain)
    seed = setting.seed if seed is None else seed
    sets = _recorded(folder) if is_folder else [(setting.name, _photographed(setting, seed))]
    told = _Told(_seen(sets, setting, model, seed), as_data)
    with located_in(*sources):
        if recording is None:
            deque(told.looks(), maxlen=0)
        else:
            write_recording(recording, told.looks(), folder.name)
    last = told.last
    for doubt in last.observation.doubts:
        echo(f"warning: {doubt}; `cleancli calibrate` adjusts to it", err=True)
    if saved is not None:
        save_frames(last.frames, saved)
    if out is not None:
        write_png(out, contact_sheet(last.frames[-1], last.observation, last.areas, last.state))
    if drawn is not None:
        write_png(
            drawn, draw(replace(last.frames[-1], camera=last.observation.camera), last.areas, last.state)
        )
    if as_data:
        click.echo(json.dumps({"looks": told.said}, indent=2))
    else:
        echo("\n".join(map(str, told.said)))


def _find_rerun() -> None:
    """Before the work, and not after it. Raises MissingPart."""
    try:
        find_rerun()
    except MissingRerun as error:
        raise MissingPart(str(error)) from error


def _photographed(setting: Scene, seed: int) -> tuple[Frame, ...]:
    """The scene's table with the tool at rest. The world is imported here: recorded frames need none."""
    from cleancli.world.table import PybulletTable

    with closing(PybulletTable(setting, derived(seed, Stream.WORLD))) as table:
        return tuple(table.observe() for _ in range(FRAMES))


def _recorded(folder: Path) -> Iterator[tuple[str, tuple[Frame, ...]]]:
    """The looks of a folder, in the order of their names. Raises OSError."""
    if (folder / CAMERA).exists():
        yield str(folder), load_frames(folder)
        return
    looks = sorted((path.parent for path in folder.glob(f"*/{CAMERA}")), key=_by_numbers)
    if not looks:
        raise BadRecording(f"{folder}: neither {CAMERA} nor a folder with one")
    for look in looks:
        yield str(look), load_frames(look)


def _by_numbers(folder: Path) -> list[str | int]:
    """Sorts `look-9` before `look-10`; words and numbers take turns, so that like meets like."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", folder.name)]


def _seen(
    sets: Iterator[tuple[str, tuple[Frame, ...]]] | Sequence[tuple[str, tuple[Frame, ...]]],
    setting: Scene,
    domain: Domain,
    seed: int,
) -> Iterator[_Seen]:
    """What each look shows; areas that are hidden in one stay as they were in the look before."""
    rng = np.random.default_rng(derived(seed, Stream.PERCEPTION))
    areas: tuple[Area, ...] = ()
    named = 0
    for source, frames in sets:
        try:
            observation = perceive(frames, setting, rng)
        except (BadFrame, NoSurface) as error:
            raise BadRecording(f"{source}: {error}") from error
        known = remember(areas, observation, setting.surface, None, named + 1)
        areas = known.areas
        named = max([named, *(int(area.name[1:]) for area in areas)])
        _, state = symbolize(areas, setting, domain)
        yield _Seen(source, Look(frames, observation, areas, state), known, left_out(areas, setting))


def _described(seen: _Seen) -> dict[str, object]:
    """Lengths in metres and square metres, angles in radians, times in seconds."""
    return {
        "source": seen.source,
        "clock": seen.look.frames[-1].clock,
        "areas": [_area(area, seen) for area in seen.look.areas],
        "left_out": seen.left_out,
        "facts": _facts(seen.look.state),
        "doubts": list(seen.look.observation.doubts),
        "changes": [str(change) for change in seen.known.changes],
        "unseen": {
            "share": round(seen.known.unseen.share, 4),
            "outlines": [
                [[round(x, 4), round(y, 4)] for x, y in outline] for outline in seen.known.unseen.outlines()
            ],
        },
    }


def _area(area: Area, seen: _Seen) -> dict[str, object]:
    alone = {
        fact.symbol: fact.value
        for fact in sorted(seen.look.state)
        if fact.objects == (area.name,) and fact.symbol != "dirt"
    }
    return {
        "area": area.name,
        "at": [round(place, 4) for place in area.ellipse.centre],
        "diameters": [round(2 * axis, 4) for axis in area.ellipse.axes],
        "angle": round(area.ellipse.angle, 4),
        "covered": round(area.covered, 6),
        "hidden": round(seen.known.hidden[area.name], 3),
        **alone,
    }


def _facts(state: State) -> dict[str, list[list[str]]]:
    """Symbol -> the areas and things for which it holds, of those that are about more than one."""
    facts: dict[str, list[list[str]]] = {}
    for fact in sorted(fact for fact in state if len(fact.objects) > 1):
        facts.setdefault(fact.symbol, []).append(list(fact.objects))
    return facts


def _printed(seen: _Seen) -> Iterator[str]:
    areas, unseen = seen.look.areas, seen.known.unseen.share
    hidden = f", {unseen:.0%} of the surface unseen" if unseen >= 0.005 else ""
    yield f"{seen.source}: {plural(len(areas), 'area')}{hidden}"
    yield from (f"  {change}" for change in seen.known.changes)
    yield from (f"  {_line(area, seen)}" for area in areas)
    if seen.left_out:
        yield f"  left out of plans: {', '.join(seen.left_out)}"
    for symbol, holds in _facts(seen.look.state).items():
        told = ", ".join(f"({' '.join(objects)})" for objects in holds)
        yield f"  {symbol}: {told if len(holds) <= TOLD else f'{len(holds)} times; --json tells where'}"


def _line(area: Area, seen: _Seen) -> str:
    (x, y), (long, short) = area.ellipse.centre, area.ellipse.axes
    told = _area(area, seen)
    said = [str(told["size"])] if "size" in told else []
    said += [name for name, value in told.items() if value is True]
    if share := seen.known.hidden[area.name]:
        said.append("remembered" if share == 1 else f"{share:.0%} hidden")
    words = "".join(f", {word}" for word in said)
    return f"{area.name}: at ({_cm(x)}, {_cm(y)}) cm, {_cm(2 * long)} x {_cm(2 * short)} cm{words}"


def _cm(metres: float) -> str:
    return f"{metres * 100:.1f}".removesuffix(".0")
