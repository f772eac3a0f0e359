"""What an episode came to: one tidy row, and what can be measured in it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

from cleancli.study.model import Selection, Value

REAL = ("planning", "perceiving", "extra_perceptions", "learning")
"""Kinds of seconds that hold real time, and differ from one machine to the next (`Account`)."""

CROWDED = 0.9
"""With less of a processor than this share of its real time, an episode shared it with others. Chosen."""

REFUSED = "refused: "
"""What the reason of an episode begins with that its planner refused."""

SYMBOLIC = "symbolic"
"""The simulator of a problem that is no scene, as rows name it."""


@dataclass(frozen=True, slots=True)
class Row:
    """An episode of a study.

    `axes` has the values of its cell by the names of axes. `run` counts the repetitions of a cell, `episode`
    those of its series, both from 1; cells are paired by run, whose `seed`s they share. `unknown`: how many
    of the `actions` had rules that were not known yet, and were looked at with the arm out of view (§5.2).
    `seconds` by kind, as in `Account`, and their `total`. `left` and `on_floor`: pieces of dirt that truly
    lie there, of all `pieces`; `ink_left`: a share. `score`: the share of the pieces that are where they
    belong; None where there are none. `paid`: the return, discounted, of as many steps as the limit allows;
    None on tables. `cpu`: seconds of the process, and `real` ones, for all of the episode.
    `versions` of what results depend on. `files`: the SHA-256 of each text that went in, in order. `key`: the
    SHA-256 of all that decides how it goes.
    """

    study: str
    part: str
    axes: Mapping[str, Value]
    run: int
    episode: int
    seed: int
    clean: bool
    reason: str
    actions: int
    seconds: Mapping[str, float]
    total: float
    pieces: int
    left: int
    on_floor: int
    ink_left: float | None
    score: float | None
    cpu: float
    real: float
    versions: Mapping[str, str]
    files: tuple[str, ...]
    key: str
    unknown: int = 0
    paid: float | None = None


@dataclass(frozen=True, slots=True)
class Measure:
    """A number that a row tells, and what it means; `{ended}` in that is as in `Words`. `is_real`: it holds
    real time. `always`: it says something also of an episode that did not end clean, and is not of the way
    there. `of_tables`: it says nothing of problems that are no scenes, `of_problems`: nothing of tables.
    `signed`: it may be negative, so that it is compared by differences and not by ratios. `is_share`: it is
    0 or 1 of an episode, so that its mean is a share of them."""

    of: Callable[[Row], float]
    meaning: str
    is_real: bool = False
    always: bool = False
    of_tables: bool = False
    of_problems: bool = False
    signed: bool = False
    is_share: bool = False


def moving(row: Row) -> float:
    """Seconds of the robot's own in transits and actions, which do not depend on the machine."""
    return row.seconds["transits"] + row.seconds["actions"]


def _kind(name: str, meaning: str, of_tables: bool = False) -> Measure:
    return Measure(lambda row: row.seconds[name], meaning, name in REAL, of_tables=of_tables)


def _thinking(row: Row) -> float:
    spent = sum(row.seconds[kind] for kind in ("planning", "perceiving", "extra_perceptions"))
    return spent / row.total if row.total else 0.0


MEASURES: Mapping[str, Measure] = MappingProxyType(
    {
        "seconds": Measure(lambda row: row.total, "seconds until the episode is over", True),
        "moving": Measure(moving, "seconds of the robot's moving, in transits and actions"),
        "actions": Measure(lambda row: float(row.actions), "actions until the episode is over"),
        "unknown": Measure(lambda row: float(row.unknown), "actions whose rules were not known yet"),
        "planning": _kind("planning", "seconds of planning"),
        "perceiving": _kind("perceiving", "seconds of looking"),
        "extra_perceptions": _kind("extra_perceptions", "seconds of looking with the arm moved away"),
        "transits": _kind("transits", "seconds on the way to where an action begins", of_tables=True),
        "acting": Measure(lambda row: row.seconds["actions"], "seconds of actions themselves"),
        "learning": _kind("learning", "seconds of looking in order to learn"),
        "thinking": Measure(_thinking, "the share of all seconds that planning and looking take", True, True),
        "score": Measure(
            lambda row: 0.0 if row.score is None else row.score,
            "the share of dirt that is where it belongs",
            always=True,
            of_tables=True,
        ),
        "left": Measure(
            lambda row: float(row.left + row.on_floor),
            "pieces of dirt that are left or lost",
            always=True,
            of_tables=True,
        ),
        "clean": Measure(
            lambda row: float(row.clean), "the share of episodes that {ended}", always=True, is_share=True
        ),
        "return": Measure(
            lambda row: 0.0 if row.paid is None else row.paid,
            "the return, discounted, of as many steps as `max_actions` says",
            always=True,
            of_problems=True,
            signed=True,
        ),
    }
)
"""By name."""


def is_crowded(row: Row) -> bool:
    """Whether planning and looking took notably longer than they need, because the processor was busy."""
    return row.cpu < CROWDED * row.real


def axes_of(row: Row) -> Mapping[str, Value]:
    """All that rows are selected by, in order."""
    return {"part": row.part, **row.axes, "episode": row.episode}


def matches(row: Row, selection: Selection) -> bool:
    """Whether a row is of the values that are meant; an axis that it does not have is of none."""
    own = axes_of(row)
    return all(own.get(axis) in values for axis, values in selection.items())


def chosen(rows: Iterable[Row], *selections: Selection) -> Iterator[Row]:
    """The rows that all selections mean."""
    return (row for row in rows if all(matches(row, each) for each in selections))


def endings(rows: Iterable[Row]) -> str:
    """Why episodes did not end clean, each reason with how many these are, the most first; empty where all
    ended clean."""
    reasons = Counter(row.reason for row in rows if not row.clean)
    return ", ".join(f"{reason} {number}" for reason, number in reasons.most_common())


def all_refused(rows: Iterable[Row]) -> bool:
    """Whether a planner refused each of some episodes, so that nothing was measured."""
    return all(row.reason.startswith(REFUSED) for row in rows)


def comparable(row: Row) -> Row:
    """The row without what differs each time that the same episode is carried out: real time."""
    kept = {kind: 0.0 if kind in REAL else spent for kind, spent in row.seconds.items()}
    return replace(row, seconds=kept, total=0.0, cpu=0.0, real=0.0)


class Words(NamedTuple):
    """How it is told whether episodes did what they were for."""

    ended: str
    failed: str
    never: str
    done: str

    @property
    def other(self) -> str:
        """What the others are."""
        return f"not {self.done}"


CLEAN = Words("ended clean", "did not end clean", "never ended clean", "clean")
FINISHED = Words("finished", "did not finish", "never finished", "finished")
"""In the symbolic world, where nothing is said to be dirty."""


def words_for(rows: Iterable[Row]) -> Words:
    """The words for rows of which all are of the symbolic world, or some are of tables."""
    return FINISHED if {row.axes.get("simulator") for row in rows} == {SYMBOLIC} else CLEAN


def meaning_of(measure: str, words: Words) -> str:
    """What a measure means, in the words of the world that rows are of."""
    return MEASURES[measure].meaning.format(ended=words.ended)
