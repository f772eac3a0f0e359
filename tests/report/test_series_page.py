"""The page of a series (docs/report.md): what each episode took, and how the rules changed."""

from __future__ import annotations

import html
import json
import re
from pathlib import Path
from typing import Any

import pytest

from cleancli.api.executions import execute_series
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.execution.events import Event, Started
from cleancli.language.diagnostics.refused import Refused
from cleancli.report.plots import Step, band, line, numbered, stairs, thinned, ticks
from cleancli.report.rules import courses
from cleancli.report.series import read_series
from cleancli.report.series_page import series_page
from support.golden import check_golden
from support.run_folders import LAMPS, LESSONS, believed, write_run, write_series

LIGHTS = "problem evening { domain = lamps objects { a b - lamp } init { lit(a), lit(b) } }"


def text_of(page: str) -> str:
    body = re.sub(r"<style>.*?</style>", "", page, flags=re.S)
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", body)).split())


def page_of(folder: Path) -> str:
    return series_page(read_series(folder))


def test_pages_are_as_they_were(tmp_path: Path) -> None:
    """But for their style: tests/golden/series.html, written by CLEANCLI_REGENERATE=1."""
    page = re.sub(r"<style>.*?</style>", "", page_of(write_series(tmp_path / "evening")), flags=re.S)
    check_golden("series.html", page)


def test_it_asks_for_nothing_outside_itself_and_what_files_say_is_escaped(tmp_path: Path) -> None:
    page = page_of(write_series(tmp_path / "x<b>", options={"known": 3, "<script>": "<b>"}))
    assert "http" not in page.replace("http-equiv", "")
    assert "src=" not in page
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_it_tells_what_each_episode_took(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "evening")
    page = page_of(folder)
    told = text_of(page)
    assert "episodes 3 of 3 actions in all 5 seconds in all 65.0 s" in told
    assert "an episode, of the first 1 27.0 s an episode, of the last 1 13.0 s" in told
    (seconds,) = re.findall(r'data-curve="seconds">\s*<svg[^>]*><polyline points="([^"]*)"', page)
    (actions,) = re.findall(r'data-curve="actions">\s*<svg[^>]*><polyline points="([^"]*)"', page)
    assert seconds == "166.7,0.0 500.0,7.4 833.3,51.9", "27, 25 and 13 of 27"
    assert actions == "166.7,0.0 500.0,0.0 833.3,50.0"
    assert 'title="episode 1: learning, 6.00 s" style="height: 22.222%"' in page, "6 of 27"
    assert 'title="episode 3: actions, 10.0 s" style="height: 37.037%"' in page
    assert re.findall(r'<a href="([^"]*)">evening', page) == [
        f"evening-seed{seed}-001/report.html" for seed in (4, 5, 6)
    ]


def test_a_single_episode_is_a_dot_and_actions_are_counted_by_whole_numbers() -> None:
    assert line([3], 4) == "500.0,25.0 500.0,25.0"
    assert ticks(3.0, 8, 1.0) == (0, 1, 2, 3)
    assert ticks(3.0, 8) == (0, 0.5, 1, 1.5, 2, 2.5, 3)


def test_it_tells_how_each_rule_changed_with_its_prior_and_from_where_on_it_is_known(tmp_path: Path) -> None:
    pressed, turned = re.findall(
        r'<section class="card rule".*?</section>', page_of(write_series(tmp_path / "evening")), re.S
    )
    assert "pressed 5 examples · known after action 2" in text_of(pressed)
    assert "not lit(?l) 0.9 0.6 0.40 to 0.80 3" in text_of(pressed)
    assert "nothing 0.1 0.4 0.20 to 0.60 2" in text_of(pressed)
    assert "turned 17 examples · known from the beginning" in text_of(turned)
    assert "not lit(?l) 0.7 0.4 0.30 to 0.50 8" in text_of(turned)
    first, _ = re.findall(r'<polyline class="line-\d" points="([^"]*)"', pressed)
    stairs_of_it = "0.0,10.0 200.0,10.0 200.0,20.0 400.0,20.0 400.0,30.0 800.0,30.0 800.0,40.0 1000.0,40.0"
    assert first == stairs_of_it, "after 0, 1, 2 and 4 of 5 actions"
    assert re.findall(r'class="prior line-\d" x1="0" x2="1000" y1="([^"]*)"', pressed) == ["10.00", "90.00"]
    assert re.findall(r'class="known" x1="([^"]*)"', pressed) == ["400.0"]
    assert re.findall(r'class="end" x1="([^"]*)"', pressed) == ["400.0", "800.0"]
    assert not re.findall(r'class="known"', turned)


def test_a_rule_that_was_seen_too_seldom_is_not_known_yet(tmp_path: Path) -> None:
    pressed, _ = courses(read_series(write_series(tmp_path / "evening", known=6)).runs)
    assert pressed.known_from is None
    assert "not known yet" in page_of(tmp_path / "evening")


def test_a_series_that_was_cut_short_is_told_as_far_as_it_came(tmp_path: Path) -> None:
    told = text_of(page_of(write_series(tmp_path / "evening", episodes=10)))
    assert "cut short 3 of 10 episodes are over: it was stopped or killed, or still goes on" in told
    told = text_of(page_of(write_series(tmp_path / "killed", episode=None)))
    assert "0 of 3 episodes are over" in told


def test_without_learning_there_are_no_rules(tmp_path: Path) -> None:
    folder = write_series(tmp_path / "evening")
    for journal in folder.glob("*/journal.jsonl"):
        lines = journal.read_text(encoding="utf-8").splitlines(keepends=True)
        journal.write_text("".join(line for line in lines if '"learned"' not in line), encoding="utf-8")
    assert "What was learned" not in page_of(folder)


def broken(folder: Path, what: str) -> None:
    """Something that no series leaves behind."""
    run_folder = folder / "evening-seed4-001"
    match what:
        case "no number":
            (folder / "series.json").write_text('{"episodes": "many"}', encoding="utf-8")
        case "too many":
            told = {"format": 1, "episodes": 10**9, "seed": 1, "video": False, "writes": False, "called": ""}
            (folder / "series.json").write_text(json.dumps(told), encoding="utf-8")
        case "too large":
            (folder / "series.json").write_text(" " * (1 << 17), encoding="utf-8")
        case "a link":
            (folder / "other").symlink_to(run_folder)
        case "no episode":
            for path in [*folder.glob("*/run.json")]:
                path.unlink()
        case "another text":
            (run_folder / "files" / "lamps.nid").write_text(LAMPS + "# more", encoding="utf-8")
        case "another rule":
            write_lesson(run_folder, believed("pulled", 0.5, (1, 1)))
        case "other outcomes":
            write_lesson(run_folder, believed(None, 0.5, (1, 1)))


def write_lesson(run_folder: Path, *records: Any) -> None:
    (run_folder / "journal.jsonl").unlink()
    (run_folder / "run.json").rename(run_folder / "kept.json")
    kept = (run_folder / "kept.json").read_bytes()
    written = write_run(run_folder.parent / "written", (*LESSONS[0], *records), 0)
    (written / "journal.jsonl").rename(run_folder / "journal.jsonl")
    for path in written.iterdir():
        path.unlink()
    written.rmdir()
    (run_folder / "kept.json").unlink()
    (run_folder / "run.json").write_bytes(kept)


@pytest.mark.parametrize(
    ("what", "code", "message"),
    [
        ("no number", "E705", "Expected `int`"),
        ("too many", "E705", "episodes"),
        ("too large", "E705", "than 64 KiB"),
        ("a link", "E705", "it is a link"),
        ("no episode", "E705", "no episode has begun"),
        ("another text", "E705", "is not the text any more"),
        ("another rule", "E705", "rules that its domain has not: pulled"),
        ("other outcomes", "E705", "other outcomes of default"),
    ],
)
def test_a_folder_that_no_series_leaves_is_refused(
    what: str, code: str, message: str, tmp_path: Path
) -> None:
    folder = write_series(tmp_path / "evening")
    broken(folder, what)
    with pytest.raises(Refused, match=re.escape(message)) as refused:
        page_of(folder)
    assert {found.code for found in refused.value.diagnostics} == {code}


def test_report_writes_the_page_and_tells_the_figures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_series(tmp_path / "evening")
    assert run(["report", str(folder)]) == ExitCode.DONE
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[1:4]] == [f"evening-seed{seed}-001" for seed in (4, 5, 6)]
    assert (folder / "report.html").read_text(encoding="utf-8") == page_of(folder)
    assert run(["report", str(folder), "--json"]) == ExitCode.DONE
    told = json.loads(capsys.readouterr().out)
    assert [row["actions"] for row in told["runs"]] == [2, 2, 1]
    assert [rule["name"] for rule in told["rules"]] == ["pressed", "turned"]
    assert told["rules"][0]["points"][-1] == {
        "action": 4,
        "probabilities": [0.6, 0.4],
        "seen": [3, 2],
        "intervals": [[0.4, 0.8], [0.2, 0.6]],
    }
    assert run(["report", str(folder), str(folder / "evening-seed4-001")]) == ExitCode.DONE
    table, means = capsys.readouterr().out.split("\n\n")
    assert len(table.splitlines()) == 5, "a row for each run of both"
    assert means.splitlines()[1].split()[:4] == ["evening", "?", "3", "0"], "where each counts once"


def test_a_series_writes_its_page_after_each_episode(tmp_path: Path) -> None:
    """So that one that is killed has one, which `report` would write alike."""
    pages: list[str] = []

    def follow(event: Event) -> None:
        if isinstance(event, Started):
            pages.extend(text_of(path.read_text(encoding="utf-8")) for path in tmp_path.glob("*/report.html"))

    done = execute_series(
        LAMPS, LIGHTS, episodes=3, learn=True, seed=1, samples=50, runs=tmp_path, video=False, on_event=follow
    )
    assert done.folder is not None
    assert any("1 of 3 episodes are over" in page for page in pages)
    assert any("2 of 3 episodes are over" in page for page in pages)
    last = (done.folder / "report.html").read_text(encoding="utf-8")
    assert last == page_of(done.folder)
    assert "3 of 3 episodes ended so" in text_of(last)
    assert f"actions in all {sum(each.actions for each in done.runs)}" in text_of(last)
    assert 'data-rule="pressed"' in last or 'data-rule="turned"' in last


# ---- lines and marks


def test_stairs_go_on_until_the_next_step_begins() -> None:
    steps = [Step(0, 0.5, 0.4, 0.6), Step(5, 1, 0.9, 1)]
    assert stairs(steps, 10) == "0.0,50.0 500.0,50.0 500.0,0.0 1000.0,0.0"
    assert (
        band(steps, 10)
        == "0.0,40.0 500.0,40.0 500.0,0.0 1000.0,0.0 1000.0,10.0 500.0,10.0 500.0,60.0 0.0,60.0"
    )


def test_a_long_line_has_no_more_steps_than_a_page_shows_and_keeps_the_last() -> None:
    steps = [Step(number, number / 50_000, 0, 1) for number in range(50_000)]
    kept = thinned(steps, 49_999)
    assert len(kept) < 600
    assert kept[-1] == steps[-1]
    assert thinned(steps[:10], 9) == tuple(steps[:10])


@pytest.mark.parametrize(
    ("count", "expected"), [(1, [1]), (3, [1, 2, 3]), (25, [1, 5, 10, 15, 20, 25]), (40, [1, 5, 10])]
)
def test_columns_are_numbered_from_one(count: int, expected: list[int]) -> None:
    found = numbered(count)
    assert [number for number, _ in found][: len(expected)] == expected
    assert len(found) <= 9
    assert all(place == pytest.approx(100 * (number - 0.5) / count) for number, place in found)
