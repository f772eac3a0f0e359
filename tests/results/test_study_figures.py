"""Figures: the same bytes from the same rows, nothing cut off, and what goes where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import cv2
import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure as Canvas

from cleancli.results.cells import cells
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
    "two widths": {"rag.width": [0.08, 0.1]},
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
        ("two widths", "rag.width", ("",), False),
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
    axes = ("strategy", "planner", "rag.width")
    assert named(axes, ("plan-2", None, 0.1)) == "plan-2, rag.width 0.1"


@pytest.fixture
def canvases(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The figures of matplotlib that are drawn, in order; each once."""
    found: list[Any] = []
    save = Canvas.savefig

    def kept(canvas: Any, *arguments: Any, **options: Any) -> None:
        if canvas not in found:
            found.append(canvas)
        save(canvas, *arguments, **options)

    monkeypatch.setattr(Canvas, "savefig", kept)
    return found


def segments(axes: Any) -> list[tuple[float, float]]:
    """The intervals: lines that go straight up."""
    lines = [line for line in axes.lines if len(line.get_xdata()) == 2 and len(set(line.get_xdata())) == 1]
    return [(float(low), float(high)) for low, high in (line.get_ydata() for line in lines)]


def test_bars_are_as_high_as_means_and_intervals_stand_on_them(canvases: list[Any]) -> None:
    rows = rows_of("fig8b", 8)
    figures_of("fig8b", rows, "seconds")
    (axes,) = canvases[0].axes
    found = {cell.values[0]: cell for cell in cells(rows, ("strategy",), "seconds")}
    assert [label.get_text() for label in axes.get_xticklabels()] == list(STRATEGIES)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("strategy", "seconds until the episode is over")
    heights = [bar.get_height() for bar in axes.patches]
    assert heights == pytest.approx([found[name].mean.value for name in STRATEGIES])
    known = [found[name].mean for name in STRATEGIES if found[name].mean.known]
    assert segments(axes) == [(mean.low, mean.high) for mean in known]
    assert [note.get_text() for note in axes.texts] == [f"✗{found['tsp'].failed}"]
    assert axes.get_ylim()[0] == 0
    assert axes.get_ylim()[1] > max(mean.high for mean in known)


def test_a_cell_without_a_clean_run_has_no_bar_but_its_count(canvases: list[Any]) -> None:
    rows = [row({"strategy": name}, 1, 10.0, name == "a") for name in ("a", "b")]
    figures_of("x", rows, "seconds")
    assert [bar.get_height() for bar in canvases[0].axes[0].patches] == [10.0, 0.0]
    assert [note.get_text() for note in canvases[0].axes[0].texts] == ["✗1"]
    assert segments(canvases[0].axes[0]) == []


def test_lines_go_through_means_beside_one_another(canvases: list[Any]) -> None:
    rows = rows_of("sensitivity", 6)
    figures_of("sensitivity", rows, "seconds")
    (axes,) = canvases[0].axes
    lines = [line for line in axes.lines if len(line.get_xdata()) == 3]
    assert [line.get_label() for line in lines] == ["plan-2", "reactive"]
    found = cells(rows, ("strategy", "rag.width"), "seconds")
    for line, own in zip(lines, (found[0::2], found[1::2]), strict=True):
        assert sorted(line.get_ydata()) == pytest.approx(sorted(cell.mean.value for cell in own))
    apart = lines[1].get_xdata() - lines[0].get_xdata()
    assert (apart > 0).all()
    assert (apart < 0.02).all()
    assert [float(tick) for tick in axes.get_xticks()] == [0.08, 0.1, 0.16]
    assert axes.get_xlabel() == "rag.width"
    assert len(segments(axes)) == 6


def test_stacks_are_the_seconds_by_kind_of_clean_episodes(canvases: list[Any]) -> None:
    rows = [
        row({"strategy": "a"}, 1, 30.0),
        row({"strategy": "a"}, 2, 60.0),
        row({"strategy": "a"}, 3, 9.0, False),
    ]
    figures_of("x", [*rows, row({"strategy": "b"}, 1, 10.0)], "seconds")
    (axes,) = canvases[1].axes
    tops = [max(bar.get_y() + bar.get_height() for bar in axes.patches if bar.get_x() < 0.5)]
    assert tops == pytest.approx([45.0])
    labels = [text.get_text() for text in canvases[1].legends[0].get_texts()]
    assert labels == ["planning", "transits", "actions", "perceiving", "extra perceptions", "learning"]
    planning = axes.patches[0]
    assert (planning.get_y(), planning.get_height()) == pytest.approx((0.0, 0.02 * 45))


def test_stacks_of_a_score_are_of_all_episodes(canvases: list[Any]) -> None:
    figures_of("x", [row({"strategy": "a"}, run, 30.0, run == 1, score=0.5) for run in (1, 2)], "score")
    assert sum(bar.get_height() for bar in canvases[1].axes[0].patches) == pytest.approx(30.0)
    figures_of("x", [row({"strategy": "a"}, 1, 30.0, False)], "seconds")
    assert not canvases[3].axes[0].patches


def test_stacks_of_several_series_are_named_below_and_their_places_above(canvases: list[Any]) -> None:
    figures_of("sensitivity", rows_of("sensitivity", 2), "seconds")
    (axes,) = canvases[1].axes
    assert [label.get_text() for label in axes.get_xticklabels()] == ["plan-2", "reactive"] * 3
    (above,) = axes.child_axes
    assert [label.get_text() for label in above.get_xticklabels()] == ["0.08", "0.1", "0.16"]
    at = [float(tick) for tick in axes.get_xticks()]
    assert at[1] - at[0] == 1.0 < at[2] - at[1]
    assert [float(tick) for tick in above.get_xticks()] == pytest.approx(
        [sum(at[i : i + 2]) / 2 for i in (0, 2, 4)]
    )
