"""Messages as bytes, against docs/protocol.md read a second time, and against whatever may come."""

from __future__ import annotations

import json
import struct
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.remote.wire import (
    LARGEST_BODY,
    LARGEST_HEAD,
    BadMessage,
    Message,
    encoded,
    parsed_head,
    received,
)


def bytes_of(message: Message) -> bytes:
    return b"".join(map(bytes, encoded(message)))


def read(data: bytes, most: int = LARGEST_BODY) -> Message:
    """As a transport hands it out; what is missing is an error of its own."""
    left = memoryview(data)

    def fill(memory: memoryview) -> None:
        nonlocal left
        if len(memory) > len(left):
            raise EOFError
        memory[:] = left[: len(memory)]
        left = left[len(memory) :]

    return received(fill, most)


def by_the_page(head: object, *bodies: bytes) -> bytes:
    """A message put together as the page says."""
    text = head if isinstance(head, bytes) else json.dumps(head).encode()
    return b"nidr" + struct.pack(">I", len(text)) + text + b"".join(bodies)


DECLARED = {"name": "a", "type": "float32", "shape": [2, 2]}


def test_a_message_of_the_page_is_read() -> None:
    head = {"request": "start", "arrays": [DECLARED, {"name": "b", "type": "uint8", "shape": [3]}]}
    message = read(by_the_page(head, struct.pack("<4f", 1, 2, 3, 4), b"\x07\x08\x09"))
    assert message.head == {"request": "start"}
    np.testing.assert_array_equal(message.arrays["a"], [[1, 2], [3, 4]])
    np.testing.assert_array_equal(message.arrays["b"], [7, 8, 9])


def test_a_message_is_written_as_the_page_says() -> None:
    data = bytes_of(Message({"poll": 1.5}, {"a": np.array([[1.0, 2.0]]), "b": np.zeros((0, 5))}))
    assert data[:4] == b"nidr"
    (length,) = struct.unpack(">I", data[4:8])
    assert json.loads(data[8 : 8 + length]) == {
        "poll": 1.5,
        "arrays": [
            {"name": "a", "type": "float64", "shape": [1, 2]},
            {"name": "b", "type": "float64", "shape": [0, 5]},
        ],
    }
    assert data[8 + length :] == struct.pack("<2d", 1.0, 2.0)


@pytest.mark.parametrize("kind", ["u1", "<f4", ">f4", "<f8", ">f8"])
def test_arrays_come_as_they_were(kind: str) -> None:
    array = np.arange(24).reshape(2, 3, 4).astype(kind)
    for laid_out in (array, array.transpose(2, 0, 1), array[:, ::-1]):
        again = read(bytes_of(Message({}, {"a": laid_out}))).arrays["a"]
        np.testing.assert_array_equal(again, laid_out)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=8,
)


@settings(deadline=None)
@given(st.dictionaries(st.text().filter(lambda key: key != "arrays"), JSON, max_size=5))
def test_heads_come_as_they_were(head: dict[str, Any]) -> None:
    with suppress(ValueError):  # too deep
        data = bytes_of(Message(head))
        assert read(data).head == head


@settings(deadline=None, max_examples=300)
@given(st.binary(max_size=200))
def test_any_bytes_are_a_message_or_refused(data: bytes) -> None:
    for whole in (data, b"nidr" + struct.pack(">I", len(data)) + data):
        with suppress(BadMessage, EOFError):
            read(whole)


@settings(deadline=None, max_examples=300)
@given(st.data())
def test_damaged_messages_are_messages_or_refused(data: st.DataObject) -> None:
    whole = bytearray(by_the_page({"x": [1, {"y": "ü"}], "arrays": [DECLARED]}, bytes(16)))
    for _ in range(data.draw(st.integers(1, 4))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    with suppress(BadMessage, EOFError):
        read(bytes(whole))


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"GET / HTTP/1.1\r\n", "a message begins with b'nidr'"),
        (b"nidr" + struct.pack(">I", LARGEST_HEAD + 1), "a head has 2 to 65536 bytes"),
        (b"nidr" + struct.pack(">I", 0), "a head has 2 to 65536 bytes"),
        (by_the_page(b"[1]"), "no JSON object"),
        (by_the_page(b"{'a': 1}"), "no JSON"),
        (by_the_page(b'{"a": 1, "a": 2}'), "a key stands twice"),
        (by_the_page(b'{"a": NaN}'), "NaN is no number"),
        (by_the_page(b'{"a": -Infinity}'), "-Infinity is no number"),
        (by_the_page(b'{"a": 1e999}'), "too large"),
        (by_the_page(b'{"a": "\xff"}'), "no JSON"),
        (by_the_page(b'{"a":' + b"[" * 9000 + b"]" * 9000 + b"}"), "levels|too deeply"),
        (by_the_page(b'{"a": ' + b"9" * 5000 + b"}"), "no JSON"),
        (by_the_page({"a": [0] * 65}), "more than 64"),
        (by_the_page({"arrays": 1}), "no list of at most 4"),
        (by_the_page({"arrays": [DECLARED] * 5}), "no list of at most 4"),
        (by_the_page({"arrays": [DECLARED, DECLARED]}), "two arrays have one name"),
        (by_the_page({"arrays": [{"name": "a", "type": "uint8"}]}), "declared by"),
        (by_the_page({"arrays": [DECLARED | {"type": "object"}]}), "the `type` of `a`"),
        (by_the_page({"arrays": [DECLARED | {"type": []}]}), "the `type` of `a`"),
        (by_the_page({"arrays": [DECLARED | {"shape": [1.0]}]}), "the `shape` of `a`"),
        (by_the_page({"arrays": [DECLARED | {"shape": [True]}]}), "the `shape` of `a`"),
        (by_the_page({"arrays": [DECLARED | {"shape": [-1, -4]}]}), "the `shape` of `a`"),
        (by_the_page({"arrays": [DECLARED | {"shape": [1, 1, 1, 1]}]}), "the `shape` of `a`"),
        (by_the_page({"arrays": [DECLARED | {"shape": [5000, 5000]}]}), "100000000 bytes, and 67108864"),
    ],
)
def test_what_is_no_message_is_refused(data: bytes, reason: str) -> None:
    """Before the body is asked for: none of these has one."""
    with pytest.raises(BadMessage, match=reason):
        read(data)


def test_arrays_that_are_too_large_for_a_request_are_refused() -> None:
    head = json.dumps({"arrays": [DECLARED]}).encode()
    with pytest.raises(BadMessage, match="16 bytes, and 15 is the limit"):
        parsed_head(head, 15)
    assert parsed_head(head, 16)[1][0].size == 16


@pytest.mark.parametrize(
    "message",
    [
        Message({"a": float("nan")}),
        Message({"a": "x" * LARGEST_HEAD}),
        Message({}, {"a": np.zeros(2, np.int64)}),
        Message({}, {"a": np.zeros((1, 1, 1, 1))}),
        Message({}, {"a": np.zeros(LARGEST_BODY + 1, np.uint8)}),
        Message({}, {str(number): np.zeros(1) for number in range(5)}),
    ],
)
def test_what_is_no_message_is_not_written(message: Message) -> None:
    with pytest.raises(ValueError, match=r"."):
        encoded(message)
