"""Commands that show what a domain means: show, compile, explain."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import pytest

from cleancli.cli.main import run
from cleancli.compiler.dump import dump
from cleancli.compiler.ground import ground
from cleancli.language.model import Action, Object, Rule, Symbol, Type
from cleancli.planning.evaluation.coverage import coverage
from support.commands import said
from support.shipped import shipped_domain, shipped_problem

DOMAIN = shipped_domain("cleaning")
TASK = ground(DOMAIN, shipped_problem("three_areas", DOMAIN))


# ---- show


def test_show_names_everything_declared(capsys: pytest.CaptureFixture[str]) -> None:
    text = said(capsys, "show", "cleaning")
    kinds: tuple[tuple[Type | Symbol | Action | Rule | Object, ...], ...] = (
        DOMAIN.types,
        DOMAIN.symbols,
        DOMAIN.actions,
        DOMAIN.rules,
        DOMAIN.constants,
    )
    for declared in itertools.chain(*kinds):
        assert declared.name in text
    assert "└── place\n    ├── area\n    └── container\n" in text
    assert "near(?a - area, ?b - area) [symmetric]" in text
    assert "0.4    not dirt(?a)\n" in text
    assert "groundings" not in text
    assert all(line == line.rstrip() for line in text.splitlines())


def test_show_counts_what_a_problem_gives(capsys: pytest.CaptureFixture[str]) -> None:
    data = json.loads(said(capsys, "show", "cleaning", "three_areas", "--json", "--samples", "500"))
    assert data["problem"]["actions"] == len(TASK.actions)
    assert data["problem"]["rules"] == len(TASK.rules)
    assert data["problem"]["coverage"] == coverage(TASK, 500)
    (join,) = (action for action in data["actions"] if action["name"] == "join2")
    assert join["groundings"] == sum(action.name == "join2" for action in TASK.actions)
    groundings = {rule["name"]: rule["groundings"] for rule in join["rules"]}
    assert sum(groundings.values()) == sum(TASK.actions[r.action].name == "join2" for r in TASK.rules)
    assert "12 rules" not in said(capsys, "show", "cleaning", "three_areas")


# ---- compile


def test_compile_prints_the_task(capsys: pytest.CaptureFixture[str]) -> None:
    assert said(capsys, "compile", "cleaning", "three_areas") == dump(TASK)


def test_compile_as_data(capsys: pytest.CaptureFixture[str]) -> None:
    data = json.loads(said(capsys, "compile", "cleaning", "three_areas", "--format", "json"))
    assert [action["name"] for action in data["actions"]] == [action.name for action in TASK.actions]
    assert len(data["rules"]) == len(TASK.rules)
    for rule in data["rules"]:
        assert sum(outcome["probability"] for outcome in rule["outcomes"]) == pytest.approx(1)


# ---- explain


def test_explain_a_covered_action(capsys: pytest.CaptureFixture[str]) -> None:
    text = said(capsys, "explain", "cleaning", "three_areas", "join2(a1, a3)")
    assert text.startswith("join2(a1, a3): covered by rule join_to_small (?a = a1, ?b = a3)\n")
    assert "  0.45: not dirt(a1), size(a3) := medium\n" in text
    assert "  0.05: nothing\n" in text
    assert (
        "rule join_to_big does not apply (?a = a1, ?b = a3)\n  size(?b) = big  fails: size(a3) is small"
        in text
    )


def test_explain_what_a_forall_changes(capsys: pytest.CaptureFixture[str]) -> None:
    text = said(capsys, "explain", "cleaning", "three_areas", "moveToContainerFast(a1)")
    assert "0.8: not dirt(a1), not dirt(a3)\n" in text, "a3 lies on the way"


def test_explain_why_no_rule_applies(capsys: pytest.CaptureFixture[str]) -> None:
    text = said(capsys, "explain", "cleaning", "three_areas", "join3(a1 a2 a1)")
    assert text.startswith(
        "join3(a1, a2, a1): no rule covers it in the initial state of three_areas\ndefault\n"
    )
    assert "  near(?a, ?b)  fails: near(a1, a2) is false\n" in text
    assert "  ?a != ?c      fails: both are a1\n" in text
    assert "dirt(?a)" not in text, "what holds is not named"


def test_explain_as_data(capsys: pytest.CaptureFixture[str]) -> None:
    data = json.loads(said(capsys, "explain", "cleaning", "three_areas", "pickUp(a2)", "--json"))
    assert data["rule"] == "pick_scattered"
    assert [outcome["effects"] for outcome in data["outcomes"]] == [
        ["not dirt(a2)"],
        ["not scattered(a2)"],
        [],
        [],
    ]
    assert data["other_rules"][0] == {
        "rule": "pick_small",
        "binding": {"a": "a2"},
        "failing": [
            {"literal": "size(?a) = small", "instead": "size(a2) is medium"},
            {"literal": "not scattered(?a)", "instead": "scattered(a2) is true"},
        ],
        "unclear": None,
    }


@pytest.mark.parametrize(
    ("action", "words"),
    [
        ("pickup(a1)", ["ACTION:1:1: error[E206]", "^^^^^^\n", "did you mean `pickUp`"]),
        ("join2(a1, a33)", ["ACTION:1:11: error[E205]", "          ^^^", "did you mean `a3`"]),
        ("join2(a1)", ["error[E208]: `join2` takes 2 objects, not 1", "`join2(?a - area, ?b - area)`"]),
        ("pickUp(bin)", ["error[E209]: `bin` is of type `container`, `pickUp` wants `area`"]),
        ("pickUp(a1", ["error[E104]", "write for example `moveToContainerFast(a1)`, in quotation"]),
        ("", ["error[E104]"]),
    ],
)
def test_explain_refuses_with_a_place(
    action: str, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["explain", "cleaning", "three_areas", action]) == 1
    told = capsys.readouterr()
    assert told.out == ""
    for word in words:
        assert word in told.err


def test_a_scene_is_looked_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    text = said(capsys, "explain", "cleaning", "two_groups", "groupScattered(a1)")
    assert text.startswith("groupScattered(a1): no rule covers it in the initial state of two_groups")
    assert "fails: scattered(a1) is false" in text
    assert "variable dirt(a1)" in said(capsys, "compile", "cleaning", "two_groups")


PANS = """domain pans {
  types { pan }
  predicates { washed(?p - pan)  dried(?p - pan)  stored(?p - pan) }
  derived {
    dry(?p - pan) := dried(?p), washed(?p)
    ready(?p - pan) := dry(?p), not stored(?p)
    left := count ?p - pan: not stored(?p)
  }
  actions { store(?p - pan)  wash(?p - pan)  wipe(?p - pan) }
  rule put: store(?p) { when ready(?p) then 1: stored(?p) }
  rule washing: wash(?p) { when not washed(?p) then 1: washed(?p) }
  rule wiping: wipe(?p) { when not dried(?p) then 1: dried(?p) }
  reward { decrease(left) }
}
"""


def test_what_a_derived_predicate_lacks_is_told_down_to_the_facts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "pans.nid").write_text(PANS)
    kitchen = "problem kitchen { domain = pans objects { p1 - pan } init { washed(p1) } horizon = 3 }"
    (tmp_path / "kitchen.nid").write_text(kitchen)
    told = said(capsys, "explain", tmp_path / "pans.nid", tmp_path / "kitchen.nid", "store(p1)")
    assert told.splitlines()[-4:] == [
        "rule put does not apply (?p = p1)",
        "  ready(?p)  fails: ready(p1) is false",
        "    since dry(?p) fails: dry(p1) is false",
        "      since dried(?p) fails: dried(p1) is false",
    ]
