"""`cleancli perceive`: what is seen on a scene's table or in recorded frames, step by step."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import click

from cleancli.api.observations import SeenLook, described, photographed, told, understood
from cleancli.api.observations import drawn as drawn_picture
from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.completion import domains, problems
from cleancli.cli.echo import echo
from cleancli.cli.inputs import open_loaded, open_scene
from cleancli.cli.progress import counting, working
from cleancli.cli.recordings import open_looks, refuse_without_rerun
from cleancli.geometry.rgbd import Frame
from cleancli.language.load import located_in
from cleancli.perception.look import Look
from cleancli.perception.pictures import contact_sheet
from cleancli.perception.reading import EVERY, Reading
from cleancli.perception.recorded import save_frames
from cleancli.perception.rerun_file import write_recording
from cleancli.perception.sources import is_recording
from cleancli.perception.tum import save_tum
from cleancli.recording.pictures import write_png

LAYOUTS = {"cleancli": save_frames, "tum": save_tum}


class _Told:
    """Says what each look shows as it comes, and keeps the `last` alone: a long recording is larger than
    memory."""

    last: Look

    def __init__(self, seen: Iterator[SeenLook], as_data: bool) -> None:
        self._seen, self._as_data = seen, as_data
        self.said: list[object] = []

    def looks(self) -> Iterator[Look]:
        """Each look, after it was told."""
        for each in self._seen:
            self.said += [described(each)] if self._as_data else told(each)
            self.last = each.look
            yield each.look


@command_of("perceive")
@click.option(
    "--out", type=options.FILE, help="Write a PNG contact sheet: what each step left, and the ellipses."
)
@click.option(
    "--drawn", type=options.FILE, help="Write a PNG of the colour image with ellipses, names and symbols."
)
@click.option("--rrd", "recording", type=options.FILE, help="Write a Rerun recording of every step.")
@click.option(
    "--save-frames", "saved", type=options.FOLDER, help="Write the camera's frames into this folder."
)
@click.option(
    "--layout",
    type=click.Choice(list(LAYOUTS)),
    default="cleancli",
    show_default=True,
    help="How --save-frames lays them out.",
)
@click.option(
    "--every",
    type=click.FloatRange(min=0, min_open=True),
    default=EVERY,
    show_default=True,
    help="Seconds from one look to the next in a bag or a TUM folder.",
)
@options.recording()
@click.option(
    "--scene",
    "setting_of",
    default="two_groups",
    show_default=True,
    shell_complete=problems,
    help="Whose surface and thresholds a RECORDING is understood with.",
)
@click.option("--domain", shell_complete=domains, help="Whose symbols are told. [default: the scene's]")
@options.seed("where dirt lies")
@options.as_json("Print it as JSON, in metres on the surface.")
def command(
    scene_or_folder: str,
    out: Path | None,
    drawn: Path | None,
    recording: Path | None,
    saved: Path | None,
    layout: str,
    every: float,
    reading: Reading,
    setting_of: str,
    domain: str | None,
    seed: int | None,
    as_data: bool,
) -> None:
    """Say what perception sees of the table of SCENE, or in the frames of a RECORDING.

    A RECORDING is a folder with the frames of one look (camera.json and PNG pictures) or with one such folder
    for each look, a folder in the layout of the TUM benchmark, or a bag of ROS (.bag, .mcap, .db3, or the
    folder of one). Of several looks, names go from each to the next, and pictures show the last.
    """
    if recording is not None:
        refuse_without_rerun()
    path = Path(scene_or_folder)
    is_recorded = is_recording(path)
    _, setting = open_scene(setting_of if is_recorded else scene_or_folder)
    loaded = open_loaded(domain or setting.domain)
    seed = setting.seed if seed is None else seed
    sets: Iterator[tuple[str, tuple[Frame, ...]]]
    notes: tuple[str, ...] = ()
    if is_recorded:
        sets, notes = open_looks(path, replace(reading, every=every))
    else:
        with working("taking pictures"):
            sets = iter([(setting.name, photographed(setting, seed))])
    shown = _Told(understood(sets, setting, loaded.model, seed), as_data)
    with located_in(*loaded.sources), counting("{} looks", quiet=False) as count:
        looks = _counted(shown.looks(), count)
        if recording is None:
            deque(looks, maxlen=0)
        else:
            write_recording(recording, looks, path.name)
    last = shown.last
    for doubt in last.observation.doubts:
        echo(f"warning: {doubt}", err=True)
    if saved is not None:
        LAYOUTS[layout](last.frames, saved)
    if out is not None:
        write_png(out, contact_sheet(last.frames[-1], last.observation, last.areas, last.state))
    if drawn is not None:
        write_png(drawn, drawn_picture(last))
    if as_data:
        click.echo(json.dumps({"looks": shown.said, "notes": notes}, indent=2))
    else:
        echo("\n".join(map(str, shown.said)))


def _counted(looks: Iterator[Look], count: Callable[[], None]) -> Iterator[Look]:
    for look in looks:
        count()
        yield look
