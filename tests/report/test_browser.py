"""The page as a browser shows it: no error, every picture there, and the chart says what run.json says."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from itertools import combinations, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from cleancli.cli.main import run
from cleancli.recording.video import VIDEO_INTERVAL, Video
from support.browsers import opened_browser
from support.run_folders import LAMPS, RECORDS, write_run, write_series


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with opened_browser() as browser:
        yield browser


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


def test_a_page_without_errors_whose_pictures_load(browser: Browser, tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(run_folder)]) == 0
    page, wrong = opened(browser, run_folder / "report.html")
    widths = page.evaluate("[...document.images].map(i => i.complete ? i.naturalWidth : 0)")
    assert widths == [1200] * 4
    assert page.locator("section.step").count() == 4
    assert page.locator(".outcome.happened").count() == 1
    assert wrong == []


def test_the_chart_says_what_run_json_says(browser: Browser, tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
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
@pytest.mark.parametrize("write", [write_run, write_series])
def test_nothing_sticks_out(
    browser: Browser, width: int, scheme: str, write: Callable[[Path], Path], tmp_path: Path
) -> None:
    folder = write(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(folder)]) == 0
    page, wrong = opened(browser, folder / "report.html", width, scheme)
    assert wrong == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    ground, ink = (
        page.evaluate(f"getComputedStyle(document.body).{what}") for what in ("backgroundColor", "color")
    )
    assert (brightness(ground) > brightness(ink)) == (scheme == "light")


@pytest.mark.parametrize("width", [400, 1280])
def test_no_table_of_a_series_needs_to_be_scrolled(browser: Browser, width: int, tmp_path: Path) -> None:
    """docs/report.md."""
    folder = write_series(tmp_path / "evening-seed1-series-001")
    assert run(["report", str(folder)]) == 0
    page, _ = opened(browser, folder / "report.html", width)
    assert page.locator(".scroll").count() > 1
    beyond = page.evaluate(
        "[...document.querySelectorAll('.scroll')].map(e => e.scrollWidth - e.clientWidth)"
    )
    assert not any(beyond)


def test_the_columns_of_a_series_are_as_high_as_its_seconds(browser: Browser, tmp_path: Path) -> None:
    folder = write_series(tmp_path / "evening")
    assert run(["report", str(folder)]) == 0
    page, wrong = opened(browser, folder / "report.html")
    assert wrong == []
    box = page.locator(".stacks").evaluate("e => e.getBoundingClientRect().height")
    for column, kinds in zip(
        page.locator(".stacks a").all(), ((1, 20, 6), (1, 20, 4), (1, 10, 2)), strict=True
    ):
        heights = [
            bar.evaluate("e => e.getBoundingClientRect().height") for bar in column.locator("span").all()
        ]
        assert heights == pytest.approx([box * seconds / 27 for seconds in kinds], abs=0.5)
    line = page.locator("[data-rule=pressed] polyline").first
    assert line.evaluate("e => getComputedStyle(e).stroke") not in ("none", "rgb(0, 0, 0)")


LONG: dict[str, Any] = {
    "episode": {"reason": "r" * 300, "clean": False, "actions": 3, "seconds": {"k" * 60: 3.0, "total": 3.0}},
    "options": {"strategy": "s" * 90, "planner": "p" * 90, "o" * 80: "v" * 120},
    "versions": {"l" * 70: "9" * 90},
    "files": [
        {"path": "/a_folder_without_any_blank" * 9 + "/cleaning.nid", "sha256": "a" * 64},
        {"path": "/another" * 30 + "/" + "x" * 120 + ".nid", "sha256": "b" * 64},
    ],
}
"""Words, names and paths that have no place to be broken at."""


@pytest.mark.parametrize("width", [320, 414, 768, 1024, 1600])
def test_long_names_stay_within_the_window_and_their_box(
    browser: Browser, width: int, tmp_path: Path
) -> None:
    one, two = write_run(tmp_path / ("n" * 200), pictures=1, **LONG), write_run(tmp_path / "two", pictures=0)
    domain = LAMPS.replace("hot(", f"{'h' * 100}(")
    series = write_series(tmp_path / ("s" * 200), domain, options={"known": 3, **LONG["options"]})
    assert run(["report", str(one)]) == 0
    assert run(["report", str(one), str(two), "--html", str(tmp_path / "both.html")]) == 0
    assert run(["report", str(series)]) == 0
    for path in (one / "report.html", tmp_path / "both.html", series / "report.html"):
        page, _ = opened(browser, path, width)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        out = page.evaluate(
            """[...document.querySelectorAll('.card')].flatMap(card => [...card.querySelectorAll('*')].filter(
              e => !e.closest('.scroll, .curve, .time, .axis, .axis-x, svg')
                && e.getBoundingClientRect().right > card.getBoundingClientRect().right + 1
            ).map(e => e.outerHTML.slice(0, 80)))"""
        )
        assert out == []
        page.close()


def write_video(path: Path) -> None:
    video = Video(path)
    for number in range(60):
        video.add(np.full((300, 400, 3), 4 * number, np.uint8), number * VIDEO_INTERVAL, "wiping", "")
    video.close()


PLAYED = """async () => {
  const video = document.querySelector('video');
  video.muted = true;
  await video.play();
  await new Promise(done => video.addEventListener('timeupdate', done));
  return [video.videoWidth, video.videoHeight, video.error, video.currentTime];
}"""


def test_a_short_video_plays_inside_the_page(browser: Browser, tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    write_video(run_folder / "video.mp4")
    assert run(["report", str(run_folder)]) == 0
    (run_folder / "video.mp4").unlink()
    page, wrong = opened(browser, run_folder / "report.html")
    played = page.evaluate(PLAYED)
    assert played[:3] == [400, 364, None]
    assert played[3] > 0
    assert wrong == []


def test_a_long_video_plays_beside_the_page_and_is_not_asked_for_before(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    write_video(run_folder / "video.mp4")
    monkeypatch.setattr("cleancli.report.videos.LARGEST", 1000)
    assert run(["report", str(run_folder)]) == 0
    page, wrong = opened(browser, run_folder / "report.html")
    assert wrong == []
    played = page.evaluate(PLAYED)
    assert played[:3] == [400, 364, None]
    assert played[3] > 0
    assert [each for each in wrong if "video.mp4" not in each] == []


SHOWN = "[...document.querySelectorAll('section.step')].map(step => step.getClientRects().length > 0)"


def test_the_slider_shows_one_step_at_a_time(browser: Browser, tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(run_folder)]) == 0
    page, wrong = opened(browser, run_folder / "report.html")
    assert page.evaluate(SHOWN) == [True, False, False, False]
    page.locator("#after").click()
    assert page.evaluate(SHOWN) == [False, True, False, False]
    assert page.locator("#named").inner_text() == page.locator("#step-1 h3").inner_text()
    page.locator("#at").focus()
    page.keyboard.press("End")
    assert page.evaluate(SHOWN) == [False, False, False, True]
    page.locator(".time a[href='#step-2']").first.click()
    page.wait_for_function("document.querySelector('#at').value === '2'")  # the address changes first
    assert page.evaluate(SHOWN) == [False, False, True, False]
    assert page.locator("#at").input_value() == "2"
    page.locator("#all").check()
    assert page.evaluate(SHOWN) == [True] * 4
    page.locator("#all").uncheck()
    assert page.evaluate(SHOWN) == [False, False, True, False]
    assert wrong == []
    page.emulate_media(media="print")
    assert page.evaluate(SHOWN) == [True] * 4
    assert not page.locator("#slider").is_visible()


def test_without_script_the_page_is_whole(browser: Browser, tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(run_folder)]) == 0
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto((run_folder / "report.html").as_uri())
    assert [step.is_visible() for step in page.locator("section.step").all()] == [True] * 4
    assert not page.locator("#slider").is_visible()
    context.close()


def test_no_other_script_may_run(browser: Browser, tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(run_folder)]) == 0
    page_of = run_folder / "report.html"
    told = page_of.read_text(encoding="utf-8").replace("</body>", "<script>window.other = 1</script></body>")
    page_of.write_text(told, encoding="utf-8")
    page, wrong = opened(browser, page_of)
    assert page.evaluate("window.other === undefined")
    assert any("Content Security Policy" in each for each in wrong)


@pytest.mark.parametrize("width", [320, 400, 1280])
def test_nothing_of_the_slider_lies_on_anything_else(browser: Browser, width: int, tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(run_folder)]) == 0
    page, _ = opened(browser, run_folder / "report.html", width)
    boxes = page.evaluate(
        """[...document.getElementById('slider').children].map(e => e.getBoundingClientRect())
           .map(({left, top, right, bottom}) => [left, top, right, bottom])"""
    )
    assert len(boxes) == 5
    for one, other in combinations(boxes, 2):
        beside = one[2] <= other[0] + 0.5 or other[2] <= one[0] + 0.5
        assert beside or one[3] <= other[1] + 0.5 or other[3] <= one[1] + 0.5
    assert all(left >= 0 and right <= width for left, _, right, _ in boxes)
    page.locator(".time a[href='#step-2']").first.click()
    bar, head = (page.locator(name).bounding_box() for name in ("#slider", "#step-2 h3"))
    assert bar is not None
    assert head is not None
    assert bar["y"] + bar["height"] <= head["y"]


@pytest.mark.parametrize("width", [400, 1280])
def test_words_of_the_account_are_not_broken(browser: Browser, width: int, tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(run_folder)]) == 0
    page, _ = opened(browser, run_folder / "report.html", width)
    for cell in page.locator("#account + .card td.kind").all():
        line = cell.evaluate("e => parseFloat(getComputedStyle(e).lineHeight)")
        height = cell.evaluate("e => e.getBoundingClientRect().height")
        words = len(cell.inner_text().split())
        assert height < (words + 0.9) * line


def test_runs_side_by_side(browser: Browser, tmp_path: Path) -> None:
    one = write_run(tmp_path / "one", pictures=0)
    two = write_run(tmp_path / "two", RECORDS[:8], 0, episode=None, truth=None)
    assert run(["report", str(one), str(two), "--html", str(tmp_path / "both.html")]) == 0
    page, wrong = opened(browser, tmp_path / "both.html", 600)
    assert wrong == []
    assert page.locator("tr[data-run]").count() == 2
    assert page.evaluate("document.documentElement.scrollWidth") <= 600


@pytest.mark.parametrize("width", [320, 1600])
def test_means_of_many_runs_stay_in_their_places(browser: Browser, width: int, tmp_path: Path) -> None:
    """Of ten runs by two strategies: bars are as long as the page says, and links lead to the runs' pages."""
    folders = []
    for seed, name in product(range(1, 6), ("plan-2", "n" * 90)):
        seconds = {"actions": 10.0 * len(name), "total": 10.0 * len(name)}
        episode = {"reason": "so", "clean": True, "actions": 3, "seconds": seconds}
        folder = write_run(
            tmp_path / f"{name[:9]}-{seed}", (), 0, seed=seed, options={"strategy": name}, episode=episode
        )
        assert run(["report", str(folder)]) == 0
        folders.append(str(folder))
    assert run(["report", *folders, "--html", str(tmp_path / "all.html")]) == 0
    page, wrong = opened(browser, tmp_path / "all.html", width)
    assert wrong == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator("#means + .card h4").all_inner_texts() == ["in all", "actions"]
    for track, share in zip(page.locator(".mean .track").all(), [6 / 90, 1.0] * 2, strict=True):
        bar, full = (
            part.evaluate("e => e.getBoundingClientRect().width") for part in (track.locator("span"), track)
        )
        assert full > 100
        assert bar / full == pytest.approx(share, abs=5e-3)
    page.locator("tr[data-run] a").first.click()
    assert page.url == Path(folders[0], "report.html").as_uri()


def brightness(colour: str) -> int:
    """Of a computed colour like `rgb(1, 2, 3)`."""
    return sum(int(part) for part in colour[colour.index("(") + 1 : -1].split(",")[:3])
