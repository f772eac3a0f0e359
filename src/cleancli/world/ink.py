"""Ink on the surface: a grid of cells that the rag rubs away where it touches, pass by pass.

Where the rag touches, and how hard, the engine tells: a stroke that comes down too high leaves the ink alone.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from cleancli.array_types import Bools, Floats, Singles
from cleancli.scene.model import Ink, Scene, Surface
from cleancli.world import constants as par
from cleancli.world.physics import Engine


class InkLayer:
    """How much ink each cell of the surface holds, 0 to 1: `amount` (rows, columns), from the south-west.

    `flaps` (n, 3) is where the rag's flaps were after the control period before, None before the first.
    """

    def __init__(self, scene: Scene) -> None:
        self.amount = drawn(scene)
        lines = [dirt for dirt in scene.dirt if isinstance(dirt, Ink)]
        self._colours = [line.colour or par.INK_COLOUR for line in lines]
        # The line whose ink is on each cell, by number: of those that cross, the last one drawn.
        self._lines = np.zeros(self.amount.shape, np.int64)
        for number, line in enumerate(lines):
            self._lines[_covered(line, scene.surface)] = number
        self._all = max(float(self.amount.sum()), 1.0)
        self._surface = scene.surface
        self._half = scene.rag.width / max(1, round(scene.rag.width / scene.rag.grasp.flap)) / 2
        self.flaps: Floats | None = None

    def rub(self, engine: Engine, top: int, flaps: Floats) -> None:
        """Take ink away after a control period; `top` is the table's body, `flaps` (n, 3) their middles."""
        moved = 0.0 if self.flaps is None else float(np.linalg.norm((flaps - self.flaps).mean(axis=0)[:2]))
        self.flaps = flaps
        pressed: dict[tuple[int, int], list[tuple[tuple[float, float, float], float]]] = {}
        for contact in engine.getContactPoints(bodyA=top):
            body, link, place, force = contact[2], contact[4], contact[5], contact[9]
            if link >= 0:  # particles are bodies without links
                pressed.setdefault((body, link), []).append((place, force))
        for (body, link), points in sorted(pressed.items()):
            turn = np.array(engine.getMatrixFromQuaternion(engine.getLinkState(body, link)[1])).reshape(3, 3)
            middle = np.mean([place[:2] for place, _ in points], axis=0)
            force = sum(force for _, force in points)
            self._fade(middle, turn[:2, 1], moved * min(1.0, force / par.INK_FORCE))

    def left(self) -> float:
        """The share of the ink that is still there."""
        return float(self.amount.sum()) / self._all

    def places(self) -> Floats:
        """(n, 3) x, y and amount of the cells whose ink can be seen."""
        rows, columns = np.nonzero(self.amount >= par.INK_SEEN)
        x, y = _middles(self._surface)
        return np.column_stack((x[columns], y[rows], self.amount[rows, columns]))

    def share_at(self, x: Floats, y: Floats) -> Singles:
        """How much ink covers places of the surface, by their coordinates of any one shape; 0 off it."""
        rows, columns = self.amount.shape
        column = np.floor((x + self._surface.width / 2) / par.INK_CELL)
        row = np.floor((y + self._surface.depth / 2) / par.INK_CELL)
        on = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        found = np.zeros(np.shape(x), np.float32)
        found[on] = self.amount[row[on].astype(int), column[on].astype(int)]
        return found

    def colour_at(self, x: Floats, y: Floats) -> Floats:
        """(n, 3) red, green and blue of the ink at places with ink on them."""
        row, column = (
            np.floor((place + side / 2) / par.INK_CELL).astype(int)
            for place, side in ((y, self._surface.depth), (x, self._surface.width))
        )
        return np.asarray(np.array(self._colours, np.float64)[self._lines[row, column]])

    def _fade(self, middle: Floats, along: Floats, moved: float) -> None:
        """Fade what lies below a flap's lower edge, which runs along a direction through `middle`."""
        along = along / np.linalg.norm(along)
        half = self._half
        x, y = _middles(self._surface)
        columns = slice(*np.searchsorted(x, (middle[0] - half, middle[0] + half)))
        rows = slice(*np.searchsorted(y, (middle[1] - half, middle[1] + half)))
        east, north = np.meshgrid(x[columns] - middle[0], y[rows] - middle[1])
        beside, ahead = east * along[0] + north * along[1], north * along[0] - east * along[1]
        below = (np.abs(beside) <= half) & (np.abs(ahead) <= par.INK_BAND / 2)
        self.amount[rows, columns][below] *= np.float32((1 - par.INK_PASS) ** (moved / par.INK_BAND))


def drawn(scene: Scene) -> Singles:
    """(rows, columns) 1 where a line of ink covers a cell's middle, 0 elsewhere."""
    x, y = _middles(scene.surface)
    inked = np.zeros((len(y), len(x)), np.bool_)
    for ink in scene.dirt:
        if isinstance(ink, Ink):
            inked |= _covered(ink, scene.surface)
    return inked.astype(np.float32)


def _covered(ink: Ink, surface: Surface) -> Bools:
    """(rows, columns) whether a line covers a cell's middle."""
    x, y = np.meshgrid(*_middles(surface))
    inked = np.zeros(x.shape, np.bool_)
    for begin, end in pairwise((*ink.along, ink.along[-1])):
        inked |= _distances(x, y, begin, end) <= ink.width / 2
    return inked


def _distances(x: Floats, y: Floats, begin: tuple[float, float], end: tuple[float, float]) -> Floats:
    """From places to a straight stretch."""
    step = np.subtract(end, begin)
    share = np.clip(((x - begin[0]) * step[0] + (y - begin[1]) * step[1]) / max(step @ step, 1e-12), 0, 1)
    away = np.hypot(x - begin[0] - share * step[0], y - begin[1] - share * step[1])
    return np.asarray(away, np.float64)


def _middles(surface: Surface) -> tuple[Floats, Floats]:
    """x and y of the middles of columns and rows."""
    columns, rows = (int(np.ceil(side / par.INK_CELL - 1e-9)) for side in (surface.width, surface.depth))
    x = (np.arange(columns, dtype=np.float64) + 0.5) * par.INK_CELL - surface.width / 2
    return x, (np.arange(rows, dtype=np.float64) + 0.5) * par.INK_CELL - surface.depth / 2
