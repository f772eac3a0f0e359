"""`explain --after` (docs/commands.md): the state after other actions, each with its likeliest change."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import cleancli
from support.commands import said

WATCH = """
domain watch {
  types { room }
  predicates { at(?r - room) locked(?r - room) jammed(?r - room) }
  functions { battery(): 0..4 }
  derived { shut := count ?r - room: locked(?r) }
  actions { walk(?a ?b - room) unlock(?r - room) charge() }
  rule walking: walk(?a, ?b) { when at(?a), not locked(?b), battery() >= 1
    then 1: at(?b), not at(?a), battery() -= 1 }
  rule unlocking: unlock(?r) { when locked(?r), not jammed(?r)
    then 0.1: jammed(?r) 0.3: not locked(?r) rest: nothing }
  rule charging: charge() { then 1: battery() += 3 }
  reward { decrease(shut) }
}
"""
NIGHT = """
problem night {
  domain = watch
  objects { hall vault - room }
  init { at(hall) locked(vault) battery() = 0 }
}
"""


def test_each_action_before_has_its_likeliest_change() -> None:
    """A lock opens more often than it jams, though mostly nothing happens; a count stops at its bound."""
    plain = cleancli.explain(WATCH, NIGHT, "walk(hall, vault)")
    assert (plain.rule, plain.after) == (None, ())
    found = cleancli.explain(WATCH, NIGHT, "walk(hall, vault)", after="unlock(vault) charge() charge()")
    assert [(each.action, each.effects) for each in found.after] == [
        ("unlock(vault)", ("not locked(vault)",)),
        ("charge()", ("battery() := 3",)),
        ("charge()", ("battery() := 4",)),
    ]
    assert found.rule == "walking"
    assert "battery() := 3" in found.outcomes[0].effects
    assert found == cleancli.explain(
        WATCH, NIGHT, "walk(hall, vault)", after=["unlock(vault)", "charge()", "charge()"]
    )


def test_what_changes_nothing_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "watch.nid").write_text(WATCH, encoding="utf-8")
    (tmp_path / "night.nid").write_text(NIGHT, encoding="utf-8")
    files = [tmp_path / "watch.nid", tmp_path / "night.nid"]
    words = ["explain", *files, "walk(hall, vault)", "--after", "walk(hall, vault)"]
    assert said(capsys, *words).splitlines()[:2] == [
        "after walk(hall, vault): nothing has changed, since no rule covers it",
        "walk(hall, vault): no rule covers it then",
    ]
    told = json.loads(said(capsys, *words, "--json"))
    assert told["after"] == [{"action": "walk(hall, vault)", "effects": [], "rule": None}]
    charged = said(capsys, *words[:-1], " ".join(["charge()"] * 3)).splitlines()
    assert charged[1:3] == ["after charge(): battery() := 4", "after charge(): nothing has changed"]
    assert "unknown action `wlak`" in said(capsys, *words[:-1], "wlak(hall)", code=1)
