"""Plans of a planner by name, with options by name, whether all planners have them or it alone."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from cleancli.compiler.task import Task
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options, Plan
from cleancli.planning.registry import PLANNERS


def planned(planner: str, task: Task, **options: Any) -> Plan:
    """The plan for a task; options that nobody has are an error."""
    common = {field.name for field in fields(Options)} & options.keys()
    own = {name: value for name, value in options.items() if name not in common}
    chosen = replace(Options(), **{name: options[name] for name in common})
    return PLANNERS[planner].having(**own)(prepare(task), chosen)
