"""Pictures: the ellipse sits on the dirt, labels keep apart, and inputs stay as they are."""

from __future__ import annotations

import numpy as np

from cleancli.geometry.ellipse import Ellipse
from cleancli.language.model import Fact
from cleancli.perception import marks
from cleancli.perception.area import Area
from cleancli.perception.perceive import perceive
from cleancli.perception.pictures import contact_sheet, draw, project
from cleancli.perception.tracking import track
from support import synthetic


def test_projection_agrees_with_the_camera_that_drew_the_frame() -> None:
    found = project(synthetic.camera(), np.array([[0.0, 0.0], [0.3, 0.2]]))
    assert np.allclose(found, np.array([[320, 239], [495, 239 - 350 / 3]]))


def test_an_ellipse_is_drawn_where_it_is_and_as_long() -> None:
    frame = synthetic.frame(np.zeros((0, 2)), 1, noise=False)
    picture = draw(frame, [Area(Ellipse((0.1, -0.05), (0.06, 0.02), 0.0), 1e-4, "a1")])
    light = (np.abs(picture.astype(int) - marks.ELLIPSE) < 60).all(axis=2)
    rows, columns = np.nonzero(light)
    middle, beside = 320 + 0.1 / 0.9 * 525, marks.BESIDE
    assert abs(columns.min() - (middle - 35 - beside)) <= 2
    assert abs(rows.max() - (239 + (0.05 + 0.02) / 0.9 * 525 + beside)) <= 2
    assert not np.array_equal(picture, frame.colour)
    assert np.array_equal(frame.colour, synthetic.frame(np.zeros((0, 2)), 1, noise=False).colour)


def test_a_label_at_the_picture_corner_stays_inside() -> None:
    frame = synthetic.frame(np.zeros((0, 2)), 1)
    corner = Area(Ellipse((0.54, 0.40), (0.01, 0.01), 0.0), 1e-4, "a1")
    state = frozenset(
        {Fact("size", ("a1",), "medium"), Fact("scattered", ("a1",)), Fact("near", ("a1", "a2"))}
    )
    assert draw(frame, [corner], state).shape == frame.colour.shape


def test_the_contact_sheet_has_six_captioned_steps() -> None:
    lentils = synthetic.grouped(np.random.default_rng(1), 14, (-0.2, 0.12), 0.025)
    frame = synthetic.frame(lentils, 1)
    observation = perceive([frame], synthetic.scene(), np.random.default_rng(0))
    sheet = contact_sheet(frame, observation, track((), observation.areas, None, 1).areas)
    assert sheet.shape == (2 * 510, 3 * 640, 3)
    assert np.array_equal(sheet[30:510, :640], frame.colour)
    captions = [
        sheet[510 * row : 510 * row + 30, 640 * column : 640 * (column + 1)]
        for row in (0, 1)
        for column in (0, 1, 2)
    ]
    assert all((caption < 100).any() for caption in captions)
