"""When a surface no longer looks as calibrated: each limit of docs/perception.md, just below and above."""

from __future__ import annotations

import re
from dataclasses import fields
from math import radians
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from cleancli.perception.fit import COLUMNS, ROWS, doubts, tilt_of
from cleancli.perception.geometry import Plane
from cleancli.scene.calibration import Appearance, Thresholds

PAGE = (Path(__file__).parents[2] / "docs" / "perception.md").read_text(encoding="utf-8")
PARTS = COLUMNS * ROWS
GREY = (100.0, 100.0, 100.0)
CALIBRATED = Appearance(COLUMNS, ROWS, (GREY,) * PARTS, radians(20))


def surface(
    *changed: tuple[float, float, float], rest: tuple[float, float, float] = GREY
) -> NDArray[np.float64]:
    """Colours of all parts: some first ones, and the rest."""
    return np.array([*changed, *[rest] * (PARTS - len(changed))])


def said(colours: NDArray[np.float64], degrees: float = 20, then: Appearance = CALIBRATED) -> str:
    return "; ".join(doubts(colours, radians(degrees), then))


@pytest.mark.parametrize("sign", [1, -1])
def test_the_tilt_of_a_surface_seen_from_right_above_is_told_in_spite_of_rounding(sign: int) -> None:
    """The product of two vectors of length 1 may be a little more than 1."""
    normal = np.array([0.0, 0.0, 1 + 1e-12])
    plane = Plane(normal, 0.0, np.zeros(3), np.array([1.0, 0.0, 0.0]))
    assert tilt_of(plane, np.array([0.0, 0.0, -float(sign)])) == pytest.approx(0 if sign > 0 else np.pi)
    assert tilt_of(plane, np.array([0.0, np.sin(0.3), -np.cos(0.3)])) == pytest.approx(0.3)


def test_what_is_as_it_was_raises_no_doubt() -> None:
    assert said(surface()) == ""
    assert f"mean colours of {COLUMNS} x {ROWS} parts" in PAGE


@pytest.mark.parametrize(("share", "way"), [(1.16, "16% brighter"), (0.84, "16% darker")])
def test_brightness(share: float, way: str) -> None:
    assert said(surface(rest=(100 * share,) * 3)) == f"the surface is {way} than when calibrated"
    nearly = 1 + (share - 1) * 14 / 16
    assert said(surface(rest=(100 * nearly,) * 3)) == ""


@pytest.mark.parametrize("share", [1.16, 0.84])
def test_one_part_that_changed_otherwise_than_most(share: float) -> None:
    assert said(surface((100 * share,) * 3)) == "light falls differently on the surface than when calibrated"
    nearly = 1 + (share - 1) * 14 / 16
    assert said(surface((100 * nearly,) * 3)) == ""
    brighter = surface((110 * share,) * 3, rest=(110.0,) * 3)
    assert "light falls differently" in said(brighter), "as a share of what most changed by"


def test_colour() -> None:
    another = "the surface, or the light on it, has another colour than when calibrated"
    assert said(surface(rest=(113.0, 100.0, 87.0))) == another
    assert said(surface(rest=(87.0, 100.0, 113.0))) == another
    assert said(surface(rest=(111.0, 100.0, 89.0))) == ""
    assert said(surface((113.0, 100.0, 87.0))) == "", "one part is none of the surface's colour"


@pytest.mark.parametrize(("degrees", "way"), [(31, "11 degrees flatter"), (9, "11 degrees steeper")])
def test_angle(degrees: float, way: str) -> None:
    assert said(surface(), degrees) == f"the camera looks at the surface {way} than when calibrated"
    assert said(surface(), 20 + (degrees - 20) * 9 / 11) == ""


def test_parts_that_are_hidden_then_or_now_do_not_count() -> None:
    unseen = surface((np.nan,) * 3, (np.nan,) * 3)
    assert said(unseen) == ""
    hidden = Appearance(COLUMNS, ROWS, ((0.0, 0.0, 0.0), *[GREY] * (PARTS - 1)), radians(20))
    assert said(surface((30.0, 60.0, 90.0)), then=hidden) == ""
    assert said(np.full((PARTS, 3), np.nan)) == ""
    assert said(np.full((PARTS, 3), np.nan), 40) != ""


def test_every_doubt_is_told() -> None:
    assert len(doubts(surface(rest=(150.0, 120.0, 100.0)), radians(40), CALIBRATED)) == 3
    other = Appearance(2, 2, (GREY,) * 4, radians(20))
    assert said(surface(), then=other) == "the calibration divides the surface into other parts"


def test_thresholds_without_a_calibration_are_as_documented() -> None:
    table = PAGE.split("| threshold | default")[1].split("\n\n")[0]
    rows = re.findall(r"^\| (`\w+`(?:, `\w+`)?) \| ([\d., ]+) \|", table, re.M)
    told = {
        name: float(number)
        for names, numbers in rows
        for name, number in zip(re.findall(r"\w+", names), numbers.split(", "), strict=True)
    }
    defaults = Thresholds()
    own = {field.name: getattr(defaults, field.name) for field in fields(Thresholds)}
    assert told == pytest.approx(own, rel=1e-3)
