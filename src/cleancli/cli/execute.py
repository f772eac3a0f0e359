"""`cleancli execute`: clean a simulated table, watch it happen, and keep a record."""

from __future__ import annotations

import hashlib
import platform
from contextlib import closing
from importlib.metadata import version
from pathlib import Path

import click

from cleancli import __version__
from cleancli.cli.completion import domains, problems
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.inputs import located_in, open_domain, open_scene
from cleancli.cli.live import show
from cleancli.cli.refusal import planning_refused
from cleancli.execution.events import Ended
from cleancli.execution.loop import EpisodeOptions, clean
from cleancli.execution.record import Recorder, free_folder
from cleancli.execution.seeds import Purpose, derived
from cleancli.language.diagnostics import Source
from cleancli.language.model import Domain
from cleancli.planning.table import DEFAULT, PLANNERS
from cleancli.world.table import PybulletTable, Truth

LIBRARIES = ("numpy", "opencv-python-headless", "numba", "pybullet")


@click.command("execute", short_help="Clean a simulated table: look, plan, act, until it is clean.")
@click.argument("domain", shell_complete=domains)
@click.argument("scene", shell_complete=problems)
@click.option("--seed", type=click.IntRange(min=0), help="Seed of all randomness. [default: the scene's]")
@click.option("--planner", type=click.Choice(list(PLANNERS)), default=DEFAULT, show_default=True)
@click.option(
    "--samples",
    type=click.IntRange(min=1),
    default=10_000,
    show_default=True,
    help="Action sequences to draw for each plan.",
)
@click.option(
    "--commit",
    type=click.IntRange(min=1),
    default=2,
    show_default=True,
    help="Actions of a plan to carry out before planning again (§4.2.4).",
)
@click.option(
    "--objective",
    type=click.Choice(["reward", "time"]),
    help="What discounts later rewards: the number of actions before, or their duration."
    "  [default: time, if the domain says how long each action takes]",
)
@click.option(
    "--max-actions",
    type=click.IntRange(min=0),
    default=60,
    show_default=True,
    help="Stop after so many actions.",
)
@click.option(
    "--runs",
    type=click.Path(path_type=Path),
    default=Path("runs"),
    show_default=True,
    help="Folder to make the run's folder in.",
)
@click.option("--video/--no-video", default=True, show_default=True, help="Record a video of the run.")
@click.option("--json", "as_data", is_flag=True, help="Print the summary as JSON, and nothing else.")
def command(
    domain: str,
    scene: str,
    seed: int | None,
    planner: str,
    samples: int,
    commit: int,
    objective: str | None,
    max_actions: int,
    runs: Path,
    video: bool,
    as_data: bool,
) -> int:
    """Clean the table of SCENE with the rules of DOMAIN on a simulated robot.

    Leaves a folder with run.json, experience.jsonl, a picture per action and a video. Exit code 3 if dirt is
    still seen at the end; the summary says where every lentil truly is, apart from what perception believed.
    """
    _, domain_sources, model = open_domain(domain)
    scene_source, setting = open_scene(scene)
    seed = setting.seed if seed is None else seed
    timed = _by_time(objective, model)
    options = EpisodeOptions(planner, samples, commit, max_actions, seed, by_time=timed)
    with closing(PybulletTable(setting, derived(seed, Purpose.WORLD))) as table:
        folder = free_folder(runs, f"{setting.name}-seed{seed}")
        header = _header(options, *domain_sources, scene_source)
        with (
            located_in(*domain_sources),
            planning_refused((*domain_sources, scene_source)),
            Recorder(folder, header, table.picture, video) as recorder,
            show(as_data) as view,
        ):
            for event in clean(model, setting, table, options):
                recorder.write(event)
                view.write(event)
        assert isinstance(event, Ended), "an episode's last event closes it"
        truth = _truth(table.truth())
        recorder.finish(truth)
    if as_data:
        click.echo((folder / "run.json").read_text(encoding="utf-8"), nl=False)
    else:
        click.echo(_summary(event, truth, folder, video))
    return ExitCode.DONE if event.clean else ExitCode.NOT_CLEAN


def _by_time(objective: str | None, domain: Domain) -> bool:
    """Whether plans discount by time. Raises UsageError where they are to and a duration is not known."""
    unknown = [action.name for action in domain.actions if action.duration is None]
    if objective == "time" and unknown:
        raise click.UsageError(f"--objective time needs a duration of {', '.join(unknown)}: [duration = 9 s]")
    return objective == "time" or (objective is None and not unknown)


def _header(options: EpisodeOptions, *sources: Source) -> dict[str, object]:
    """What another person needs to run the same again."""
    return {
        "versions": {
            "cleancli": __version__,
            "python": platform.python_version(),
            **{library: version(library) for library in LIBRARIES},
        },
        "seed": options.seed,
        "options": {
            "planner": options.planner,
            "samples": options.samples,
            "commit": options.commit,
            "objective": "time" if options.by_time else "reward",
            "max_actions": options.max_actions,
        },
        "files": {s.path: hashlib.sha256(s.text.encode()).hexdigest() for s in sources},
    }


def _truth(truth: Truth) -> dict[str, object]:
    return {
        "particles": truth.total,
        "in_container": truth.in_container,
        "on_table": truth.on_table,
        "in_dustpan": truth.in_dustpan,
        "on_floor": truth.on_floor,
        "ink_left": round(truth.ink_left, 4),
        "left_on_table_at": [[round(float(x), 4), round(float(y), 4)] for x, y, _ in truth.left],
    }


def _summary(ended: Ended, truth: dict[str, object], folder: Path, video: bool) -> str:
    total = sum(ended.seconds.values())
    spent = ", ".join(f"{kind} {seconds:.1f}" for kind, seconds in ended.seconds.items())
    lines = [
        f"{'clean' if ended.clean else 'not clean'}: {ended.reason}, after {ended.actions} actions",
        f"seconds: {total:.1f} ({spent})",
        f"truly: {truth['in_container']} of {truth['particles']} particles in the container,"
        f" {truth['on_table']} on the table, {truth['on_floor']} on the floor"
        + (f", {truth['in_dustpan']} in the dustpan" if truth["in_dustpan"] else ""),
        f"record: {folder}/  pictures: step-*.png" + ("  video: video.mp4" if video else ""),
    ]
    if truth["ink_left"]:
        lines.insert(3, f"ink left: {truth['ink_left']:.0%}")
    if truth["on_table"]:
        lines.insert(3, f"left on the table at (m): {truth['left_on_table_at']}")
    return "\n".join(lines)
