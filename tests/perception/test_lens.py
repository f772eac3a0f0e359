"""Pictures are rectified as the models of distortion say, and lenses that are not known are refused."""

from __future__ import annotations

import numpy as np
import pytest

from cleancli.perception.lens import Lens, UnknownLens, lens, rectified

HEIGHT, WIDTH = 60, 80


def _seen_at(through: Lens, column: float, row: float) -> tuple[float, float]:
    """Where the lens shows what a pinhole camera of its first focal length shows at a pixel: Brown's
    model, with the rational radial part where there are eight coefficients."""
    k1, k2, p1, p2, k3, k4, k5, k6 = (*through.coefficients, *[0.0] * (8 - len(through.coefficients)))
    x = (column - through.centre[0]) / through.focal[0]
    y = (row - through.centre[1]) / through.focal[0]
    r2 = x * x + y * y
    radial = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
    bent = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    bent_too = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return bent * through.focal[0] + through.centre[0], bent_too * through.focal[1] + through.centre[1]


@pytest.mark.parametrize(
    "through",
    [
        lens((90.0, 92.0), (41.0, 29.0)),
        lens((90.0, 92.0), (41.0, 29.0), "plumb_bob", (-0.2, 0.05, 0.004, -0.003, 0.01)),
        lens((90.0, 90.0), (41.0, 29.0), "plumb_bob", (0.1, -0.02, 0.001, 0.002)),
        lens(
            (90.0, 88.0),
            (39.0, 31.0),
            "rational_polynomial",
            (0.4, -0.1, 0.001, -0.001, 0.02, 0.3, -0.05, 0.01),
        ),
    ],
)
def test_each_pixel_is_taken_from_where_the_lens_shows_it(through: Lens) -> None:
    columns, rows = np.meshgrid(np.arange(WIDTH, dtype=np.float32), np.arange(HEIGHT, dtype=np.float32))
    colour = np.stack([columns * 2, rows * 2, np.zeros_like(rows)], axis=2).astype(np.uint8)
    depth = 1 + columns + 100 * rows
    straight, straight_depth = rectified(colour, depth, through)
    compared = 0
    for row in range(0, HEIGHT, 3):
        for column in range(0, WIDTH, 3):
            at, down = _seen_at(through, column, row)
            if 0 <= at <= WIDTH - 1 and 0 <= down <= HEIGHT - 1:
                compared += 1
                assert straight[row, column, 0] == pytest.approx(2 * at, abs=0.6)
                assert straight[row, column, 1] == pytest.approx(2 * down, abs=0.6)
                back = straight_depth[row, column] - 1
                assert back % 100 == pytest.approx(at, abs=0.55)
                assert back // 100 == pytest.approx(down, abs=0.55)
            elif at < -1 or down < -1 or at > WIDTH or down > HEIGHT:
                assert straight_depth[row, column] == 0
    assert compared > 300


def test_a_pinhole_camera_is_left_as_it_is() -> None:
    colour, depth = np.zeros((HEIGHT, WIDTH, 3), np.uint8), np.ones((HEIGHT, WIDTH), np.float32)
    same = rectified(colour, depth, lens((90.0, 90.0), (40.0, 30.0), "plumb_bob", (0.0,) * 5))
    assert same[0] is colour
    assert same[1] is depth


@pytest.mark.parametrize(
    ("model", "coefficients", "said"),
    [
        ("equidistant", (0.1,) * 4, "`equidistant` is not known, only `plumb_bob` or `rational_polynomial`"),
        ("", (0.1,) * 5, "`` is not known"),
        ("plumb_bob", (0.1,) * 3, "`plumb_bob` has 4 or 5 coefficients, not 3"),
        ("rational_polynomial", (0.1,) * 5, "8 coefficients, not 5"),
        ("plumb_bob", (float("nan"),) * 5, "no number of the lens above"),
        ("plumb_bob", (1e300,) * 5, "no number of the lens above"),
    ],
)
def test_a_distortion_is_used_or_refused(model: str, coefficients: tuple[float, ...], said: str) -> None:
    with pytest.raises(UnknownLens, match=said):
        lens((90.0, 90.0), (40.0, 30.0), model, coefficients)
