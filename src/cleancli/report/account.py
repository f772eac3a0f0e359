"""What runs come to, as rows that a table in the terminal, JSON and a page show alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cleancli.recording.journal import Looked
from cleancli.report.run import Run, Truth
from cleancli.report.timeline import KINDS, in_order


@dataclass(frozen=True, slots=True)
class RunRow:
    """One run. `clean` and `reason` are None and empty while it has not ended, `left` is how many particles
    truly lay on the table at its end, `ink_left` the share of its ink; None where nobody has looked, or where
    there was none. `areas`: dirty areas seen in the last look, None in
    the `symbolic` world."""

    name: str
    problem: str
    strategy: str
    seed: int
    clean: bool | None
    reason: str
    actions: int
    areas: int | None
    total: float
    seconds: Mapping[str, float]
    particles: int | None
    left: int | None
    on_floor: int | None
    ink_left: float | None
    symbolic: bool = False
    goal: bool | None = None

    @property
    def verdict(self) -> str:
        """In a word or two, how the run ended; the symbolic world has nothing to be clean."""
        if self.clean is None:
            return "cut short"
        return f"{'' if self.clean else 'not '}{'done' if self.symbolic else 'clean'}"

    @property
    def remains(self) -> str:
        """What is truly left on the table, in words; empty where nobody has looked."""
        ink = [] if self.ink_left is None else [f"{self.ink_left:z.1%} of the ink"]
        if None in (self.particles, self.left) or (ink and not self.particles):
            return "".join(ink)
        return ", ".join([f"{self.left} of {self.particles}", *ink])


def row_of(run: Run) -> RunRow:
    """The run in figures."""
    episode, truth = run.header.episode, run.header.truth or Truth()
    looks = [record for record in run.records if isinstance(record, Looked)]
    # Of a run cut short nothing says where it took place; a table shows areas, or has no facts.
    symbolic = truth.facts is not None or (
        truth.particles is None
        and any(look.facts for look in looks)
        and not any(look.areas for look in looks)
    )
    return RunRow(
        name=run.name,
        problem=run.problem,
        strategy=run.strategy,
        seed=run.header.seed,
        clean=None if episode is None else episode.clean,
        reason="" if episode is None else episode.reason,
        actions=run.actions(),
        areas=len(looks[-1].areas) if looks and not symbolic else None,
        total=run.total(),
        seconds=in_order(run.spent()),
        particles=truth.particles,
        left=truth.on_table,
        on_floor=truth.on_floor,
        ink_left=truth.ink_left,
        symbolic=symbolic,
        goal=truth.goal,
    )


SHOWN = 0.005
"""Seconds that are shown as more than 0.00."""


def taken(spent: Mapping[str, float], symbolic: bool) -> Mapping[str, float]:
    """Seconds by kind; in the symbolic world without the kinds that take none there, as looks do."""
    return {kind: s for kind, s in spent.items() if s >= SHOWN} if symbolic else spent


def name_of(kind: str) -> str:
    """A kind of time in words."""
    return kind.replace("_", " ")


def colour_of(kind: str) -> int:
    """The number of a kind's colour on pages: its place among the known ones, or one more for all others."""
    return KINDS.index(kind) if kind in KINDS else len(KINDS)
