"""`cleancli cell`: where the camera and the robot of a real cell stand, and whether that can be right."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from functools import partial, wraps
from math import radians
from pathlib import Path
from typing import Any

import click
import numpy as np

from cleancli.cell.board import BAR, BOARDS, Board, svg
from cleancli.cell.camera import Laid, NoBoard, Sighted, sighted
from cleancli.cell.cell_file import BadCell, CameraPlace, Cell, TablePlace, as_text, decode, matrix
from cleancli.cell.faults import Felt, Seen, faults_felt, faults_seen, felt, seen
from cleancli.cell.touches import (
    UNITS,
    BadTouches,
    header,
    read_touch,
    read_touches,
    touched,
)
from cleancli.cli import options
from cleancli.cli.command_table import COMMANDS
from cleancli.cli.completion import problems
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.inputs import open_scene
from cleancli.cli.progress import working
from cleancli.cli.recordings import cell_of, open_frames
from cleancli.cli.views.cells import camera_data, camera_told, felt_told, seen_told, table_data, table_told
from cleancli.files.replace import replace_file, write_atomically
from cleancli.language.load import read_source
from cleancli.perception.frame_source import BadRecording
from cleancli.perception.reading import Reading
from cleancli.perception.surface import NoSurface
from cleancli.scene.model import Scene

_paper = click.option(
    "--paper", type=click.Choice(list(BOARDS)), default="a3", show_default=True, help="The board's size."
)
_out = click.option(
    "--out", type=options.FILE, required=True, help="Write what is known of the cell to this file."
)
_count = click.option(
    "--count",
    type=click.IntRange(1, 100),
    default=10,
    show_default=True,
    help="Frames of a bag or a TUM folder, spread evenly.",
)
_RECORDING = click.Path(path_type=Path, exists=True)


def _laid_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """How the board lies on the surface: the command gets all of it as `laid`."""

    @click.option(
        "--at",
        nargs=2,
        type=click.FloatRange(-500, 500),
        default=(0.0, 0.0),
        show_default=True,
        help="Centimetres from the surface's middle to the board's, east and north.",
    )
    @click.option(
        "--turn",
        type=click.FloatRange(-360, 360),
        default=0.0,
        show_default=True,
        help="Degrees from the scene's x to the board's, counter-clockwise.",
    )
    @click.option(
        "--bar",
        type=click.FloatRange(150, 250),
        default=1000 * BAR,
        show_default=True,
        help="Millimetres that the board's bar measures in print.",
    )
    @wraps(function)
    def gathered(at: tuple[float, float], turn: float, bar: float, **values: Any) -> Any:
        return function(laid=Laid((at[0] / 100, at[1] / 100), radians(turn), bar / 1000), **values)

    return gathered


@click.group("cell", short_help=COMMANDS["cell"].summary)
def command() -> None:
    """Find out where the camera and the robot of a real cell stand.

    docs/cell.md walks through it, from the board to the first stroke.
    """


@command.command("board")
@click.option("--out", type=options.FILE, required=True, help="Write the sheet to this SVG file.")
@_paper
def board(out: Path, paper: str) -> None:
    """Write the board that `cell camera` looks for, to be printed in true size."""
    chosen = BOARDS[paper]
    replace_file(out, svg(chosen))
    squares = f"{chosen.columns} x {chosen.rows} squares of {1000 * chosen.square:g} mm"
    echo(f"{out}: {squares} on {paper.upper()}; print it at 100 %, and measure the bar: {1000 * BAR:g} mm")


@command.command("camera")
@click.argument("scene", shell_complete=problems)
@click.argument("recorded", metavar="RECORDING", type=_RECORDING)
@_out
@_laid_options
@_count
@options.recording(with_cell=False)
@options.seed("the points of depth that are tried")
@options.as_json("Print what was found as JSON, in metres.")
def camera(
    scene: str,
    recorded: Path,
    out: Path,
    laid: Laid,
    count: int,
    reading: Reading,
    seed: int | None,
    as_data: bool,
) -> None:
    """Find out where the camera stands over the surface of SCENE, by the board in a RECORDING.

    The board lies on the surface, whole in view, and neither it nor the camera moves.
    """
    _, setting = open_scene(scene)
    before, cell = _cell_to_change(out)
    frames = open_frames(recorded, reading, count)
    rng = np.random.default_rng(setting.seed if seed is None else seed)
    try:
        with working("looking for the board"):
            found = sighted(frames, laid, rng)
    except NoBoard as error:
        raise BadRecording(f"{recorded}: {error}") from error
    _refuse_beyond(setting, laid, found)
    place = CameraPlace(matrix(found.pose), round(found.misfit, 3))
    write_atomically(out, as_text(replace(cell, camera=place)), before)
    for doubt in found.doubts:
        echo(f"warning: {doubt}", err=True)
    echo(json.dumps(camera_data(found), indent=2) if as_data else camera_told(found, len(frames), out))


@command.command("touch")
@click.argument("scene", shell_complete=problems)
@click.argument("touches", type=options.FILE)
@_out
@click.option("--ask", is_flag=True, help="Ask for touches, and add each to TOUCHES at once.")
@click.option(
    "--unit", type=click.Choice(list(UNITS)), default="m", show_default=True, help="Of a new file of TOUCHES."
)
@_paper
@_laid_options
@options.as_json("Print what was found as JSON, in metres.")
def touch(
    scene: str, touches: Path, out: Path, ask: bool, unit: str, paper: str, laid: Laid, as_data: bool
) -> None:
    """Find out where the robot finds the table of SCENE, by places of it that its tool has touched.

    TOUCHES is a file with a line for each: x, y and z of the tool as the robot tells them, and the corner of
    the board, if it was one. Touch with the tool that cleans, over the whole table.
    """
    _, setting = open_scene(scene)
    board = BOARDS[paper]
    before, cell = _cell_to_change(out)
    known = None if cell.table is None else np.array(cell.table.pose)
    try:
        if ask:
            _ask(touches, unit, board)
        taken = read_touches(read_source(touches).text, board)
        found = touched(taken, board, laid, setting.surface, known)
    except BadTouches as error:
        raise BadRecording(f"{touches}: {error}") from error
    spread = None if found.spread is None else round(found.spread, 6)
    write_atomically(out, as_text(replace(cell, table=TablePlace(matrix(found.pose), spread))), before)
    for doubt in found.doubts:
        echo(f"warning: {doubt}", err=True)
    echo(json.dumps(table_data(found), indent=2) if as_data else table_told(found, out))


def _ask(file: Path, unit: str, board: Board) -> None:
    """Ask for touches until there is an empty answer, and keep each in the file before the next is asked
    for. Raises BadTouches where the file holds something else."""
    if not file.exists():
        write_atomically(file, header(unit) + "\n", None)
    text = read_source(file).text
    done = {found.corner for found in read_touches(text, board)}
    unit = next(name for name in UNITS if text.startswith(header(name)))
    for corner in _places_to_touch(board, done):
        where = f"corner {corner} of the board" if corner else "the table anywhere, far from the others"
        line = click.prompt(
            f"touch {where}: x y z in {unit}, or nothing to go on",
            default="",
            show_default=False,
            value_proc=partial(_typed, corner, unit, board),
            err=True,
        )
        if line:
            added = f"{text.rstrip()}\n{line}\n"
            write_atomically(file, added, text)
            text = added
        elif not corner:
            return


def _typed(corner: str, unit: str, board: Board, answer: str) -> str:
    """A line for the file from what was typed, or nothing."""
    line = ",".join([*answer.replace(",", " ").split(), corner])
    if not answer.strip():
        return ""
    try:
        read_touch(line, unit, board)
    except BadTouches as error:
        raise click.UsageError(str(error)) from error
    return line


def _places_to_touch(board: Board, done: set[str | None]) -> Iterator[str]:
    """The outermost corners of the board that are not done yet; then anywhere, without an end."""
    row, names = board.columns - 1, board.corner_names
    yield from (name for name in (names[-row], names[-1], names[row - 1], names[0]) if name not in done)
    while True:
        yield ""


@command.command("check")
@click.argument("scene", shell_complete=problems)
@click.argument("cell", type=options.FILE)
@click.option("--frames", "recorded", type=_RECORDING, help="A recording of the table alone, seen whole.")
@click.option("--touches", type=options.FILE, help="A file of new touches of the table, of one at least.")
@_count
@options.recording(with_cell=False)
@_paper
@_laid_options
@options.seed("the points of depth that are tried")
@options.as_json("Print what was measured as JSON, in metres and degrees.")
def check(
    scene: str,
    cell: Path,
    recorded: Path | None,
    touches: Path | None,
    count: int,
    reading: Reading,
    paper: str,
    laid: Laid,
    seed: int | None,
    as_data: bool,
) -> ExitCode:
    """Report what of a CELL cannot be right, by the table of SCENE that the camera sees and the tool touches.

    With exit code 1 if there is anything.
    """
    _, setting = open_scene(scene)
    reading = replace(reading, cell=cell)
    known = cell_of(reading)
    if recorded is None and touches is None:
        raise click.UsageError("there is nothing to check by: --frames RECORDING, --touches FILE, or both")
    rng = np.random.default_rng(setting.seed if seed is None else seed)
    sighting = None if recorded is None else _seen(recorded, reading, count, setting, rng)
    feeling = None if touches is None else _felt(touches, BOARDS[paper], laid, known, cell)
    faults = (*(faults_seen(sighting) if sighting else ()), *(faults_felt(feeling) if feeling else ()))
    if as_data:
        parts = {"seen": sighting, "felt": feeling}
        told = {name: None if part is None else asdict(part) for name, part in parts.items()}
        echo(json.dumps(told | {"faults": faults}, indent=2))
    else:
        echo("\n".join([*seen_told(sighting), *felt_told(feeling)]))
        for fault in faults:
            echo(f"error: {fault}", err=True)
    return ExitCode.REFUSED if faults else ExitCode.DONE


def _seen(recorded: Path, reading: Reading, count: int, setting: Scene, rng: np.random.Generator) -> Seen:
    """Where the camera sees the table. Raises OSError."""
    frames = open_frames(recorded, reading, count)
    if not frames[0].camera.located:
        raise BadRecording(f"{reading.cell}: it does not say where the camera stands: `cleancli cell camera`")
    try:
        return seen(frames, setting.surface, rng)
    except NoSurface as error:
        raise BadRecording(f"{recorded}: {error}") from error


def _felt(touches: Path, board: Board, laid: Laid, known: Cell, path: Path) -> Felt:
    """Where the tool touches the table. Raises OSError."""
    if known.table is None:
        raise BadRecording(f"{path}: it does not say where the table is: `cleancli cell touch`")
    try:
        taken = read_touches(read_source(touches).text, board)
    except BadTouches as error:
        raise BadRecording(f"{touches}: {error}") from error
    if not taken:
        raise BadRecording(f"{touches}: there is no touch in it")
    return felt(taken, board, laid, np.array(known.table.pose))


def _cell_to_change(out: Path) -> tuple[str | None, Cell]:
    """The text of the file as it is and what it says, None and nothing where there is no file yet. What is no
    cell is hardly meant to be replaced by one."""
    if not out.resolve().parent.is_dir():
        raise click.BadParameter(f"there is no folder `{out.parent}`", param_hint="--out")
    if not out.exists():
        return None, Cell()
    text = read_source(out).text
    try:
        return text, decode(text.encode("utf-8"))
    except BadCell as error:
        raise click.BadParameter(f"`{out}` exists, and {error}", param_hint="--out") from error


def _refuse_beyond(setting: Scene, laid: Laid, found: Sighted) -> None:
    """A board that does not lie on the surface lies elsewhere than was said."""
    half = np.array([setting.surface.width, setting.surface.depth]) / 2
    places = laid.places(found.board, np.arange(len(found.board.places)))
    beyond = float((np.abs(places) - half).max())
    if beyond > 0:
        raise click.BadParameter(
            f"the board would lie {100 * beyond:z.0f} cm beyond the surface of `{setting.name}`, which is "
            f"{200 * half[0]:z.0f} x {200 * half[1]:z.0f} cm",
            param_hint="--at",
        )
