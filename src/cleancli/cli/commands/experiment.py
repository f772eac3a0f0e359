"""`cleancli experiment`: carry out the episodes of a study, here or on a cluster, and keep a row of each."""

from __future__ import annotations

import importlib
import json
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import click

from cleancli.api.run_session import alone_in
from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode, MissingPart, Stopped
from cleancli.cli.progress import counted
from cleancli.cli.usage import usage_errors
from cleancli.experiment.episode import Finished, OtherVersion
from cleancli.experiment.rows import PARQUET, write_rows
from cleancli.experiment.schedule import Enough, GivenUp, Pool, here, number_due, rows, scheduled
from cleancli.experiment.series import OpenedStudy, open_studies
from cleancli.experiment.store import Store, read_finished
from cleancli.experiment.summary import cells_table
from cleancli.files.replace import replace_file
from cleancli.language.diagnostics.plural import plural
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.study.row import Row
from cleancli.study.schema import MOST_RUNS

_INSTALL = "pip install 'bokeh>=3.1' 'distributed>=2025.1' 'matplotlib>=3.8' 'pyarrow>=18'"
_SHARE = re.compile(r"(\d{1,3}(?:\.\d{1,9})?) ?%")


def _share(context: click.Context, parameter: click.Parameter, value: str | None) -> float | None:
    """What `10%` says, as a share."""
    if value is None:
        return None
    match = _SHARE.fullmatch(value)
    if match is None or not 0 < float(match[1]) < 100:
        raise click.BadParameter("write a share such as `10%`", context, parameter)
    return float(match[1]) / 100


@command_of("experiment")
@click.option("--runs", type=click.IntRange(1, MOST_RUNS), help="Runs of each cell. [default: the study's]")
@options.seed("the first run", "the study's, or 1")
@click.option("--quick", is_flag=True, help="The study made small, as it says itself, without physics.")
@click.option("--resume", is_flag=True, help="Go on with what the output folder holds.")
@click.option(
    "--jobs", type=click.IntRange(min=1), help="Processes of this machine. [default: one for each core]"
)
@click.option(
    "--until",
    metavar="SHARE",
    callback=_share,
    help="Go on, run by run, until each mean is known to this share of it, such as `10%`; --runs at most.",
)
@click.option("--scheduler", metavar="ADDRESS", help="A Dask cluster that runs already: tcp://HOST:8786.")
@click.option(
    "--output", type=options.FOLDER, help="Folder for the rows. [default: experiments/ and the study's name]"
)
@click.option(
    "--report",
    "reported",
    type=click.Path(exists=True, path_type=Path),
    multiple=True,
    metavar="ROWS",
    help="Carry out nothing: write the page of results from an experiment's folder, or its rows.parquet.",
)
@options.as_json("Print the summary as JSON, and nothing else.")
@usage_errors()
def command(
    study: str | None,
    runs: int | None,
    seed: int | None,
    quick: bool,
    resume: bool,
    jobs: int | None,
    until: float | None,
    scheduler: str | None,
    output: Path | None,
    reported: tuple[Path, ...],
    as_data: bool,
) -> int:
    """Carry out the episodes of STUDY: each combination of what it lists, as often as it says.

    The output folder gets a line for each episode as soon as it is over, and in the end the rows of all as
    Parquet and CSV. An episode that is finished is never carried out again. Exit code 3 if episodes were
    given up because their workers were lost.

    With --report nothing is carried out: the page of results, results.md, and its figures are written from
    rows alone.
    """
    if reported:
        return _report(reported, study, output, as_data)
    if study is None:
        raise click.UsageError("name a study, such as fig8a, or rows to --report")
    if jobs is not None and scheduler is not None:
        raise click.UsageError("--jobs is for this machine, --scheduler for a cluster: ask for one")
    source = read_source(find(study, "studies"))
    studies = open_studies(source, quick, runs, seed)
    name = f"{Path(source.path).stem}{'-quick' if quick else ''}"
    folder = Path("experiments") / name if output is None else output
    _require("pyarrow")
    known = dict(read_finished(folder))
    if known and not resume:
        held = plural(len(known), "finished episode")
        raise click.UsageError(f"{folder} holds {held}: go on with --resume, or name another --output")
    kept = len(known)
    enough = None if until is None else _until(until)
    folder.mkdir(parents=True, exist_ok=True)
    with alone_in(folder):
        for each in studies:
            replace_file(folder / f"{each.study.name}.nid", each.source.text)
        given_up = _carry_out(studies, known, folder, enough, jobs, scheduler, as_data)
        found = rows(studies, known, enough)
        write_rows(folder, found)
    _tell(studies, found, known, kept, given_up, folder, as_data)
    return ExitCode.NOT_CLEAN if given_up else ExitCode.DONE


def _report(rows: Sequence[Path], study: str | None, output: Path | None, as_data: bool) -> int:
    """Write the page, beside the first rows unless told where."""
    if study is not None:
        raise click.UsageError("--report takes the studies from the rows: name none")
    _require("pyarrow")
    _require("matplotlib")
    from cleancli.experiment.report import write_report

    beside = rows[0] if rows[0].is_dir() else rows[0].parent
    page = write_report(rows, beside if output is None else output)
    if as_data:
        click.echo(json.dumps({"page": str(page)}))
    else:
        echo(f"page: {page}")
    return ExitCode.DONE


def _carry_out(
    studies: Sequence[OpenedStudy],
    known: dict[str, Finished],
    folder: Path,
    enough: Enough | None,
    jobs: int | None,
    scheduler: str | None,
    quiet: bool,
) -> list[GivenUp]:
    """All that is not known yet; each finished episode is kept at once. Raises Stopped on Ctrl-C."""
    given_up = []
    number = number_due(studies, known)
    try:
        with Store.opened(folder) as store, _pool(jobs, scheduler, number, quiet) as pool:
            for outcome in counted("episodes", scheduled(studies, known, pool, enough), number):
                if isinstance(outcome, Finished):
                    store.add(outcome)
                else:
                    given_up.append(outcome)
    except KeyboardInterrupt:
        raise Stopped(f"{plural(len(known), 'episode')} finished; go on with the same and --resume") from None
    except OtherVersion as error:
        raise OSError(f"{error}: install the same everywhere") from None
    return given_up


@contextmanager
def _pool(jobs: int | None, scheduler: str | None, number: int, quiet: bool) -> Iterator[Pool]:
    """Where episodes are carried out: in this process where one job is asked for, or one is enough."""
    wanted = min(number, len(os.sched_getaffinity(0)) if jobs is None else jobs)
    if scheduler is None and wanted <= 1:
        yield here
        return
    _require("distributed")
    from cleancli.experiment.cluster import local_cluster, on_cluster, remote_cluster

    with local_cluster(wanted) if scheduler is None else remote_cluster(scheduler) as client:
        if not quiet:
            echo(f"dashboard: {client.dashboard_link}", err=True)
        yield lambda series, known: on_cluster(client, series, known)


def _until(share: float) -> Enough:
    """Imported here: scipy takes long to load."""
    from cleancli.experiment.until import known_to

    return known_to(share)


def _require(library: str) -> None:
    """Load an optional part; raises MissingPart."""
    try:
        importlib.import_module(library)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] not in (library, "dask"):
            raise
        raise MissingPart(f"experiments need {library}: {_INSTALL}") from error


def _tell(
    studies: Sequence[OpenedStudy],
    found: Sequence[Row],
    known: dict[str, Finished],
    kept: int,
    given_up: Sequence[GivenUp],
    folder: Path,
    as_data: bool,
) -> None:
    by_study = {each.study.name: [row for row in found if row.study == each.study.name] for each in studies}
    if as_data:
        told = {
            "studies": {name: _numbers(own) for name, own in by_study.items()},
            "carried_out": len(known) - kept,
            "kept": kept,
            "given_up": [{"key": each.episode.key, "reason": each.reason} for each in given_up],
            "rows": str(folder / PARQUET),
        }
        click.echo(json.dumps(told, indent=2))
        return
    for each in studies:
        echo(f"{each.study.name}: {each.study.about}" if each.study.about else each.study.name)
        echo(str(cells_table(each.study, by_study[each.study.name])))
    for lost in given_up:
        echo(f"given up: {lost.episode.key[:12]} ({lost.episode.study}): {lost.reason}", err=True)
    echo(f"{plural(len(found), 'row')}, {plural(len(known) - kept, 'episode')} carried out: {folder}/")


def _numbers(own: Sequence[Row]) -> dict[str, int]:
    return {"episodes": len(own), "clean": sum(row.clean for row in own)}
