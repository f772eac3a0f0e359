"""The site of the documentation: built without a warning, with all pages, and whole in narrow windows."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

from support.browsers import opened_browser

ROOT = Path(__file__).parent.parent
pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("myst_parser") is None, reason="the extra `docs` is not installed"
)


def built(pages: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Of the command that CONTRIBUTING.md tells, where warnings are errors."""
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-d", str(folder / "cache")]
    return subprocess.run(
        [*command, str(pages), str(folder / "site")], capture_output=True, text=True, timeout=300
    )


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """All of it, built once."""
    folder = tmp_path_factory.mktemp("docs")
    ended = built(ROOT / "docs", folder)
    assert (ended.returncode, ended.stderr) == (0, "")
    return folder / "site"


def test_every_page_is_there_and_can_be_searched(site: Path) -> None:
    pages = [path.relative_to(ROOT / "docs") for path in (ROOT / "docs").rglob("*.md")]
    assert len(pages) > 40
    assert all((site / page.with_suffix(".html")).is_file() for page in pages)
    assert "gallery" in (site / "searchindex.js").read_text(encoding="utf-8")


def test_the_front_page_is_the_readme_without_what_is_about_the_repository(site: Path) -> None:
    page = (site / "index.html").read_text(encoding="utf-8")
    assert "at_work.webp" in page
    assert "Install it, and clean a table" in page
    assert "test command" not in page
    assert 'href="language.html"' in page


def test_a_value_and_its_error_stay_on_one_line(site: Path) -> None:
    page = (site / "measurements" / "execution.html").read_text(encoding="utf-8")
    assert "99.6\N{NO-BREAK SPACE}±\N{NO-BREAK SPACE}0.4" in page


def test_texts_of_the_language_are_coloured(site: Path) -> None:
    page = (site / "language.html").read_text(encoding="utf-8")
    assert re.search('<span class="kd">domain</span>.*<span class="nc">cleaning</span>', page)
    assert '<span class="k">forall</span>' in page


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("[gone](gone.md)", "gone.md"),
        ("[there](other.md#nowhere)", "nowhere"),
        ("![no picture](none.png)", "none.png"),
        ("```nonsense\nx\n```", "nonsense"),
    ],
)
def test_what_is_dead_or_unknown_is_an_error(written: str, told: str, tmp_path: Path) -> None:
    pages = tmp_path / "pages"
    pages.mkdir()
    (pages / "conf.py").write_text((ROOT / "docs" / "conf.py").read_text())
    (pages / "gallery.md").write_text("# Page\n\n[whole](other.md#heading)\n")
    (pages / "other.md").write_text("# Other\n\n## Heading\n")
    (pages / "index.md").write_text(f"# Front\n\n{written}\n")
    ended = built(pages, tmp_path)
    assert ended.returncode == 1
    assert re.search(rf"index.md:\d+: .*{re.escape(told)}", ended.stderr), ended.stderr


CUT = """
width => [...document.querySelectorAll("article :is(p, li, img, h1, h2, h3)")]
    .filter(e => !e.closest(".table-wrapper, pre") && e.getBoundingClientRect().right > width + 1)
    .map(e => e.textContent.slice(0, 60))
"""
"""Parts of a page that reach beyond the window; tables and code scroll by themselves."""


def test_nothing_is_wider_than_the_window(site: Path) -> None:
    with opened_browser() as browser:
        page = browser.new_page()
        for path in sorted(site.rglob("*.html")):
            page.goto(path.as_uri(), wait_until="load")
            for width in (400, 1280):
                page.set_viewport_size({"width": width, "height": 900})
                assert page.evaluate("document.documentElement.scrollWidth") <= width, path.name
                assert page.evaluate(CUT, width) == [], (path.name, width)
