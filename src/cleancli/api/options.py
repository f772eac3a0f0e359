"""Checks of what callers ask for, with the messages that the commands give."""

from __future__ import annotations

from collections.abc import Collection
from math import isfinite

from cleancli.planning.plan import BadOption


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
