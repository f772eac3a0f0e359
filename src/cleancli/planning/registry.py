"""The planners by name, each with the usual values of its own options."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from cleancli.planning.planner import Planner
from cleancli.planning.planners.aprada import aprada
from cleancli.planning.planners.determinized import DeterminizedOptions, likeliest, optimistic
from cleancli.planning.planners.exact import ExactOptions, exact
from cleancli.planning.planners.prada import PradaOptions, prada
from cleancli.planning.planners.prada_plus import PradaPlusOptions, prada_plus
from cleancli.planning.planners.sst import SstOptions, sst
from cleancli.planning.planners.uct import UctOptions, uct

_PLANNERS: tuple[Planner[Any], ...] = (
    Planner("prada+", prada_plus, PradaPlusOptions(), reaches=True),
    Planner("prada", prada, PradaOptions()),
    Planner("aprada", aprada, PradaOptions()),
    Planner("exact", exact, ExactOptions(), reaches=True),
    Planner("uct", uct, UctOptions()),
    Planner("sst", sst, SstOptions()),
    Planner("likeliest", likeliest, DeterminizedOptions()),
    Planner("all-outcomes", optimistic, DeterminizedOptions()),
)

PLANNERS: Mapping[str, Planner[Any]] = MappingProxyType({planner.name: planner for planner in _PLANNERS})

DEFAULT = "prada+"
"""The planner where none is asked for: the best of them in benchmarks/regret.py that refuses no problem."""
