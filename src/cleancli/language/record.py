"""Dataclasses that are frozen, have slots, and share methods that are written once.

A plain dataclass compiles its methods for itself. For all the small classes of the language that takes longer
than checking a file does. Plain ones are faster to make and to compare: so those that there are thousands of
when planning stay plain.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, FrozenInstanceError, dataclass, field
from typing import Any, NoReturn, cast, dataclass_transform


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
class _RecordType(type):
    """Notes the fields that a class states, before those that it inherits."""

    _parts: Mapping[str, Field[Any]] = {}
    _fields: tuple[str, ...]
    _setters: tuple[Callable[[object, object], None], ...]
    _defaults: tuple[tuple[str, Any], ...]
    _compared: tuple[str, ...]

    def __new__(mcs, name: str, bases: tuple[type, ...], namespace: dict[str, Any]) -> _RecordType:
        own = tuple(namespace.get("__annotations__", ()))
        stated = {name: namespace.pop(name, MISSING) for name in own}
        made: Any = super().__new__(mcs, name, bases, {**namespace, "__slots__": own, "__match_args__": own})
        parts = {n: part if isinstance(part, Field) else field(default=part) for n, part in stated.items()}
        made._parts = parts | made._parts
        made._fields = tuple(made._parts)
        made._setters = tuple(getattr(made, name).__set__ for name in made._fields)
        made._defaults = tuple((name, part.default) for name, part in made._parts.items())
        made._compared = tuple(name for name, part in made._parts.items() if part.compare)
        return cast(_RecordType, dataclass(init=False, repr=False, eq=False)(made))


class Record(metaclass=_RecordType):
    """What a class of records inherits; its fields are stated as those of a dataclass are."""

    def __init__(self, *values: object, **named: object) -> None:
        kind = type(self)
        setters = kind._setters
        missing = len(setters) - len(values)
        if missing == len(named) == 1 and kind._fields[-1] in named:  # as the span of a node
            setters[-1](self, named[kind._fields[-1]])
        elif missing or named:
            values = kind._in_order(values, named)
        for put, value in zip(setters, values):  # noqa: B905 (the last may be set already)
            put(self, value)

    @classmethod
    def _in_order(cls, values: tuple[object, ...], named: dict[str, object]) -> tuple[object, ...]:
        """The values of all fields in their order."""
        missing = cls._fields[len(values) :]
        if missing and missing == tuple(named):
            return (*values, *named.values())
        rest = [named.pop(name, default) for name, default in cls._defaults[len(values) :]]
        if named or len(values) > len(cls._fields) or [value for value in rest if value is MISSING]:
            raise TypeError(f"{cls.__name__} is made of {', '.join(cls._fields)}")
        return (*values, *rest)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise FrozenInstanceError(f"cannot assign to field {name!r}")

    def __delattr__(self, name: str) -> NoReturn:
        raise FrozenInstanceError(f"cannot delete field {name!r}")

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self._values() == other._values()

    def __hash__(self) -> int:
        return hash((type(self), self._values()))

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        """For other processes and copies, which could not set what is frozen."""
        return type(self), tuple([getattr(self, name) for name in type(self)._fields])

    def __repr__(self) -> str:
        shown = (f"{name}={getattr(self, name)!r}" for name in type(self)._compared)
        return f"{type(self).__name__}({', '.join(shown)})"

    def _values(self) -> tuple[object, ...]:
        """What is compared."""
        return tuple([getattr(self, name) for name in type(self)._compared])
