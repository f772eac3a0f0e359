"""Lines and bands of a plot, as points in a box 1000 wide and 100 high; and the marks of its axes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

WIDTH, HEIGHT = 1000.0, 100.0

TICKS = 8
"""At most about so many along an axis."""

FINEST = 500
"""Steps of a line that are told apart. Chosen: a page shows it about twice as many pixels wide."""

Marks = tuple[tuple[float, float], ...]
"""Numbers, each with its place along the axis in percent."""


@dataclass(frozen=True, slots=True)
class Step:
    """From `start` on, something is so much, and between `low` and `high`."""

    start: float
    value: float
    low: float
    high: float


def ticks(longest: float, most: int = TICKS, least: float = 0.0) -> tuple[float, ...]:
    """Round numbers from 0 on, at most about so many and at least so far apart, for an axis that ends at the
    longest."""
    steps = (factor * 10.0**power for power in range(-3, 7) for factor in (1, 2, 5))
    step = next((step for step in steps if longest / step <= most and step >= least), longest)
    return tuple(step * number for number in range(int(longest / step) + 1))


def marks(longest: float, most: int = TICKS, least: float = 0.0) -> Marks:
    """Those of an axis from 0 to `longest`."""
    return tuple((tick, 100 * tick / longest) for tick in ticks(longest, most, least)) if longest else ()


def numbered(count: int) -> Marks:
    """Those of an axis with a column for each number from 1 on."""
    step = max(1, round(ticks(count)[1]) if count > TICKS else 1)
    numbers = dict.fromkeys((1, *range(step, count + 1, step)))
    return tuple((number, 100 * (number - 0.5) / count) for number in numbers)


def line(values: Sequence[float], top: float) -> str:
    """A value for each column of an axis, joined; a single one is a dot."""
    columns = len(values)
    values = values if columns > 1 else [*values, *values]
    return _points((WIDTH * (i % columns + 0.5) / columns, _y(value, top)) for i, value in enumerate(values))


def stairs(steps: Sequence[Step], end: float) -> str:
    """The values, each until the next begins; probabilities, up to 1."""
    points = []
    for step, until in _stretches(steps, end):
        points += [(WIDTH * step.start / end, _y(step.value, 1)), (WIDTH * until / end, _y(step.value, 1))]
    return _points(points)


def band(steps: Sequence[Step], end: float) -> str:
    """What lies between the lows and the highs."""
    above, below = [], []
    for step, until in _stretches(steps, end):
        for x in (WIDTH * step.start / end, WIDTH * until / end):
            above.append((x, _y(step.high, 1)))
            below.append((x, _y(step.low, 1)))
    return _points([*above, *reversed(below)])


def thinned(steps: Sequence[Step], end: float) -> tuple[Step, ...]:
    """The last of those that a page would show in the same place."""
    return tuple({round(FINEST * step.start / end): step for step in steps}.values())


def _stretches(steps: Sequence[Step], end: float) -> list[tuple[Step, float]]:
    ends = [*(step.start for step in steps[1:]), end]
    return list(zip(steps, ends, strict=True))


def _y(value: float, top: float) -> float:
    return HEIGHT * (1 - value / top) if top else HEIGHT


def _points(points: Iterable[tuple[float, float]]) -> str:
    return " ".join(f"{x:z.1f},{y:z.1f}" for x, y in points)
