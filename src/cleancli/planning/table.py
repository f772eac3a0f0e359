"""The planners by name; a planner is a function from a prepared task to a plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from cleancli.planning.aprada import aprada
from cleancli.planning.plan import Options, Plan
from cleancli.planning.prada import prada
from cleancli.planning.prada_plus import prada_plus
from cleancli.planning.prepared import Prepared

Planner = Callable[[Prepared, Options], Plan]

PLANNERS: Mapping[str, Planner] = MappingProxyType({"aprada": aprada, "prada": prada, "prada+": prada_plus})
