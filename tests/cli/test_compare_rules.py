"""`cleancli compare-rules`: as docs/comparing-rules.md shows it, its codes, and what it refuses."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import cleancli
from cleancli.cli.main import run

PAGE = (Path(__file__).parents[2] / "docs" / "comparing-rules.md").read_text(encoding="utf-8")
WHOLE, RULE = re.findall(r"^```nid\n(.*?)^```$", PAGE, re.M | re.S)
PAYING = WHOLE.replace("0.1: spilt()", "0.1: spilt(), reward -= 2, cost += 1/2")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    start, end = WHOLE.index("  rule pour"), WHOLE.index("  rule wipe")
    Path("tea.nid").write_text(WHOLE, encoding="utf-8")
    Path("careful.nid").write_text(WHOLE[:start] + RULE + WHOLE[end:], encoding="utf-8")
    return tmp_path


def test_the_example_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    (shown,) = re.findall(r"^```text\n(.*?)^```$", PAGE, re.M | re.S)
    assert run(["compare-rules", "tea.nid", "careful.nid"]) == 0
    assert capsys.readouterr().out == shown
    assert str(cleancli.compare_rules("tea.nid", "careful.nid")) == shown.rstrip("\n")


def test_in_states_that_occurred(capsys: pytest.CaptureFixture[str]) -> None:
    line = (
        '{"action": "pour", "arguments": ["c"], "objects": {"c": "cup", "d": "cup"}, "before": %s,'
        ' "after": []}\n'
    )
    states = ["[]", '[["full", ["d"], true]]', '[["cracked", ["c"], true]]', '[["full", ["c"], true]]']
    Path("seen.jsonl").write_text("".join(line % state for state in states), encoding="utf-8")
    assert run(["compare-rules", "tea.nid", "careful.nid", "seen.jsonl", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["states"] == 4
    assert data["variation"] == pytest.approx((2 * 0.05 + 1) / 4)
    whole, cracked, wipe = data["rules"]
    assert (whole["first"], whole["second"], whole["states"]) == ("pour", "pour_whole", 2)
    assert (whole["variation"], whole["likeness"]) == (0.05, "other")
    assert whole["witness"]["state"] == []
    assert (cracked["second"], cracked["states"], cracked["largest"]) == (None, 1, 1.0)
    assert cracked["witness"] == {
        "action": "pour(c)",
        "objects": {"c": "cup"},
        "state": ["cracked(c)"],
        "first": [
            {"probability": 0.9, "changes": ["full(c)"]},
            {"probability": 0.1, "changes": ["spilt()"]},
        ],
        "second": [{"probability": 1.0, "changes": []}],
    }
    assert (wipe["states"], wipe["variation"], wipe["likeness"]) == (0, None, "same")


@pytest.mark.parametrize(
    ("second", "limit", "code"), [("tea", "0", 0), ("careful", "0.05", 1), ("careful", "1", 0)]
)
def test_the_limit_decides_the_exit_code(second: str, limit: str, code: int) -> None:
    assert run(["compare-rules", "tea.nid", f"{second}.nid", "--limit", limit]) == code


def test_the_seed_says_what_is_drawn(capsys: pytest.CaptureFixture[str]) -> None:
    told = []
    for seed in (3, 3, 4):
        assert run(["compare-rules", "tea.nid", "careful.nid", "--states", "50", "--seed", str(seed)]) == 0
        told.append(capsys.readouterr().out)
    assert told[0] == told[1] != told[2]
    assert "over 50 states drawn with seed 3" in told[0]


def test_other_vocabularies_are_refused_with_what_differs(capsys: pytest.CaptureFixture[str]) -> None:
    other = """domain other {
  types      { cup }
  predicates { full(?c - cup)  chipped(?c - cup)  spilt(?c - cup) }
  derived    { empty := count ?c - cup: not full(?c) }
  actions    { pour(?c - cup)  mop() }
  rule pour: pour(?c) { then 0.9: full(?c) 0.1: spilt(?c), chipped(?c) }
  reward     { decrease(empty) }
}
"""
    Path("other.nid").write_text(other, encoding="utf-8")
    assert run(["compare-rules", "tea.nid", "other.nid"]) == 2
    told = " ".join(capsys.readouterr().err.split())
    for part in (
        "only rules over one vocabulary can be compared",
        "they declare the symbol `spilt` otherwise",
        "only the first declares the symbol `cracked`",
        "only the second declares the action `mop`",
    ):
        assert part in told


def test_a_mistake_in_either_file_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    Path("wrong.nid").write_text(WHOLE.replace("0.9: full", "0.8: full"), encoding="utf-8")
    for files in (["wrong.nid", "tea.nid"], ["tea.nid", "wrong.nid"]):
        assert run(["compare-rules", *files]) == 1
        assert "error[" in capsys.readouterr().err
    with pytest.raises(ValueError, match="`states`: 0 is not in the range"):
        cleancli.compare_rules("tea.nid", "tea.nid", states=0)


def test_what_outcomes_pay_is_compared(capsys: pytest.CaptureFixture[str]) -> None:
    """A result is what changes and what is paid for it, in the text and in TV, and stands in the witness."""
    Path("paying.nid").write_text(PAYING, encoding="utf-8")
    assert run(["compare-rules", "paying.nid", "tea.nid", "--limit", "0"]) == 1
    told = capsys.readouterr().out
    pour = next(line.split() for line in told.splitlines() if line.startswith("pour"))
    assert pour == ["pour", "pour", "pour", "other", pour[4], "0.1000", "0.1000"]
    assert "0.1: spilt(), reward -= 2, cost += 0.5\n" in told
    assert "1 rule of 2 and 2 say the same" in told
    assert run(["compare-rules", "paying.nid", "paying.nid", "--limit", "0"]) == 0


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("pour(?c - cup)", "pour(?c - cup) [cost = 2]", "pour costs 0 in the first and 2 in the second"),
        (
            "pour(?c - cup)",
            "pour(?c - cup) [duration = 4 s]",
            "pour lasts no time that is said in the first and 4 s in the second",
        ),
        (
            "decrease(empty)",
            "2 * decrease(empty)",
            "the reward is `decrease(empty)` in the first and `2 * decrease(empty)` in the second",
        ),
    ],
)
def test_what_no_rule_says_is_told_beside_the_total_variation(old: str, new: str, said: str) -> None:
    found = cleancli.compare_rules("tea.nid", WHOLE.replace(old, new, 1), states=20)
    assert found.notes[-1] == f"{said}, beside TV"
    assert found.to_dict()["notes"] == list(found.notes)
    assert found.variation == 0
    assert {each.likeness for each in found.rules} == {"same"}
