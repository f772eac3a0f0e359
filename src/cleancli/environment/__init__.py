"""The simulated table for Gymnasium; importing this package registers `cleancli/CleanTable-v0`."""

from __future__ import annotations

import gymnasium

MOST_ACTIONS = 60
"""Actions after which an episode is truncated, as in `cleancli execute`."""

gymnasium.register(
    id="cleancli/CleanTable-v0",
    entry_point="cleancli.environment.clean_table:CleanTable",
    max_episode_steps=MOST_ACTIONS,
)
