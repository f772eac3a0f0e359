"""The product against another reading of docs/language.md and docs/planning.md, on random domains.

`python benchmarks/differential.py` does the same with thousands of domains.
"""

from __future__ import annotations

import itertools
from collections import Counter
from pathlib import Path

import pytest

from support.differential.comparing import compare
from support.differential.comparison import Comparison, unlikely

DOMAINS = 27
"""Domains that pass `check`, in each part."""

OFTEN = {
    "transition": 300,
    "reward": 500,
    "paid": 300,
    "standing": 60,
    "goal": 60,
    "rule": 100,
    "dropped": 50,
    "explain": 150,
    "frequency": 20,
    "drawn reward": 20,
    "exact value": 40,
    "sequence": 5,
    "sampled value": 5,
    "forecast: rules": 8,
    "forecast: effects": 6,
    "optimum": 30,
    "optimum by time": 2,
    "course": 30,
    "learned": 60,
    "compare-rules: variation": 5,
    "environment: over": 100,
}
"""What is compared in each part at least so often: a test that compares nothing finds nothing."""


@pytest.mark.parametrize("part", range(10))
def test_product_and_interpreter_agree(part: int, tmp_path: Path) -> None:
    compared = compared_in(part, tmp_path)
    differences = [f"seed {each.seed}: {text}" for each in compared for text in each.differences]
    assert not differences, "\n".join(
        [*differences[:10], "see `python benchmarks/differential.py --only SEED`"]
    )
    frequency = unlikely(compared)
    assert frequency > 1e-6, "frequencies that are each possible are together too far from what is declared"
    total = sum((each.compared for each in compared), Counter[str]())
    seldom = {what: total[what] for what, number in OFTEN.items() if total[what] < number}
    assert not seldom


def compared_in(part: int, folder: Path) -> list[Comparison]:
    """All that were drawn until enough of them had passed the checker and were grounded."""
    found: list[Comparison] = []
    for seed in itertools.count(1000 * part):
        found.append(compare(seed, folder))
        if sum(not each.refused for each in found) == DOMAINS:
            return found
    raise AssertionError("unreachable")
