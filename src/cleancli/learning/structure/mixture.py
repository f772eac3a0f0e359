"""How likely transitions are where several outcomes may have made each, for many sets of them at once.

A set is told by how many transitions of each pattern it has; a pattern is how likely each outcome makes such
a transition (0 or 1 of an outcome that is modelled, little of noise). Expectation and maximisation (Dempster,
Laird and Rubin 1977) finds the probabilities of outcomes that make a set likeliest.
"""

from __future__ import annotations

import numpy as np

from cleancli.array_types import Floats

FEW_ROUNDS = 12
"""Rounds that compare what may be asked for; chosen, since the order of candidates is then mostly settled."""
SOME_ROUNDS = 40
"""Rounds before the next choice; chosen."""
ROUNDS = 400
TOLERANCE = 1e-7
_NEVER = 1e-300
MOST_PRODUCTS = 1 << 18
"""Products of numbers in one multiplication of matrices up to which OpenBLAS computes it in one thread.
Larger ones are many small ones here: threads that wait for each other on a busy machine take ten times the
CPU, and how many there are decides the rounding."""


def fitted(counts: Floats, likelihoods: Floats, start: Floats, rounds: int = ROUNDS) -> Floats:
    """The probabilities of outcomes in sets of transitions (b, outcomes).

    `counts` are (b, patterns), `likelihoods` (patterns, outcomes), and `start` is (outcomes,) or (b,
    outcomes); what is 0 there stays so. An empty set keeps the start.
    """
    totals = counts.sum(axis=1, keepdims=True)
    beliefs = np.broadcast_to(start, (len(counts), likelihoods.shape[1])).astype(float)
    for _ in range(rounds):
        expected = np.maximum(_product(beliefs, likelihoods.T), _NEVER)
        shares = beliefs * _product(counts / expected, likelihoods)
        after = np.where(totals > 0, shares / np.maximum(totals, _NEVER), beliefs)
        moved = float(np.abs(after - beliefs).max(initial=0.0))
        beliefs = after
        if moved < TOLERANCE:
            break
    return beliefs


def log_likelihoods(counts: Floats, likelihoods: Floats, beliefs: Floats) -> Floats:
    """How likely sets of transitions are by probabilities of outcomes, as logarithms (b,)."""
    logs = np.log(np.maximum(_product(np.atleast_2d(beliefs), likelihoods.T), _NEVER))
    found: Floats = (counts * logs).sum(axis=1)
    return found


def _product(one: Floats, other: Floats) -> Floats:
    """The product of two matrices, so many rows at a time that one thread computes them."""
    rows = max(1, MOST_PRODUCTS // max(other.size, 1))
    parts = [one[start : start + rows] @ other for start in range(0, max(len(one), 1), rows)]
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
