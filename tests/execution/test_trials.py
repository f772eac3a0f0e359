"""How one action is tried, and how its end is judged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cleancli.execution.trials import Trial, TrialResult, attempt, extent, judge, linked
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.recording.overlay import BAR, BORDER, SCALE, WAY, entries, legend, overlay
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene

NOTHING = np.empty((0, 2))
HEAP = np.array([(0.0, 0.0), (0.01, 0.0), (0.0, 0.012)])


def table(dirt: str, more: str = "") -> Scene:
    return load_scene(Source("s", f"scene s {{ {more} dirt {{ {dirt} }} }}"))


@pytest.mark.parametrize(
    ("after", "gathering", "areas", "outcome"),
    [
        (NOTHING, False, 1, TrialResult.NONE_LEFT),
        (HEAP, False, 1, TrialResult.SOME_LEFT),
        (np.concatenate((HEAP, HEAP + 0.3)), False, 1, TrialResult.SPREAD_OUT),
        (np.concatenate((HEAP, HEAP + 0.3)), True, 2, TrialResult.SOME_LEFT),
        (HEAP, True, 2, TrialResult.NONE_LEFT),
        (NOTHING, True, 2, TrialResult.NONE_LEFT),
        (np.concatenate((HEAP, HEAP + 0.3, HEAP - 0.3)), True, 2, TrialResult.SPREAD_OUT),
        (HEAP / 2, True, 1, TrialResult.NONE_LEFT),
        (HEAP * 1.5, True, 1, TrialResult.SOME_LEFT),
    ],
)
def test_an_end_is_judged(after: np.ndarray, gathering: bool, areas: int, outcome: TrialResult) -> None:
    assert judge(HEAP, after, gathering, areas, 0.05) is outcome


def test_groups_are_what_chains_of_near_points_lead_through() -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform(0, 0.5, (40, 2))
    near = np.linalg.norm(points[:, None] - points[None], axis=2) < 0.06
    reach = near.copy()
    for _ in range(40):
        reach = (reach @ near) | reach
    groups = linked(points, 0.06)
    assert sorted(number for group in groups for number in group) == list(range(40))
    assert 3 < len(groups) < 30
    for group in groups:
        assert set(np.flatnonzero(reach[group[0]])) == set(group)


def test_extent_is_the_longest_distance() -> None:
    assert extent(HEAP) == pytest.approx(np.hypot(0.01, 0.012))
    assert extent(HEAP[:1]) == extent(NOTHING) == 0


def test_a_trial_moves_the_area_that_was_asked_for_and_tells_all_particles() -> None:
    scene = table("group { count = 8  at = (-20 cm, 10 cm)  radius = 2 cm }"
                  "group { count = 6  at = (30 cm, 0 cm)  radius = 2 cm }")  # fmt: skip
    trial = attempt(scene, "moveToContainerFast", ("a2",), 4)
    assert trial.targets == 6
    assert trial.outcome in (TrialResult.NONE_LEFT, TrialResult.SOME_LEFT, TrialResult.SPREAD_OUT)
    assert len(trial.before) == 14
    assert len(trial.after) == 8 + trial.left
    assert trial.seconds > 2
    assert (trial.left == 0) == (trial.outcome is TrialResult.NONE_LEFT)


def test_an_area_that_is_not_seen_is_not_acted_on() -> None:
    scene = table("group { count = 8  at = (0 cm, 0 cm)  radius = 2 cm }")
    small = replace(scene, camera=replace(scene.camera, image_width=320, image_height=240, focal=262.5))
    trial = attempt(small, "join2", (), 1)
    assert trial.outcome is TrialResult.NOT_TRIED
    assert trial.seconds == 0


def test_the_map_shows_before_and_after_where_they_are() -> None:
    scene = table("ink { along = (0 m, 0 m) }")
    before, after = np.array([(0.1, 0.2)]), np.array([(-0.3, -0.1)])
    stroke = np.array([(0.2, -0.2), (0.4, -0.2)])
    trial = Trial(1, TrialResult.SOME_LEFT, 1, 1, 0, 1.0, before, after, stroke)
    picture = overlay(scene, [("one", [trial])])
    for (x, y), red in (((0.1, 0.2), False), ((-0.3, -0.1), True)):
        column, row = round((x + 0.45) * SCALE) + BORDER, round((0.35 - y) * SCALE) + BORDER
        patch = picture[row - 4 : row + 5, column - 4 : column + 5].reshape(-1, 3).astype(int)
        marked = patch[np.argmin(patch.sum(axis=1))]
        assert (marked[0] > marked[2]) == red
    way = picture[round(0.55 * SCALE) + BORDER, round(0.66 * SCALE) + BORDER : round(0.8 * SCALE) + BORDER]
    assert (np.abs(way.astype(int) - WAY) < 60).all()


@pytest.mark.parametrize("width", [300, 460, 780])
@pytest.mark.parametrize("zone", ["", "zone { at = (0 cm, 0 cm)  side = 10 cm }"])
def test_the_legend_explains_each_sign_once_and_nothing_lies_on_anything(width: int, zone: str) -> None:
    scene = table("ink { along = (0 m, 0 m) }", zone)
    told = [text for _, text in entries(scene)]
    assert len(told) == len(set(told)) == 5 + bool(zone)
    assert "10 cm" in told
    picture = legend(scene, width)
    assert picture.shape[1] == width
    assert (picture[:, : BORDER - 4] == 255).all()
    assert (picture[:, -3:] == 255).all()


def test_the_scale_bar_is_as_long_as_it_says() -> None:
    picture = legend(table("ink { along = (0 m, 0 m) }"), 780)
    rows = np.atleast_2d((picture < 60).all(axis=2)).tolist()
    lengths = [len(run) for row in rows for run in "".join("01"[black] for black in row).split("0")]
    assert max(lengths) == pytest.approx(BAR * SCALE, abs=4)
