"""The page as text, and the command that writes it."""

from __future__ import annotations

import base64
import html
import json
import re
import struct
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.recording.journal import Acted, Ended, Expected, FactEntry, Record, Spent, Started
from cleancli.report.comparison_page import comparison_page
from cleancli.report.page import run_page
from cleancli.report.pictures import data_uri
from cleancli.report.plots import ticks
from cleancli.report.run import read_run
from cleancli.report.videos import LARGEST, embedded
from support.golden import check_golden
from support.run_folders import FAST, GONE, RECORDS, SECONDS, SMALLER, STRAIGHT, looked, write_run


def test_what_files_say_is_escaped(tmp_path: Path) -> None:
    episode = {"reason": "<script>alert(1)</script>", "clean": False, "actions": 0, "seconds": {"total": 0.0}}
    page = run_page(read_run(write_run(tmp_path / "x<b>", episode=episode)))
    assert page.count("<script") == 1, "our own"
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert(1)" in page
    assert "it can&#39;t reach &lt;there&gt; &amp; back" in page


def test_the_page_asks_for_nothing_outside_itself(tmp_path: Path) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    page = run_page(read_run(run_folder))
    assert "http://" not in page
    assert "https://" not in page
    assert page.count('src="data:image/webp;base64,') == 4 == page.count("src=")


def test_pictures_that_are_missing_or_torn_are_left_out(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "run", pictures=2)
    whole = (folder / "step-001.png").read_bytes()
    (folder / "step-001.png").write_bytes(b"")
    (folder / "step-002.png").write_bytes(b"not a picture")
    page = run_page(read_run(folder))
    assert page.count("<img") == 1
    assert len(whole) > len(data_uri(folder / "step-000.png") or "")


@pytest.mark.parametrize("longest", [0.0, 1e-4, 0.9, 7.0, 36.45, 3600.0, 1e9])
def test_ticks_are_few_and_within(longest: float) -> None:
    found = ticks(longest)
    assert 1 <= len(found) <= 9
    assert found[0] == 0
    assert found[-1] <= longest


def test_one_run_is_written_into_its_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(run_folder)]) == ExitCode.DONE
    assert (run_folder / "report.html").read_text(encoding="utf-8") == run_page(read_run(run_folder))
    out = capsys.readouterr().out
    assert "two_groups-seed1-001" in out
    assert "36.5" in out
    assert "report.html" in out


def test_several_runs_are_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one = write_run(tmp_path / "one", pictures=0)
    two = write_run(tmp_path / "two", RECORDS[:8], 0, episode=None, truth=None)
    assert run(["report", str(one), str(two), "--html", str(tmp_path / "both.html")]) == ExitCode.DONE
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:5] == ["run", "strategy", "seed", "ended", "actions"]
    assert lines[1].split()[:5] == ["one", "prada+", "1", "clean", "3"]
    assert "100 %" in lines[1]
    assert "cut short" in lines[2]
    assert "27 %" in lines[2]
    assert (tmp_path / "both.html").read_text(encoding="utf-8").count("<tr data-run") == 2
    assert not (one / "report.html").exists()


def test_what_took_no_time_in_any_run_has_no_column(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = write_run(tmp_path / "one", pictures=0)
    written = json.loads((one / "run.json").read_text(encoding="utf-8"))
    written["episode"]["seconds"] = {"actions": 2.5, "perceiving": 0.0, "total": 2.5}
    (one / "run.json").write_text(json.dumps(written), encoding="utf-8")
    assert run(["report", str(one)]) == ExitCode.DONE
    head, row = capsys.readouterr().out.splitlines()[:2]
    assert head.split()[-3:] == ["seconds", "actions", "s"]
    assert row.split()[-2:] == ["2.5", "2.5"]


def test_json_is_the_figures_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run_folder = write_run(tmp_path / "two_groups-seed1-001")
    assert run(["report", str(run_folder), "--json"]) == ExitCode.DONE
    (row,) = json.loads(capsys.readouterr().out)["runs"]
    assert row["seconds"] == SECONDS
    assert row["total"] == pytest.approx(sum(SECONDS.values()))
    assert not (run_folder / "report.html").exists()


def test_mistakes_are_told_and_nothing_is_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["report", str(tmp_path)]) == ExitCode.REFUSED
    assert "E705" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
    assert run(["report"]) == ExitCode.USAGE
    whole = write_run(tmp_path / "run", pictures=0)
    assert run(["report", str(whole), "--html", str(tmp_path / "no" / "where.html")]) == ExitCode.FILES


def test_pages_are_as_they_were(tmp_path: Path) -> None:
    """But for their style: tests/golden/page.html and comparison.html, written by CLEANCLI_REGENERATE=1."""

    def plain(page: str) -> str:
        return re.sub(r"<style>.*?</style>", "", page, flags=re.S)

    whole = read_run(write_run(tmp_path / "one", pictures=0))
    cut = read_run(write_run(tmp_path / "two", RECORDS[:8], 0, episode=None, truth=None))
    check_golden("page.html", plain(run_page(whole)))
    check_golden("comparison.html", plain(comparison_page([whole, cut], tmp_path)))


# ---- what the page says (docs/report.md)


def text_of(page: str) -> str:
    """What a reader sees: the page without its tags, blanks made one."""
    body = re.sub(r"<style>.*?</style>", "", page, flags=re.S)
    return " ".join(html.unescape(re.sub(r"<[^>]*>", " ", body)).split())


def steps_told(page: str) -> list[str]:
    """The text of each step's section, that of the first look aside."""
    return [text_of(part) for part in re.findall(r'id="step-[1-9]\d*">(.*?)</section>', page, re.S)]


def noted(page: str) -> list[str]:
    """What stands beside each action in one phrase."""
    return [html.unescape(note) for note in re.findall(r'<span class="note[^"]*">([^<]*)</span>', page)]


def test_the_figures_at_the_top_count_what_went_as_was_likeliest(tmp_path: Path) -> None:
    told = text_of(run_page(read_run(write_run(tmp_path / "run", pictures=0))))
    assert "in all 36.5 s actions 3 went as was likeliest 1 of 3 dirty areas seen at last 0" in told
    assert "particles truly left 1 of 28" in told
    assert "on the floor" not in told, "none fell"
    fallen = {"particles": 28, "on_table": 0, "on_floor": 2}
    told = text_of(run_page(read_run(write_run(tmp_path / "fallen", pictures=0, truth=fallen))))
    assert "particles truly left 0 of 28 particles on the floor 2" in told


@pytest.mark.parametrize(
    ("truth", "figures", "remains"),
    [
        ({"particles": 0, "on_table": 0, "ink_left": 0.0123}, "ink truly left 1.2%", "1.2% of the ink"),
        (
            {"particles": 9, "on_table": 2, "ink_left": 0.0},
            "particles truly left 2 of 9 ink truly left 0.0%",
            "2 of 9, 0.0% of the ink",
        ),
        ({"particles": 0, "on_table": 0, "ink_left": None}, "particles truly left 0 of 0", "0 of 0"),
    ],
)
def test_what_is_left_is_told_of_ink_where_there_was_ink(
    truth: dict[str, object], figures: str, remains: str, tmp_path: Path
) -> None:
    run = read_run(write_run(tmp_path / "run", pictures=0, truth=truth))
    told = text_of(run_page(run))
    assert figures in told
    assert ("particles truly left" in told) == ("particles" in figures)
    assert f" {remains} " in text_of(comparison_page([run], tmp_path))


def test_a_run_that_is_cut_short_says_so_and_tells_its_time_so_far(tmp_path: Path) -> None:
    page = run_page(read_run(write_run(tmp_path / "cut", RECORDS[:10], 0, episode=None, truth=None)))
    told = text_of(page)
    assert "cut short the run has not ended: it was stopped or killed, or still goes on" in told
    assert "so far 9.7 s actions 2" in told, "one over, and one that failed"
    assert "truly" not in told
    assert "these are the journal's seconds until then" in told


def test_each_step_says_in_a_phrase_how_it_went(tmp_path: Path) -> None:
    less_likely = Acted(1, FAST, ("a1",), 9.0, {"actions": 6.0}, "fast_medium", 1, SMALLER.effects)
    noise = Acted(1, FAST, ("a1",), 9.0, {"actions": 6.0}, "fast_medium", 2, ())
    unknown = Started(1, FAST, ("a1",), Expected(None, ()))

    def phrase(name: str, *records: Record) -> str:
        (said,) = noted(run_page(read_run(write_run(tmp_path / name, records, 0))))
        return said

    started, acted = RECORDS[4], RECORDS[6]
    assert isinstance(acted, Acted)
    assert phrase("likeliest", started, acted) == "as was likeliest"
    assert phrase("second", started, less_likely) == "not the likeliest outcome"
    assert phrase("noise", started, noise) == "none of the modelled outcomes"
    assert phrase("nothing", started, replace(acted, outcome=None)) == "none of the modelled outcomes"
    assert phrase("no rule", unknown, replace(acted, outcome=None)) == "no rule says what to expect"
    assert phrase("failed", RECORDS[8], RECORDS[9]) == "failed: it can't reach <there> & back"
    assert phrase("cut", started) == "the run was cut short here"


def test_each_step_tells_what_was_expected_what_happened_and_the_plan(tmp_path: Path) -> None:
    first, second, third = steps_told(run_page(read_run(write_run(tmp_path / "run", pictures=0))))
    assert "expected by rule fast_medium 0.60 not dirt(a1) — happened 0.30 size(a1) := small" in first
    assert "changed: not dirt(a1) dirty areas seen: 2 before, 1 after transits 3.00 s actions 6.00 s" in first
    assert (
        "the plan made before: 2 actions, value 1.85 (sampled, coverage 0.25), by prada+ in 0.30 s" in first
    )
    assert "happened" not in second.replace("what happened", "")
    assert "The robot did not carry it out: it can't reach <there> & back" in second
    assert "the plan made before" not in second, "it is the first action's"
    assert "changed: nothing that its rules could set" in third
    assert "happened" not in third.replace("what happened", ""), "none of the outcomes did"


def test_what_follows_from_places_is_told_apart_from_what_rules_set(tmp_path: Path) -> None:
    changed = (*GONE.effects, FactEntry("near", ("a1", "a2"), False))
    started, acted = RECORDS[4], RECORDS[6]
    assert isinstance(acted, Acted)
    records = (started, replace(acted, changed=changed))
    (step,) = steps_told(run_page(read_run(write_run(tmp_path / "run", records, 0))))
    assert "changed: not dirt(a1) and what follows from places not near(a1, a2) dirty" in step


def test_the_axis_shows_who_took_each_stretch_of_time_and_how_many_areas_were_left(tmp_path: Path) -> None:
    page = run_page(read_run(write_run(tmp_path / "run", pictures=0)))
    titles = [html.unescape(title) for title in re.findall(r'title="([^"]*)"', page)]
    assert f"1. {FAST}(a1): actions, 6.00 s from 3.5 s on" in titles
    assert "planning, 0.30 s from 0.2 s on" in titles, "of no action"
    assert f"3. {STRAIGHT}(a2): actions, 15.0 s from 18.8 s on" in titles
    stretches = [tuple(map(float, found)) for found in re.findall(r"left: ([\d.]+)%; width: ([\d.]+)%", page)]
    assert stretches[0][0] == 0
    assert all(a[0] + a[1] == pytest.approx(b[0], abs=2e-3) for a, b in pairwise(stretches))
    assert sum(stretches[-1]) == pytest.approx(100, abs=2e-3)
    (points,) = re.findall(r'points="([^"]*)"', page)
    curve = [tuple(map(float, point.split(","))) for point in points.split()]
    assert curve[0][0] == pytest.approx(1000 * 0.2 / 36.45, abs=0.1)
    assert curve[0][1] == 0, "two areas are the most"
    assert [y for _, y in curve] == [0, 0, 50, 50, 100, 100, 100, 100], "stairs: two areas, one, none"
    assert curve[-1][0] == 1000
    assert all(a[0] == b[0] or a[1] == b[1] for a, b in pairwise(curve))
    assert "dirty areas seen, from 2 down" in text_of(page)


def test_a_run_that_took_no_time_has_no_axis_and_is_a_page_all_the_same(tmp_path: Path) -> None:
    """The symbolic world by a domain that tells no durations, and a planner that took none."""
    nothing = {"total": 0.0}
    episode = {"reason": "nothing seems worth doing", "clean": False, "actions": 0, "seconds": nothing}
    records = (looked(0.0, "a1"), Spent({"planning": 0.0}), Ended(0.0, "", False, 0, {}))
    page = run_page(read_run(write_run(tmp_path / "run", records, 0, episode=episode)))
    assert "not clean nothing seems worth doing" in text_of(page)
    assert "No action was begun" in page
    assert "How it went" not in page
    assert "<polyline" not in page
    symbolic = (looked(0.0), RECORDS[4], RECORDS[6], Spent({"actions": 9.0}))
    page = run_page(read_run(write_run(tmp_path / "symbolic", symbolic, 0)))
    assert "How it went" in page
    assert "<polyline" not in page, "there are no areas to count"


def test_a_symbolic_run_hides_nothing_from_the_planner_and_has_no_seconds_of_looks(tmp_path: Path) -> None:
    spent = {"planning": 1.0, "transits": 0.0, "actions": 9.0, "perceiving": 0.004, "extra_perceptions": 0.0}
    episode = {"reason": "the goal holds", "clean": True, "actions": 1, "seconds": {**spent, "total": 10.0}}
    acted = RECORDS[6]
    assert isinstance(acted, Acted)
    acted = replace(acted, seconds={"transits": 0.0, "actions": 9.0})
    records = (looked(0.0), RECORDS[4], acted, Spent(acted.seconds))
    told = {}
    for name, truth in (
        ("symbolic", {"facts": 10, "goal": True}),
        ("table", {"particles": 3, "on_table": 0}),
    ):
        folder = write_run(tmp_path / name, records, 0, episode=episode, truth=truth)
        told[name] = text_of(run_page(read_run(folder)))
    for kind in ("transits", "perceiving", "extra perceptions"):
        assert kind in told["table"]
        assert kind not in told["symbolic"]
    assert "planning 1.00" in told["symbolic"]
    assert "the goal holds yes" in told["symbolic"]
    assert "Neither perception nor the planner has seen this." in told["table"]
    assert "The planner sees every fact of the symbolic world. facts that hold 10" in told["symbolic"]
    assert "Neither perception nor the planner" not in told["symbolic"]


def test_videos_are_on_the_page_in_the_order_of_the_run(tmp_path: Path) -> None:
    folder = write_run(tmp_path / "run", pictures=0)
    assert "<video" not in run_page(read_run(folder))
    for name in ("video.mp4", "video-2.mp4", "video-10.mp4", "video-x.mp4", "video.mp4.part"):
        (folder / name).write_bytes(b"")
    page = run_page(read_run(folder))
    assert re.findall(r'<video [^>]*src="([^"]*)"', page) == ["video.mp4", "video-2.mp4", "video-10.mp4"]


def test_videos_are_inside_the_page_as_long_as_they_fit(tmp_path: Path) -> None:
    names = ("video.mp4", "video-2.mp4", "video-3.mp4", "video-4.mp4")
    start = b"\0\0\0\x18ftypisom"
    for name, size in zip(names, (100, LARGEST, 50, LARGEST - 300), strict=True):
        (tmp_path / name).write_bytes(start + bytes(size))
    (tmp_path / "video-5.mp4").write_bytes(b"<html>no video</html>")
    (tmp_path / "video-6.mp4").symlink_to(tmp_path / "video.mp4")
    found = embedded(tmp_path, (*names, "video-5.mp4", "video-6.mp4", "video 7.mp4"))
    assert [video.inside for video in found] == [True, False, True, True, False, False, False]
    assert base64.b64decode(found[0].address.removeprefix("data:video/mp4;base64,")) == start + bytes(100)
    assert [video.address for video in found[4:]] == ["video-5.mp4", "video-6.mp4", "video%207.mp4"]


@pytest.mark.parametrize("size", [(100_000, 100_000), (2**31, 2**31), (0, 5)])
def test_pictures_of_absurd_sizes_are_left_out(tmp_path: Path, size: tuple[int, int]) -> None:
    """Before memory is taken: the header tells."""
    folder = write_run(tmp_path / "run", pictures=2)
    whole = bytearray((folder / "step-001.png").read_bytes())
    whole[16:24] = struct.pack(">II", *size)
    (folder / "step-001.png").write_bytes(whole)
    assert run_page(read_run(folder)).count("<img") == 1
