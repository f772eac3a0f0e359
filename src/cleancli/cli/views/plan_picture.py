"""The picture of a plan: what is believed of each literal after each step (`cleancli plan --plot`)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np

from cleancli.array_types import Floats
from cleancli.cli.exit_codes import MissingPart
from cleancli.compiler.task import literal_text
from cleancli.planning.evaluation.belief_value import plan_beliefs
from cleancli.planning.evaluation.forecast import Forecast
from cleancli.planning.request import PlanningRequest

MOST_ROWS = 30
"""Literals that a picture shows: those that change most. More are too small to read. Chosen."""

LEAST_CHANGE = 0.005
"""A literal that changes by less over all steps is not worth a row. Chosen."""

_SHADE = "Blues"
# Told apart by marks and dashes as well as by colour, also where one lies on the other.
_FORECAST: dict[str, Any] = {"color": "#14304a", "linewidth": 2.0, "marker": "o", "markersize": 3.5}
_FACTORED: dict[str, Any] = {
    "color": "#d9480f",
    "linewidth": 1.2,
    "linestyle": (0, (4, 3)),
    "marker": "s",
    "markersize": 6.5,
    "markerfacecolor": "none",
}
FACTORED = "PRADA's factored belief"


def check_picture(path: Path | None) -> None:
    """Raises BadParameter for a name that says neither .png nor .svg, MissingPart without matplotlib."""
    if path is None:
        return
    if path.suffix.lower() not in (".png", ".svg"):
        raise click.BadParameter("name a file that ends in .png or .svg", param_hint="'--plot'")
    _figure(1, 1)


def draw_picture(job: PlanningRequest, actions: Sequence[int], expected: Forecast, path: Path) -> None:
    """Write the picture: a row for each literal that changes, and the expected count below."""
    factored = plan_beliefs(job.prepared, actions, job.options.rule_threshold)
    rows = _rows(job, expected.marginals, factored)
    slots = [slot for slot, _ in rows]
    counts = _counts(job, expected, factored)
    heights = [0.34 * max(len(rows), 2)] + [1.5] * (counts is not None)
    figure = _figure(max(6.4 + 0.62 * len(expected.marginals), 8.7), 2.2 + sum(heights))
    axes = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    _draw_rows(axes[0], [text for _, text in rows], expected.marginals[:, slots], factored[:, slots])
    if counts is not None:
        _draw_counts(axes[1], *counts)
    axes[0].set_xlim(-0.5, len(actions) + 0.5)
    labels = [f"{number}. {job.task.actions[action]}" for number, action in enumerate(actions, start=1)]
    axes[-1].set_xticks(
        range(len(actions) + 1),
        ["start", *labels],
        rotation=40,
        fontsize=8,
        ha="right",
        rotation_mode="anchor",
    )
    source = "exact belief" if expected.runs is None else f"belief in {expected.runs} drawn runs"
    figure.suptitle(f"{job.problem.name}: belief after each step", fontsize=11)
    _draw_legend(figure, axes[0], source)
    figure.savefig(path, dpi=130)


def _rows(job: PlanningRequest, marginals: Floats, factored: Floats) -> list[tuple[int, str]]:
    """Slots with their text as literals, in the task's order: those that change most under the marginals or
    the factored belief. Of a variable with two values the second says all."""
    change = np.maximum(*(np.abs(np.diff(found, axis=0)).sum(axis=0) for found in (marginals, factored)))
    slots: list[tuple[int, str]] = []
    first = 0
    for variable in job.task.variables:
        values = range(len(variable.values))
        shown = (
            values if len(values) > 2 else [variable.values.index(True)] if True in variable.values else [1]
        )
        slots += [(first + value, literal_text(variable, [value])) for value in shown]
        first += len(values)
    most = sorted((slot for slot, _ in slots if change[slot] > LEAST_CHANGE), key=lambda s: -change[s])[
        :MOST_ROWS
    ]
    return [(slot, text) for slot, text in slots if slot in most]


def _counts(job: PlanningRequest, expected: Forecast, factored: Floats) -> tuple[Floats, Floats] | None:
    """The expected count after each step, by the forecast and by the factored belief."""
    if job.task.counted is None or expected.remaining is None:
        return None
    first = np.cumsum([0, *(len(variable.values) for variable in job.task.variables)])
    by_belief = np.zeros(len(factored))
    for condition in job.task.counted:
        chance = np.ones(len(factored))
        for variable, allowed in condition:
            chance *= factored[:, [int(first[variable]) + value for value in sorted(allowed)]].sum(axis=1)
        by_belief += chance
    after = [step.remaining for step in expected.steps]
    return np.array([expected.remaining, *after], dtype=np.float64), by_belief


def _draw_legend(figure: Any, axes: Any, source: str) -> None:
    """What each line and the shade stand for, beside the picture."""
    shade = "the darker, the likelier;\nafter the last step, in figures"
    figure.legend(
        handles=[
            *axes.plot([], [], label=source, **_FORECAST),
            *axes.plot([], [], label=FACTORED, **_FACTORED),
            *axes.fill([], [], facecolor="#4292c6", label=shade),
        ],
        loc="outside right upper",
        fontsize=8,
        frameon=False,
    )


def _draw_rows(axes: Any, labels: Sequence[str], marginals: Floats, factored: Floats) -> None:
    """A band for each literal, from 0 near its lower edge to 1 near its upper."""
    steps = np.arange(len(marginals))
    if not labels:
        axes.text(0.5, 0.5, "nothing changes", transform=axes.transAxes, ha="center")
        axes.set_yticks([])
        return
    axes.imshow(
        marginals.T,
        cmap=_SHADE,
        vmin=0,
        vmax=1.6,
        aspect="auto",
        interpolation="nearest",
    )
    for row in range(len(labels)):
        for found, style in ((marginals, _FORECAST), (factored, _FACTORED)):
            axes.plot(steps, row + 0.33 - 0.66 * found[:, row], drawstyle="steps-mid", **style)
        axes.axhline(row + 0.5, color="white", linewidth=2)
        axes.text(steps[-1] + 0.6, row, f"{marginals[-1, row]:z.2f}", va="center", fontsize=8)
    axes.set_yticks(range(len(labels)), labels, fontsize=8)
    axes.set_ylim(len(labels) - 0.5, -0.5)


def _draw_counts(axes: Any, expected: Floats, factored: Floats) -> None:
    axes.plot(expected, **_FORECAST)
    axes.plot(factored, **_FACTORED)
    axes.set_ylim(bottom=0)
    axes.set_ylabel("expected\ncount", fontsize=8)
    axes.tick_params(labelsize=8)
    axes.grid(axis="y", linewidth=0.4)
    axes.text(len(expected) - 0.4, expected[-1], f"{expected[-1]:z.2f}", va="center", fontsize=8)


def _figure(width: float, height: float) -> Any:
    """An empty figure; the one place that loads matplotlib, which is an optional part. Raises MissingPart."""
    try:
        from matplotlib.figure import Figure
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] != "matplotlib":
            raise
        raise MissingPart("a picture needs matplotlib: pip install 'matplotlib>=3.8'") from error
    return Figure(figsize=(width, height), layout="constrained")
