"""What planners achieved in simulated episodes: a table, and what the numbers are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from cleancli.api.goals import unreached_lines
from cleancli.api.plain import fields_of, plain
from cleancli.api.tables import TextTable, shown
from cleancli.compiler.task import Objective
from cleancli.language.diagnostics.plural import plural
from cleancli.learning.exploration.simulated import PAIRS
from cleancli.simulation.episode import Episode
from cleancli.simulation.summary import Estimate, Summary


@dataclass(frozen=True, slots=True)
class DeadEnds:
    """Of the episodes that a planner gave up, how many had no way to the goal left."""

    number: int
    given_up: int


@dataclass(frozen=True, slots=True)
class SimulationResult:
    """What planners achieved: a summary of each, and all its episodes, in the planners' order. `options` are
    those of all planners, and those of their own that these have. `short_horizon`: that of the first plan
    and a longer one to try, where the problem states none and episodes were given up. `lengths`: how far
    plans look ahead beside how long episodes were, in words, where what episodes come to differs by it.
    `hopeless`: no action of the world can lead to the goal; `dead_ends`: for each planner where none could
    any more, None where that is known of no episode. `variations`: where rules were explored, how far
    what they foretell after each episode is from what the world does (total variation, in the mean), for each
    planner."""

    problem: str
    domain: str
    world: str
    strategy: str
    objective: str
    options: Mapping[str, object]
    max_actions: int
    commit: int
    think: bool
    planners: tuple[Summary, ...]
    episodes: tuple[tuple[Episode, ...], ...]
    short_horizon: tuple[int, int] | None
    lengths: str | None
    hopeless: bool
    dead_ends: tuple[DeadEnds | None, ...]
    variations: tuple[tuple[float, ...], ...] = ()

    def to_dict(self) -> dict[str, object]:
        """The same as `cleancli simulate --json` prints."""
        return {
            "problem": self.problem,
            "domain": self.domain,
            "world": self.world,
            "strategy": self.strategy,
            "objective": self.objective,
            "options": plain(self.options),
            "limits": {"max_actions": self.max_actions, "commit": self.commit, "think": self.think},
            "planners": [
                {**fields_of(summary), **self._explored(number), "rows": plain(self.episodes[number])}
                for number, summary in enumerate(self.planners)
            ],
        }

    def _explored(self, planner: int) -> dict[str, object]:
        return {"variations": plain(self.variations[planner])} if self.variations else {}

    def __str__(self) -> str:
        return "\n".join((str(self.table()), *self.ending()))

    def _repr_html_(self) -> str:
        told = "".join(f"<p>{shown(line)}</p>" for line in self.ending())
        return f"<div>{self.table().html()}{told}</div>"

    def table(self) -> TextTable:
        """A row for each planner."""
        compared = len(self.planners) > 1
        columns = ["planner", "return", "plain", "actions", "robot s", "success %", "ms/plan", "95 %"]
        if self.objective == Objective.PROBABILITY.value:
            del columns[1:3]
            return TextTable(tuple(columns), tuple((one.planner, *_done(one)) for one in self.planners))
        if self.objective == Objective.COST.value:
            columns[1:3] = ["cost"]
            rows = ((one.planner, _mean(one.cost, 3), *_done(one)) for one in self.planners)
            return TextTable(tuple(columns), tuple(rows))
        if compared:
            columns.insert(2, "over first")
        return TextTable(tuple(columns), tuple(_row(each, compared) for each in self.planners))

    def ending(self) -> Iterator[str]:
        """What the numbers are, and why episodes ended."""
        episodes = plural(self.planners[0].episodes, "episode")
        yield f"means of {episodes}; ± and to: 95 % intervals (Student's t, Wilson's)"
        if self.think:
            yield "robot time goes on while planners think"
        for summary in self.planners:
            reasons = ", ".join(f"{reason.value} {number}" for reason, number in summary.reasons.items())
            yield f"{summary.planner} ended: {reasons}"
        if not self.hopeless:
            yield from self._dead_ends()
        for summary, off in zip(self.planners, self.variations, strict=False):
            yield f"{summary.planner}: what it foretells is off by {_falling(off)}"
        if self.variations:
            yield f"off by: total variation, in the mean of {PAIRS} pairs of a state and an action"
        yield from unreached_lines(self.hopeless, self.short_horizon)
        if self.lengths is not None and not self.hopeless:
            yield self.lengths

    def _dead_ends(self) -> Iterator[str]:
        for summary, ends in zip(self.planners, self.dead_ends, strict=True):
            if ends is not None:
                given_up = f"of {plural(ends.given_up, 'episode')} that it gave up, {ends.number}"
                yield f"{summary.planner}: {given_up} had come where the goal can no longer be reached"


def _falling(off: Sequence[float]) -> str:
    """How far off it was after which episodes: the first, twice as many, and so on, and all."""
    numbers = sorted({*(2**power for power in range(len(off).bit_length())), len(off)})
    (first, *others) = (f"{off[number - 1]:z.3f} after {number}" for number in numbers)
    return ", ".join((f"{first} episode", *others))


def _row(summary: Summary, compared: bool) -> tuple[str, ...]:
    gain = [_mean(summary.gain, 3)] if compared else []
    returned = [_mean(summary.discounted, 3), *gain, _mean(summary.plain, 3)]
    return (summary.planner, *returned, *_done(summary))


def _done(summary: Summary) -> tuple[str, ...]:
    planning = [_milliseconds(spent) for spent in (summary.planning_median, summary.planning_95)]
    return (_mean(summary.actions, 2), _mean(summary.seconds, 1), _share(summary.success), *planning)


def _mean(estimate: Estimate | None, digits: int) -> str:
    if estimate is None:
        return "-"
    half = "" if estimate.high is None else f" ± {estimate.high - estimate.mean:z.{digits}f}"
    return f"{estimate.mean:z.{digits}f}{half}"


def _share(estimate: Estimate | None) -> str:
    """Not symmetric, so with both ends."""
    if estimate is None or estimate.low is None or estimate.high is None:
        return "-"
    return f"{100 * estimate.mean:z.1f} ({100 * estimate.low:z.1f} to {100 * estimate.high:z.1f})"


def _milliseconds(seconds: float | None) -> str:
    return "-" if seconds is None else f"{1000 * seconds:z.1f}"
