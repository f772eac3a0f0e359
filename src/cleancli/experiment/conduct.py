"""A study from its text to its rows: opened, carried out where that is wanted, and kept in a folder."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from cleancli.api.checks import check_between, check_least
from cleancli.api.run_session import alone_in
from cleancli.api.tables import preformatted
from cleancli.experiment.episode import Finished, OtherVersion
from cleancli.experiment.rows import PARQUET, write_rows
from cleancli.experiment.schedule import Enough, GivenUp, Pool, here, number_due, rows, scheduled
from cleancli.experiment.series import OpenedStudy, open_studies
from cleancli.experiment.store import Store, read_finished
from cleancli.experiment.summary import cells_table, ending
from cleancli.files.replace import replace_file
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.plural import plural
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.planning.plan import BadOption
from cleancli.study.model import Study
from cleancli.study.row import Row
from cleancli.study.schema import MOST_RUNS

Outcomes = Iterable[Finished | GivenUp]


@dataclass(frozen=True, slots=True)
class Watch:
    """How somebody looks on: `episodes` passes on what comes of episodes, of which so many are due;
    `dashboard` is told the address of Dask's page."""

    episodes: Callable[[Outcomes, int], Outcomes]
    dashboard: Callable[[str], None]


UNWATCHED = Watch(lambda outcomes, number: outcomes, lambda address: None)


@dataclass(frozen=True, slots=True)
class StudyOptions:
    """What may be asked for of a study, by the names of the command's options. `jobs`: None stands for one
    for each core; `until`: the share of each mean that its interval may be as wide as."""

    runs: int | None = None
    seed: int | None = None
    quick: bool = False
    resume: bool = False
    jobs: int | None = None
    until: float | None = None
    scheduler: str | None = None
    output: Path | None = None


class StudyStopped(KeyboardInterrupt):
    """Ctrl-C has ended a study; the message says how to go on with it."""


@dataclass(frozen=True, slots=True)
class StudyResult:
    """What a study, and those that it consists of, came to: a row for each episode that is finished.

    `carried_out` of them now, `kept` by the folder from before; `given_up`: those that no worker finished.
    """

    studies: tuple[Study, ...]
    rows: tuple[Row, ...]
    carried_out: int
    kept: int
    given_up: tuple[GivenUp, ...]
    folder: Path

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli experiment --json` prints."""
        return {
            "studies": {each.name: _numbers(self._own(each)) for each in self.studies},
            "carried_out": self.carried_out,
            "kept": self.kept,
            "given_up": [{"key": each.episode.key, "reason": each.reason} for each in self.given_up],
            "rows": str(self.folder / PARQUET),
        }

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _repr_html_(self) -> str:
        return preformatted(str(self))

    def write_report(self, folder: str | Path | None = None) -> Path:
        """Write the page of results and its figures, beside the rows unless told where, and give its path.
        Raises ImportError without matplotlib, OSError."""
        # It loads what draws, which nobody else needs.
        from cleancli.experiment.report import write_report

        return write_report([self.folder], self.folder if folder is None else Path(folder))

    def _lines(self) -> Iterator[str]:
        for each in self.studies:
            yield f"{each.name}: {each.about}" if each.about else each.name
            yield str(cells_table(each, self._own(each)))
            yield from ending(each, self._own(each))
        done = f"{plural(len(self.rows), 'row')}, {plural(self.carried_out, 'episode')} carried out"
        yield f"{done}: {self.folder}/"

    def _own(self, study: Study) -> list[Row]:
        return [row for row in self.rows if row.study == study.name]


def run_study(
    study: str | Path,
    *,
    runs: int | None = None,
    seed: int | None = None,
    quick: bool = False,
    resume: bool = False,
    jobs: int | None = 1,
    until: float | None = None,
    scheduler: str | None = None,
    output: str | Path | None = None,
) -> StudyResult:
    """Carry out the episodes of a study that its folder does not hold yet, and keep a row of each.

    `until`: the share of each mean that its interval may be as wide as. Raises Refused, BadOption (a
    ValueError), ImportError without pyarrow, or without distributed where there are to be several processes,
    OSError.
    """
    check_between(1, MOST_RUNS, runs=runs)
    check_least(0, seed=seed)
    check_least(1, jobs=jobs)
    if until is not None and not 0 < until < 1:
        raise BadOption(f"`until`: {until} is not in the range 0<x<1")
    folder = None if output is None else Path(output)
    return conducted(study, StudyOptions(runs, seed, quick, resume, jobs, until, scheduler, folder))


def conducted(study: str | Path, options: StudyOptions, watch: Watch = UNWATCHED) -> StudyResult:
    """The same while somebody looks on. Raises StudyStopped on Ctrl-C; what is finished then is kept."""
    import pyarrow  # noqa: F401 - it is missed before the first episode, not after the last

    source = _source(study)
    studies = open_studies(source, options.quick, options.runs, options.seed)
    folder = _folder(source, studies, options)
    known = dict(read_finished(folder))
    if known and not options.resume:
        held = plural(len(known), "finished episode")
        raise BadOption(f"{folder} holds {held}: go on with --resume, or name another --output")
    kept = len(known)
    enough = None if options.until is None else _until(options.until)
    folder.mkdir(parents=True, exist_ok=True)
    with alone_in(folder):
        for each in studies:
            replace_file(folder / f"{each.study.name}.nid", each.source.text)
        given_up = _carry_out(studies, known, folder, enough, options, watch)
        found = rows(studies, known, enough)
        write_rows(folder, found)
    models = tuple(each.study for each in studies)
    return StudyResult(models, found, len(known) - kept, kept, given_up, folder)


_TEXT = "<study>"


def _source(study: str | Path) -> Source:
    """The text that is meant: this one, that of a file, or that of a shipped study. Raises Refused (E001)."""
    if isinstance(study, str) and "{" in study:
        return Source(_TEXT, study)
    return read_source(find(str(study), "studies"))


def _folder(source: Source, studies: Sequence[OpenedStudy], options: StudyOptions) -> Path:
    """The one asked for, else one named after the study's file, or after the study where it has none."""
    if options.output is not None:
        return options.output
    name = studies[0].study.name if source.path == _TEXT else Path(source.path).stem
    return Path("experiments") / f"{name}{'-quick' if options.quick else ''}"


def _carry_out(
    studies: Sequence[OpenedStudy],
    known: dict[str, Finished],
    folder: Path,
    enough: Enough | None,
    options: StudyOptions,
    watch: Watch,
) -> tuple[GivenUp, ...]:
    """All that is not known yet; each finished episode is kept at once."""
    given_up = []
    number = number_due(studies, known)
    try:
        with Store.opened(folder) as store, _pool(options, number, watch) as pool:
            for outcome in watch.episodes(scheduled(studies, known, pool, enough), number):
                if isinstance(outcome, Finished):
                    store.add(outcome)
                else:
                    given_up.append(outcome)
    except KeyboardInterrupt:
        done = plural(len(known), "episode")
        raise StudyStopped(f"{done} finished; go on with the same and --resume") from None
    except OtherVersion as error:
        raise OSError(f"{error}: install the same everywhere") from None
    return tuple(given_up)


@contextmanager
def _pool(options: StudyOptions, number: int, watch: Watch) -> Iterator[Pool]:
    """Where episodes are carried out: in this process where one job is asked for, or one is enough."""
    wanted = min(number, len(os.sched_getaffinity(0)) if options.jobs is None else options.jobs)
    if options.scheduler is None and wanted <= 1:
        yield here
        return
    from cleancli.experiment.cluster import local_cluster, on_cluster, remote_cluster

    with local_cluster(wanted) if options.scheduler is None else remote_cluster(options.scheduler) as client:
        watch.dashboard(client.dashboard_link)
        yield lambda series, known: on_cluster(client, series, known)


def _until(share: float) -> Enough:
    """Imported here: scipy takes long to load."""
    from cleancli.experiment.until import known_to

    return known_to(share)


def _numbers(own: Sequence[Row]) -> Mapping[str, int]:
    return {"episodes": len(own), "clean": sum(row.clean for row in own)}
