"""Which share of the plan space some samples cover (eq. 3), and how many samples a small space needs."""

from __future__ import annotations

import math

from cleancli.compiler.task import Task, held

ENOUGH = 10
"""Samples per sequence of a small plan space: drawing more would find nothing new (§4.2.1). Chosen."""


def coverage(task: Task, samples: int) -> float:
    """n / (#dirt · #a)^H, at most 1 (eq. 3), for #a actions and H steps.

    #dirt is the count that the reward wants decreased, as it is in the initial state; 1 without one.
    """
    if samples <= 0:
        return 0.0
    return min(1.0, math.exp(math.log(samples) - _log_sequences(task)))


def enough_samples(task: Task, limit: int) -> int:
    """At most `limit` samples, fewer where (#dirt · #a)^H is small (§4.2.1), none where no action is left."""
    if not task.actions or task.horizon <= 0:
        return 0
    if math.log(ENOUGH) + _log_sequences(task) >= math.log(max(limit, 1)):
        return limit
    sequences: int = max(_pairs(task), 1) ** task.horizon
    return min(limit, ENOUGH * sequences)


def _log_sequences(task: Task) -> float:
    """log (#dirt · #a)^H; a space without dirt or actions has the one empty sequence."""
    return max(task.horizon, 0) * math.log(max(_pairs(task), 1))


def _pairs(task: Task) -> int:
    return (1 if task.counted is None else held(task.counted, task.initial)) * len(task.actions)
