"""Arrays of numbers, against numpy's own and slower words for the same."""

from __future__ import annotations

import numpy as np
import pytest

from cleancli.compiler.ragged import distinct


@pytest.mark.parametrize("number", [0, 1, 2, 60])
def test_distinct_numbers_ascend_and_are_all_there(number: int) -> None:
    for seed in range(20):
        numbers = np.random.default_rng(seed).integers(-4, 20, size=number)
        assert distinct(numbers).tolist() == sorted(set(numbers.tolist()))
