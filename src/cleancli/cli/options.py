"""Options that several commands have, each with its range and its words in one place."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import Any, Protocol, TypeVar, cast

import click

from cleancli.api.checks import DISCOUNTING
from cleancli.language.checking.learned import LARGEST_M, MOST_FORGETTING
from cleancli.learning.estimate import ESTIMATORS
from cleancli.learning.method import DEFAULT, MATCHES
from cleancli.perception.reading import MAX_DIFFERENCE, Reading

F = TypeVar("F", bound=Callable[..., Any])

FILE = click.Path(path_type=Path, dir_okay=False)
FOLDER = click.Path(path_type=Path, file_okay=False)


class Option(Protocol):
    """What gives the option to a function that becomes a command."""

    def __call__(self, function: F, /) -> F: ...


def seed(of: str = "all randomness", usual: str = "the scene's") -> Option:
    """What is drawn, and from which seed where none is asked for."""
    return click.option("--seed", type=click.IntRange(min=0), help=f"Seed of {of}. [default: {usual}]")


def samples(help: str, usual: int | None = None, most: int | None = None) -> Option:
    """What planners draw; `usual` is None where the problem may say."""
    kind = click.IntRange(min=1, max=most)
    return click.option("--samples", type=kind, default=usual, show_default=usual is not None, help=help)


def time_limit(of: str) -> Option:
    """The time that a planner has."""
    kind = click.FloatRange(min=0, min_open=True)
    return click.option("--time-limit", type=kind, help=f"Seconds for {of}; see the docs.")


def objective(choices: Sequence[str], usual: str = "reward; without a horizon see the docs") -> Option:
    """What plans are best by."""
    help = "What discounts later rewards: the number of actions before (reward), or their duration (time)."
    if len(choices) > len(DISCOUNTING):
        help += " Without a horizon: what reaching the goal is to take little of, as surely as can be."
    return click.option("--objective", type=click.Choice(list(choices)), help=f"{help}  [default: {usual}]")


def named() -> Option:
    """Options of planners by name."""
    return click.option(
        "--option", "named", multiple=True, metavar="NAME=VALUE", help="Of a planner; may be repeated."
    )


def learning() -> Option:
    """How counts become probabilities, and what counts."""
    given = (
        click.option(
            "--estimator",
            type=click.Choice(list(ESTIMATORS)),
            help="How counts and prior are combined: eq. 5, eq. 4, eq. 4 with m fitted, or not at all."
            f"  [default: as DOMAIN notes, or {DEFAULT.estimator}]",
        ),
        click.option(
            "--m",
            type=click.FloatRange(min=0, max=LARGEST_M),
            help=f"Weight of the prior, in examples.  [default: as DOMAIN notes, or {DEFAULT.m:g}]",
        ),
        click.option(
            "--match",
            type=click.Choice(MATCHES),
            help="What a transition counts for that several outcomes may have made: each, or the likeliest."
            f"  [default: as DOMAIN notes, or {DEFAULT.match}]",
        ),
        click.option(
            "--forgetting",
            type=click.FloatRange(min=0, max=MOST_FORGETTING),
            help="By which share an example counts for less than the next one of its rule."
            f"  [default: as DOMAIN notes, or {DEFAULT.forgetting:g}]",
        ),
    )

    def added(function: F) -> F:
        for option in reversed(given):
            function = option(function)
        return function

    return added


def recording(with_cell: bool = True) -> Option:
    """How a recording is read: the command gets all of it as `reading`. Without `--cell` where the command
    itself has another file that tells where the camera stands, or finds it out."""
    given = [
        click.option("--frame", help="The frame of tf that is the scene's. [default: no place is known]"),
        click.option("--colour-topic", "--color-topic", "colour_topic", help="Of a bag. [default: found]"),
        click.option("--depth-topic", help="Of a bag. [default: found]"),
        click.option("--info-topic", help="The camera_info of a bag. [default: beside the colour]"),
        click.option(
            "--max-difference",
            type=click.FloatRange(min=0),
            default=MAX_DIFFERENCE,
            show_default=True,
            help="Seconds by which colour and depth of one frame may differ.",
        ),
    ]
    names = ["frame", "colour_topic", "depth_topic", "info_topic", "max_difference"]
    if with_cell:
        told = "Where the camera stands, if the recording does not tell."
        given.append(click.option("--cell", type=FILE, help=told))
        names.append("cell")

    def added(function: F) -> F:
        @wraps(function)
        def gathered(**values: Any) -> Any:
            return function(reading=Reading(**{name: values.pop(name) for name in names}), **values)

        for option in reversed(given):
            gathered = option(gathered)
        return cast(F, gathered)

    return added


def max_actions(help: str, most: int | None = None) -> Option:
    """How long an episode may be."""
    kind = click.IntRange(min=0, max=most)
    return click.option("--max-actions", type=kind, default=60, show_default=True, help=help)


def jobs(help: str) -> Option:
    """How many processes share the work."""
    return click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help=help)


def as_json(help: str) -> Option:
    """The answer for programs."""
    return click.option("--json", "as_data", is_flag=True, help=help)
