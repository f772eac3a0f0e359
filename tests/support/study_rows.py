"""Rows of studies, made up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np

from cleancli.study.model import Value
from cleancli.study.row import Row

KINDS = ("planning", "transits", "actions", "perceiving", "extra_perceptions", "learning")


def row(
    axes: Mapping[str, Value],
    run: int,
    seconds: float,
    clean: bool = True,
    *,
    episode: int = 1,
    part: str = "",
    score: float | None = None,
) -> Row:
    """An episode that took so long, two thirds of it in actions; the rest is made up."""
    shares = dict(zip(KINDS, (0.02, 0.2, 2 / 3, 0.03, 0.05, 1 / 30), strict=True))
    return Row(
        study="made_up",
        part=part,
        axes=axes,
        run=run,
        episode=episode,
        seed=100 + run,
        clean=clean,
        reason="nothing is left to do" if clean else "60 actions were carried out",
        actions=max(1, round(seconds / 8)),
        unknown=max(0, 3 - episode),
        seconds={kind: share * seconds for kind, share in shares.items()},
        total=seconds,
        pieces=40,
        left=0 if clean else 3,
        on_floor=0,
        ink_left=None,
        score=score,
        cpu=1.0,
        real=2.0,
        versions={"cleancli": "1.0", "pybullet": "3.2.7"},
        files=(),
        key=f"{axes}{run}{episode}{part}",
    )


def drawn(
    axes: Mapping[str, Sequence[Value]],
    means: Mapping[Value, float],
    runs: int,
    *,
    failing: Mapping[Value, float] | None = None,
    episodes: int = 1,
    part: str = "",
) -> Iterator[Row]:
    """Every cell of some axes: a mean is the product of those of its values; a run's seed lengthens all cells
    alike. `failing`: by value, how likely a run does not end clean."""
    rng = np.random.default_rng(11)
    of_run = rng.normal(1.0, 0.15, runs)
    for values in product(*axes.values()):
        chance = max((failing or {}).get(value, 0.0) for value in values)
        for run, episode in product(range(1, runs + 1), range(1, episodes + 1)):
            mean = float(np.prod([means.get(value, 1.0) for value in values])) * (0.6 + 0.4 / episode)
            seconds = mean * of_run[run - 1] * rng.normal(1.0, 0.1)
            clean = bool(rng.random() >= chance)
            own = dict(zip(axes, values, strict=True))
            yield row(own, run, max(0.1, seconds), clean, episode=episode, part=part)
