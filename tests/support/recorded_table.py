"""A bag of a table with two groups of lentils, as a user has one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from support.bags import Ros, told_messages, write_bag
from support.synthetic import frame, grouped


def write(path: Path) -> None:
    """Two seconds of it, as one file at a path that ends in .mcap."""
    rng = np.random.default_rng(1)
    lentils = np.concatenate([grouped(rng, 9, (x, 0.1), 0.03) for x in (0.1, -0.2)])
    frames = [replace(frame(lentils, seed), clock=5 + seed / 2) for seed in range(4)]
    ros = Ros(False)
    write_bag(path.with_name("parts.mcap"), told_messages(ros, frames), ros).rename(path)
