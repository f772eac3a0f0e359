"""Every picture of README and docs/: python benchmarks/pictures.py [FOLDER] [--seed N] [--only NAME ...]

Each is a picture that the program itself makes, of a run, a plan or a page, so that whoever changes how the
program draws makes them all anew with this command. Writes into FOLDER, which is docs/pictures unless said
otherwise. `--seed` is that of all randomness, 1 for the pictures in docs/pictures; the blocks have a seed of
their own (benchmarks/piles.py). The picture of a report takes a browser (Chromium or Chrome).

Figures of studies are made by `cleancli experiment --report`. Two minutes of CPU; `--quick` makes only a few,
in some seconds, and `--only` those named.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager, redirect_stdout
from dataclasses import replace
from functools import partial
from io import StringIO
from pathlib import Path

import av
import cv2
import learner
import numpy as np
import piles
from PIL import Image as Pillow
from playwright.sync_api import sync_playwright

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from cleancli.array_types import Image
from cleancli.cli.main import run
from cleancli.execution.seeds import Stream, derived
from cleancli.language.find import find
from cleancli.language.load import read_source
from cleancli.recording.pictures import write_png
from cleancli.recording.video import VIDEO_RATE
from cleancli.scene.check import load_scene
from cleancli.scene.model import Scene
from cleancli.world.table import PybulletTable
from support import browsers

LAYOUTS = "abcdef"
ACROSS = 3
"""Panels in a row of a sheet of layouts."""

PANEL = 480, 360
"""Pixels of a panel."""

LARGER = 5
"""Pixels across which a particle is drawn on a sheet; it would be one or two."""

FILM_WIDTH = 720
FILM_EVERY = 3
"""One of so many pictures of the video is in the film."""

FILM_BYTES = 1_400_000
WIDEST = 1280
"""Pixels of a picture of a run; larger ones are made smaller."""

Maker = Callable[[Path, int], None]
"""Writes a picture into a file, with a seed."""


def main() -> None:
    """Write the pictures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, nargs="?", default=Path("docs/pictures"))
    parser.add_argument("--seed", type=int, default=1, help="where dirt lies, and all else that is drawn")
    parser.add_argument("--only", nargs="+", choices=PICTURES, metavar="NAME", help=", ".join(PICTURES))
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for name in options.only or (QUICK if options.quick else PICTURES):
        PICTURES[name](options.folder.resolve() / name, options.seed)
        print(name)


def sheet(prefix: str, path: Path, seed: int) -> None:
    """All layouts for one robot, in rows."""
    panels = [panel(f"{prefix}layout_{letter}", seed) for letter in LAYOUTS]
    rows = [np.hstack(panels[first : first + ACROSS]) for first in range(0, len(panels), ACROSS)]
    write_png(path, np.vstack(rows))


def panel(name: str, seed: int) -> Image:
    """The table of a shipped scene with its dirt drawn larger, and the scene's name above it."""
    scene = load_scene(read_source(find(name, "problems")))
    picture, clean = _table(scene, seed), _table(replace(scene, dirt=()), seed)
    dirt = (picture != clean).any(axis=2)
    around = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (LARGER, LARGER))
    larger = cv2.dilate(dirt.astype(np.uint8), around).astype(bool)
    picture[larger] = np.median(picture[dirt], axis=0) if dirt.any() else 0
    where, colour = (8, 22), (40, 40, 40)
    cv2.putText(picture, name, where, cv2.FONT_HERSHEY_SIMPLEX, 0.6, colour, 1, cv2.LINE_AA)
    return picture


def _table(scene: Scene, seed: int) -> Image:
    with closing(PybulletTable(scene, derived(seed, Stream.WORLD))) as table:
        return table.picture(*PANEL)


def blocks(path: Path, seed: int) -> None:
    """The table of the sweeping task before and after; its seed is that of its table in the documents."""
    piles.episode("plan-2", 100 + seed, piles.MOST_PUSHES, path)


def step(domain: str, scene: str, number: int, path: Path, seed: int) -> None:
    """The picture of a run's action: what the camera saw before it, and the room at its end."""
    with carried_out(domain, scene, seed, "--no-video", "--max-actions", str(number)) as folder:
        _write_webp(path, Pillow.open(folder / f"step-{number:03d}.png"))


def film(domain: str, scene: str, path: Path, seed: int) -> None:
    """The video of a run as a picture that moves."""
    with carried_out(domain, scene, seed) as folder:
        animate(folder / "video.mp4", path)


def animate(video: Path, path: Path) -> None:
    """A video as an animated WebP for pages, which does not take long to load."""
    with av.open(str(video)) as container:
        pictures = [
            Pillow.fromarray(frame.to_ndarray(format="rgb24")) for frame in container.decode(video=0)
        ][::FILM_EVERY]
    height = round(FILM_WIDTH * pictures[0].height / pictures[0].width)
    first, *others = [picture.resize((FILM_WIDTH, height), Pillow.Resampling.LANCZOS) for picture in pictures]
    for quality in (80, 60, 40, 20):
        first.save(
            path,
            save_all=True,
            append_images=others,
            duration=round(1000 * FILM_EVERY / VIDEO_RATE),
            loop=0,
            quality=quality,
            method=6,
        )
        if path.stat().st_size <= FILM_BYTES:
            break


def drawn(words: str, path: Path, seed: int) -> None:
    """What a command of the program draws into the file that its last option names."""
    with _elsewhere():
        _command(*words.split(), "drawn.png", "--seed", str(seed))
        picture = Pillow.open("drawn.png")
        if path.suffix == ".webp":
            _write_webp(path, picture)
        else:
            picture.save(path, optimize=True)


def page(path: Path, seed: int) -> None:
    """The top of a run's page, as a browser shows it."""
    browser_path = browsers.found()
    if browser_path is None:
        raise SystemExit(f"{path.name}: no browser here, of {', '.join(browsers.NAMES)}")
    with carried_out("cleaning", "two_groups", seed) as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=browser_path, args=["--no-sandbox"])
        shown = browser.new_page(viewport={"width": 1000, "height": WIDEST})
        shown.goto((folder.resolve() / "report.html").as_uri(), wait_until="load")
        shown.screenshot(path="page.png")
        browser.close()
        _write_webp(path, Pillow.open("page.png"))


@contextmanager
def carried_out(domain: str, scene: str, seed: int, *options: str) -> Iterator[Path]:
    """The folder of a run of `cleancli execute`, which goes when it is no longer needed."""
    with _elsewhere():
        _command("execute", domain, scene, "--seed", str(seed), "--quiet", *options, also=3)
        yield next(Path("runs").iterdir())


@contextmanager
def _elsewhere() -> Iterator[None]:
    """In a folder of its own."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def _command(*words: str, also: int = 0) -> None:
    """Carry out a command of the program. Raises SystemExit where it ends with a code above 0 and `also`."""
    with redirect_stdout(StringIO()):
        code = run(list(words))
    if code not in (0, also):
        raise SystemExit(f"cleancli {' '.join(words)}: exit code {code}")


def _write_webp(path: Path, picture: Pillow.Image) -> None:
    picture.thumbnail((WIDEST, WIDEST), Pillow.Resampling.LANCZOS)
    picture.convert("RGB").save(path, quality=82, method=6)


PICTURES: Mapping[str, Maker] = {
    "at_work.webp": partial(film, "cleaning", "wam_groups"),
    "two_groups.webp": partial(step, "cleaning", "two_groups", 1),
    "wam_groups.webp": partial(step, "cleaning", "wam_groups", 1),
    "wam_bow.webp": partial(step, "cleaning", "wam_bow", 1),
    "rim.webp": partial(step, "cleaning", "rim", 1),
    "scattered_40.webp": partial(step, "sweeping", "scattered_40", 1),
    "crumbs.webp": partial(step, "sweeping", "crumbs", 1),
    "reem_pick_up.webp": partial(step, "sweeping", "reem_pick_up", 1),
    "whiteboard.webp": partial(step, "wiping_ink", "whiteboard", 2),
    "piles.webp": partial(step, "piles", "piles", 4),
    "piles.png": blocks,
    "layouts.png": partial(sheet, ""),
    "wam_layouts.png": partial(sheet, "wam_"),
    "reem_layouts.png": partial(sheet, "reem_"),
    "plan.png": partial(drawn, "plan cleaning three_areas --plot"),
    "steps.webp": partial(drawn, "perceive two_groups --out"),
    "push.png": partial(drawn, "act two_groups moveToContainerFast --repeat 10 --plot"),
    "report.webp": page,
    "learner.png": lambda path, _: learner.draw(path, learner.read(learner.ROWS)),
}
"""By the name of its file: what makes it."""

QUICK = ("plan.png", "two_groups.webp")

if __name__ == "__main__":
    main()
