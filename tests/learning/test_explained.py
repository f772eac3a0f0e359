"""What each transition counted for, and outcomes that a rule lacks (docs/learning.md)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from cleancli.cli.main import run
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain

TEXT = """domain tidy {
  types { box }
  predicates { dirty(?b - box)  wet(?b - box)  beside(?a ?b - box) }
  functions { size(?b - box): small < large }
  derived { left := count ?b - box: dirty(?b) }
  actions { wipe(?b - box)  soak(?b - box) }
  rule wiped: wipe(?b) {
    when dirty(?b)
    then 0.6: not dirty(?b), forall ?o - box: beside(?b, ?o) => not dirty(?o)
         0.2: not dirty(?b)
         rest: noise
  }
  rule soaked: soak(?b) { then 0.5: wet(?b) 0.5: size(?b) := small }
  reward { decrease(left) }
}
"""
BEFORE: list[list[Any]] = [
    ["dirty", ["a"], True],
    ["dirty", ["b"], True],
    ["dirty", ["c"], True],
    ["beside", ["a", "b"], True],
    ["beside", ["a", "c"], True],
    *(["size", [name], "large"] for name in "abc"),
]


def line(gone: str = "", wet: str = "", beside: bool = True) -> str:
    """A wipe of `a`, after which some boxes are not dirty any more, and others are wet."""
    before = [fact for fact in BEFORE if beside or fact[0] != "beside"]
    after = [fact for fact in before if fact[0] != "dirty" or fact[1][0] not in gone]
    after += [["wet", [name], True] for name in wet]
    objects = dict.fromkeys("abc", "box")
    record = {"action": "wipe", "arguments": ["a"], "objects": objects, "before": before, "after": after}
    return json.dumps(record) + "\n"


def explained(
    folder: Path, capsys: pytest.CaptureFixture[str], *lines: str, text: str = TEXT
) -> list[dict[str, Any]]:
    domain, given = folder / "tidy.nid", folder / "e.jsonl"
    domain.write_text(text, encoding="utf-8")
    given.write_text("".join(lines), encoding="utf-8")
    assert run(["learn", str(domain), str(given), "--explain", "--json"]) == 0
    assert domain.read_text(encoding="utf-8") == text
    return [json.loads(each) for each in capsys.readouterr().out.splitlines()]


def test_shares_slips_and_nearest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = explained(tmp_path, capsys, line("abc"), line("ab"), line("a", beside=False), line("bc"))
    assert [each["outcome"] for each in found] == [0, 0, 0, 2]
    assert [each["number"] for each in found] == [1, 2, 3, 4]
    assert found[0]["shares"][0] > 0.99
    assert found[0]["slips"] == []
    assert found[1]["slips"] == [{"fact": ["dirty", ["c"]], "announced": False, "seen": True}]
    # Nothing stands beside it: both may have made it, mostly the one that was likelier before.
    assert found[2]["shares"][0] > found[2]["shares"][1] > 0.1
    # The neighbours are clean and the box itself is not: noise, and of the outcomes it is wrong about least.
    assert found[3]["shares"] == [0, 0, 1]
    assert (found[3]["nearest"], found[3]["wrong"]) == (
        0,
        [{"fact": ["dirty", ["a"]], "announced": False, "seen": True}],
    )


def test_an_outcome_that_is_missing_is_suggested(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What happens again and again and is not modelled; not what happens once, or is modelled."""
    lines = [line("a")] * 30 + [line("a", wet="a")] * 12 + [line("", wet="a")]
    found = explained(tmp_path, capsys, *lines)
    suggested = [each["suggestion"] for each in found if "suggestion" in each]
    assert [(each["rule"], each["effects"], each["explains"], each["noise"]) for each in suggested] == [
        ("wiped", "not dirty(?b), wet(?b)", 12, 13)
    ]
    # Pasted as it stands it is an outcome of the language, and explains what it says.
    effects = suggested[0]["effects"]
    better = TEXT.replace("         rest: noise", f"         0.1: {effects}\n         rest: noise", 1)
    load_domain(Source("tidy.nid", better))
    again = explained(tmp_path, capsys, *lines, text=better)
    assert sum(each.get("outcome") == 2 for each in again) == 12
    assert not any("suggestion" in each for each in again)


def test_what_no_rule_changes_so_far_is_suggested_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Where nothing that rules change has changed."""
    text = TEXT.replace("0.5: wet(?b) 0.5: size(?b) := small", "0.5: size(?b) := small 0.5: nothing")
    found = explained(tmp_path, capsys, line("a"), *[line("", wet="ab")] * 5, line(), text=text)
    suggested = [each["suggestion"] for each in found if "suggestion" in each]
    assert [(each["effects"], each["explains"], each["noise"]) for each in suggested] == [("wet(?b)", 5, 6)]


def test_people_are_told_in_words(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    domain, given = tmp_path / "tidy.nid", tmp_path / "e.jsonl"
    domain.write_text(TEXT, encoding="utf-8")
    given.write_text(line("ab") + line("bc") + line("", wet="a") * 2, encoding="utf-8")
    assert run(["learn", str(domain), str(given), "--explain"]) == 0
    told = capsys.readouterr().out
    most = "`0.6: not dirty(?b), forall ?o - box: beside(?b, ?o) => not dirty(?o)`"
    assert f"{given}, 1. wipe(a), by wiped" in told
    assert "though dirty(c)" in told
    assert f"nearest: {most}, but dirty(a)" in told
    assert "wiped: `0.50: wet(?b)` would explain 2 of 3 results that count as noise" in told
    assert run(["learn", str(domain), str(given), "--explain", "--write"]) == 2
