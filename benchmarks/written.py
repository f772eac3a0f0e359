"""Planners as the benchmarks write them: `prada+:solve=0`, or `uct:samples=1000,exploration=1`."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from typing import Any

from cleancli.planning.plan import Options
from cleancli.planning.planner import Planner

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from support.planned import having


def planner_of(text: str, options: Options) -> tuple[Planner[Any], Options]:
    """The planner, with its own options, and the options of all planners with what the text asks for.

    KeyError or TypeError where there is no such planner or option.
    """
    name, _, settings = text.partition(":")
    pairs = (setting.partition("=") for setting in settings.split(",") if setting)
    return having(name, options, {key: ast.literal_eval(value) for key, _, value in pairs})
