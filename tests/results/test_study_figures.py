"""Figures: the same bytes from the same rows, nothing cut off, and what goes where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import cv2
import matplotlib
import numpy as np
import pytest

from cleancli.results.figures import DOTS, MOST_BARS, figures_of
from cleancli.results.layout import grid_of, named
from cleancli.study.model import Value
from cleancli.study.row import Row
from support.study_rows import drawn, row

STRATEGIES = ("plan-1", "plan-2", "plan-3", "determinized", "reactive", "wipe", "tsp")
LAYOUTS = tuple(f"layout_{letter}" for letter in "abcdef")
STUDIES: Mapping[str, Mapping[str, Sequence[Value]]] = {
    "fig8a": {"scene": LAYOUTS, "strategy": STRATEGIES},
    "fig8b": {"scene": ["scattered_40"], "strategy": STRATEGIES},
    "sensitivity": {"rag.width": [0.08, 0.1, 0.16], "strategy": ["plan-2", "reactive"]},
    "long": {"scene": [f"reem_{layout}_in_the_kitchen" for layout in LAYOUTS], "planner": ["uct", "prada+"]},
    "many": {"scene": LAYOUTS, "strategy": STRATEGIES, "planner": ["uct", "prada+"]},
    "single": {"scene": ["two_groups"]},
}


def rows_of(study: str, runs: int = 5) -> list[Row]:
    return list(drawn(STUDIES[study], {"reactive": 190.0, "layout_f": 3.0}, runs, failing={"tsp": 0.6}))


@pytest.mark.parametrize("study", STUDIES)
def test_nothing_is_cut_off(study: str) -> None:
    """The outermost pixels stay white."""
    assert len(LAYOUTS) * len(STRATEGIES) <= MOST_BARS < 2 * len(LAYOUTS) * len(STRATEGIES)
    for figure in figures_of(study, rows_of(study), "seconds"):
        picture = cv2.imdecode(np.frombuffer(figure.files["png"], np.uint8), cv2.IMREAD_COLOR)
        assert picture is not None
        assert picture.shape[1] == 8 * DOTS
        assert (picture.shape[0] > 5 * DOTS) == (study == "many"), "many bars stand in several panels"
        edges = [picture[:1], picture[-1:], picture[:, :1], picture[:, -1:]]
        assert all((edge == 255).all() for edge in edges), figure.name


def test_figures_are_the_same_bytes_each_time_also_under_other_settings() -> None:
    rows = rows_of("fig8b")
    found = figures_of("fig8b", rows, "seconds")
    with matplotlib.rc_context({"font.size": 20, "svg.hashsalt": None, "axes.facecolor": "black"}):
        assert figures_of("fig8b", rows, "seconds") == found
    for figure in found:
        assert b"<dc:date>" not in figure.files["svg"]
        assert b"atplotlib" not in figure.files["png"]


def test_a_series_has_figures_of_its_actions_and_a_study_of_its_times() -> None:
    series = list(drawn({"estimator": ["decreasing-m", "m"]}, {"m": 100.0}, 5, episodes=4))
    names = [figure.name for figure in figures_of("fig10", series, "seconds")]
    assert names == ["fig10", "fig10_actions", "fig10_unknown", "fig10_times"]
    assert [figure.name for figure in figures_of("fig9", rows_of("fig8b"), "moving")] == [
        "fig9",
        "fig9_times",
    ]


@pytest.mark.parametrize(
    ("study", "along", "series", "is_line"),
    [
        ("fig8a", "scene", STRATEGIES, False),
        ("fig8b", "strategy", ("",), False),
        ("sensitivity", "rag.width", ("plan-2", "reactive"), True),
        ("single", "scene", ("",), False),
    ],
)
def test_what_goes_from_left_to_right(study: str, along: str, series: Sequence[str], is_line: bool) -> None:
    grid = grid_of(rows_of(study), "seconds")
    assert grid.along == along
    assert tuple(name for name, _ in grid.series) == tuple(series)
    assert grid.is_line is is_line
    if study != "single":
        assert grid.places == tuple(STUDIES[study][along])


def test_episodes_are_a_line_in_their_order_and_missing_cells_are_gaps() -> None:
    rows = [
        row({"m": name}, 1, 10.0, episode=e) for name, own in (("a", (3, 1, 2)), ("b", (2,))) for e in own
    ]
    grid = grid_of(rows, "seconds")
    assert (grid.along, grid.places, grid.is_line) == ("episode", (1, 2, 3), True)
    assert [[cell is not None for cell in cells] for _, cells in grid.series] == [
        [True] * 3,
        [False, True, False],
    ]


def test_a_series_is_named_by_what_its_cells_have() -> None:
    assert named(("plan-2", None, 0.1)) == "plan-2, 0.1"
