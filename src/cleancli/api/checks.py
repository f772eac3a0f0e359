"""Checks of what callers ask for, with the messages that the commands give."""

from __future__ import annotations

import math
import types
from collections.abc import Collection

from cleancli.language.model import Domain
from cleancli.planning.plan import BadOption

DISCOUNTING = ("reward", "time")
"""What may discount later rewards."""


def check_least(low: int, **named: object) -> None:
    """Raise BadOption for what is no whole number from `low` on; None stands for the usual."""
    for name, value in named.items():
        _check(name, value, int, f"x>={low}", low, math.inf)


def check_between(low: int, high: int, **named: object) -> None:
    """The same with a greatest one."""
    for name, value in named.items():
        _check(name, value, int, f"{low}<=x<={high}", low, high)


def check_share(name: str, value: object) -> None:
    """Raise BadOption for what is no number from 0 to 1; None stands for the usual."""
    _check(name, value, int | float, "0<=x<=1", 0, 1)


def check_seconds(name: str, value: object, *, none_of_it: bool, most: float = math.inf) -> None:
    """Raise BadOption for what is no number of seconds; `none_of_it`: whether 0 is one. None stands for the
    usual."""
    bounds = f"0<=x<={most}" if most < math.inf else "x>=0" if none_of_it else "x>0"
    _check(name, value, int | float, bounds, 0, most)
    if value == 0 and not none_of_it:
        raise BadOption(f"`{name}`: {value} is not in the range {bounds}")


def _check(
    name: str, value: object, kind: type | types.UnionType, bounds: str, low: float, high: float
) -> None:
    if value is None:
        return
    if not isinstance(value, kind) or isinstance(value, bool) or math.isnan(value):  # type: ignore[arg-type]
        whole = "integer" if kind is int else "float"
        raise BadOption(f"`{name}`: {value!r} is not a valid {whole}")
    if not low <= value <= high:  # type: ignore[operator]
        raise BadOption(f"`{name}`: {value} is not in the range {bounds}")


def check_acts(world: Domain) -> None:
    """Raise BadOption for a world without rules, in which no action would ever do anything."""
    if not world.rules:
        raise BadOption(
            "the domain has no rules, so that nothing can happen: name those by which the world acts",
            "--world",
        )


def check_one_of(name: str, value: str | None, known: Collection[str]) -> None:
    """Raise BadOption for a word that is not known; None stands for the usual."""
    if value is not None and value not in known:
        listed = ", ".join(map(repr, known))
        raise BadOption(f"`{name}`: {value!r} is not one of {listed}")
