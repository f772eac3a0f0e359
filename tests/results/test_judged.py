"""What rows come to: cells, comparisons by run, failures, verdicts. By hand, and against plain loops."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from random import Random
from statistics import fmean

import numpy as np
import pytest

from cleancli.results.cells import cells, telling, varied
from cleancli.results.judged import Judged, Sides, judged
from cleancli.statistics.paired import signed_rank
from cleancli.statistics.verdict import Bounds, Verdict
from cleancli.study.model import Comparison, Selection
from cleancli.study.row import Row
from support.study_rows import drawn, row

PLAN, REACTIVE = {"strategy": ("plan-2",)}, {"strategy": ("reactive",)}


def comparison(
    expect: str = "less", first: Selection = PLAN, second: Selection = REACTIVE, **said: object
) -> Comparison:
    return Comparison("named", "", str(said.pop("measure", "seconds")), expect, first, second, **said)  # type: ignore[arg-type]


def one(said: Comparison, rows: Sequence[Row]) -> Judged:
    (found,) = judged([said], rows)
    return found


def sides(found: Judged) -> Sides:
    assert found.sides is not None
    return found.sides


def two(plan: Sequence[float], reactive: Sequence[float], scene: str = "a") -> list[Row]:
    """Seconds of both strategies, run by run; negative ones did not end clean."""
    return [
        row({"scene": scene, "strategy": name}, run, abs(seconds), seconds > 0)
        for name, own in (("plan-2", plan), ("reactive", reactive))
        for run, seconds in enumerate(own, 1)
    ]


def test_cells_are_means_of_runs_in_the_order_of_rows() -> None:
    rows = [row({"strategy": "b"}, 1, 10.0, episode=1), row({"strategy": "b"}, 1, 20.0, episode=2)]
    rows += [row({"strategy": "b"}, 2, 40.0, episode=1), row({"strategy": "b"}, 2, 90.0, False, episode=2)]
    rows += [row({"strategy": "a"}, 1, 7.0)]
    first, second = cells(rows, ("strategy",), "seconds")
    assert first.values == ("b",)
    assert first.mean.value == fmean([15.0, 40.0]), "of each run, its clean episodes"
    assert (first.runs, first.failed, first.mean.count) == (2, 1, 2)
    assert (second.values, second.mean.value) == (("a",), 7.0)
    (shares,) = cells(rows, (), "clean")
    assert shares.mean.value == fmean([1.0, 0.5]), "a share of clean episodes counts all of them"


def test_axes_vary_where_rows_differ() -> None:
    rows = [
        row({"scene": "a", "m": 1}, 1, 1.0),
        row({"scene": "a", "m": 2}, 1, 1.0),
        row({"scene": "a"}, 1, 1.0),
    ]
    assert varied(rows) == ("m",)
    assert varied([*rows, row({"scene": "a"}, 1, 1.0, episode=2)]) == ("m", "episode")


def test_axes_that_follow_from_others_are_not_told() -> None:
    """A planner that follows from the strategy, and a domain from the scene; not a scene from the domain."""
    cells = (("a", "table", "plan-2"), ("b", "floor", "reactive"), ("a", "table", "reactive"))
    rows = [
        row({"domain": domain, "scene": scene, "strategy": strategy, "planner": f"p{strategy}"}, 1, 1.0)
        for domain, scene, strategy in cells
    ]
    assert telling(rows) == ("scene", "strategy")
    assert telling([*rows, row(dict(rows[0].axes) | {"planner": "uct"}, 1, 1.0)]) == (
        "scene",
        "strategy",
        "planner",
    )
    assert telling(rows[:1]) == ()


def test_a_comparison_is_paired_by_run() -> None:
    """Rows that have no partner are left out, in whichever order rows come."""
    rows = two([10, 20, 30, 40, 50, 60], [20, 40, 60, 80, 100]) + two([999], [], scene="b")
    expected = one(comparison(), rows)
    found = sides(expected)
    assert found.paired.pairs == 5
    assert found.paired.ratio.value == 0.5
    assert found.paired.ratio.high == pytest.approx(0.5)
    assert found.difference.value == -30.0
    assert found.first.value == 30.0
    assert expected.verdict is Verdict.WON
    Random(1).shuffle(rows)
    assert one(comparison(), rows) == expected


def test_what_did_not_end_clean_loses_its_pair() -> None:
    """The first gave up after a second, beside a run that was clean after 100."""
    found = one(comparison(), two([-1, 50, 50, 50, 50], [100, 100, 100, 100, 120]))
    assert sides(found).failed == (1, 0)
    assert sides(found).paired.lesser == 0.8
    assert sides(found).paired.ratio.value == pytest.approx((2 * 120 + 4 * 50) / 520)
    assert sides(found).difference.value == -55.0
    assert sides(found).difference.count == 4
    assert sides(found).first.value == 50.0


def test_who_is_seldom_clean_loses_although_its_clean_runs_are_fast() -> None:
    found = one(comparison(), two([-1, -1, -1, -1, -1, -1, -1, 10], [60, 70, 80, 90, 60, 70, 80, 90]))
    assert found.verdict is Verdict.LOST
    assert sides(found).difference.value == -80.0
    never = one(comparison(), two([-1] * 6, [60, 70, 80, 90, 60, 70]))
    assert never.verdict is Verdict.LOST
    assert isnan(sides(never).difference.value)
    always = one(comparison("less", REACTIVE, PLAN), two([-1] * 6, [60, 70, 80, 90, 60, 70]))
    assert always.verdict is Verdict.WON


def test_what_failed_counts_as_twice_the_longest_of_its_own_scene() -> None:
    rows = [*two([-1, 10, 10, 10, 10], [20] * 5), *two([100] * 5, [500] * 5, scene="b")]
    means = [(2 * 20 + 100) / 2, *[(10 + 100) / 2] * 4]
    assert sides(one(comparison(), rows)).paired.ratio.value == pytest.approx(fmean(means) / 260)


def test_a_score_counts_whether_or_not_all_is_clean() -> None:
    rows = [
        row({"strategy": name}, run, 30.0, False, score=score)
        for name, scores in (
            ("plan-2", (0.9, 1.0, 0.98, 0.96, 0.97)),
            ("reactive", (0.5, 0.6, 0.7, 0.4, 0.5)),
        )
        for run, score in enumerate(scores, 1)
    ]
    found = one(comparison("more", measure="score"), rows)
    assert found.verdict is Verdict.WON
    assert sides(found).failed == (0, 0)
    limited = one(comparison("more", second={}, measure="score", limit=0.99), rows)
    assert limited.verdict is Verdict.UNDECIDED
    assert limited.estimate.value == pytest.approx(0.962)


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (comparison(), Verdict.WON),
        (comparison(factor=0.6), Verdict.WON),
        (comparison(factor=0.4), Verdict.LOST),
        (comparison("more"), Verdict.LOST),
        (comparison("equal", margin=0.1), Verdict.LOST),
        (comparison("equal", factor=0.5, margin=0.1), Verdict.WON),
        (comparison(second={}, limit=75.0), Verdict.WON),
        (comparison("more", second={}, limit=75.0), Verdict.LOST),
        (comparison("equal", second={}, limit=50.0, margin=0.2), Verdict.WON),
        (comparison("equal", second={}, limit=50.0, margin=0.001), Verdict.UNDECIDED),
    ],
    ids=lambda value: (
        str(value) if isinstance(value, Verdict) else f"{value.expect}{value.factor}{value.limit}"
    ),
)
def test_what_is_expected_decides(said: Comparison, expected: Verdict) -> None:
    """Of runs that take about 50 seconds where the others take about 100."""
    rows = list(drawn({"strategy": ("plan-2", "reactive")}, {"plan-2": 50.0, "reactive": 100.0}, 20))
    found = one(said, rows)
    assert found.verdict is expected
    assert (found.more is not None) <= (expected is Verdict.UNDECIDED)


def test_episodes_of_one_run_are_one_pair() -> None:
    """Late ones beside early ones, of series."""
    rows = list(drawn({"strategy": ("plan-2",)}, {"plan-2": 100.0}, 8, episodes=6))
    found = one(comparison(first={"episode": (5, 6)}, second={"episode": (1,)}, factor=0.8), rows)
    assert sides(found).paired.pairs == 8
    assert found.verdict is Verdict.WON
    late = [fmean(r.total for r in rows if r.run == run and r.episode in (5, 6)) for run in range(1, 9)]
    early = [r.total for r in rows if r.episode == 1]
    assert sides(found).paired.ratio.value == pytest.approx(fmean(late) / fmean(early))


def test_parts_are_compared_whatever_axes_only_one_of_them_has() -> None:
    wam = list(drawn({"scene": ("a",)}, {"a": 50.0}, 6, part="wam"))
    reem = list(drawn({"scene": ("a",), "grasp": ("folded",)}, {"a": 90.0}, 6, part="reem"))
    found = one(comparison(first={"part": ("wam",)}, second={"part": ("reem",)}), wam + reem)
    assert sides(found).paired.pairs == 6
    assert found.verdict is Verdict.WON


def test_axes_of_which_the_sides_share_no_value_keep_no_rows_apart() -> None:
    """Each strategy has its planner, and each platform its scenes; scenes that both have are compared."""
    rows = [
        row({"scene": scene, "strategy": name, "planner": name[:2]}, run, seconds)
        for scene, longer in (("a", 1.0), ("b", 3.0))
        for name, seconds in (("plan-2", 10.0 * longer), ("reactive", 20.0 * longer))
        for run in range(1, 6)
    ]
    assert sides(one(comparison(), rows)).paired.pairs == 5
    without = [each for each in rows if each.axes["scene"] == "a" or each.axes["strategy"] == "plan-2"]
    assert sides(one(comparison(), without)).paired.ratio.value == 0.5, "of scene a, which both have"


def test_p_of_what_lies_between_two_bounds_is_the_larger_of_both() -> None:
    rows = two([44, 46, 48, 50, 52, 53], [])
    found = one(comparison("equal", second={}, limit=50.0, margin=0.1), rows)
    assert found.bounds == Bounds(45.0, 55.0)
    near, far = (signed_rank(np.array([44.0, 46, 48, 50, 52, 53]) - end) for end in (45, 55))
    assert found.chance == max(near, far) == near > far


def test_p_values_are_raised_for_the_number_of_comparisons() -> None:
    rows = list(drawn({"strategy": ("plan-2", "reactive")}, {"plan-2": 95.0, "reactive": 100.0}, 12))
    alone = one(comparison(), rows)
    among = judged([comparison(), comparison(measure="actions"), comparison(factor=2.0)], rows)
    assert among[0].chance == alone.chance == alone.adjusted
    assert all(each.adjusted >= each.chance for each in among)
    assert min(each.adjusted for each in among) == pytest.approx(3 * min(each.chance for each in among))


def test_without_rows_nothing_is_decided() -> None:
    for said in (comparison(), comparison(second={}, limit=3.0)):
        found = one(said, [])
        assert found.verdict is Verdict.UNDECIDED
        assert found.more is None
        assert found.chance == 1.0
