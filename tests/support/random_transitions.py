"""Transitions at random, as they never happen: for what must come back as it was written."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cleancli.language.model import Domain, Object, Problem
from cleancli.learning.experience import Transition
from support.exported_ppddl import calls, drawn_values


def drawn(
    domain: Domain, problem: Problem, seed: int, count: int = 12, further: str = "z9"
) -> Iterator[Transition]:
    """Transitions between states at random; the next begins where one ended, or elsewhere, or with a further
    object."""
    rng = np.random.default_rng(seed)
    every = list(calls(domain, problem))
    objects = tuple(sorted(problem.objects))
    values = drawn_values(domain, problem, rng)
    for _ in range(count):
        action, names = every[int(rng.integers(len(every)))]
        after = drawn_values(domain, problem, rng)
        yield Transition(action, names, objects, values, after)
        values = after if rng.random() < 0.7 else drawn_values(domain, problem, rng)
        if rng.random() < 0.2:
            objects = tuple(sorted((*problem.objects, Object(further, problem.objects[0].type))))
