"""An episode of a study is what `cleancli execute` carries out; its key is all that decides how it goes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from cleancli.api.executions import execute, execute_series
from cleancli.api.provenance import inputs_of_run
from cleancli.experiment.episode import Episode, OtherVersion, carried_out
from cleancli.experiment.series import OpenedStudy
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.learning.evidence import NO_EVIDENCE
from cleancli.report.run import read_run
from cleancli.study.model import Limits
from cleancli.study.row import Row, comparable
from support.studies import SYMBOLIC, opened, rows_here

LITTLE = """
scene little {
  dirt {
    group { count = 3  at = (20 cm, 5 cm)  radius = 1.5 cm }
  }
}
"""


def first(text: str) -> Episode:
    return opened(text)[0].blocks[0][0][0]


def told(row: Row) -> dict[str, Any]:
    """What `execute --json` tells too, and does not depend on the machine."""
    same = comparable(row)
    return {"clean": same.clean, "reason": same.reason, "actions": same.actions, "seconds": same.seconds}


def executed(record: dict[str, Any]) -> dict[str, Any]:
    kinds = ("transits", "actions")
    seconds = {k: v if k in kinds else 0.0 for k, v in record["seconds"].items() if k != "total"}
    return {name: record[name] for name in ("clean", "reason", "actions")} | {"seconds": seconds}


@pytest.mark.needs_pybullet
def test_a_row_of_a_table_agrees_with_execute(tmp_path: Path) -> None:
    (tmp_path / "little.nid").write_text(LITTLE, encoding="utf-8")
    study = (
        f'study s {{ scene = "{tmp_path}/little.nid"  strategy = plan_1  seed = 3  rag {{ width = 10 cm }} }}'
    )
    episode = first(study)
    by_hand = LITTLE.replace("dirt {", "rag { width = 10 cm } dirt {")
    result = execute("cleaning", by_hand, seed=3, strategy="plan-1", runs=tmp_path / "runs", video=False)
    row = carried_out(episode).row
    record: Any = result.to_dict()
    assert told(row) == executed(record["episode"])
    truth = record["truth"]
    assert (row.pieces, row.left, row.on_floor) == (3, truth["on_table"], truth["on_floor"])
    assert row.score == (truth["in_container"] + truth["in_dustpan"]) / 3
    assert row.axes["simulator"] == "physics"


@pytest.mark.needs_pybullet
def test_a_row_agrees_where_saving_a_table_matters(tmp_path: Path) -> None:
    """A table that is saved after an action is built anew, and takes another course on this one."""
    row = carried_out(first("study s { scene = two_groups  strategy = wipe  seed = 3 }")).row
    result = execute("cleaning", "two_groups", seed=3, strategy="wipe", runs=tmp_path / "runs", video=False)
    record: Any = result.to_dict()
    assert told(row) == executed(record["episode"])


SLOW = """
domain kiln {
  predicates { fired() glazed() }
  actions    { fire() [duration = 45 min]  glaze() [duration = 30 min] }
  rule fire:  fire() { when not fired() then 1: fired() }
  rule glaze: glaze() { when fired(), not glazed() then 1: glazed() }
  reward { 1 * goal }
}
"""
POT = "problem pot { domain = kiln goal { glazed() } horizon = 4 }"


@pytest.mark.parametrize(
    ("limit", "reason"), [(None, "nothing is left to do"), (2000, "the limit of 2000 s")]
)
def test_a_problem_has_a_limit_of_seconds_where_one_is_said(
    tmp_path: Path, limit: float | None, reason: str
) -> None:
    """docs/execution.md: 1800 seconds are the limit of tables, and `simulate` has none."""
    (tmp_path / "kiln.nid").write_text(SLOW, encoding="utf-8")
    (tmp_path / "pot.nid").write_text(POT, encoding="utf-8")
    done = execute(SLOW, POT, seed=1, max_seconds=limit, runs=tmp_path / "runs", video=False)
    assert done.reason.startswith(reason)
    record: Any = done.to_dict()
    assert record["options"]["max_seconds"] == limit
    again = inputs_of_run(read_run(done.folder)).options.max_seconds
    assert again == (math.inf if limit is None else limit)
    said = "" if limit is None else f"max_seconds = {limit}"
    files = f'domain = "{tmp_path}/kiln.nid" scene = "{tmp_path}/pot.nid"'
    row = carried_out(first(f"study s {{ {files} seed = 1 {said} }}")).row
    assert told(row) == executed(record["episode"])


def test_a_series_agrees_with_execute(tmp_path: Path) -> None:
    study = """study s {
      scene = three_areas samples = 200 estimator = m m = 3 known = 2 episodes = 3 runs = 2 seed = 5
    }"""
    rows = [row for row in rows_here(opened(study)) if row.run == 2]
    assert [row.seed for row in rows] == [8, 9, 10]
    done = execute_series(
        "cleaning",
        "three_areas",
        episodes=3,
        seed=8,
        samples=200,
        learn=True,
        estimator="m",
        m=3,
        known=2,
        runs=tmp_path,
        video=False,
    )
    records: list[Any] = [run.to_dict() for run in done.runs]
    assert [told(row) for row in rows] == [executed(record["episode"]) for record in records]


def test_what_a_series_has_seen_is_handed_on() -> None:
    study = "study s { scene = three_areas samples = 200 estimator = decreasing_m episodes = 2 runs = 1 }"
    one, two = opened(study)[0].blocks[0][0]
    before = carried_out(one)
    after = carried_out(two, before.evidence)
    assert len(before.evidence.order) == before.row.actions
    assert len(after.evidence.order) == before.row.actions + after.row.actions
    assert carried_out(two, NO_EVIDENCE).evidence.order != after.evidence.order


def test_actions_whose_rules_are_not_known_yet_are_counted() -> None:
    """None where nothing is learned, all at first, and none once each was seen twice."""
    study = """study s {
      scene = three_areas samples = 200 estimator = none, m  known = 2 episodes = 4 runs = 1 seed = 5
    }"""
    rows = rows_here(opened(study))
    plain, learning = ([row for row in rows if row.axes["estimator"] == name] for name in ("none", "m"))
    assert [row.unknown for row in plain] == [0, 0, 0, 0]
    assert learning[0].unknown == learning[0].actions
    assert learning[-1].unknown == 0 < learning[-1].actions


CHANGES: dict[str, Callable[[Episode], Episode]] = {
    "seed": lambda e: replace(e, seed=e.seed + 1),
    "option": lambda e: replace(e, axes={**e.axes, "samples": 300}),
    "limit": lambda e: replace(e, limits=Limits(max_actions=3)),
    "text": lambda e: replace(e, texts=replace(e.texts, given=Source("x", e.texts.given.text + "\n"))),
    "rules": lambda e: replace(
        e, texts=replace(e.texts, domain=(Source("x", e.texts.domain[0].text + "\n"), *e.texts.domain[1:]))
    ),
    "world": lambda e: replace(e, texts=replace(e.texts, world=e.texts.domain)),
    "version": lambda e: replace(e, versions={**e.versions, "pybullet": "0"}),
    "before": lambda e: replace(e, before="k"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_the_key_changes_with_all_that_decides(change: str) -> None:
    episode = first(SYMBOLIC)
    assert CHANGES[change](episode).key != episode.key


def test_the_key_does_not_change_with_names_places_and_order() -> None:
    episode = first(SYMBOLIC)
    moved = tuple(Source(f"elsewhere/{each.path}", each.text) for each in episode.texts.domain)
    other = replace(
        episode,
        study="other",
        part="other",
        run=9,
        axes=dict(reversed(list(episode.axes.items()))),
        texts=replace(episode.texts, domain=moved),
    )
    assert other.key == episode.key


def test_cells_that_differ_in_nothing_are_one() -> None:
    study = """study s {
      scene = two_groups  strategy = plan_2, reactive  planner = prada, uct  estimator = none, m  m = 3, 5
    }"""
    cells = opened(study)[0].cells
    plans = [cell.axes for cell in cells if cell.axes["strategy"] == "plan-2"]
    others = [cell.axes for cell in cells if cell.axes["strategy"] == "reactive"]
    assert len(plans) == 2 * (1 + 2)
    assert len(others) == 1 + 2
    assert not any("planner" in axes for axes in others)
    assert not any("m" in axes for axes in (*plans, *others) if axes["estimator"] == "none")


def test_a_worker_of_another_version_says_so() -> None:
    episode = replace(first(SYMBOLIC), versions={"cleancli": "9.9"})
    with pytest.raises(OtherVersion, match=r"the worker has cleancli .*, the study 9\.9"):
        carried_out(episode)


def test_a_planner_that_refuses_is_a_row_that_is_not_clean() -> None:
    study = "study s { scene = layout_e planner = exact simulator = stand_in runs = 1 max_actions = 2 }"
    row = carried_out(first(study)).row
    assert row.axes["simulator"] == "stand-in"
    assert not row.clean
    assert row.reason.startswith("refused: this cannot be planned")
    assert (row.actions, row.left) == (0, 40)


def test_runs_have_the_same_seeds_in_all_cells() -> None:
    (study,) = opened("study s { scene = two_groups strategy = plan_1, wipe runs = 3 episodes = 2 seed = 7 }")
    seeds = [[[e.seed for e in series] for series in block] for block in study.blocks]
    assert seeds == [[[7, 8]] * 2, [[9, 10]] * 2, [[11, 12]] * 2]


def test_a_study_of_studies_opens_each(tmp_path: Path) -> None:
    (tmp_path / "one.nid").write_text("study one { scene = two_groups }", encoding="utf-8")
    (tmp_path / "all.nid").write_text("study both { studies = one, fig8b }", encoding="utf-8")
    from cleancli.experiment.series import open_studies
    from cleancli.language.load import read_source

    studies: tuple[OpenedStudy, ...] = open_studies(read_source(tmp_path / "all.nid"), runs=2, seed=50)
    assert [each.study.name for each in studies] == ["one", "fig8b"]
    assert {(each.study.runs, each.study.seed) for each in studies} == {(2, 50)}
