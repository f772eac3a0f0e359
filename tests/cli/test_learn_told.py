"""What `learn` says of how much it learned from: rules that are written, and what they were seen for."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cleancli.cli.main import run

DOMAIN = """domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp) }
  derived    { burning := count ?l - lamp: lit(?l) }
  actions    { press(?l - lamp) }
  rule go_out: press(?l) { when lit(?l) then 0.9: not lit(?l)  0.1: nothing }
  %s
  reward { decrease(burning) }
}
"""


@pytest.mark.parametrize(
    ("default", "told"),
    [
        ("", "2 transitions, 1 example for 1 of 1 rule\n1 transition that no rule covers: "),
        ("default { 1: nothing }", "2 transitions, 2 examples for 2 of 2 rules\n"),
    ],
)
def test_a_default_that_is_not_written_is_no_rule(
    default: str,
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("lamps.nid").write_text(DOMAIN % default, encoding="utf-8")
    lit = [["lit", ["l1"], True]]
    lines = [
        {"action": "press", "arguments": ["l1"], "objects": {"l1": "lamp"}, "before": before, "after": []}
        for before in (lit, [])
    ]
    Path("seen.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    assert run(["learn", "lamps.nid", "seen.jsonl"]) == 0
    assert told in capsys.readouterr().out
