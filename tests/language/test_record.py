"""Records behave as frozen dataclasses with slots do."""

from __future__ import annotations

import copy
import pickle
from dataclasses import FrozenInstanceError, dataclass, field, fields, replace

import pytest

from cleancli.language.record import Record


class Base(Record):
    place: int = field(kw_only=True, compare=False)


class Made(Base):
    name: str
    parts: tuple[int, ...] = ()
    note: str | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True)
class Plain:
    place: int = field(kw_only=True, compare=False)
    name: str
    parts: tuple[int, ...] = ()
    note: str | None = field(default=None, compare=False)


def test_fields_are_given_by_place_or_name() -> None:
    for kind in (Made, Plain):
        made = kind("a", parts=(1,), place=3)
        assert (made.name, made.parts, made.note, made.place) == ("a", (1,), None, 3)
        assert [f.name for f in fields(kind)] == ["place", "name", "parts", "note"]
        assert kind.__match_args__ == ("name", "parts", "note")
        assert not hasattr(made, "__dict__")


@pytest.mark.parametrize("kind", [Made, Plain])
@pytest.mark.parametrize(
    ("given", "named"),
    [
        (("a",), {}),
        ((), {"place": 1}),
        (("a",), {"place": 1, "size": 2}),
        (("a",), {"place": 1, "name": "b"}),
    ],
)
def test_fields_that_are_missing_unknown_or_given_twice_are_refused(
    kind: type, given: tuple[object, ...], named: dict[str, object]
) -> None:
    with pytest.raises(TypeError):
        kind(*given, **named)


def test_what_is_compared() -> None:
    for kind in (Made, Plain):
        one = kind("a", (1,), "seen", place=1)
        assert one == kind("a", (1,), place=2)
        assert hash(one) == hash(kind("a", (1,), place=2))
        assert one != kind("b", (1,), "seen", place=1)
        assert one != replace(one, parts=())
        assert replace(one, place=5).place == 5
        assert replace(one, place=5).note == "seen"
    assert Made("a", place=1) != Plain("a", place=1)


def test_nothing_can_be_changed() -> None:
    for kind in (Made, Plain):
        made = kind("a", place=1)
        with pytest.raises(FrozenInstanceError):
            made.name = "b"  # type: ignore[misc]
        with pytest.raises(FrozenInstanceError):
            del made.name
        assert made.name == "a"


def test_what_is_shown() -> None:
    assert repr(Made("a", (1,), place=1)) == "Made(name='a', parts=(1,))"


def test_copies_and_pickles_are_equal_in_all_fields() -> None:
    made = Made("a", (1,), "seen", place=1)
    for other in (copy.deepcopy(made), pickle.loads(pickle.dumps(made))):
        assert other == made
        assert (other.note, other.place) == ("seen", 1)
