"""What every planner takes and returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from cleancli.compiler.fluents import Values
from cleancli.compiler.task import GroundAction, Objective
from cleancli.planning.policy import Policy

V = TypeVar("V", int, float, str)


def option(usual: V, *allowed: float | str) -> V:
    """A field of a dataclass that can be asked for by its name: the usual value, then the least and the most
    of a number, or the words that it may be (docs/commands.md lists them)."""
    made: V = field(default=usual, metadata={"allowed": allowed})
    return made


@dataclass(frozen=True, slots=True)
class Options:
    """What all planners are asked for; each reads what concerns it (docs/planning.md lists which), and has
    options of its own (planning/planner.py).

    `samples`: action sequences to draw (PRADA's n). `seed` of the planner's own random stream. `time_limit`
    in seconds: a planner that can returns the best so far when it is over. `threads` at most; results don't
    depend on them. `previous`: what is left of the last plan, to start from. `counted`: a problem in which
    the reward counts more objects is made smaller before it is grounded (planning/reductions/subproblem.py).
    Where beliefs are computed, rules less likely than `rule_threshold` are taken not to apply, and `compat`
    computes literally as libPRADA does."""

    samples: int = 10_000
    seed: int = 0
    time_limit: float | None = None
    threads: int = 2
    previous: tuple[GroundAction, ...] = ()
    compat: bool = False
    counted: int = option(30, 1, 1_000_000)
    rule_threshold: float = option(0.03, 0, 1)


@dataclass(frozen=True, slots=True)
class Reached:
    """What a policy without a horizon is worth: the `probability` that it reaches the goal, and the expected
    `cost` until then, or until the goal is out of reach, in actions, costs or seconds as the `objective` is.

    Both are wrong by no more than their `error`, of as many `states` as can be reached.
    """

    objective: Objective
    probability: float
    probability_error: float
    cost: float
    cost_error: float
    states: int


@dataclass(frozen=True, slots=True)
class Branch:
    """What a policy does where a run of it leaves its likeliest course: after `step` actions of the course,
    with this `probability`, where the last of them has had these `effects` (variables of the task and their
    values). The `actions` are the likeliest course from there. `late`: the effects are those of the course,
    but have taken so many tries that the policy does otherwise then."""

    step: int
    probability: float
    effects: tuple[tuple[int, int], ...]
    actions: tuple[GroundAction, ...]
    late: bool = False


@dataclass(frozen=True, slots=True)
class Plan:
    """A sequence of actions and its value: expected discounted reward up to the horizon, though the sequence
    may end before it. Without a horizon, which is None then, the value is the probability of the goal, the
    sequence the likeliest way to it, and `reached` says more.

    `measure` says whose value that is: "factored" (a belief of independent variables), "exact" or "sampled"
    (the sequence's own), "policy" (of acting on what is seen, of which the sequence is the likeliest course),
    "estimated" (of the same, if it stopped after some steps, by drawn results), or "hoped" (of the same, and
    a guess by how far a goal is). `coverage` is eq. 3's share of the sequences that were sampled, None where
    none were; `seconds` per phase of the planner. `policy`: whose likeliest
    course the sequence is; None of a sequence that is carried out whatever happens. `results`: what each
    action of its course sets where it goes as the course says; none of such a sequence.
    """

    planner: str
    actions: tuple[GroundAction, ...]
    value: float
    measure: str
    samples: int
    horizon: int | None
    coverage: float | None
    seconds: Mapping[str, float]
    reached: Reached | None = None
    policy: Policy | None = field(default=None, compare=False, repr=False)
    results: tuple[Values, ...] = ()


class BadOption(ValueError):
    """What is asked for makes no sense; `option` is what commands call it, where it is one alone."""

    def __init__(self, message: str, option: str = "") -> None:
        super().__init__(message)
        self.option = option


class PlanningRefused(ValueError):
    """A planner cannot plan this task with these options; the message says why, and `help` what may help."""

    def __init__(self, message: str, help: str = "") -> None:
        super().__init__(message)
        self.help = help


class TooManyStatesError(PlanningRefused):
    """A planner that must know all states has `reached` more than the `limit`."""

    def __init__(self, reached: int, limit: int, help: str = "") -> None:
        super().__init__(
            f"{reached} states reached, and there are more; the limit is {limit}",
            help or "raise it by `--option states=...`, or plan with `prada+` or `prada`",
        )
        self.reached = reached
        self.limit = limit

    def __reduce__(self) -> tuple[type[TooManyStatesError], tuple[int, int, str]]:
        """Exceptions are pickled by their message, from which this one could not be made again."""
        return TooManyStatesError, (self.reached, self.limit, self.help)
