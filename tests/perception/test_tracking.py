"""Names that stay with the dirt: untouched, pushed, joined, split and gone areas."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.geometry.ellipse import Ellipse
from cleancli.perception.area import Area
from cleancli.perception.tracking import Merge, Stroke, _merges, track


def area(x: float, y: float, name: str = "", radius: float = 0.02, covered: float = 4e-4) -> Area:
    return Area(Ellipse((x, y), (radius, radius), 0.0), covered, name)


BEFORE = (area(-0.2, 0.1, "a1"), area(0.0, 0.0, "a2"), area(0.2, -0.1, "a3"))


def names(after: tuple[Area, ...], stroke: Stroke | None = None, next_number: int = 4) -> list[str]:
    return [tracked.name for tracked in track(BEFORE, after, stroke, next_number).areas]


def test_the_first_look_names_in_order() -> None:
    assert [a.name for a in track((), (area(0, 0), area(0.1, 0)), None, 1).areas] == ["a1", "a2"]


def test_untouched_areas_keep_their_names_whatever_their_order() -> None:
    assert names((area(0.203, -0.1), area(-0.2, 0.102), area(0.001, 0))) == ["a3", "a1", "a2"]


def test_a_name_without_an_area_is_gone_and_is_not_given_again() -> None:
    assert names((area(-0.2, 0.1), area(0.3, 0.3))) == ["a1", "a4"]
    assert names((), Stroke(("a1",), ((-0.2, 0.1), (0.45, 0.1)), 0.06)) == []


def test_beyond_the_gate_it_is_another_area() -> None:
    assert names((area(-0.2, 0.169),)) == ["a1"]
    assert names((area(-0.2, 0.171),)) == ["a4"]


def test_of_two_pieces_in_place_the_nearer_keeps_the_name() -> None:
    assert names((area(-0.03, 0.0), area(0.012, 0.0))) == ["a4", "a2"]


TO_BIN = Stroke(("a1",), ((-0.23, 0.1), (0.45, 0.1)), 0.06)


def test_the_largest_remainder_along_the_stroke_keeps_the_name() -> None:
    after = (
        area(-0.2, 0.1, covered=5e-5),
        area(0.0, 0.0),
        area(0.3, 0.13, covered=2e-4),
        area(0.2, -0.1),
        area(0.4, 0.06, covered=1e-4),
    )
    assert names(after, TO_BIN) == ["a4", "a2", "a1", "a3", "a5"]


def test_what_was_swept_may_have_rolled_away_but_not_what_was_not() -> None:
    assert names((area(0.3, 0.25), area(0.0, 0.0)), TO_BIN) == ["a1", "a2"]
    assert names((area(0.3, 0.25), area(0.0, 0.0))) == ["a4", "a2"]


def test_a_remainder_does_not_take_the_name_of_an_untouched_area() -> None:
    assert names((area(0.03, 0.045, covered=9e-4), area(0.0, 0.0), area(0.2, -0.1)), TO_BIN) == [
        "a1",
        "a2",
        "a3",
    ]


JOIN = Stroke(("a1", "a2"), ((-0.23, 0.11), (0.0, 0.0)), 0.06)


def test_the_target_of_a_join_keeps_its_name() -> None:
    assert names((area(0.01, 0.0, radius=0.03, covered=8e-4), area(0.2, -0.1)), JOIN) == ["a2", "a3"]


def test_what_a_join_leaves_behind_keeps_the_pushed_name() -> None:
    after = (area(-0.13, 0.06, covered=1e-4), area(0.0, 0.0, radius=0.03, covered=7e-4), area(0.2, -0.1))
    assert names(after, JOIN) == ["a1", "a2", "a3"]


def test_a_join_that_misses_changes_no_name() -> None:
    assert names(BEFORE, JOIN) == ["a1", "a2", "a3"]


def test_a_target_pushed_along_is_found_along_the_stroke() -> None:
    stroke = Stroke(("a1", "a2"), ((-0.23, 0.11), (0.0, 0.0), (0.12, -0.06)), 0.06)
    assert names((area(0.11, -0.04, radius=0.03), area(0.2, -0.1)), stroke) == ["a2", "a3"]


def test_joining_three_keeps_the_last_name() -> None:
    stroke = Stroke(("a1", "a2", "a3"), ((-0.23, 0.11), (0.0, 0.0), (0.2, -0.1)), 0.06)
    assert names((area(0.2, -0.1, radius=0.05), area(0.02, 0.0, covered=1e-5)), stroke) == ["a3", "a2"]


def test_a_stroke_without_points_on_the_surface_pushes_nothing() -> None:
    assert names(BEFORE, Stroke(("a1",), (), 0.06)) == ["a1", "a2", "a3"]
    assert names(BEFORE, Stroke(("a1",), ((-0.2, 0.1),), 0.06)) == ["a1", "a2", "a3"]


def changes(after: tuple[Area, ...], stroke: Stroke | None) -> list[str]:
    return [str(change) for change in track(BEFORE, after, stroke, 4).changes]


def test_what_is_joined_is_merged_into_the_target() -> None:
    assert changes((area(0.01, 0.0, radius=0.03, covered=8e-4), area(0.2, -0.1)), JOIN) == [
        "a1 merged into a2"
    ]


@pytest.mark.parametrize(
    ("name", "of"), [("a2", ("a1", "a2")), ("a5", ("a5", "a1", "a2")), ("a9", ("a1", "a2"))]
)
def test_who_is_merged_counts_the_name_that_stays_if_there_was_one(name: str, of: tuple[str, ...]) -> None:
    """The area that two flow into has the name of one of them, that of a third, or a new one."""
    before = area(0, 0, "a1"), area(0.1, 0, "a2"), area(0.3, 0, "a5")
    assert list(_merges(before, np.array([[1.0], [0.5], [0.0]]), [name])) == [Merge(of, name)]


def test_pieces_along_the_way_are_split_off() -> None:
    after = (area(-0.05, 0.1, covered=1e-4), area(0.0, 0.0), area(0.2, -0.1), area(0.35, 0.1, covered=2e-4))
    tracked = track(BEFORE, after, TO_BIN, 4)
    assert [a.name for a in tracked.areas] == ["a4", "a2", "a3", "a1"]
    assert [str(change) for change in tracked.changes] == ["a1 split into a1, a4"]


def test_where_nothing_splits_or_merges_nothing_is_named() -> None:
    assert changes(BEFORE, None) == []
    assert changes(BEFORE[1:], TO_BIN) == []


PLACES = st.lists(
    st.tuples(st.floats(-0.4, 0.4), st.floats(-0.3, 0.3)),
    max_size=6,
    unique_by=lambda place: (
        round(place[0], 3),
        round(place[1], 3),
    ),  # places that differ by rounding alone cannot be told apart
)


@settings(max_examples=60, deadline=None)
@given(PLACES, st.sampled_from([None, TO_BIN, JOIN]))
def test_no_name_is_given_twice(places: list[tuple[float, float]], stroke: Stroke | None) -> None:
    after = tuple(area(x, y, covered=1e-5 * (1 + i)) for i, (x, y) in enumerate(places))
    tracked = track(BEFORE, after, stroke, 4).areas
    assert len({a.name for a in tracked}) == len(after)
    assert [a.ellipse for a in tracked] == [a.ellipse for a in after]
    assert all(a.name in ("a1", "a2", "a3") or int(a.name[1:]) >= 4 for a in tracked)
    assert track(tracked, after, None, 99).areas == pytest.approx(tracked)
