"""The checked study: products of axes, and comparisons of what they come to."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from cleancli.language.syntax import SettingValue

Value = str | int | float
"""What an axis may have: names as options have them (`plan-2`), lengths in metres, angles in radians."""

Selection = Mapping[str, tuple[Value, ...]]
"""For some axes the values that are meant; with `part` and `episode`, those of rows as well."""


@dataclass(frozen=True, slots=True)
class Part:
    """All combinations of the values of these axes, in the order in which they are written; a setting of the
    scene is an axis by its section and key (`rag.width`). `name`: empty where there is but one."""

    name: str
    axes: Mapping[str, tuple[Value, ...]]


@dataclass(frozen=True, slots=True)
class Limits:
    """When an episode is given up (`execution.setup.EpisodeOptions`); `max_seconds` is infinite where there
    is no limit."""

    max_actions: int = 60
    max_seconds: float = 1800.0


@dataclass(frozen=True, slots=True)
class Comparison:
    """What is expected of a measure, in rows that `where` selects, paired by run: of those that are `first`
    too it is `expect` ("less", "more", "equal") than `factor` times that of those that are `second`; where
    there is no second, than `limit`. `margin`: up to which share of the second both are equal. `claim`: the
    number of the paper's claim (1 to 9) that it tests, if any; `says`: in words.
    `node`: how the text names the measure, if it does, for messages.
    """

    name: str
    says: str
    measure: str
    expect: str
    first: Selection
    second: Selection
    where: Selection = field(default_factory=dict)
    claim: int | None = None
    factor: float = 1.0
    limit: float | None = None
    margin: float = 0.0
    node: SettingValue | None = field(default=None, repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class Study:
    """`runs` of each cell, each a series of `episodes`, the first with `seed`. `measure`: what its figure
    shows. `limits`: of tables; `symbolic_limits`: of problems that are no scenes. `studies`: those that it
    consists of, by name; then it has no parts of its own. `quick`: the same study made small. `written`: how
    the text says the values of axes, for messages."""

    name: str
    about: str
    parts: tuple[Part, ...]
    comparisons: tuple[Comparison, ...]
    measure: str = "seconds"
    runs: int = 5
    episodes: int = 1
    seed: int = 1
    limits: Limits = field(default_factory=Limits)
    symbolic_limits: Limits = field(default_factory=lambda: Limits(max_seconds=math.inf))
    studies: tuple[str, ...] = ()
    quick: Study | None = field(default=None, repr=False)
    written: Mapping[str, Mapping[Value, SettingValue]] = field(
        default_factory=dict, repr=False, compare=False
    )
