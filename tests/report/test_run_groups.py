"""Many runs compared: which belong together, their means, how they compare, and links to their pages."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Mapping
from math import isnan
from pathlib import Path
from statistics import fmean
from typing import Any

import pytest

from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.main import run
from cleancli.report.comparison_page import comparison_page
from cleancli.report.groups import groups_of
from cleancli.report.run import Run, read_run
from support.run_folders import write_run

OTHER = [
    {"path": "cleaning.nid", "sha256": "a" * 64, "copy": "files/cleaning.nid"},
    {"path": "rim.nid", "sha256": "b" * 64, "copy": "files/rim.nid"},
]
"""What goes into runs of another problem."""


def wrote(folder: Path, seed: int, seconds: float, clean: bool | None = True, **options: str | int) -> Run:
    """A run that took so long, three quarters of it in actions; None: it was cut short."""
    spent = {"transits": seconds / 4, "actions": seconds * 3 / 4, "learning": 0.0, "total": seconds}
    episode = {"reason": "so", "clean": clean, "actions": round(seconds / 10), "seconds": spent}
    changes: Mapping[str, Any] = {"options": {"strategy": "plan-2", **options}, "seed": seed}
    if clean is None:
        return read_run(write_run(folder, (), 0, **changes, episode=None, truth=None))
    return read_run(write_run(folder, (), 0, **changes, episode=episode))


def many(tmp_path: Path) -> list[Run]:
    """Six seeds by two strategies, of which reactive takes twice as long and fails once."""
    plans = [wrote(tmp_path / f"plan{seed}", seed, 40.0 + seed) for seed in range(1, 7)]
    reactive = [
        wrote(tmp_path / f"reactive{seed}", seed, 80.0 + 2 * seed, seed != 6, strategy="reactive")
        for seed in range(1, 7)
    ]
    return [*plans, *reactive]


def test_runs_that_differ_in_their_seeds_alone_are_a_group(tmp_path: Path) -> None:
    plan, reactive = groups_of(many(tmp_path))
    assert (plan.problem, plan.name, plan.runs, plan.failed, plan.unended) == (
        "two_groups",
        "plan-2",
        6,
        0,
        0,
    )
    assert (reactive.name, reactive.runs, reactive.failed) == ("reactive", 6, 1)
    assert plan.total.value == fmean(range(41, 47))
    assert plan.total.low < plan.total.value < plan.total.high
    assert reactive.total.value == fmean(range(82, 92, 2)), "of those that ended clean"
    assert plan.seconds["actions"].value == pytest.approx(plan.total.value * 3 / 4)
    assert plan.actions.value == fmean([4, 4, 4, 4, 4, 5])


def test_groups_are_compared_with_the_first_of_their_problem_seed_by_seed(tmp_path: Path) -> None:
    plan, reactive = groups_of(many(tmp_path))
    assert isnan(plan.ratio.value)
    assert reactive.ratio.value == pytest.approx((82 + 84 + 86 + 88 + 90 + 2 * 92) / (6 * 43.5))
    assert reactive.ratio.count == 6
    runs = [
        wrote(tmp_path / f"{n}-{s}", s, 10.0 * n, strategy=f"s{n}")
        for n, s in ((1, 1), (1, 2), (2, 2), (2, 3))
    ]
    assert groups_of(runs)[1].ratio.value == 2.0
    assert groups_of(runs)[1].ratio.count == 1
    apart = [wrote(tmp_path / f"apart{seed}", seed, 10.0, strategy=f"s{seed}") for seed in (1, 2)]
    assert isnan(groups_of(apart)[1].ratio.value)


def test_groups_are_named_by_all_in_which_they_differ(tmp_path: Path) -> None:
    runs = [
        wrote(tmp_path / "a", 1, 40.0, planner="uct", max_actions=60),
        wrote(tmp_path / "b", 1, 40.0, planner="prada+", max_actions=60),
        wrote(tmp_path / "c", 2, 40.0, planner="prada+", max_actions=60),
    ]
    assert [group.name for group in groups_of(runs)] == ["plan-2, planner uct", "plan-2, planner prada+"]
    more = wrote(tmp_path / "d", 1, 40.0, planner="uct", max_actions=20)
    names = [group.name for group in groups_of([*runs, more])]
    assert names[0] == "plan-2, planner uct, max actions 60"
    assert names[2] == "plan-2, planner uct, max actions 20"
    elsewhere = write_run(tmp_path / "e", (), 0, seed=1, options={"strategy": "tsp"}, files=OTHER)
    names = [group.name for group in groups_of([*runs[1:], read_run(elsewhere)])]
    assert names == ["plan-2", "tsp"], "than others of the same problem"


def test_what_was_cut_short_is_in_no_mean(tmp_path: Path) -> None:
    runs = [wrote(tmp_path / "whole", 1, 40.0), wrote(tmp_path / "cut", 2, 0.0, None)]
    (group,) = groups_of(runs)
    assert (group.runs, group.unended, group.total.count, group.total.value) == (2, 1, 1, 40.0)
    (none,) = groups_of(runs[1:])
    assert isnan(none.total.value)
    assert none.seconds == {}


def test_the_table_and_json_tell_means(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folders = [str(each.folder) for each in many(tmp_path)]
    assert run(["report", *folders]) == ExitCode.DONE
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 1 + 12 + 1 + 3
    assert lines[14].split()[:4] == ["problem", "runs", "of", "runs"]
    assert re.match(
        r"two_groups +plan-2 +6 +0 +4\.2 \[4\.0, 4\.\d] +43\.5 \[4\d\.\d, 4\d\.\d] +- ", lines[15]
    )
    assert "learning" not in lines[14]
    assert run(["report", *folders, "--json"]) == ExitCode.DONE
    first, second = json.loads(capsys.readouterr().out)["groups"]
    assert first["ratio"] == {"mean": None, "low": None, "high": None}
    assert second["ratio"]["mean"] == pytest.approx((82 + 84 + 86 + 88 + 90 + 184) / 261)
    assert second["total"]["low"] < second["total"]["mean"] == 86.0
    assert second["seconds"]["transits"]["mean"] == 86.0 / 4


def test_runs_without_their_like_have_no_means(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runs = [wrote(tmp_path / name, 1, 40.0, strategy=name) for name in ("plan-2", "reactive")]
    assert 'id="means"' not in comparison_page(runs, tmp_path)
    assert run(["report", *(str(each.folder) for each in runs)]) == ExitCode.DONE
    assert len(capsys.readouterr().out.splitlines()) == 3


def test_the_page_has_a_figure_per_kind_of_time_on_one_scale(tmp_path: Path) -> None:
    page = comparison_page(many(tmp_path), tmp_path)
    means = page[page.index('id="means"') : page.index('id="account"')]
    assert re.findall(r"<h4>(.*?)</h4>", means) == ["in all", "transits", "actions"]
    assert means.count('<div class="mean">') == 6
    shares = [float(width) for width in re.findall(r'kind-2" style="width: ([\d.]+)%', means)]
    plan, reactive = groups_of(many(tmp_path / "again"))
    top = reactive.seconds["actions"].high
    assert shares == pytest.approx(
        [100 * each.seconds["actions"].value / top for each in (plan, reactive)], abs=1e-3
    )
    assert "2.35 [" in means[means.index("data-group") :]


def test_each_run_has_a_link_from_where_the_page_is(tmp_path: Path) -> None:
    runs = [wrote(tmp_path / "runs" / name, 1, 40.0) for name in ("a b#1", "c")]
    (runs[0].folder / "report.html").write_text("page", encoding="utf-8")
    page = comparison_page(runs, tmp_path / "pages")
    links = [html.unescape(link) for link in re.findall(r'<a href="([^"]+)">', page)]
    assert links == ["../runs/a%20b%231/report.html"] * 2, "and the other has no page"
