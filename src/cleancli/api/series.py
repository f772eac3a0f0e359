"""Episodes one after the other, each with its own seed, that carry on what was learned (§6.3)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cleancli.api.inputs import LoadedProblem
from cleancli.api.lessons import LearningResult, knowledge, rule_changes, taught
from cleancli.api.run_session import Inputs
from cleancli.api.runs import OpenedRun, RunResult, new_run
from cleancli.api.tables import TextTable
from cleancli.execution.believed import lesson_of as lesson_from
from cleancli.language.model import Experience
from cleancli.learning.gathered import Origin, whole
from cleancli.recording.folder import EXPERIENCE

CarryOut = Callable[[OpenedRun], RunResult]


@dataclass(frozen=True, slots=True)
class SeriesResult:
    """What a series of episodes came to; `learned` from all of them, None where nothing is learned."""

    runs: tuple[RunResult, ...]
    learned: LearningResult | None

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


def episodes(
    inputs: Inputs, number: int, runs: Path, video: bool, carry_out: CarryOut
) -> Iterator[RunResult]:
    """Carry out so many episodes in turn, the seed of each one more than that of the one before.

    Raises what `new_run` does, and what carrying an episode out does.
    """
    for index in range(number):
        own = replace(inputs, options=replace(inputs.options, seed=inputs.options.seed + index))
        with new_run(own, runs, video) as run:
            result = carry_out(run)
        yield result
        inputs = replace(inputs, evidence=result.evidence)


def lesson_of(
    given: LoadedProblem,
    inputs: Inputs,
    runs: Sequence[RunResult],
    is_writable: bool,
    include_outside: bool = False,
) -> LearningResult | None:
    """What a series teaches so far, beside what the domain's text has counted; None where nothing is learned.

    Raises Refused.
    """
    method, domain = inputs.options.learning, given.domain
    if method is None:
        return None
    model = domain.model
    lesson = lesson_from(model, runs[-1].evidence, method)
    before = () if model.learned is None else model.learned.experience
    known = {each.sha256 for each in before}
    experience = [each for run in runs for each in _experience(run.folder)]
    rests_on = knowledge(method, (*before, *(each for each in experience if each.sha256 not in known)))
    origins = [Origin(each.name, 1, each.transitions) for each in experience]
    changes = rule_changes(model, lesson, runs[-1].evidence, origins)
    return taught(domain, lesson, rests_on, changes, (), is_writable, include_outside)


def _experience(folder: Path) -> Iterator[Experience]:
    """That of a run, if it has any."""
    transitions, sha256 = whole(folder / EXPERIENCE)
    if transitions:
        yield Experience(str(folder), sha256, transitions)
