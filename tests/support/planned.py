"""Planners by name, with options by name, whether all planners have them or one alone."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from cleancli.compiler.task import Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options, Plan
from cleancli.planning.planner import Planner
from cleancli.planning.registry import PLANNERS


def planned(planner: str, task: Task, **options: Any) -> Plan:
    """The plan for a task; options that nobody has are an error."""
    chosen, common = having(planner, Options(), options)
    return chosen(prepare(task), common)


def having(planner: str, options: Options, asked: dict[str, Any]) -> tuple[Planner[Any], Options]:
    """The planner with the options that are its own, and those of all planners with the others."""
    common = {field.name for field in fields(Options)} & asked.keys()
    own = {name: value for name, value in asked.items() if name not in common}
    return PLANNERS[planner].having(**own), replace(options, **{name: asked[name] for name in common})
