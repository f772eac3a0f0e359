"""Singular and plural in sentences."""

from __future__ import annotations


def plural(number: int | str, one: str, several: str = "") -> str:
    """`1 action`, `2 actions`. What several are called may be told: `1 fact holds`, `2 facts hold`. A number
    that is no whole one is given as it is to be written."""
    return f"{number} {one if str(number) == '1' else several or f'{one}s'}"
