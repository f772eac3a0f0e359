"""Planners as the benchmarks write them: `prada+:solve=0`, or `uct:samples=1000,exploration=1`."""

from __future__ import annotations

import ast
from dataclasses import fields, replace
from typing import Any

from cleancli.planning.plan import Options
from cleancli.planning.planner import Planner
from cleancli.planning.registry import PLANNERS


def planner_of(text: str, options: Options) -> tuple[Planner[Any], Options]:
    """The planner, with its own options, and the options of all planners with what the text asks for.

    KeyError or TypeError where there is no such planner or option.
    """
    name, _, settings = text.partition(":")
    pairs = (setting.partition("=") for setting in settings.split(",") if setting)
    asked = {key: ast.literal_eval(value) for key, _, value in pairs}
    common = {field.name for field in fields(Options)} & asked.keys()
    own = {key: value for key, value in asked.items() if key not in common}
    return PLANNERS[name].having(**own), replace(options, **{key: asked[key] for key in common})
