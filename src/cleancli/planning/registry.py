"""The planners by name; a planner is a function from a prepared task to a plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from cleancli.planning.compiled_task import Prepared
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planners.aprada import aprada
from cleancli.planning.planners.determinized import likeliest, optimistic
from cleancli.planning.planners.exact import exact
from cleancli.planning.planners.prada import prada
from cleancli.planning.planners.prada_plus import prada_plus
from cleancli.planning.planners.sst import sst
from cleancli.planning.planners.uct import uct

Planner = Callable[[Prepared, Options], Plan]

PLANNERS: Mapping[str, Planner] = MappingProxyType(
    {
        "prada+": prada_plus,
        "prada": prada,
        "aprada": aprada,
        "exact": exact,
        "uct": uct,
        "sst": sst,
        "likeliest": likeliest,
        "all-outcomes": optimistic,
    }
)

DEFAULT = "prada+"
"""The planner where none is asked for: the best of them in benchmarks/regret.py that refuses no problem."""
