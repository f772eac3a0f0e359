"""Compiled inner loops of planners, a module each, which is imported when it is first named.

All need numba, which takes longer to load than most plans take: so what may end without a plan writes
`from cleancli.planning import kernels`, and `kernels.tree_search` where it runs the loop.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType

    from cleancli.planning.kernels import annealing as annealing
    from cleancli.planning.kernels import backward_induction as backward_induction
    from cleancli.planning.kernels import base_policies as base_policies
    from cleancli.planning.kernels import belief_search as belief_search
    from cleancli.planning.kernels import decision_graph as decision_graph
    from cleancli.planning.kernels import goal_policy as goal_policy
    from cleancli.planning.kernels import relaxed as relaxed
    from cleancli.planning.kernels import sparse_sampling as sparse_sampling
    from cleancli.planning.kernels import state_graph as state_graph
    from cleancli.planning.kernels import transitions as transitions
    from cleancli.planning.kernels import tree_search as tree_search

_LOOPS = frozenset(
    {
        "annealing",
        "backward_induction",
        "base_policies",
        "belief_search",
        "decision_graph",
        "goal_policy",
        "relaxed",
        "sparse_sampling",
        "state_graph",
        "transitions",
        "tree_search",
    }
)


def are_loaded() -> bool:
    """Whether this process has imported a loop, and so numba."""
    return f"{__name__}.jit" in sys.modules


def __getattr__(name: str) -> ModuleType:
    if name not in _LOOPS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return import_module(f"{__name__}.{name}")
