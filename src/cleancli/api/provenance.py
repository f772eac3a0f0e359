"""What went into a run, as its folder keeps it: run.json and copies of all files, written and read back."""

from __future__ import annotations

import errno
import hashlib
import math
import platform
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from cleancli import __version__
from cleancli.api.inputs import LoadedDomain
from cleancli.api.run_inputs import Inputs
from cleancli.execution.setup import MOST, EpisodeOptions, Job
from cleancli.execution.strategies import STRATEGIES
from cleancli.files.untrusted import decoded
from cleancli.language.checking.learned import MOST_FORGETTING
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, printable
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import kind_of, load_problem
from cleancli.language.model import Problem
from cleancli.learning.estimate import ESTIMATORS
from cleancli.learning.method import MATCHES, Method
from cleancli.learning.optimism import OPTIMISM
from cleancli.planning.plan import BadOption
from cleancli.planning.registry import PLANNERS
from cleancli.recording.folder import FILES, RUN, read_text
from cleancli.recording.journal import Count, Seconds
from cleancli.report.run import FORMAT, LARGEST_HEADER, Header, InputFile, Run
from cleancli.report.texts import copy_of, domain_of, text_of
from cleancli.scene.calibration import as_text
from cleancli.scene.check import load_scene

LIBRARIES = ("numpy", "opencv-python-headless", "numba", "pybullet")
"""Those that results depend on."""


def versions() -> dict[str, str]:
    """What a run may depend on, with its version; a library that is not installed is not among it."""
    found = {"cleancli": __version__, "python": platform.python_version()}
    for library in LIBRARIES:
        with suppress(PackageNotFoundError):
            found[library] = version(library)
    return found


class _Options(msgspec.Struct):
    """What run.json tells of how a run began, as far as going on takes it."""

    strategy: str
    planner: str | None
    samples: Annotated[int, Meta(ge=1, le=MOST)]
    objective: Literal["reward", "time"]
    job: Job
    known: Count
    max_actions: Count
    max_seconds: Seconds | None
    estimator: str | None = None
    m: Annotated[float, Meta(ge=0, le=MOST)] = 0.0
    match: str = MATCHES[0]
    forgetting: Annotated[float, Meta(ge=0, le=MOST_FORGETTING)] = 0.0
    optimism: str = OPTIMISM[0]
    structure: bool = False
    taught: bool = False


class _Begun(msgspec.Struct):
    """The same, where it stands."""

    options: _Options


def header_of(options: EpisodeOptions, job: Job, copied: Mapping[str, object]) -> dict[str, object]:
    """What another person needs to run the same again; null are the estimator where nothing is learned, and a
    limit of seconds that there is not."""
    learning = options.learning
    return {
        "format": FORMAT,
        "versions": versions(),
        "seed": options.seed,
        "options": {
            "strategy": options.strategy,
            "planner": options.planner or STRATEGIES[options.strategy].planner,
            "samples": options.samples,
            "objective": "time" if options.by_time else "reward",
            "job": job.value,
            "known": options.known,
            "optimism": options.optimism,
            "structure": options.structure,
            "taught": options.is_taught,
            "estimator": learning.estimator if learning else None,
            "m": learning.m if learning else 0,
            "match": learning.match if learning else "shared",
            "forgetting": learning.forgetting if learning else 0,
            "max_actions": options.max_actions,
            "max_seconds": None if math.isinf(options.max_seconds) else options.max_seconds,
        },
        **copied,
    }


def copied_into(inputs: Inputs, folder: Path) -> dict[str, object]:
    """Copy what went in into the folder, and say which is which."""
    (folder / FILES).mkdir()
    of_world = () if inputs.world is None else inputs.world.sources
    of_teacher = () if inputs.teacher is None else inputs.teacher.sources
    texts = [(source.path, source.text) for source in (*inputs.sources, *of_world, *of_teacher)]
    copies = [_copy(*each, number, folder) for number, each in enumerate(texts)]
    entries, others = copies[: len(inputs.sources)], copies[len(inputs.sources) :]
    world, teacher = others[: len(of_world)], others[len(of_world) :]
    given = inputs.given
    if isinstance(given, Problem) or given.calibration is None:
        return {
            "files": entries,
            **({"world": world} if world else {}),
            **({"teacher": teacher} if teacher else {}),
        }
    path = Path(inputs.sources[-1].path).parent / given.calibration.path
    return {
        "files": entries,
        "calibration": _copy(str(path), as_text(given.calibration), len(entries), folder),
    }


def _copy(path: str, text: str, number: int, folder: Path) -> dict[str, str]:
    """Names of files may be the same in different folders, or those of files that no system likes."""
    name = re.sub(r"[^\w.-]", "_", Path(path).name) or "_"
    name = f"{number}-{name}" if (folder / FILES / name).exists() else name
    (folder / FILES / name).write_bytes(text.encode())
    return {
        "path": printable(path),
        "sha256": hashlib.sha256(text.encode()).hexdigest(),
        "copy": f"{FILES}/{name}",
    }


def inputs_of_run(run: Run) -> Inputs:
    """What went into a run, read anew from its folder. Raises Refused, OSError, and BadOption where another
    version has begun it."""
    began = run.header.versions.get("cleancli")
    if began != __version__:
        raise BadOption(f"{run.folder} began with cleancli {began}, and this is {__version__}: use that one")
    source = read_text(run.folder, RUN, LARGEST_HEADER)
    options = _options(run.header, decoded(source, _Begun, "E705", "record of a run").options, source)
    return _inputs(run, options, Job(run.header.options["job"]))


def _options(header: Header, given: _Options, source: Source) -> EpisodeOptions:
    """Raises Refused (E705) for a strategy, a planner or a way of learning that there is not."""
    for name, chosen, known in (
        ("strategy", given.strategy, STRATEGIES),
        ("planner", given.planner, PLANNERS),
        ("estimator", given.estimator, ESTIMATORS),
        ("match", given.match, MATCHES),
        ("optimism", given.optimism, OPTIMISM),
    ):
        if chosen is not None and chosen not in known:
            message = f"`{source.path}` tells of a {name} that there is not: {chosen!r}"
            raise Refused([Diagnostic("E705", message, None, help=f"known are {', '.join(known)}")])
    return EpisodeOptions(
        given.strategy,
        given.planner,
        given.samples,
        given.max_actions,
        math.inf if given.max_seconds is None else given.max_seconds,
        header.seed,
        given.objective == "time",
        given.known,
        None if given.estimator is None else _method(given.estimator, given),
        given.optimism,
        given.structure,
        given.taught,
    )


def _method(estimator: str, given: _Options) -> Method:
    return Method(estimator, given.m, given.match, given.forgetting)


def _inputs(run: Run, options: EpisodeOptions, job: Job) -> Inputs:
    """The texts that went in, read anew from their copies. Raises Refused, OSError."""
    sources = tuple(text_of(run, file) for file in run.header.files)
    if not sources:
        help = "only runs of this version and later ones can be gone on with"
        raise Refused(
            [Diagnostic("E705", f"`{run.folder}` does not hold the files that went in", None, help=help)]
        )
    domain, last = domain_of(sources), sources[-1]
    if kind_of(last) == "scene":
        return Inputs(domain, load_scene(last, lambda _: _calibration(run)), sources, options, job)
    problem = load_problem(last, domain)
    world, teacher = _rules(run, run.header.world), _rules(run, run.header.teacher)
    return Inputs(domain, problem, sources, options, job, world=world, teacher=teacher)


def _rules(run: Run, files: Sequence[InputFile]) -> LoadedDomain | None:
    """Those that these copies hold, if there are any."""
    texts = tuple(text_of(run, file) for file in files)
    if not texts:
        return None
    domain = domain_of(texts)
    return LoadedDomain(domain.name, domain, texts)


def _calibration(run: Run) -> bytes:
    """The calibration that went in; OSError where none did."""
    if run.header.calibration is None:
        raise OSError(errno.ENOENT, "the run holds no copy of it", str(run.folder))
    return copy_of(run, run.header.calibration)


def other_versions(header: Header) -> Iterator[str]:
    """Says which libraries differ from those the run began with: it may go on differently then."""
    found = versions()
    for name in LIBRARIES:
        old, now = header.versions.get(name), found.get(name)
        if old != now:
            here = f"this is {now}" if now else "which is not installed here"
            began = f"with {name} {old}" if old else f"without {name}"
            yield f"the run began {began}, {here}"
