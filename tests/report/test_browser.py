"""The page as a browser shows it: no error, every picture there, and the chart says what run.json says."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright
from run_folders import RECORDS, write_run

from cleancli.cli.main import run

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """A browser of this machine; where there is none the tests are skipped, but not in CI, which has one."""
    found = next((path for path in map(shutil.which, NAMES) if path), None)
    if found is None:
        assert not os.environ.get("CI"), "CI installs a browser (.ci/run)"
        pytest.skip(f"no browser here, of {', '.join(NAMES)}: install one to have the pages tested in it")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield browser
        browser.close()


def opened(browser: Browser, path: Path, width: int = 1280, scheme: str = "light") -> tuple[Page, list[str]]:
    """The page, and everything that went wrong or was asked for while it loaded."""
    page = browser.new_page(
        viewport={"width": width, "height": 800}, color_scheme="dark" if scheme == "dark" else "light"
    )
    wrong: list[str] = []
    page.on("console", lambda message: wrong.append(f"console {message.type}: {message.text}"))
    page.on("pageerror", lambda error: wrong.append(f"error: {error}"))
    page.on("requestfailed", lambda request: wrong.append(f"failed: {request.url[:80]}"))
    page.on(
        "request",
        lambda r: None if r.url.startswith(("data:", path.as_uri())) else wrong.append(f"asked for {r.url}"),
    )
    page.goto(path.as_uri(), wait_until="load")
    return page, wrong


def test_a_page_without_errors_whose_pictures_load(browser: Browser, run_folder: Path) -> None:
    assert run(["report", str(run_folder)]) == 0
    page, wrong = opened(browser, run_folder / "report.html")
    widths = page.evaluate("[...document.images].map(i => i.complete ? i.naturalWidth : 0)")
    assert widths == [1200] * 4
    assert page.locator("section.step").count() == 4
    assert page.locator(".outcome.happened").count() == 1
    assert wrong == []


def test_the_chart_says_what_run_json_says(browser: Browser, run_folder: Path) -> None:
    assert run(["report", str(run_folder)]) == 0
    page, _ = opened(browser, run_folder / "report.html")
    told = json.loads((run_folder / "run.json").read_text(encoding="utf-8"))["episode"]["seconds"]
    rows = page.locator("#account + .card tr[data-kind]").all()
    shown = {str(row.get_attribute("data-kind")).replace(" ", "_"): row for row in rows}
    assert shown.keys() == told.keys()
    for kind, row in shown.items():
        assert float(row.get_attribute("data-seconds") or "nan") == told[kind]
        assert row.locator("td").nth(2).inner_text() == f"{told[kind]:.2f}"
        if kind != "total":
            track, bar = row.locator(".track"), row.locator(".track span")
            width, full = (part.evaluate("e => e.getBoundingClientRect().width") for part in (bar, track))
            assert width / full == pytest.approx(told[kind] / told["total"], abs=2e-3)


@pytest.mark.parametrize("width", [320, 600, 1600])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_sticks_out(browser: Browser, width: int, scheme: str, run_folder: Path) -> None:
    assert run(["report", str(run_folder)]) == 0
    page, _ = opened(browser, run_folder / "report.html", width, scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    ground, ink = (
        page.evaluate(f"getComputedStyle(document.body).{what}") for what in ("backgroundColor", "color")
    )
    assert (brightness(ground) > brightness(ink)) == (scheme == "light")


def test_runs_side_by_side(browser: Browser, tmp_path: Path) -> None:
    one = write_run(tmp_path / "one", pictures=0)
    two = write_run(tmp_path / "two", RECORDS[:8], 0, episode=None, truth=None)
    assert run(["report", str(one), str(two), "--html", str(tmp_path / "both.html")]) == 0
    page, wrong = opened(browser, tmp_path / "both.html", 600)
    assert wrong == []
    assert page.locator("tr[data-run]").count() == 2
    assert page.evaluate("document.documentElement.scrollWidth") <= 600


def brightness(colour: str) -> int:
    """Of a computed colour like `rgb(1, 2, 3)`."""
    return sum(int(part) for part in colour[colour.index("(") + 1 : -1].split(",")[:3])
