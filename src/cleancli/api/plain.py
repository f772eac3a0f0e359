"""Results as dictionaries, lists, texts and numbers, which is what JSON holds."""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from fractions import Fraction

from cleancli.compiler.task import GroundAction


def plain(value: object) -> object:
    """A result with all that is in it; records become dictionaries. Raises TypeError for what has no such
    form."""
    match value:
        case enum.Enum():
            return value.value
        case None | bool() | int() | float() | str():
            return value
        case Fraction():
            return float(value)
        case GroundAction():
            return str(value)
        case Mapping():
            return {str(plain(name)): plain(part) for name, part in value.items()}
        case list() | tuple():
            return [plain(part) for part in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    raise TypeError(f"{type(value).__name__} has no plain form")
