"""Texts above pictures: beside each other, whole, and on nothing that the picture shows."""

from __future__ import annotations

import numpy as np
import pytest

from cleancli.recording.caption import GAP, PAPER, ROW, captioned, fitting, width_of

LONG = "12. moveToContainerStraight(a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12)"


@pytest.mark.parametrize("texts", [("1. pickUp(a1)", "8.4 s"), (LONG, "1234.5 s of robot time"), ("", "")])
@pytest.mark.parametrize("width", [160, 400, 960])
def test_texts_of_a_row_fit_beside_each_other(texts: tuple[str, str], width: int) -> None:
    scale = fitting(texts, width)
    left, right = (width_of(text, scale) for text in texts)
    assert left + right + 3 * GAP <= width + 2


def test_the_band_is_added_and_covers_nothing() -> None:
    picture = np.random.default_rng(1).integers(0, 255, (120, 400, 3), np.uint8)
    told = captioned(picture, ("left", "right"), ("below", ""))
    assert told.shape == (120 + 2 * ROW, 400, 3)
    np.testing.assert_array_equal(told[2 * ROW :], picture)


def test_texts_stand_whole_at_both_ends_of_their_row() -> None:
    band = captioned(np.zeros((2, 400, 3), np.uint8), ("left", "right"), ("", ""))[: 2 * ROW]
    written = (band != PAPER).any(axis=2)
    rows, columns = np.nonzero(written)
    assert rows.min() > 0
    assert rows.max() < ROW - 1
    assert GAP - 2 <= columns.min() <= GAP + 4
    assert 400 - GAP - 5 <= columns.max() <= 400 - GAP + 2
    assert not written[:, 150:250].any()
