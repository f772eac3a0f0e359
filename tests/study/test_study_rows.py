"""Rows are selected by what they are of, and measured."""

from __future__ import annotations

from dataclasses import replace

import pytest

from cleancli.study.row import MEASURES, Row, chosen, comparable, matches

ROW = Row(
    study="s",
    part="narrow",
    axes={"scene": "two_groups", "strategy": "plan-2", "rag.width": 0.08},
    run=2,
    episode=3,
    seed=8,
    clean=True,
    reason="nothing is left to do",
    actions=5,
    unknown=2,
    seconds={
        "planning": 1.0,
        "perceiving": 2.0,
        "extra_perceptions": 3.0,
        "transits": 10.0,
        "actions": 20.0,
        "learning": 4.0,
    },
    total=40.0,
    pieces=28,
    left=1,
    on_floor=2,
    ink_left=None,
    score=25 / 28,
    cpu=9.0,
    real=10.0,
    versions={"cleancli": "1"},
    files=("a", "b"),
    key="k",
)


@pytest.mark.parametrize(
    ("measure", "value"),
    [
        ("seconds", 40),
        ("moving", 30),
        ("actions", 5),
        ("unknown", 2),
        ("planning", 1),
        ("perceiving", 2),
        ("extra_perceptions", 3),
        ("transits", 10),
        ("acting", 20),
        ("learning", 4),
        ("thinking", 6 / 40),
        ("score", 25 / 28),
        ("left", 3),
        ("clean", 1),
    ],
)
def test_measures(measure: str, value: float) -> None:
    assert MEASURES[measure].of(ROW) == pytest.approx(value)
    again = MEASURES[measure].of(replace(ROW, seconds=dict.fromkeys(ROW.seconds, 0.0), total=0.0))
    assert MEASURES[measure].is_real or measure in ("moving", "transits", "acting") or again == value


def test_a_row_is_selected_by_its_axes_part_and_number() -> None:
    assert matches(ROW, {})
    assert matches(ROW, {"strategy": ("reactive", "plan-2"), "part": ("narrow",), "episode": (3,)})
    assert not matches(ROW, {"strategy": ("reactive",)})
    assert not matches(ROW, {"episode": (1, 2)})
    assert not matches(ROW, {"rag.grasp": ("wide",)})
    assert list(chosen([ROW, replace(ROW, part="x")], {"part": ("x",)}, {"episode": (3,)})) == [
        replace(ROW, part="x")
    ]


def test_what_is_comparable_has_no_real_time_and_all_else() -> None:
    slower = replace(ROW, cpu=1.0, real=2.0, total=99.0, seconds={**ROW.seconds, "planning": 7.0})
    assert comparable(slower) == comparable(ROW)
    assert comparable(replace(ROW, seconds={**ROW.seconds, "transits": 11.0})) != comparable(ROW)
    assert comparable(replace(ROW, actions=6)) != comparable(ROW)
