"""Which planners, with which options: as whoever calls says, or else the problem, or else the usual."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import Field, fields, replace
from typing import Any, NoReturn

from cleancli.language.diagnostics.sink import meant
from cleancli.language.model import Problem
from cleancli.planning.plan import BadOption, Options
from cleancli.planning.planner import Planner
from cleancli.planning.registry import DEFAULT, PLANNERS

LIKE_LIBPRADA = ("prada", "aprada")
"""Planners that know beliefs alone, and so can plan with rules that overlap."""


def planner_options(
    problem: Problem,
    *,
    samples: int | None = None,
    seed: int | None = None,
    time_limit: float | None = None,
    threads: int | None = None,
    compat: bool = False,
) -> Options:
    """The options of all planners that have a word of their own wherever they are asked for."""
    usual = Options(seed=1)
    return Options(
        samples=next(n for n in (samples, problem.samples, usual.samples) if n is not None),
        seed=next(n for n in (seed, problem.seed, usual.seed) if n is not None),
        time_limit=time_limit,
        threads=usual.threads if threads is None else threads,
        compat=compat,
    )


def planner_named(asked: str | None, problem: Problem, compat: bool = False) -> str:
    """The planner that is asked for, one of `PLANNERS`, or else the problem's; raises BadOption where that is
    an unknown one, and for one that cannot do as libPRADA does where that is asked for."""
    name = asked or problem.planner or ("prada" if compat else DEFAULT)
    if compat and name not in LIKE_LIBPRADA:
        raise BadOption(f"--compat goes with {' or '.join(LIKE_LIBPRADA)}, not with {name}")
    if name not in PLANNERS:
        known = ", ".join(PLANNERS)
        raise BadOption(f"the problem asks for the planner `{name}`; there is {known}")
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


def with_named(
    planners: Sequence[str], options: Options, named: Sequence[str]
) -> tuple[tuple[Planner[Any], ...], Options]:
    """The planners, and the options of all planners, with what texts like `rule_threshold=0.05` ask for.

    An option goes to each of these planners that has it. Raises BadOption, also where none has.
    """
    chosen = tuple(PLANNERS[name] for name in planners)
    for text in named:
        name, _, value = (part.strip() for part in text.partition("="))
        if field := named_options(options).get(name):
            options = replace(options, **{name: _value(field, value)})
        elif any(name in named_options(planner.own) for planner in chosen):
            chosen = tuple(_having(planner, name, value) for planner in chosen)
        else:
            _refuse(name, planners)
    return chosen, options


def _having(planner: Planner[Any], name: str, value: str) -> Planner[Any]:
    """The planner with an option of its own, if it has that."""
    field = named_options(planner.own).get(name)
    return planner if field is None else planner.having(**{name: _value(field, value)})


def named_options(record: Any) -> dict[str, Field[Any]]:
    """The fields of a dataclass of options that are asked for by name."""
    return {field.name: field for field in fields(record) if "allowed" in field.metadata}


def _refuse(name: str, planners: Sequence[str]) -> NoReturn:
    """Say where an option belongs that no planner takes here."""
    written = {field.name for field in fields(Options)} - named_options(Options()).keys() - {"previous"}
    if name.replace("-", "_") in written:
        _bad(f"`{name}` has an option of its own: --{name.replace('_', '-')}")
    owners = [planner.name for planner in PLANNERS.values() if name in named_options(planner.own)]
    if owners:
        others = f", not of {' or '.join(planners)}" if planners else ", and a given sequence is valued"
        _bad(f"`{name}` is an option of {' and '.join(owners)}{others}")
    records = [Options(), *(planner.own for planner in PLANNERS.values())]
    _bad(f"unknown option `{name}`; {meant(name, (n for r in records for n in named_options(r)), 'option')}")


def _value(field: Field[Any], text: str) -> Any:
    """What a text says of an option; raises BadOption."""
    allowed: tuple[Any, ...] = field.metadata["allowed"]
    if isinstance(field.default, str):
        if text not in allowed:
            _bad(f"`{field.name}` is {' or '.join(allowed)}, not `{text}`")
        return text
    return _number(field.name, int if isinstance(field.default, int) else float, text, *allowed)


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
