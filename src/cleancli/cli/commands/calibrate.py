"""`cleancli calibrate`: adjust perception to a clean surface, and keep what was found (§3.1)."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import ExitStack, closing
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.progress import counted, working
from cleancli.cli.recordings import open_frames
from cleancli.execution.seeds import Stream, derived
from cleancli.files.replace import write_atomically
from cleancli.geometry.rgbd import Frame
from cleancli.language.diagnostics.diagnostic import Level
from cleancli.language.diagnostics.plural import plural
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import parse_as, read_source
from cleancli.language.syntax import SceneNode
from cleancli.perception.calibrate import Adjusted, NotClean, calibrate
from cleancli.perception.frame_source import BadRecording
from cleancli.perception.perceive import BadFrame
from cleancli.perception.pictures import margins, not_clean
from cleancli.perception.reading import Reading
from cleancli.perception.surface import NoSurface
from cleancli.recording.pictures import write_png
from cleancli.scene.calibration import BadCalibration, Thresholds, as_text, read_calibration
from cleancli.scene.check import check_scene
from cleancli.scene.model import Scene
from cleancli.scene.robots import REMOTE

if TYPE_CHECKING:
    from cleancli.remote.robot import RemoteRobot
    from cleancli.world.table import PybulletTable

_RECORDING = click.Path(path_type=Path, exists=True)


@command_of("calibrate")
@click.option("--out", type=options.FILE, required=True, help="Write the calibration to this file.")
@click.option("--frames", "recorded", type=_RECORDING, help="Use recorded frames of the clean surface.")
@click.option(
    "--count",
    type=click.IntRange(1, 100),
    default=10,
    show_default=True,
    help="Frames, simulated or spread evenly over a bag or a TUM folder.",
)
@options.recording()
@click.option(
    "--reference",
    "keeps_picture",
    is_flag=True,
    help="Keep a picture of the surface, to take its texture away: for a camera that stands still.",
)
@click.option(
    "--drawn",
    type=options.FILE,
    help="Write a PNG of how near the surface comes to the threshold, or of what is not clean.",
)
@options.seed("the frames' noise")
@options.as_json("Print the calibration as JSON.")
def command(
    scene: str,
    out: Path,
    recorded: Path | None,
    count: int,
    reading: Reading,
    keeps_picture: bool,
    drawn: Path | None,
    seed: int | None,
    as_data: bool,
) -> None:
    """Adjust perception's thresholds to the surface of SCENE in its light, seen without its dirt.

    Each is set to the smallest value for which the whole surface is seen as clean, and a margin. What stands
    on the surface teaches how far its shadow reaches. Scenes refer to the file with
    `camera { calibration = "FILE" }`.
    """
    setting = _scene_to_calibrate(scene)
    seed = setting.seed if seed is None else seed
    before = _calibration_to_replace(out)
    frames = _frames(recorded, reading, setting, seed, count)
    rng = np.random.default_rng(derived(seed, Stream.PERCEPTION))
    try:
        with working("lowering the thresholds"):
            found = calibrate(frames, setting, str(out), rng, keeps_picture)
    except NotClean as error:
        if drawn is not None:
            write_png(drawn, not_clean(error.frame, error.where, str(error)))
        seen_in = f"; {drawn} shows where" if drawn else "; --drawn PICTURE shows where"
        raise BadRecording(f"{recorded or 'the camera'}: {error}{seen_in}") from error
    except (BadFrame, NoSurface) as error:
        raise BadRecording(f"{recorded or 'the camera'}: {error}") from error
    text = as_text(found.calibration)
    write_atomically(out, text, before)
    if drawn is not None:
        write_png(drawn, margins(frames[0], found.steepness))
    echo(text.rstrip() if as_data else _printed(found, len(frames), out))


def _scene_to_calibrate(name_or_path: str) -> Scene:
    """The scene, whether the calibration that it may already name can be read or not. Raises Refused."""
    source = read_source(find(name_or_path, "problems"))
    root, findings = parse_as(source, "scene")
    setting = check_scene(root, findings) if isinstance(root, SceneNode) else None
    mistakes = [found for found in findings.sorted if found.code not in ("E516", "E517")]
    if setting is None or any(found.level is Level.ERROR for found in mistakes):
        raise Refused(mistakes, [source])
    return replace(setting, calibration=None)


def _calibration_to_replace(out: Path) -> str | None:
    """The text of the file as it is, None where there is none yet. What is no calibration is hardly meant to
    be replaced by one."""
    if not out.resolve().parent.is_dir():
        raise click.BadParameter(f"there is no folder `{out.parent}`", param_hint="--out")
    if out.exists():
        try:
            read_calibration(out, str(out))
        except BadCalibration as error:
            message = f"`{out}` exists, and is no calibration: {error}"
            raise click.BadParameter(message, param_hint="--out") from error
    return read_source(out).text if out.exists() else None


def _frames(
    recorded: Path | None, reading: Reading, setting: Scene, seed: int, count: int
) -> tuple[Frame, ...]:
    if recorded is not None:
        return open_frames(recorded, reading, count)
    return tuple(_photographed(setting, seed, count))


def _photographed(setting: Scene, seed: int, count: int) -> Iterable[Frame]:
    """Frames of the table without its dirt, and without the tool. pybullet is needed here alone, and a remote
    robot's table has to be clean."""
    from cleancli.world.robot import finish

    with ExitStack() as kept:
        with working("moving the tool out of view"):
            table = kept.enter_context(closing(_table(setting, seed)))
            table.withdraw()
            finish(table)
        yield from counted("frames", (table.observe() for _ in range(count)), count)


def _table(setting: Scene, seed: int) -> RemoteRobot | PybulletTable:
    if setting.robot == REMOTE:
        from cleancli.remote.robot import RemoteRobot

        return RemoteRobot(setting.driver)
    from cleancli.world.table import PybulletTable

    return PybulletTable(replace(setting, dirt=()), derived(seed, Stream.WORLD))


def _printed(found: Adjusted, frames: int, out: Path) -> str:
    kept = found.calibration.reference
    used = found.calibration.thresholds if kept is None else kept.thresholds
    default, thresholds = asdict(Thresholds()), asdict(used)
    flat = "" if kept is None else ", its texture taken away,"
    lines = [
        f"{out}: the surface is clean in {plural(frames, 'frame')}{flat} with",
        "threshold        value  default",
    ]
    lines += [f"{name:14} {value:7.3g}  {default[name]:7.3g}" for name, value in thresholds.items()]
    lines += _expected(found)
    if found.objects:
        lines.append(f"objects on {found.objects:z.1%} of it taught `object_edge`")
    if thresholds["contrast"] > 2 * default["contrast"]:
        lines.append(
            f"dirt that differs by less than {thresholds['contrast']:z.0%} from the surface will not be seen"
        )
    return "\n".join([*lines, f'refer to it in a scene: camera {{ calibration = "{out.name}" }}'])


def _expected(found: Adjusted) -> list[str]:
    """What other frames will show, as far as these tell."""
    each = found.left_out
    if not each:
        return ["one frame tells nothing about others: with several it is said what to expect of them"]
    false = sum(one.false for one in each)
    room = min(one.gradient for one in each), min(one.contrast for one in each)
    return [
        f"expected of unseen frames (each judged by the {plural(len(each) - 1, 'other')}): "
        f"{plural(false, 'false patch', 'false patches')} in {plural(len(each), 'frame')}, at least "
        f"{min(one.background for one in each):z.2%} background,",
        f"thresholds {room[0]:z.2f} times (gradient) and {room[1]:z.2f} times (contrast) what the worst "
        "needs",
    ]
