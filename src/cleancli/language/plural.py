"""Numbers of things in sentences."""

from __future__ import annotations


def plural(number: int, noun: str) -> str:
    """`1 action`, `2 actions`."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
