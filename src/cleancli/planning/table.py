"""The planners by name; a planner is a function from a task to a plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from cleancli.compiler.task import Task
from cleancli.planning.plan import Options, Plan
from cleancli.planning.prada import prada

Planner = Callable[[Task, Options], Plan]

PLANNERS: Mapping[str, Planner] = MappingProxyType({"prada": prada})
