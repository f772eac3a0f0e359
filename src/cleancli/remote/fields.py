"""Reads what a head says, key by key and against types: whatever is missing, odd or too much is refused."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from cleancli.remote.wire import Array, BadMessage, Message

LONGEST_TEXT = 1000
"""Characters of a text that a head holds."""
LARGEST = 1e9
"""Of any number in a head: seconds of thirty years."""

_UNPRINTABLE = re.compile(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff]")


class BadArray(BadMessage):
    """An array is missing, or has another type or shape than it must."""


class Fields:
    """The members of a JSON object, and the arrays of a message. Each is read once; `end` refuses what was
    not asked for. All raise BadMessage."""

    def __init__(self, members: Mapping[str, Any], arrays: Mapping[str, Array] | None = None) -> None:
        self._left, self._arrays = dict(members), dict(arrays or {})

    def has(self, key: str) -> bool:
        """Whether a key that may be left out is there."""
        return key in self._left

    def text(self, key: str) -> str:
        """One line, without characters that steer a terminal."""
        value = self._taken(key)
        if not isinstance(value, str) or len(value) > LONGEST_TEXT or _UNPRINTABLE.search(value):
            raise BadMessage(f"`{key}` is no line of at most {LONGEST_TEXT} characters")
        return value

    def flag(self, key: str) -> bool:
        """True or false."""
        value = self._taken(key)
        if not isinstance(value, bool):
            raise BadMessage(f"`{key}` is neither true nor false")
        return value

    def whole(self, key: str) -> int:
        """A whole number from 0."""
        value = self._taken(key)
        if type(value) is not int or not 0 <= value <= LARGEST:
            raise BadMessage(f"`{key}` is no whole number from 0")
        return value

    def number(self, key: str) -> float:
        """A number of any sign."""
        return _number(key, self._taken(key))

    def numbers(self, key: str, length: int) -> tuple[float, ...]:
        """So many numbers."""
        value = self._taken(key)
        if not isinstance(value, list) or len(value) != length:
            raise BadMessage(f"`{key}` is no list of {length} numbers")
        return tuple(_number(key, each) for each in value)

    def some_numbers(self, key: str) -> tuple[float, ...]:
        """However many numbers."""
        value = self._taken(key)
        if not isinstance(value, list):
            raise BadMessage(f"`{key}` is no list of numbers")
        return tuple(_number(key, each) for each in value)

    def words(self, key: str) -> tuple[str, ...]:
        """Texts, each as `text` has it."""
        value = self._taken(key)
        if not isinstance(value, list):
            raise BadMessage(f"`{key}` is no list of texts")
        return tuple(Fields({key: each}).text(key) for each in value)

    def within(self, key: str) -> Fields:
        """The members of an object that a key holds."""
        value = self._taken(key)
        if not isinstance(value, dict):
            raise BadMessage(f"`{key}` is no object")
        return Fields(value)

    def array(self, name: str, kind: str, shape: tuple[int | None, ...]) -> Array:
        """An array of this type and shape; None: any length there."""
        if name not in self._arrays:
            raise BadArray(f"the array `{name}` is missing")
        array = self._arrays.pop(name)
        fits = array.ndim == len(shape) and all(
            asked is None or asked == length for asked, length in zip(shape, array.shape, strict=True)
        )
        if array.dtype != kind or not fits:
            asked = " x ".join("any" if length is None else str(length) for length in shape)
            came = " x ".join(map(str, array.shape))
            raise BadArray(f"`{name}` is {array.dtype} of {came}, and not {kind} of {asked}")
        return array

    def end(self) -> None:
        """Nothing else may be there."""
        for kind, names in (("key", self._left), ("array", self._arrays)):
            if names:
                raise BadMessage(f"there is no {kind} `{min(names)[:40]}` here")

    def _taken(self, key: str) -> Any:
        if key not in self._left:
            raise BadMessage(f"`{key}` is missing")
        return self._left.pop(key)


def line(text: str) -> str:
    """A text as `Fields.text` reads it: what a driver says of its failures may be anything."""
    return _UNPRINTABLE.sub("?", text)[:LONGEST_TEXT]


def fields_of(message: Message) -> Fields:
    """What a message says."""
    return Fields(message.head, message.arrays)


def _number(key: str, value: object) -> float:
    if type(value) not in (int, float) or not abs(value) <= LARGEST:  # type: ignore[arg-type]
        raise BadMessage(f"`{key}` is no number up to {LARGEST:g}")
    return float(value)  # type: ignore[arg-type]
