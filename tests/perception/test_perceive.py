"""Perception against frames whose truth is known: every lentil, no more, in the right place."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from cleancli.geometry.rgbd import Frame
from cleancli.perception import geometry
from cleancli.perception.perceive import BadFrame, Observation, perceive
from cleancli.perception.surface import STRIDE, NoSurface
from support import synthetic
from support.synthetic import Box

NONE = np.zeros((0, 2))
GROUPS = np.vstack(
    [
        synthetic.grouped(np.random.default_rng(1), 14, (-0.2, 0.12), 0.025),
        synthetic.grouped(np.random.default_rng(2), 14, (-0.05, -0.15), 0.025),
    ]
)


def see(*frames: Frame, link: float = 0.035) -> Observation:
    return perceive(frames, synthetic.scene(link=link), np.random.default_rng(0))


def dirty_points(observation: Observation) -> np.ndarray:
    rows, columns = np.nonzero(observation.steps.believed)
    pixels = np.column_stack([columns, rows]).astype(float)
    return geometry.on_plane(synthetic.camera(), observation.plane, pixels)


def recall_and_false(observation: Observation, lentils: np.ndarray) -> tuple[float, int]:
    """The share of lentils with a dirty pixel on them, and how many pixels are on no lentil."""
    apart = np.linalg.norm(lentils[:, None] - dirty_points(observation)[None], axis=2)
    return float((apart.min(axis=1) < 0.004).mean()), int((apart.min(axis=0) > 0.006).sum())


@pytest.mark.parametrize(
    ("tilt", "light"),
    [((0.0, 0.0), 0.0), ((0.04, -0.03), 0.0), ((0.0, 0.0), 0.5), ((-0.05, 0.02), -0.4)],
)
@pytest.mark.parametrize("layout", ["groups", "scattered", "both"])
def test_every_lentil_is_found_and_nothing_else(layout: str, tilt: tuple[float, float], light: float) -> None:
    loose = synthetic.scattered(np.random.default_rng(3), 40)
    lentils = {"groups": GROUPS, "scattered": loose, "both": np.vstack([GROUPS[:14], loose[:12]])}[layout]
    observation = see(synthetic.frame(lentils, seed=5, tilt=tilt, light=light))
    recall, false = recall_and_false(observation, lentils)
    assert recall == 1.0
    assert false == 0
    assert observation.hidden < 0.002


def test_single_lentils_are_placed_within_a_millimetre() -> None:
    lentils = np.array([(x, y) for x in (-0.3, -0.13, 0.02, 0.21) for y in (-0.22, -0.07, 0.11, 0.25)])
    areas = see(synthetic.frame(lentils, seed=1, tilt=(0.03, 0.02))).areas
    assert len(areas) == len(lentils)
    centres = np.array([area.ellipse.centre for area in areas])
    errors = np.linalg.norm(lentils[:, None] - centres[None], axis=2).min(axis=1)
    assert np.median(errors) < 0.001
    assert errors.max() < 0.002


def test_covered_area_and_ellipse_of_a_group() -> None:
    areas = see(synthetic.frame(GROUPS, seed=1)).areas
    assert len(areas) == 2
    for area, group in zip(areas, (GROUPS[:14], GROUPS[14:]), strict=True):
        assert area.covered == pytest.approx(14 * np.pi * synthetic.RADIUS**2, rel=0.2)
        long, short = area.ellipse.axes
        assert 0.02 < short <= long < 0.04
        offsets = group - area.ellipse.centre
        turn = np.array(
            [
                [np.cos(area.ellipse.angle), -np.sin(area.ellipse.angle)],
                [np.sin(area.ellipse.angle), np.cos(area.ellipse.angle)],
            ]
        )
        assert (np.hypot(*((offsets @ turn) / (long, short)).T) < 1).all()


@pytest.mark.parametrize(("apart", "count"), [(0.036, 1), (0.046, 2)])
def test_dirt_closer_than_the_link_distance_is_one_area(apart: float, count: int) -> None:
    """The link is a gap: the lentils' middles are 6 mm farther apart."""
    lentils = np.array([(0.1, 0.1), (0.1 + apart, 0.1)])
    assert len(see(synthetic.frame(lentils, seed=1)).areas) == count


def test_a_clean_surface_has_no_areas() -> None:
    for seed in range(4):
        observation = see(synthetic.frame(NONE, seed, light=0.3))
        assert observation.areas == ()
        assert not observation.steps.believed.any()


def test_a_dark_surface_is_clean_too() -> None:
    assert see(synthetic.frame(NONE, 1, colour=(74, 66, 60), light=0.3)).areas == ()


def test_a_tool_in_view_is_no_dirt_and_hides_what_is_below() -> None:
    tool = Box((0.0, -0.02), (0.012, 0.10), 0.036)
    gripper = Box((-0.03, 0.0), (0.05, 0.08), 0.2)
    lentils = np.array([(0.01, 0.04), (-0.2, 0.1), (0.2, -0.1), (0.1, 0.03)])
    observation = see(synthetic.frame(lentils, 1, boxes=(tool, gripper)))
    assert recall_and_false(observation, lentils[1:]) == (1.0, 0)
    assert len(observation.areas) == 3
    assert 0.01 < observation.hidden < 0.05
    column, row = np.rint(geometry.project(synthetic.camera(), lentils[:1]))[0].astype(int)
    assert observation.hidden_mask[row, column]


def test_the_container_and_the_floor_are_not_searched() -> None:
    outside = np.array([(0.47, 0.0), (0.5, 0.1), (0.0, 0.37)])
    frame = synthetic.frame(NONE, 1)
    colour = frame.colour.copy()
    for column, row in np.rint(geometry.project(frame.camera, outside)).astype(int):
        colour[row - 2 : row + 3, column - 2 : column + 3] = 20
    assert see(replace(frame, colour=colour)).areas == ()


@pytest.mark.parametrize("unknown", [0.0, np.nan, np.inf])
def test_holes_in_the_depth_blind_nothing_but_themselves(unknown: float) -> None:
    frame = synthetic.frame(GROUPS, 1)
    depth = frame.depth.copy()
    depth[np.random.default_rng(0).random(depth.shape) < 0.02] = unknown
    depth[100:140, 400:440] = unknown
    observation = see(replace(frame, depth=depth))
    assert recall_and_false(observation, GROUPS) == (1.0, 0)
    assert observation.hidden_mask[120, 420]
    assert observation.hidden == pytest.approx(44**2 * (0.9 / 525) ** 2 / (0.88 * 0.68), rel=0.1)


def test_dirt_must_be_seen_in_two_of_three_frames() -> None:
    clean, spotted = synthetic.frame(NONE, 1), synthetic.frame(GROUPS[:1], 2)
    assert see(clean, spotted, clean).areas == ()
    assert len(see(spotted, clean, spotted).areas) == 1


def test_what_most_frames_do_not_show_is_hidden() -> None:
    behind = synthetic.frame(GROUPS[:14], 1, boxes=[Box((-0.3, 0.05), (-0.1, 0.2), 0.1)])
    shown = synthetic.frame(GROUPS[:14], 2)
    assert see(behind, behind, shown).areas == ()
    assert see(behind, behind, shown).hidden > 0.03
    assert len(see(behind, shown, shown).areas) == 1


def test_the_same_seed_gives_the_same_observation() -> None:
    frame = synthetic.frame(GROUPS, 1)
    assert see(frame).areas == see(frame).areas


def test_no_surface_says_why() -> None:
    frame = synthetic.frame(NONE, 1)
    for unknown in (0.0, np.nan, np.inf):
        with pytest.raises(NoSurface, match="depth is known at 0"):
            see(replace(frame, depth=np.full_like(frame.depth, unknown)))
    with pytest.raises(NoSurface, match=r"-70 cm from where"):
        see(replace(frame, depth=np.full_like(frame.depth, 1.6)))
    rough = np.random.default_rng(0).uniform(0.5, 1.0, frame.depth.shape).astype(np.float32)
    with pytest.raises(NoSurface, match="the largest plane holds"):
        see(replace(frame, depth=rough))


def test_frames_that_do_not_fit_are_refused() -> None:
    frame = synthetic.frame(NONE, 1)
    moved = replace(frame, camera=replace(frame.camera, pose=np.eye(4)))
    few = 2 * STRIDE - 1
    thin = replace(frame.camera, width=few)
    for frames, reason in (
        ((), "there is no frame"),
        ((frame, moved), "frame 2 was taken by another camera, or from another place"),
        ((replace(frame, colour=frame.colour[:-1]),), "frame 1: colour must be"),
        ((replace(frame, colour=frame.colour.astype(np.float32)),), "frame 1: colour must be"),
        ((replace(frame, depth=frame.depth[:, 1:]),), "frame 1: depth must be"),
        ((replace(frame, depth=np.zeros((0, 0), np.float32)),), "frame 1: depth must be"),
        (
            (Frame(frame.colour[:, :few], frame.depth[:, :few], thin, frame.clock),),
            f"an image of {few} x {frame.camera.height} pixels is too small",
        ),
    ):
        with pytest.raises(BadFrame, match=reason):
            see(*frames)


def test_a_corner_that_the_arm_cuts_off_is_no_dirt() -> None:
    frame = synthetic.frame(NONE, 1)
    rows, columns = np.nonzero(see(frame).steps.surface)
    top, left = rows.min(), columns.min()
    arm = np.zeros(frame.depth.shape, np.bool_)
    arm[:, left + 16 : left + 60] = arm[top + 16 : top + 60, :] = True
    arm[top + 60 :, : left + 16] = True
    hidden = replace(
        frame,
        depth=np.where(arm, np.float32(0.6), frame.depth),
        colour=np.where(arm[:, :, None], np.uint8(190), frame.colour),
    )
    assert see(hidden).areas == ()


def test_the_time_of_every_step_is_told() -> None:
    """Together they took all the time that there was."""
    frame = synthetic.frame(GROUPS, seed=5)
    started = time.perf_counter()
    seen = see(frame, frame)
    whole = time.perf_counter() - started
    steps = ("plane", "surface", "edges", "background", "median", "belief", "ellipses", "hidden", "doubts")
    assert tuple(seen.seconds) == steps
    assert all(seconds > 0 for seconds in seen.seconds.values())
    assert sum(seen.seconds.values()) == pytest.approx(whole, rel=0.2)
