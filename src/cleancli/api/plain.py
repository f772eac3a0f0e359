"""Results as dictionaries, lists, texts and numbers, which is what JSON holds."""

from __future__ import annotations

import enum
from collections.abc import Collection, Mapping
from dataclasses import fields, is_dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from cleancli.compiler.task import GroundAction

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


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
        return fields_of(value)
    raise TypeError(f"{type(value).__name__} has no plain form")


def fields_of(record: DataclassInstance, without: Collection[str] = ()) -> dict[str, object]:
    """The fields of a record but some, in their order, in plain form."""
    names = (field.name for field in fields(record) if field.name not in without)
    return {name: plain(getattr(record, name)) for name in names}
