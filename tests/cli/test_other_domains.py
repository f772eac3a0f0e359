"""A domain without tables and dirt is spoken of in its own words, and of one thing as of one."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from cleancli.cli.main import run

DOMAIN = """domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp) }
  derived    { burning := count ?l - lamp: lit(?l) }
  actions    { press(?l - lamp) [duration = 2 s] }
  rule go_out: press(?l) { when lit(?l) then 1: not lit(?l) }
  reward { decrease(burning) }
}
"""
PROBLEM = """problem hall {
  domain = lamps
  objects { l1 - lamp }
  init { lit(l1) }
  goal { not lit(l1) }
  horizon = 1
  planner { name = exact }
}
"""
OF_TABLES = re.compile(
    r"\b(arm|table|dirt|dirty|area|areas|clean|look|looked|robot|tool|camera|particles?)\b", re.I
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lamps.nid").write_text(DOMAIN, encoding="utf-8")
    (tmp_path / "hall.nid").write_text(PROBLEM, encoding="utf-8")
    return tmp_path


def said(capsys: pytest.CaptureFixture[str], *words: str, code: int = 0) -> str:
    assert run(words) == code
    printed = capsys.readouterr()
    return printed.out + printed.err


def test_a_run_in_the_symbolic_world_speaks_of_counts_and_the_goal(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = said(capsys, "execute", "lamps.nid", "hall.nid", "--strategy", "plan-1")
    assert "now: burning 1; the goal does not hold" in text
    assert "in the end: burning 0; the goal holds" in text
    assert "done: nothing is left to do, after 1 action\n" in text
    assert "1. press(l1): not lit(l1)" in text
    assert not OF_TABLES.search(text.replace("record: runs", "")), text
    (page,) = folder.glob("runs/*/report.html")
    body = page.read_text(encoding="utf-8").split("</style>")[1]
    shown = re.sub(r"<[^>]*>", " ", body)
    assert "done" in shown
    assert not OF_TABLES.search(shown), OF_TABLES.findall(shown)
    compared = said(capsys, "report", *map(str, folder.glob("runs/*")))
    assert " done " in compared


def test_a_run_that_does_not_get_there_is_not_done(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "lamps.nid").write_text(DOMAIN.replace("1: not lit(?l)", "1: nothing"), encoding="utf-8")
    text = said(capsys, "execute", "lamps.nid", "hall.nid", "--strategy", "plan-1", code=3)
    assert text.count("not done: ") == 1
    assert "in the end: burning 1; the goal does not hold" in text


def test_one_thing_is_not_several(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fact = ["lit", ["l1"], True]
    transition = {
        "action": "press",
        "arguments": ["l1"],
        "objects": {"l1": "lamp"},
        "before": [fact],
        "after": [],
    }
    (folder / "seen.jsonl").write_text(json.dumps(transition) + "\n", encoding="utf-8")
    both = ("lamps.nid", "hall.nid")
    commands = [
        ("check", *both),
        ("show", *both),
        ("compile", *both),
        ("explain", *both, "press(l1)"),
        ("plan", *both),
        ("plan", *both, "--explain"),
        ("plan", *both, "--evaluate", "press(l1)"),
        ("simulate", *both, "--episodes", "1", "--max-actions", "1"),
        ("execute", *both, "--strategy", "plan-1", "--max-actions", "1"),
        ("learn", "lamps.nid", "seen.jsonl"),
        ("rename", "press", "push", "lamps.nid"),
        ("fmt", "--check", "hall.nid"),
    ]
    for words in commands:
        run(words)
        text = "".join(capsys.readouterr())
        assert not re.findall(r"(?<![\d.])1 (?!means|less|plus|s\b|is\b|was\b)[a-z]+s\b", text), (words, text)


GIVES_UP = DOMAIN.replace("1: not lit(?l)", "0.001: not lit(?l)  rest: broken(?l)").replace(
    "lit(?l - lamp) }\n  derived", "lit(?l - lamp)  broken(?l - lamp) }\n  derived"
)


@pytest.mark.parametrize("is_timed", [True, False])
def test_time_is_spoken_of_where_the_domain_has_it_and_all_is_said_once(
    folder: Path, capsys: pytest.CaptureFixture[str], is_timed: bool
) -> None:
    domain = GIVES_UP.replace("lit(?l) then", "lit(?l), not broken(?l) then")
    domain = domain if is_timed else domain.replace(" [duration = 2 s]", "")
    (folder / "lamps.nid").write_text(domain, encoding="utf-8")
    text = said(capsys, "execute", "lamps.nid", "hall.nid", "--strategy", "plan-1", code=3)
    assert text.count("after 1 action") == 1  # it breaks, and then nothing is worth doing
    assert text.count("decided: nothing") == 1
    assert (" of the domain's time" in text) is is_timed
    assert ("actions 2.0" in text) is is_timed
    assert not re.search(r"(?<![\d.])0\.0 s\b|: 0\.0$", text, re.M), text


@pytest.mark.parametrize(
    ("words", "planner"),
    [
        (("--strategy", "plan-1"), "prada+"),
        (("--strategy", "determinized"), "all-outcomes"),
        (("--strategy", "plan-all", "--planner", "exact"), "exact"),
        (("--strategy", "determinized", "--planner", "uct"), "uct"),
    ],
)
def test_a_run_tells_the_planner_that_it_was_planned_by(
    words: tuple[str, ...], planner: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The strategy's own where none is asked for (docs/execution.md), so that others can run the same."""
    told = json.loads(said(capsys, "execute", "lamps.nid", "hall.nid", *words, "--json"))
    assert told["options"]["planner"] == planner
    assert told["options"]["strategy"] == words[1]
