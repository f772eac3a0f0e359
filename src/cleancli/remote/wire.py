"""Messages as bytes (docs/protocol.md): a prefix, a head in JSON, and arrays that the head declares.

What comes from the other side is not trusted: the prefix bounds the head, and the head bounds the arrays,
before any memory is used for them. Pure functions, but for `received`, which asks its caller for bytes.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAGIC = b"nidr"
"""What each message begins with."""
PREFIX = struct.Struct(">4sI")
"""The magic, and the length of the head in bytes, the highest byte first."""
LARGEST_HEAD = 1 << 16
"""Bytes."""
LARGEST_BODY = 64 << 20
"""Bytes of all arrays of a message: colour and depth of 3840 x 2160 pixels take 58 million."""
MOST_ARRAYS = 4
MOST_DIMENSIONS = 3
MOST_MEMBERS = 64
"""Of an object or a list in a head."""
DEEPEST = 6
"""Objects and lists within one another in a head."""

TYPES: Mapping[str, np.dtype[Any]] = MappingProxyType(
    {"uint8": np.dtype("u1"), "float32": np.dtype("<f4"), "float64": np.dtype("<f8")}
)
"""Elements of arrays, by their names in heads; the lowest byte comes first."""

Array = NDArray[Any]
Fill = Callable[[memoryview], None]
"""Fills all of a piece of memory with the bytes that come next, or raises."""


class BadMessage(Exception):
    """What came is no message; the text says why, as a sentence without an end."""


@dataclass(frozen=True, slots=True)
class Message:
    """What the head says, without the declaration of the arrays, and the arrays by their names."""

    head: Mapping[str, Any]
    arrays: Mapping[str, Array] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Declared:
    """An array that a head announces."""

    name: str
    kind: np.dtype[Any]
    shape: tuple[int, ...]

    @property
    def size(self) -> int:
        """Bytes."""
        return math.prod(self.shape) * self.kind.itemsize


def encoded(message: Message) -> tuple[bytes | memoryview, ...]:
    """The pieces of a message, to be sent one after the other. Raises ValueError for what the protocol has no
    place for: other types, numbers that are not finite, and more than a message may hold."""
    arrays = {name: _laid_out(name, array) for name, array in message.arrays.items()}
    declared = [
        {"name": name, "type": _name_of(array.dtype), "shape": list(array.shape)}
        for name, array in arrays.items()
    ]
    head = json.dumps({**message.head, "arrays": declared}, allow_nan=False, separators=(",", ":")).encode()
    if len(head) > LARGEST_HEAD:
        raise ValueError(f"a head of {len(head)} bytes is longer than {LARGEST_HEAD}")
    try:
        parsed_head(head, LARGEST_BODY)
    except BadMessage as error:
        raise ValueError(str(error)) from None
    # An array without elements has no bytes to send, and memory that cannot be cast.
    bodies = (array.data.cast("B") for array in arrays.values() if array.size)
    return (PREFIX.pack(MAGIC, len(head)) + head, *bodies)


def received(fill: Fill, most: int = LARGEST_BODY) -> Message:
    """The next message, whose arrays take at most so many bytes. Raises BadMessage, and what `fill` does."""
    prefix = bytearray(PREFIX.size)
    fill(memoryview(prefix))
    head = bytearray(head_length(bytes(prefix)))
    fill(memoryview(head))
    said, declared = parsed_head(bytes(head), most)
    arrays: dict[str, Array] = {}
    for each in declared:
        body = bytearray(each.size)
        if body:
            fill(memoryview(body))
        arrays[each.name] = np.frombuffer(body, each.kind).reshape(each.shape)
    return Message(said, arrays)


def head_length(prefix: bytes) -> int:
    """Bytes of the head that follows a prefix. Raises BadMessage."""
    magic, length = PREFIX.unpack(prefix)
    if magic != MAGIC:
        raise BadMessage(f"a message begins with {MAGIC!r}, and this with {magic!r}")
    if not 2 <= length <= LARGEST_HEAD:
        raise BadMessage(f"a head has 2 to {LARGEST_HEAD} bytes, and this would have {length}")
    return int(length)


def parsed_head(data: bytes, most: int) -> tuple[dict[str, Any], tuple[Declared, ...]]:
    """What a head says, and the arrays that follow, of at most so many bytes. Raises BadMessage."""
    try:
        head = json.loads(data.decode("utf-8"), object_pairs_hook=_each_once, parse_constant=_refused)
    except RecursionError:
        raise BadMessage("the head is nested too deeply") from None
    except (ValueError, UnicodeDecodeError) as error:
        raise BadMessage(f"the head is no JSON: {error}") from None
    if not isinstance(head, dict):
        raise BadMessage("the head is no JSON object")
    _refuse_odd(head, DEEPEST)
    declared = head.pop("arrays", [])
    if not isinstance(declared, list) or len(declared) > MOST_ARRAYS:
        raise BadMessage(f"`arrays` is no list of at most {MOST_ARRAYS} arrays")
    arrays = tuple(map(_declaration, declared))
    if len({each.name for each in arrays}) < len(arrays):
        raise BadMessage("two arrays have one name")
    if (size := sum(each.size for each in arrays)) > most:
        raise BadMessage(f"the arrays would take {size} bytes, and {most} is the limit")
    return head, arrays


def _declaration(said: object) -> Declared:
    if not isinstance(said, dict) or said.keys() != {"name", "type", "shape"}:
        raise BadMessage("an array is declared by its `name`, `type` and `shape`")
    name, kind, shape = said["name"], said["type"], said["shape"]
    if not isinstance(name, str):
        raise BadMessage("the `name` of an array is no text")
    if not isinstance(kind, str) or kind not in TYPES:
        raise BadMessage(f"the `type` of `{name}` is none of {', '.join(TYPES)}")
    if not isinstance(shape, list) or not 1 <= len(shape) <= MOST_DIMENSIONS or not all(map(_counts, shape)):
        raise BadMessage(f"the `shape` of `{name}` is no list of 1 to {MOST_DIMENSIONS} whole numbers")
    return Declared(name, TYPES[kind], tuple(shape))


def _counts(value: object) -> bool:
    """Whether this can be the length of an array, of which the product cannot be huge either."""
    return type(value) is int and 0 <= value <= LARGEST_BODY


def _each_once(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key stands twice in an object")
    return found


def _refused(word: str) -> float:
    raise ValueError(f"{word} is no number")


def _refuse_odd(value: object, depth: int) -> None:
    """Numbers that are infinite once they are read (1e999), and objects of many members or levels."""
    if isinstance(value, float) and not math.isfinite(value):
        raise BadMessage("a number in the head is too large")
    if isinstance(value, dict | list):
        if not depth or len(value) > MOST_MEMBERS:
            raise BadMessage(f"the head has more than {DEEPEST} levels, or more than {MOST_MEMBERS} in one")
        for each in value.values() if isinstance(value, dict) else value:
            _refuse_odd(each, depth - 1)


def _laid_out(name: str, array: Array) -> Array:
    """In the order of its elements, the lowest byte first."""
    for kind in TYPES.values():
        if array.dtype.newbyteorder("=") == kind.newbyteorder("="):
            return np.ascontiguousarray(array, kind)
    raise ValueError(f"`{name}` holds {array.dtype}: a message carries {', '.join(TYPES)}")


def _name_of(kind: np.dtype[Any]) -> str:
    return next(name for name, known in TYPES.items() if known == kind)
