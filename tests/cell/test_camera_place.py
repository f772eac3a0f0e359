"""Where the camera stands by a board, against pictures drawn from poses that are known."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from cleancli.cell.board import BOARDS
from cleancli.cell.camera import Laid, NoBoard, Sighted, sighted
from cleancli.cell.corners import corners_in
from cleancli.geometry.rgbd import Frame
from support.board_pictures import Optics, errors, looking, picture

LAID = Laid((0.07, -0.04), 0.4)
POSE = looking(0.9, slant=20, towards=130, yaw=-12)


PLAIN = Optics()


def taken(optics: Optics = PLAIN, laid: Laid = LAID, seed: int = 1, name: str = "a3") -> Frame:
    return picture(BOARDS[name], laid, POSE, np.random.default_rng(seed), optics)


def found(*frames: Frame, laid: Laid = LAID) -> Sighted:
    return sighted(frames, laid, np.random.default_rng(0))


@pytest.mark.parametrize("name", BOARDS)
@pytest.mark.parametrize(
    "optics", [PLAIN, Optics(distortion=(-0.2, 0.05, 0.001, -0.001)), Optics(covered=0.3)]
)
def test_the_pose_is_that_of_the_picture(name: str, optics: Optics) -> None:
    seen = found(taken(optics, name=name))
    millimetres, degrees = errors(seen.pose, POSE)
    assert millimetres < 4
    assert degrees < 0.25
    assert seen.board == BOARDS[name]
    assert seen.doubts == ()


def test_a_board_somewhere_else_is_not_the_same_cell() -> None:
    """How the board lies is what makes the camera's place one of the scene."""
    other = found(taken(), laid=replace(LAID, at=(0.07, 0.06)))
    assert other.pose[:3, 3] - found(taken()).pose[:3, 3] == pytest.approx((0, 0.1, 0), abs=1e-3)
    turned = found(taken(), laid=replace(LAID, turn=LAID.turn + np.radians(90)))
    assert errors(turned.pose, POSE)[1] == pytest.approx(90, abs=0.1)


def test_colour_alone_tells_it_too_and_says_so() -> None:
    frame = taken()
    seen = found(replace(frame, depth=np.zeros_like(frame.depth)))
    millimetres, degrees = errors(seen.pose, POSE)
    assert millimetres < 12
    assert degrees < 0.8
    assert seen.depth_scale is None
    assert "the depth of the board is not known" in seen.doubts[0]


def test_pictures_without_the_board_count_for_nothing() -> None:
    blank = replace(taken(), colour=np.full_like(taken().colour, 200))
    seen = found(blank, taken(), taken(seed=2))
    assert seen.pictures == 2
    assert seen.corners == sum(len(c.numbers) for s in (1, 2) if (c := corners_in(taken(seed=s).colour)))


def test_a_sheet_that_was_fitted_to_the_page_is_told_and_its_bar_mends_it() -> None:
    """Printed at 97 %: the bar measures 194 mm."""
    printed = replace(LAID, bar=0.194)
    frame = taken(laid=printed)
    (doubt,) = found(frame).doubts
    assert "depth shows the board 3." in doubt
    assert "smaller than it was printed" in doubt
    mended = found(frame, laid=printed)
    assert mended.doubts == ()
    assert mended.depth_scale == pytest.approx(1, abs=0.005)
    assert errors(mended.pose, POSE)[0] < 3


def test_depth_in_another_scale_is_told() -> None:
    (doubt,) = found(taken(Optics(bias=0.04))).doubts
    assert "larger than it was printed" in doubt


def test_a_lens_that_is_not_described_is_told() -> None:
    """A picture that is bent, read as if it were straight: corners away from its middle are seen nearer to
    it, by 15 pixels at 200."""
    frame = taken()
    away = np.indices(frame.depth.shape) - np.array([240.0, 320.0])[:, None, None]
    longer = 1 + 2e-6 * (away**2).sum(axis=0)
    rows, columns = (away * longer + np.array([240.0, 320.0])[:, None, None]).astype(np.float32)
    bent = cv2.remap(frame.colour, columns, rows, cv2.INTER_LINEAR)
    seen = found(replace(frame, colour=bent.astype(np.uint8)))
    assert seen.misfit > 1
    assert seen.doubts


@pytest.mark.parametrize(
    ("frames", "told"),
    [
        ((replace(taken(), colour=np.zeros_like(taken().colour)),), "no picture shows 6 corners"),
        ((taken(), taken(name="a4")), "different boards"),
        ((taken(), taken(laid=replace(LAID, at=(0.1, 0.0)))), "the board moves by"),
        ((taken(), replace(taken(), camera=replace(taken().camera, focal=600.0))), "different cameras"),
    ],
)
def test_pictures_that_tell_nothing_are_refused(frames: tuple[Frame, ...], told: str) -> None:
    with pytest.raises(NoBoard, match=told):
        found(*frames)


def test_places_of_corners_are_the_same_whatever_opencv(monkeypatch: pytest.MonkeyPatch) -> None:
    """Versions 4 give (n, 1, 2) and are half a pixel off; what is refined from there is the same."""
    frame = taken()
    here = corners_in(frame.colour)
    assert here is not None

    class Older:
        def __init__(self, board: cv2.aruco.CharucoBoard) -> None:
            self.detector = real(board)

        def detectBoard(self, image: np.ndarray) -> tuple[object, ...]:  # noqa: N802 - OpenCV's name
            at, numbers, *rest = self.detector.detectBoard(image)
            if numbers is None:
                return at, numbers, *rest
            at = np.asarray(at, np.float32).reshape(-1, 1, 2) + np.float32(0.5)
            return at, np.asarray(numbers).reshape(-1, 1), *rest

    real = cv2.aruco.CharucoDetector
    monkeypatch.setattr(cv2.aruco, "CharucoDetector", Older)
    older = corners_in(frame.colour)
    assert older is not None
    assert (older.numbers == here.numbers).all()
    assert np.abs(older.pixels - here.pixels).max() < 0.1
    # Half a pixel would be: the truth is what the picture was drawn from.
    assert found(frame).misfit < 0.2
