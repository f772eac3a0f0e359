"""The planners by name; a planner is a function from a prepared task to a plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from cleancli.planning.aprada import aprada
from cleancli.planning.determinized import likeliest, optimistic
from cleancli.planning.exact import exact
from cleancli.planning.plan import Options, Plan
from cleancli.planning.prada import prada
from cleancli.planning.prada_plus import prada_plus
from cleancli.planning.prepared import Prepared
from cleancli.planning.sst import sst
from cleancli.planning.uct import uct

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
