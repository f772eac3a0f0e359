"""The sheet to print: what its drawing shows is the board, in true millimetres."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import cv2
import numpy as np
import pytest

from cleancli.cell.board import BOARDS, Board, raster, svg
from cleancli.cell.corners import corners_in

DOTS = 8
"""Pixels to a millimetre."""
SPACE = "{http://www.w3.org/2000/svg}"


def drawn(board: Board) -> np.ndarray:
    """The sheet as a printer draws it."""
    root = ElementTree.fromstring(svg(board))
    width, height = (float(root.attrib[side].removesuffix("mm")) for side in ("width", "height"))
    assert root.attrib["viewBox"] == f"0 0 {width:g} {height:g}"
    page = np.full((round(DOTS * height), round(DOTS * width)), 255, np.uint8)
    (black, *_) = root.iter(f"{SPACE}path")
    for found in re.finditer(r"M(\S+) (\S+?)h(\S+?)v(\S+?)h\S+?z", black.attrib["d"]):
        x, y, wide, high = (DOTS * float(number) for number in found.groups())
        page[round(y) : round(y + high), round(x) : round(x + wide)] = 0
    return page


@pytest.mark.parametrize("name", BOARDS)
def test_the_sheet_has_the_corners_where_the_board_says(name: str) -> None:
    """Found by OpenCV in the drawing, at the places that `places` tells, millimetre by millimetre."""
    board = BOARDS[name]
    page = drawn(board)
    small = cv2.resize(page, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    found = corners_in(np.repeat(small[:, :, None], 3, axis=2))
    assert found is not None
    assert found.board == board
    assert len(found.numbers) == (board.columns - 1) * (board.rows - 1) == len(board.corner_names)
    per_metre = 1000 * DOTS / 2
    middle = found.pixels[np.argsort(found.numbers)].mean(axis=0)
    expected = np.column_stack([found.places[:, 0], -found.places[:, 1]]) * per_metre + middle
    assert np.abs(found.pixels - expected).max() < 0.1 * DOTS


@pytest.mark.parametrize("name", BOARDS)
def test_the_sheet_is_paper_of_its_name_and_leaves_a_rim_white(name: str) -> None:
    board, page = BOARDS[name], drawn(BOARDS[name])
    assert board.sheet == {"a4": (0.297, 0.210), "a3": (0.420, 0.297)}[name]
    rows, columns = np.nonzero(page == 0)
    rim = 6 * DOTS
    assert rows.min() >= rim
    assert columns.min() >= rim
    assert rows.max() < page.shape[0] - rim
    assert columns.max() < page.shape[1] - rim


def test_the_bar_is_twenty_centimetres() -> None:
    root = ElementTree.fromstring(svg(BOARDS["a4"]))
    bar = list(root.iter(f"{SPACE}path"))[-1].attrib["d"]
    assert re.match(r"M\S+ \S+?h200M", bar)
    assert bar.count("v") == 21, "a tick each centimetre, at both ends as well"


@pytest.mark.parametrize("name", BOARDS)
def test_marks_point_to_the_middle(name: str) -> None:
    """From above, from the left and from the right; and the bar's middle tick from below."""
    root = ElementTree.fromstring(svg(BOARDS[name]))
    marks, bar = (path.attrib["d"] for path in list(root.iter(f"{SPACE}path"))[-2:])
    above, left, right = (tuple(map(float, at)) for at in re.findall(r"M([\d.]+) ([\d.]+)", marks))
    rows, columns = np.nonzero(drawn(BOARDS[name]) == 0)
    across, along = ((each.min() + each.max() + 1) / 2 / DOTS for each in (rows, columns))
    assert above[0] == pytest.approx(along, abs=0.1)
    assert left[1] == right[1] == pytest.approx(across, abs=0.1)
    ticks = [float(x) for x in re.findall(r"M([\d.]+) [\d.]+v", bar)]
    assert ticks[10] == pytest.approx(along, abs=0.1)


def test_corners_are_called_as_on_a_chessboard() -> None:
    """a1 is on the lower left, and the names on the sheet stand beside the lines of their corners."""
    board = BOARDS["a3"]
    named = dict(zip(board.corner_names, board.places, strict=True))
    assert named["a1"] == pytest.approx((-3 * 0.048, -1.5 * 0.048))
    assert named["g4"] == pytest.approx((3 * 0.048, 1.5 * 0.048))
    assert named["d2"] == pytest.approx((0, -0.5 * 0.048))
    root = ElementTree.fromstring(svg(board))
    words = {text.text: text.attrib for text in root.iter(f"{SPACE}text")}
    assert float(words["a"]["x"]) == pytest.approx(210 - 3 * 48)
    assert float(words["1"]["y"]) - float(words["4"]["y"]) == pytest.approx(3 * 48)


def test_no_marker_is_on_two_boards() -> None:
    spans = [range(b.first, b.first + b.columns * b.rows // 2) for b in BOARDS.values()]
    numbers = [number for span in spans for number in span]
    assert len(set(numbers)) == len(numbers)
    assert max(numbers) < 50, "the dictionary has no more"


@pytest.mark.parametrize("name", BOARDS)
def test_half_of_the_squares_are_black(name: str) -> None:
    """The one at the upper left is, as OpenCV has it since 4.6; so boards of both paper sizes read alike."""
    picture = raster(BOARDS[name])
    assert (picture[:8, :8] == 0).all()
    assert (picture[:8, 8] == 255).all()
