"""Pictures of the layouts of §6: python benchmarks/layouts.py [FOLDER] [--seed N]

Writes a picture for each robot, layouts.png, wam_layouts.png and reem_layouts.png, with a panel for each of
its layouts a to f as an onlooker sees the table. Those of docs/pictures have the seed of the scenes, 1. About
ten seconds.
"""

from __future__ import annotations

import argparse
from contextlib import closing
from pathlib import Path

import cv2
import numpy as np

from cleancli.array_types import Image
from cleancli.execution.seeds import Stream, derived
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.recording.pictures import write_png
from cleancli.scene.check import load_scene
from cleancli.world.table import PybulletTable

PREFIXES = ("", "wam_", "reem_")
LAYOUTS = "abcdef"
ACROSS = 3
"""Panels in a row."""

SIZE = 480, 360
"""Pixels of a panel."""


def panel(name: str, seed: int) -> Image:
    """The table of a shipped scene, with the scene's name above it."""
    scene = load_scene(read_source(find(name, "problems")))
    with closing(PybulletTable(scene, derived(seed, Stream.WORLD))) as table:
        picture = table.picture(*SIZE)
    where, colour = (8, 22), (40, 40, 40)
    cv2.putText(picture, name, where, cv2.FONT_HERSHEY_SIMPLEX, 0.6, colour, 1, cv2.LINE_AA)
    return picture


def sheet(prefix: str, seed: int) -> Image:
    """All layouts for one robot, in rows."""
    panels = [panel(f"{prefix}layout_{letter}", seed) for letter in LAYOUTS]
    rows = [np.hstack(panels[first : first + ACROSS]) for first in range(0, len(panels), ACROSS)]
    return np.vstack(rows)


def main() -> None:
    """Write the pictures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, nargs="?", default=Path("docs/pictures"))
    parser.add_argument("--seed", type=int, default=1, help="where dirt lies")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for prefix in PREFIXES:
        write_png(options.folder / f"{prefix}layouts.png", sheet(prefix, options.seed))


if __name__ == "__main__":
    main()
