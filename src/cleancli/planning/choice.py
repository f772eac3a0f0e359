"""What planners are asked for: by whoever calls them, or else by the problem, or else the usual."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, NoReturn

from cleancli.language.diagnostics.sink import meant
from cleancli.language.model import Problem
from cleancli.planning.plan import BadOption, Options
from cleancli.planning.registry import DEFAULT, PLANNERS

OWN = ("samples", "seed", "time_limit", "threads", "previous", "compat")
"""Fields of `Options` that have an option of their own, or none."""

LIKE_LIBPRADA = ("prada", "aprada")
"""Planners that know beliefs alone, and so can plan with rules that overlap."""

ALLOWED: Mapping[str, tuple[float, float] | frozenset[str]] = {
    "counted": (1, 1_000_000),
    "rule_threshold": (0, 1),
    "margin": (0, math.inf),
    "solve": (0, 10_000_000),
    "states": (1, 10_000_000),
    "arithmetic": frozenset({"float", "rational"}),
    "exploration": (0, math.inf),
    "branching": (1, 1_000),
    "depth": (1, 100),
    "width": (1, 10_000_000),
}
"""The least and the most of every other field that is a number, or the words that it may be
(docs/commands.md lists them)."""


def planner_options(
    problem: Problem,
    *,
    samples: int | None = None,
    seed: int | None = None,
    time_limit: float | None = None,
    threads: int | None = None,
    compat: bool = False,
    named: Sequence[str] = (),
) -> Options:
    """The options; `named` are texts like `rule_threshold=0.05`. Raises BadOption."""
    usual = Options(seed=1)
    asked = Options(
        samples=next(n for n in (samples, problem.samples, usual.samples) if n is not None),
        seed=next(n for n in (seed, problem.seed, usual.seed) if n is not None),
        time_limit=time_limit,
        threads=usual.threads if threads is None else threads,
        compat=compat,
    )
    for text in named:
        asked = _with(asked, text)
    return asked


def planner_named(asked: str | None, problem: Problem, compat: bool = False) -> str:
    """The planner that is asked for, or else the problem's; raises BadOption for an unknown one, and for one
    that cannot do as libPRADA does where that is asked for."""
    name = asked or problem.planner or ("prada" if compat else DEFAULT)
    if compat and name not in LIKE_LIBPRADA:
        raise BadOption(f"--compat goes with {' or '.join(LIKE_LIBPRADA)}, not with {name}")
    if name not in PLANNERS:
        known = ", ".join(PLANNERS)
        whose = "the problem asks for the planner" if asked is None else "unknown planner"
        raise BadOption(f"{whose} `{name}`; there is {known}")
    return name


def planners_named(text: str) -> tuple[str, ...]:
    """The planners of a list like `prada,uct`, each once; raises BadOption."""
    names = tuple(dict.fromkeys(name for name in text.replace(",", " ").split()))
    for name in names:
        if name not in PLANNERS:
            raise BadOption(f"unknown planner `{name}`; there is {', '.join(PLANNERS)}", "--compare")
    if not names:
        raise BadOption(f"name planners: {', '.join(PLANNERS)}", "--compare")
    return names


def _with(options: Options, text: str) -> Options:
    name, _, value = (part.strip() for part in text.partition("="))
    known = {field.name: field.default for field in fields(Options) if field.name not in OWN}
    if name not in known:
        own = name.replace("-", "_")
        if own in OWN and own != "previous":
            _bad(f"`{name}` has an option of its own: --{name.replace('_', '-')}")
        _bad(f"unknown option `{name}`; {meant(name, known, 'option')}")
    allowed, default = ALLOWED[name], known[name]
    read: Any
    if isinstance(allowed, frozenset):
        if value not in allowed:
            _bad(f"`{name}` is {' or '.join(sorted(allowed))}, not `{value}`")
        read = value
    else:
        read = _number(name, int if isinstance(default, int) else float, value, *allowed)
    return replace(options, **{name: read})


def _number(name: str, kind: type[int] | type[float], text: str, low: float, high: float) -> int | float:
    try:
        value = kind(text)
    except ValueError:
        _bad(f"`{name}` wants {'a whole number' if kind is int else 'a number'}, not `{text}`")
    if not (math.isfinite(value) and low <= value <= high):
        bounds = f"is at least {low:g}" if math.isinf(high) else f"lies between {low:g} and {high:g}"
        _bad(f"`{name}` {bounds}")
    return value


def _bad(message: str) -> NoReturn:
    raise BadOption(message, "--option")
