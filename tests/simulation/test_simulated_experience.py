"""What `simulate --record` writes is what happened, and can be learned from (docs/simulation.md)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from cleancli.api.simulations import simulate
from cleancli.cli.main import run

TEXT = """domain doors {
  types { door }
  predicates { open(?d - door)  jammed(?d - door) }
  derived { shut := count ?d - door: not open(?d) }
  actions { push(?d - door) [duration = 2 s]  wait() [duration = 1 s] }
  rule pushed: push(?d) {
    when not open(?d), not jammed(?d)
    then %s: open(?d)
         0.1: jammed(?d)
         rest: nothing
  }
  reward { decrease(shut) }
}"""
PROBLEM = "problem p { domain = doors objects { a b c - door } init { jammed(c) } }"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, chance in (("true", "0.3"), ("wrong", "0.8")):
        (tmp_path / f"{name}.nid").write_text(TEXT % chance, encoding="utf-8")
    (tmp_path / "p.nid").write_text(PROBLEM, encoding="utf-8")
    return tmp_path


def origin(record: Mapping[str, Any]) -> tuple[str, int]:
    """The planner and the episode."""
    return record["planner"], record["episode"]


def test_each_action_follows_from_the_one_before(folder: Path) -> None:
    result = simulate(
        "true.nid", "p.nid", planner=["prada", "uct"], episodes=8, samples=50, seed=3, record="e.jsonl"
    )
    records = [json.loads(line) for line in (folder / "e.jsonl").read_text().splitlines()]
    assert len(records) == sum(len(each.actions) for played in result.episodes for each in played)
    for record in records:
        assert (record["seed"], record["transit"], record["seconds"]) == (3, 0, 2)
    for before, after in pairwise(records):
        if after["number"] > 1:
            assert after["before"] == before["after"]
            assert origin(after) == origin(before)
        else:
            assert after["before"] == [["jammed", ["c"], True]]
    # Of each episode the last record stays.
    opened = {origin(each): sum(fact[0] == "open" for fact in each["after"]) for each in records}
    for summary, played in zip(result.planners, result.episodes, strict=True):
        for episode in played:
            if episode.actions:
                assert opened[summary.planner, episode.number] == episode.plain


def test_what_is_recorded_agrees_with_the_world_and_not_with_wrong_rules(folder: Path) -> None:
    words = "simulate wrong.nid p.nid --world true.nid --episodes 150 --samples 20 --record e.jsonl --json"
    assert run(words.split()) == 0
    assert run(["learn", "true.nid", "e.jsonl", "--check"]) == 0
    assert run(["learn", "wrong.nid", "e.jsonl", "--check"]) == 1
    assert run(["learn", "wrong.nid", "e.jsonl", "--write"]) == 0
    assert run(["learn", "wrong.nid", "e.jsonl", "--check"]) == 0


def test_nothing_is_written_over_and_nothing_is_done_in_vain(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "e.jsonl").write_text("mine")
    assert run(["simulate", "true.nid", "p.nid", "--episodes", "2", "--record", "e.jsonl"]) == 2
    assert "the file exists" in capsys.readouterr().err
    assert (folder / "e.jsonl").read_text() == "mine"
