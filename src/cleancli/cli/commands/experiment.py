"""`cleancli experiment`: carry out the episodes of a study, here or on a cluster, and keep a row of each."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import click

from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode, MissingPart, Stopped
from cleancli.cli.progress import counted
from cleancli.cli.usage import usage_errors
from cleancli.experiment.conduct import StudyOptions, StudyStopped, Watch, conducted
from cleancli.study.schema import MOST_RUNS

_INSTALL = "pip install 'bokeh>=3.1' 'distributed>=2025.1' 'matplotlib>=3.8' 'pyarrow>=18'"
_OPTIONAL = ("bokeh", "dask", "distributed", "matplotlib", "pyarrow")
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
    asked = StudyOptions(runs, seed, quick, resume, jobs, until, scheduler, output)
    watch = Watch(partial(counted, "episodes"), lambda link: _tell_dashboard(link, as_data))
    with _optional_parts():
        result = conducted(study, asked, watch)
    if as_data:
        click.echo(json.dumps(result.to_dict(), indent=2))
    else:
        echo(str(result))
        for lost in result.given_up:
            echo(f"given up: {lost.episode.key[:12]} ({lost.episode.study}): {lost.reason}", err=True)
    return ExitCode.NOT_CLEAN if result.given_up else ExitCode.DONE


def _report(rows: Sequence[Path], study: str | None, output: Path | None, as_data: bool) -> int:
    """Write the page, beside the first rows unless told where."""
    if study is not None:
        raise click.UsageError("--report takes the studies from the rows: name none")
    beside = rows[0] if rows[0].is_dir() else rows[0].parent
    with _optional_parts():
        from cleancli.experiment.report import write_report

        page = write_report(rows, beside if output is None else output)
    if as_data:
        click.echo(json.dumps({"page": str(page)}))
    else:
        echo(f"page: {page}")
    return ExitCode.DONE


def _tell_dashboard(link: str, quiet: bool) -> None:
    if not quiet:
        echo(f"dashboard: {link}", err=True)


@contextmanager
def _optional_parts() -> Iterator[None]:
    """Raises MissingPart for a library that experiments alone need, Stopped where Ctrl-C ended a study."""
    try:
        yield
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing not in _OPTIONAL:
            raise
        raise MissingPart(f"experiments need {missing}: {_INSTALL}") from error
    except StudyStopped as stopped:
        raise Stopped(str(stopped)) from None
