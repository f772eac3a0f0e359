"""Expectation and maximisation of many sets at once against one set, one transition after the other."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cleancli.array_types import Floats
from cleancli.learning.structure import mixture
from cleancli.learning.structure.mixture import fitted, log_likelihoods


def slow(counts: list[float], likelihoods: list[list[float]], rounds: int = 2000) -> list[float]:
    """The same by its definition (Dempster, Laird and Rubin 1977)."""
    number = len(likelihoods[0])
    beliefs = [1 / number] * number
    for _ in range(rounds):
        seen = [0.0] * number
        for count, row in zip(counts, likelihoods, strict=True):
            joint = [belief * likely for belief, likely in zip(beliefs, row, strict=True)]
            seen = [s + count * j / sum(joint) for s, j in zip(seen, joint, strict=True)]
        beliefs = [s / sum(counts) for s in seen]
    return beliefs


def patterns(seed: int) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    likelihoods = (rng.random((6, 3)) < 0.5).astype(float)
    noise = rng.choice([0.01, 0.0001], size=(6, 1))
    return rng.integers(0, 20, size=(4, 6)).astype(float) + 1, np.hstack([likelihoods, noise])


@pytest.mark.parametrize("seed", range(5))
def test_sets_are_fitted_as_each_alone(seed: int) -> None:
    counts, likelihoods = patterns(seed)
    found = fitted(counts, likelihoods, np.full(4, 0.25), rounds=2000)
    logs = log_likelihoods(counts, likelihoods, found)
    for own, beliefs, log in zip(counts, found, logs, strict=True):
        expected = slow(own.tolist(), likelihoods.tolist())
        assert beliefs.sum() == pytest.approx(1)
        least = sum(
            count * math.log(sum(p * q for p, q in zip(row, expected, strict=True)))
            for count, row in zip(own.tolist(), likelihoods.tolist(), strict=True)
        )
        assert log == pytest.approx(least, abs=1e-3)


def test_what_is_impossible_at_first_stays_so_and_an_empty_set_keeps_its_start() -> None:
    counts, likelihoods = patterns(1)
    start = np.array([0.5, 0.0, 0.25, 0.25])
    found = fitted(np.vstack([counts, np.zeros((1, 6))]), likelihoods, start)
    assert not found[:, 1].any()
    assert found[-1].tolist() == start.tolist()


def test_many_sets_are_fitted_as_each_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the sets are divided, so that no multiplication is large."""
    rng = np.random.default_rng(5)
    counts, likelihoods = rng.integers(0, 9, (7, 5)).astype(float), rng.random((5, 3))
    start = np.full(3, 1 / 3)
    alone = np.concatenate([fitted(each[None], likelihoods, start, 30) for each in counts])
    monkeypatch.setattr(mixture, "MOST_PRODUCTS", 2 * likelihoods.size)
    together = fitted(counts, likelihoods, start, 30)
    assert together == pytest.approx(alone, abs=1e-6)
    assert log_likelihoods(counts, likelihoods, together) == pytest.approx(
        [log_likelihoods(c[None], likelihoods, b[None])[0] for c, b in zip(counts, alone, strict=True)],
        abs=1e-4,
    )
