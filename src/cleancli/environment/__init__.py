"""The simulated table and the symbolic world for Gymnasium; importing this package registers
`cleancli/CleanTable-v0` and `cleancli/Symbolic-v0`."""

from __future__ import annotations

import gymnasium

MOST_ACTIONS = 60
"""Actions after which an episode is truncated, as in `cleancli execute` and `simulate`."""

gymnasium.register(
    id="cleancli/CleanTable-v0",
    entry_point="cleancli.environment.clean_table:CleanTable",
    max_episode_steps=MOST_ACTIONS,
)
gymnasium.register(
    id="cleancli/Symbolic-v0",
    entry_point="cleancli.environment.symbolic:Symbolic",
    vector_entry_point="cleancli.environment.symbolic:SymbolicVector",
)
