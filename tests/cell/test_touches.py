"""Where the robot finds the table, by touches whose truth is known."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from cleancli.cell.board import BOARDS
from cleancli.cell.camera import Laid
from cleancli.cell.touches import BadTouches, Touch, Touched, header, read_touches, touched
from support import synthetic
from support.board_pictures import errors

Array = NDArray[np.float64]

BOARD, LAID = BOARDS["a3"], Laid((0.05, 0.02), 0.3)
SURFACE = synthetic.scene().surface
GRID = np.array([(x, y) for y in (-0.25, 0, 0.25) for x in (-0.3, 0, 0.3)])
CORNERS = ("a1", "g1", "g4", "a4", "d2")


def turned(about: Sequence[float]) -> Array:
    """The rotation (3, 3) about a vector by its length: the sum of the exponential series."""
    x, y, z = about
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0.0]])
    total, term = np.eye(3), np.eye(3)
    for number in range(1, 30):
        term = term @ cross / number
        total = total + term
    return total


def table(about: Sequence[float] = (0.02, -0.01, 2.1), at: Sequence[float] = (0.6, -0.2, 0.03)) -> Array:
    """Where the robot finds the table: turned by the vector `about`, its middle `at` a place."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turned(about), at
    return pose


def touch(pose: Array, places: Array, noise: float, rng: np.random.Generator) -> list[Array]:
    points = np.column_stack([places, np.zeros(len(places))]) @ pose[:3, :3].T + pose[:3, 3]
    return list(points + rng.normal(0, noise, points.shape)) if noise else list(points)


def at_corners(pose: Array, noise: float = 0.0, names: Sequence[str] = CORNERS) -> list[Touch]:
    numbers = np.array([BOARD.corner_names.index(name) for name in names])
    found = touch(pose, LAID.places(BOARD, numbers), noise, np.random.default_rng(3))
    return [Touch((p[0], p[1], p[2]), name) for p, name in zip(found, names, strict=True)]


def anywhere(pose: Array, noise: float = 0.0, seed: int = 4, places: Array = GRID) -> list[Touch]:
    return [Touch((p[0], p[1], p[2])) for p in touch(pose, places, noise, np.random.default_rng(seed))]


def found(touches: Sequence[Touch], before: Array | None = None) -> Touched:
    return touched(touches, BOARD, LAID, SURFACE, before)


@pytest.mark.parametrize("pose", [table(), table((3.1, 0.1, 0.2)), table((0.1, -0.05, -3.0))])
def test_exact_touches_tell_the_pose(pose: Array) -> None:
    """Also for a robot that hangs from the ceiling, whose z points down."""
    seen = found([*at_corners(pose), *anywhere(pose)])
    millimetres, degrees = errors(seen.pose, pose)
    assert millimetres < 1e-6
    assert degrees < 1e-4
    assert seen.doubts == ()
    assert seen.spread == pytest.approx(0, abs=1e-9)


def test_height_and_slant_alone_are_new_where_no_corner_was_touched() -> None:
    """The table was raised by a centimetre and slants; where it stands has not changed."""
    before = table((0.0, 0.0, 2.1))
    slant = turned((0.01, 0.02, 0))
    now = table()
    now[:3, :3] = slant @ before[:3, :3]
    now[:3, 3] = before[:3, 3] + (0, 0, 0.01)
    seen = found(anywhere(now), before)
    assert seen.pose[:3, 2] == pytest.approx(now[:3, 2])
    places = np.column_stack([GRID, np.zeros(9)])
    heights = [(pose[:3, :3] @ places.T).T + pose[:3, 3] for pose in (seen.pose, now)]
    assert np.abs(heights[0] - heights[1]).max() < 5e-4, "sideways by a slant of the surface's own height"
    assert seen.corners is None
    with pytest.raises(BadTouches, match="two corners of the board at least"):
        found(anywhere(now))


def test_the_errors_that_are_stated_are_those_that_are_made() -> None:
    """Nine touches with 1 mm of noise, 400 times: the height in the middle and at the worst corner are off
    by as much as is said, as root mean squares over all of them."""
    pose = table()
    off, said = [], []
    corner = np.array([0.45, 0.35])
    for seed in range(400):
        seen = found(anywhere(pose, 0.001, seed), pose)
        assert seen.height_errors is not None
        said.append(seen.height_errors)
        plane = seen.pose[:3, 2]
        true = [pose[:3, :3] @ (x, y, 0) + pose[:3, 3] for x, y in ((0.0, 0.0), corner)]
        off.append([float(plane @ (place - seen.pose[:3, 3])) for place in true])
    made, stated = np.sqrt((np.array(off) ** 2).mean(axis=0)), np.sqrt((np.array(said) ** 2).mean(axis=0))
    # Of 400 root mean squares one is off by 3.5 % (standard deviation).
    assert made == pytest.approx(stated, rel=0.14)
    assert made[0] == pytest.approx(0.001 / 3, rel=0.14), "the mean of nine"
    expected = 0.001 * np.sqrt(1 / 9 + 0.45**2 / (6 * 0.3**2) + 0.35**2 / (6 * 0.25**2))
    assert made[1] == pytest.approx(expected, rel=0.14)


@pytest.mark.parametrize("noise", [0.0, 0.0005])
@pytest.mark.parametrize("number", [0, 4, 8])
def test_one_touch_that_was_a_mistake_is_named(number: int, noise: float) -> None:
    pose = table()
    touches = anywhere(pose, noise)
    x, y, z = touches[number].tool
    touches[number] = Touch((x, y, z + 0.008))
    (doubt,) = found(touches, pose).doubts
    assert re.match(rf"touch {number + 1} lies [789]\.\d mm above the plane of the others", doubt)


@pytest.mark.parametrize(
    ("touches", "told"),
    [
        (anywhere(table(), places=GRID[:3] * [1, 2]), "they lie almost on a line"),
        (anywhere(table())[:2], "3 touches at least tell a plane, not 2"),
        (
            [Touch((1000 * t.tool[0], 1000 * t.tool[1], 1000 * t.tool[2])) for t in anywhere(table())],
            "unit mm?",
        ),
        (
            [Touch((t.tool[0] / 1000, t.tool[1] / 1000, t.tool[2] / 1000)) for t in anywhere(table())],
            "unit m?",
        ),
    ],
)
def test_touches_that_tell_nothing_are_refused(touches: list[Touch], told: str) -> None:
    with pytest.raises(BadTouches, match=re.escape(told)):
        found(touches, table())


def doubts(*touches: Touch) -> str:
    return " ".join(found(touches, table()).doubts)


def test_what_speaks_against_a_place_is_said() -> None:
    pose = table()
    assert "three touches always lie on a plane" in doubts(*anywhere(pose, places=GRID[[0, 2, 7]]))
    assert "touches lie" in doubts(*anywhere(pose, 0.006))
    small = anywhere(pose, 0.001, places=GRID / 4)
    assert "the height of a corner of the table is known to" in doubts(*small)
    swapped = [*at_corners(pose, names=("a1", "g1", "a4"))]
    swapped[1], swapped[2] = Touch(swapped[1].tool, "a4"), Touch(swapped[2].tool, "g1")
    assert "the robot finds the board" in doubts(*swapped, *anywhere(pose))
    *outer, inner = at_corners(pose)
    x, y, z = inner.tool
    beside = [*outer, Touch((x + 0.015, y, z), inner.corner), *anywhere(pose)]
    assert "corners are" in doubts(*beside)


TEXT = header("mm") + "\n600, -200, 30, a1\n\n 610.5,-200,30\n"


def test_a_file_names_its_unit() -> None:
    assert read_touches(TEXT, BOARD) == (
        Touch((0.6, -0.2, 0.03), "a1"),
        Touch((0.6105, -0.2, 0.03)),
    )
    assert read_touches(TEXT.replace("_mm", "_m"), BOARD)[0].tool == (600, -200, 30)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "line 1: the header must be"),
        ("x,y,z\n1,2,3\n", "line 1: the header must be"),
        (TEXT + "1,2\n", "line 5: `1,2` must begin with three numbers"),
        (TEXT + "1,2,three\n", "line 5"),
        (TEXT + "1,2,3,k9\n", "line 5: the board a3 has no corner `k9`: they are a1 to g4"),
        (TEXT + "1,2,3,a1,\n1,2,3,a1,5\n", "line 6: `1,2,3,a1,5` has more"),
        (TEXT + "1,2,nan\n", "line 5: `1,2,nan`: x, y and z must be finite"),
    ],
)
def test_a_line_that_is_no_touch_is_named(text: str, told: str) -> None:
    with pytest.raises(BadTouches, match=re.escape(told)):
        read_touches(text, BOARD)
