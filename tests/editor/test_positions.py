"""Offsets and the editor's places are each other's inverse, in every encoding."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cleancli.editor.positions import UTF_8, UTF_16, UTF_32, Positions

TEXTS = st.text(st.sampled_from("a é🧽\t\r\n"), max_size=30)


@pytest.mark.parametrize(("encoding", "unit"), [(UTF_8, 7), (UTF_16, 4), (UTF_32, 3)])
def test_units_of_a_line(encoding: str, unit: int) -> None:
    assert Positions("x\n🧽éb", encoding).place(4) == (1, unit - 1)
    assert Positions("x\n🧽éb", encoding).place(5) == (1, unit)
    assert Positions("x\n🧽éb", encoding).offset(1, unit) == 5


def test_half_a_character_means_its_begin() -> None:
    assert Positions("🧽b").offset(0, 1) == 0


@given(TEXTS, st.sampled_from([UTF_8, UTF_16, UTF_32]))
def test_there_and_back(text: str, encoding: str) -> None:
    positions = Positions(text, encoding)
    for offset in range(len(text) + 1):
        line, unit = positions.place(offset)
        if text[offset - 1 : offset + 1] != "\r\n":
            assert positions.offset(line, unit) == offset


@given(TEXTS, st.integers(0, 40), st.integers(0, 40))
def test_places_outside_lead_inside(text: str, line: int, unit: int) -> None:
    assert 0 <= Positions(text).offset(line, unit) <= len(text)
