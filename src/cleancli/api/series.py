"""Episodes one after the other, each with its own seed, that carry on what was learned (§6.3)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from cleancli.api.inputs import LoadedProblem
from cleancli.api.lessons import LearningResult, knowledge, rule_changes, taught
from cleancli.api.run_session import Inputs
from cleancli.api.runs import OpenedRun, RunResult, new_run
from cleancli.api.tables import TextTable
from cleancli.execution.believed import lesson_of
from cleancli.language.model import Experience
from cleancli.learning.gathered import Origin, whole
from cleancli.recording.folder import EXPERIENCE

CarryOut = Callable[[OpenedRun], RunResult]


MOST_EPISODES = 10_000
"""Of one series."""


@dataclass(frozen=True, slots=True)
class Series:
    """A series that is about to begin. `inputs` are those of the first episode. `writes`: what was learned
    goes into the domain's file after each, which `is_writable`."""

    given: LoadedProblem
    inputs: Inputs
    episodes: int
    runs: Path
    video: bool
    is_writable: bool
    writes: bool = False
    include_outside: bool = False


@dataclass(frozen=True, slots=True)
class SeriesResult:
    """What a series of episodes came to; `learned` from all of them, None where nothing is learned, and the
    `experience` that this rests on."""

    runs: tuple[RunResult, ...]
    learned: LearningResult | None
    experience: tuple[Experience, ...] = field(default=(), repr=False)

    @property
    def is_clean(self) -> bool:
        """Whether every episode ended so."""
        return all(run.clean for run in self.runs)

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli execute --episodes N --json` prints."""
        learned = {} if self.learned is None else self.learned.to_dict()
        return {"episodes": [run.to_dict() for run in self.runs], **learned}

    def table(self) -> TextTable:
        """A row for each episode: how it ended, and the seconds that it took by kind (Fig. 10)."""
        kinds = tuple(self.runs[0].seconds)
        heads = ("episode", "clean", "actions", "seconds", *(kind.replace("_", " ") for kind in kinds))
        rows = tuple(
            (
                str(number),
                "yes" if run.clean else "no",
                str(run.actions),
                f"{sum(run.seconds.values()):.1f}",
                *(f"{run.seconds[kind]:.1f}" for kind in kinds),
            )
            for number, run in enumerate(self.runs, start=1)
        )
        return TextTable(heads, rows, (1,))

    def __str__(self) -> str:
        parts = [str(self.table())] if len(self.runs) > 1 else []
        return "\n".join([*parts, *([] if self.learned is None else [str(self.learned)])])

    def _repr_html_(self) -> str:
        learned = "" if self.learned is None else self.learned._repr_html_()
        return f"<div>{self.table().html()}{learned}</div>"


def carried_out(series: Series, carry_out: CarryOut) -> Iterator[SeriesResult]:
    """Carry out the episodes in turn, the seed of each one more than that of the one before, and give after
    each what the series has come to; what was learned is in the domain's file by then, where it is written.

    Raises what `new_run` and carrying an episode out do, and what writing does (`LearningResult.write`).
    """
    inputs, so_far = series.inputs, SeriesResult((), None)
    for index in range(series.episodes):
        options = replace(inputs.options, seed=series.inputs.options.seed + index)
        with new_run(replace(inputs, options=options), series.runs, series.video) as run:
            result = carry_out(run)
        before, so_far = so_far, _with(series, so_far, result)
        if series.writes and so_far.learned is not None:
            so_far.learned.write(before.learned)
        inputs = replace(inputs, evidence=result.evidence)
        yield so_far


def _with(series: Series, before: SeriesResult, result: RunResult) -> SeriesResult:
    """The series with one more episode, and what all of them teach beside what the domain's text has counted.
    Raises Refused."""
    runs = (*before.runs, result)
    domain, method = series.given.domain, series.inputs.options.learning
    if method is None:
        return SeriesResult(runs, None)
    experience = (*before.experience, *_experience(result.folder))
    noted = () if domain.model.learned is None else domain.model.learned.experience
    known = {each.sha256 for each in noted}
    rests_on = knowledge(method, (*noted, *(each for each in experience if each.sha256 not in known)))
    lesson = lesson_of(domain.model, result.evidence, method)
    origins = [Origin(each.name, 1, each.transitions) for each in experience]
    changes = rule_changes(domain.model, lesson, result.evidence, origins)
    learned = taught(domain, lesson, rests_on, changes, (), series.is_writable, series.include_outside)
    return SeriesResult(runs, learned, experience)


def _experience(folder: Path) -> Iterator[Experience]:
    """That of a run, if it has any."""
    transitions, sha256 = whole(folder / EXPERIENCE)
    if transitions:
        yield Experience(str(folder), sha256, transitions)
