"""Pieces of dirt that are one area (docs/perception.md), against a comparison of all pairs."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from cleancli.perception.areas import CELL, linked

PIECE = 0.002
"""Metres: width of a piece, as of a pixel."""


def chained(middles: np.ndarray, most: float) -> list[set[int]]:
    """The pieces that chains of steps between middles of at most `most` metres lead to."""
    groups = [{number} for number in range(len(middles))]
    for one, other in combinations(range(len(middles)), 2):
        if np.linalg.norm(middles[one] - middles[other]) <= most:
            first, second = (next(g for g in groups if n in g) for n in (one, other))
            if first is not second:
                groups.remove(second)
                first |= second
    return groups


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("link", [0.01, 0.03])
def test_a_gap_below_the_link_divides_no_area_and_one_above_it_does(seed: int, link: float) -> None:
    """The gap is between what the pieces cover, which reaches a quarter of a piece beyond their middles.
    Where cells are too coarse to tell, either is right."""
    middles = np.random.default_rng(seed).uniform(0, 0.2, (25, 2))
    owners = linked(middles, np.full(len(middles), PIECE**2), link)
    found = [set(np.flatnonzero(owners == owner).tolist()) for owner in range(owners.max() + 1)]
    most = link + PIECE / 2
    surely, perhaps = (chained(middles, most + way * 2 * CELL) for way in (-1, 1))
    assert all(any(group <= whole for whole in found) for group in surely)
    assert all(any(group <= whole for whole in perhaps) for group in found)
