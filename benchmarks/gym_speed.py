"""Steps a second of the Gymnasium environments: python benchmarks/gym_speed.py [--seed N] [--quick]

`cleancli/Symbolic-v0`, alone and in batches, with actions drawn among those that apply; and
`cleancli/CleanTable-v0`, which simulates physics and a camera. CPU seconds on one core, medians of five
rounds. About a minute.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np

from cleancli.environment.clean_table import CleanTable
from cleancli.environment.symbolic import Symbolic, SymbolicVector

ROUNDS = 5


def masked(masks: Any, rng: np.random.Generator) -> Any:
    """An action that applies, for each row of masks."""
    return (rng.random(masks.shape) * (masks + 1e-9)).argmax(axis=-1)


def alone(env: gymnasium.Env[Any, Any], seed: int) -> Callable[[int], None]:
    """Carries out so many steps of one environment."""
    rng = np.random.default_rng(seed)
    _, first = env.reset(seed=seed)
    mask = [first["action_mask"]]

    def go(steps: int) -> None:
        for _ in range(steps):
            *_, terminated, truncated, info = env.step(int(masked(mask[0], rng)))
            if terminated or truncated:
                _, info = env.reset()
            mask[0] = info["action_mask"]

    return go


def batched(number: int, seed: int) -> Callable[[int], None]:
    """Carries out so many steps in all, in batches."""
    env = SymbolicVector(number, "three_areas")
    rng = np.random.default_rng(seed)
    _, first = env.reset(seed=seed)
    mask = [first["action_mask"]]

    def go(steps: int) -> None:
        for _ in range(steps // number):
            *_, info = env.step(masked(mask[0], rng))
            mask[0] = info["action_mask"]

    return go


def rate(go: Callable[[int], None], steps: int) -> float:
    """Steps a second of CPU time."""
    go(max(1, steps // 10))
    rates = []
    for _ in range(ROUNDS):
        begun = time.process_time()
        go(steps)
        rates.append(steps / (time.process_time() - begun))
    return statistics.median(rates)


def main() -> None:
    """Print a row for each way."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="few steps")
    parser.add_argument("--seed", type=int, default=1, help="of actions and of what comes of them")
    options = parser.parse_args()
    quick, seed = options.quick, options.seed
    print("| environment | batch | steps a second |\n|---|---|---|")
    symbolic = Symbolic("three_areas")
    print(
        f"| Symbolic, three_areas | 1 | {rate(alone(symbolic, seed), 200 if quick else 5000):,.0f} |",
        flush=True,
    )
    for number in (16, 256, 4096):
        found = rate(batched(number, seed), number * (5 if quick else 200))
        print(f"| Symbolic, three_areas | {number} | {found:,.0f} |", flush=True)
    table = CleanTable("two_groups")
    print(f"| CleanTable, two_groups | 1 | {rate(alone(table, seed), 1 if quick else 5):.2g} |", flush=True)
    for scene, domain in (("two_groups", "cleaning"), ("scattered_40", "sweeping")):
        stand_in = CleanTable(scene, domain, simulator="stand_in")
        found = rate(alone(stand_in, seed), 2 if quick else 50)
        print(f"| CleanTable, {scene}, stand-in | 1 | {found:.2g} |", flush=True)
    print(f"load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
