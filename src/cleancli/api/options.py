"""What callers ask planners for, and checks of it, with the messages that the commands give."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import isfinite

from cleancli.language.model import Problem
from cleancli.planning.asked import planner_options
from cleancli.planning.plan import BadOption, Options

OBJECTIVES = ("reward", "time")
"""What may discount later rewards."""


@dataclass(frozen=True, slots=True)
class Asked:
    """What planners are asked for; None stands for what the problem says, or else for the usual. `options`
    are those of planners, by name. Raises BadOption for what makes no sense."""

    samples: int | None = None
    seed: int | None = None
    time_limit: float | None = None
    threads: int | None = None
    objective: str = "reward"
    options: Mapping[str, object] | None = None

    def __post_init__(self) -> None:
        check_least(1, samples=self.samples, threads=self.threads)
        check_least(0, seed=self.seed)
        check_seconds("time_limit", self.time_limit, none_of_it=False)
        check_one_of("objective", self.objective, OBJECTIVES)

    @property
    def time_discounts(self) -> bool:
        """Whether later rewards are discounted by time, and not by the number of actions before."""
        return self.objective == "time"

    def of(self, problem: Problem, seed: int | None) -> Options:
        """What planners are asked for in this problem, with this seed. Raises BadOption."""
        return planner_options(
            problem,
            samples=self.samples,
            seed=seed,
            time_limit=self.time_limit,
            threads=self.threads,
            named=[f"{name}={value}" for name, value in (self.options or {}).items()],
        )


def check_least(low: int, **named: object) -> None:
    """Raise BadOption for what is no whole number from `low` on; None stands for the usual."""
    for name, value in named.items():
        if value is None:
            continue
        if not isinstance(value, int) or isinstance(value, bool):
            raise BadOption(f"`{name}`: {value!r} is not a valid integer")
        if value < low:
            raise BadOption(f"`{name}`: {value} is not in the range x>={low}")


def check_seconds(name: str, value: object, *, none_of_it: bool) -> None:
    """Raise BadOption for what is no number of seconds; `none_of_it`: whether 0 is one. None stands for the
    usual."""
    if value is None:
        return
    if not isinstance(value, int | float) or isinstance(value, bool) or not isfinite(value):
        raise BadOption(f"`{name}`: {value!r} is not a valid float")
    if value < 0 or (value == 0 and not none_of_it):
        raise BadOption(f"`{name}`: {value} is not in the range x{'>=' if none_of_it else '>'}0")


def check_one_of(name: str, value: str | None, known: Collection[str]) -> None:
    """Raise BadOption for a word that is not known; None stands for the usual."""
    if value is not None and value not in known:
        listed = ", ".join(map(repr, known))
        raise BadOption(f"`{name}`: {value!r} is not one of {listed}")
