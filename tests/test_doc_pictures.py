"""Pictures of the documents: all are made by one command, small enough for a page, and used."""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from PIL import Image as Pillow

from cleancli.recording.video import Video

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "pictures"


@pytest.fixture
def pictures(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module("pictures")


def test_each_picture_has_its_maker_and_a_page_that_shows_it(pictures: ModuleType) -> None:
    assert {path.name for path in FOLDER.iterdir() if path.is_file()} == set(pictures.PICTURES)
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    shown = {
        Path(name).name
        for page in pages
        for name in re.findall(r"!\[[^]]*\]\(([^)]+)\)", page.read_text("utf-8"))
    }
    assert set(pictures.PICTURES) <= shown


def test_the_film_moves_is_wide_enough_and_not_large() -> None:
    path = FOLDER / "at_work.webp"
    with Pillow.open(path) as film:
        assert getattr(film, "n_frames", 1) > 10
        assert film.width >= 640
    assert path.stat().st_size < 1_500_000


def test_a_video_becomes_a_film_as_quick_as_the_video(pictures: ModuleType, tmp_path: Path) -> None:
    video = Video(tmp_path / "video.mp4")
    for number in range(12):
        video.add(np.full((96, 128, 3), 20 * number, np.uint8), 0.2 * number, "an action", "an account")
    video.close()
    pictures.animate(tmp_path / "video.mp4", tmp_path / "film.webp")
    with Pillow.open(tmp_path / "film.webp") as film:
        assert film.width == pictures.FILM_WIDTH
        assert getattr(film, "n_frames", 1) == 12 / pictures.FILM_EVERY
        film.load()
        assert film.info["duration"] == pytest.approx(1000 * pictures.FILM_EVERY / 20, abs=1)


def test_particles_of_a_layout_are_drawn_larger_and_nothing_else_is(pictures: ModuleType) -> None:
    """Only what differs from the same table without dirt, and some pixels around it."""
    name = "layout_a"
    scene = pictures.load_scene(pictures.read_source(pictures.find(name, "problems")))
    small, panel = pictures._table(scene, 1), pictures.panel(name, 1)
    below = slice(40, None)  # the title
    changed = (small != panel).any(axis=2)[below]
    assert 50 < changed.sum() < 0.02 * changed.size
    clean = pictures._table(pictures.replace(scene, dirt=()), 1)
    dirt = (small != clean).any(axis=2)[below]
    assert (panel[below] != clean[below]).any(axis=2).sum() > 3 * dirt.sum() > 0


def test_one_command_makes_them(
    pictures: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["pictures.py", str(tmp_path), "--quick"])
    pictures.main()
    assert capsys.readouterr().out.split() == list(pictures.QUICK)
    for name in pictures.QUICK:
        with Pillow.open(tmp_path / name) as made:
            assert made.width >= 640


def test_the_gallery_shows_the_runs_of_its_commands(pictures: ModuleType) -> None:
    """A picture is of the command below it, for which the run folder has an own place."""
    sections = (ROOT / "docs" / "gallery.md").read_text("utf-8").split("\n## ")[1:]
    told: dict[str, str] = {}
    for section in sections:
        shown = re.findall(r"\(pictures/([^)]+)\)", section)
        commands = re.findall(r"^    cleancli (.*)$", section, re.M)
        assert len(shown) == len(commands) <= 1, section
        told |= dict(zip(shown, commands, strict=True))
    for name, command in told.items():
        made = pictures.PICTURES[name]
        if made.func is pictures.step:
            domain, scene, _ = made.args
            assert command == f"execute {domain} {scene}"
    steps = {name for name, made in pictures.PICTURES.items() if getattr(made, "func", None) is pictures.step}
    assert steps <= told.keys()
