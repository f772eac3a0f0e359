"""Messages that say what to write instead, where somebody was seen to need it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import cleancli
from cleancli.cli.main import run

LAMPS = """
domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp) }
  derived    { burning := count ?l - lamp: lit(?l) }
  actions    { press(?l ?m - lamp) }
  rule swap: press(?l, ?m) { when lit(?l) then 0.9: not lit(?l), lit(?m)  0.1: nothing }
  reward { decrease(burning) }
}
"""
TWO = "problem two { domain = lamps objects { a b - lamp } init { lit(a) } }"


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def said(capsys: pytest.CaptureFixture[str], command: str, code: int = 0) -> str:
    assert run(command.split()) == code
    found = capsys.readouterr()
    return found.out + found.err


def test_ones_own_file_is_meant_by_its_path(capsys: pytest.CaptureFixture[str]) -> None:
    Path("lamps.nid").write_text(LAMPS, encoding="utf-8")
    assert "did you mean `lamps.nid`?" in said(capsys, "plan lamps three_areas", 1)
    assert "did you mean `cleaning`?" in said(capsys, "plan cleanin three_areas", 1)


def test_check_finds_what_conflicts_for_the_objects_of_a_problem(capsys: pytest.CaptureFixture[str]) -> None:
    """docs/language.md, "Outcomes": press(a, a) would make `lit(a)` false and true."""
    Path("lamps.nid").write_text(LAMPS, encoding="utf-8")
    Path("two.nid").write_text(TWO, encoding="utf-8")
    assert "error[E602]" not in said(capsys, "check lamps.nid")
    told = said(capsys, "check .", 1)
    assert "lamps.nid:7:" in told
    assert "error[E602]: for press(a, a), one outcome gives lit(a) two values" in told
    Path("lamps.nid").write_text(LAMPS.replace("when lit(?l)", "when lit(?l), ?l != ?m"), encoding="utf-8")
    said(capsys, "check .")


@pytest.mark.parametrize(
    "text",
    [
        "study s { scene = three_areas  planner = prada+ }",
        "problem p { domain = cleaning objects { a - area } init { } planner { name = prada+ } }",
    ],
)
def test_prada_plus_is_told_as_files_write_it(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("file.nid").write_text(text, encoding="utf-8")
    told = said(capsys, "check file.nid", 1)
    assert 'help: a study writes `prada_plus`, and a problem `name = "prada+"`' in told


@pytest.mark.parametrize(
    ("right", "wrong"), [("horizon", "horizont"), ("discount", "discounts"), ("objects", "objectss")]
)
def test_a_word_with_more_letters_is_told_without_them(
    right: str, wrong: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = "problem p { domain = cleaning objects { a - area } init { } horizon = 3 discount = 0.9 }"
    Path("file.nid").write_text(text.replace(right, wrong), encoding="utf-8")
    assert f"help: did you mean `{right}`, and not `{wrong}`?" in said(capsys, "check file.nid", 1)


def test_learning_the_same_again_says_that_nothing_is_new(capsys: pytest.CaptureFixture[str]) -> None:
    Path("lamps.nid").write_text(LAMPS, encoding="utf-8")
    line: dict[str, object] = {
        "action": "press",
        "arguments": ["a", "b"],
        "objects": {"a": "lamp", "b": "lamp"},
    }
    line |= {"before": [["lit", ["a"], True]], "after": [["lit", ["b"], True]]}
    Path("seen.jsonl").write_text(json.dumps(line) + "\n", encoding="utf-8")
    command = "learn lamps.nid seen.jsonl --write"
    assert said(capsys, command).endswith("wrote lamps.nid\n")
    assert said(capsys, command).endswith("nothing new: lamps.nid says all of this already\n")


def test_the_margin_is_told_of_the_planners_that_have_one(capsys: pytest.CaptureFixture[str]) -> None:
    Path("lamps.nid").write_text(LAMPS.replace("0.9: not lit(?l), ", "0.9: "), encoding="utf-8")
    Path("two.nid").write_text(TWO, encoding="utf-8")
    for planner, has_margin in (("exact", False), ("likeliest", False), ("prada", True)):
        told = said(capsys, f"plan lamps.nid two.nid --planner {planner}")
        worth = "over 0.05 more" if has_margin else "more"
        nothing = f"no plan within 2 actions was found that is worth {worth} than doing nothing"
        assert f"nothing worth doing: {nothing}\n" in told


def test_a_path_that_is_nearly_that_of_a_file_beside_it_is_told_that_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("lamps.nid").write_text(LAMPS, encoding="utf-8")
    (tmp_path / "deep").mkdir()
    Path("deep/monday.nid").write_text(TWO, encoding="utf-8")
    Path("deep/monday.txt").touch()
    assert "did you mean `deep/monday.nid`? shipped: " in said(capsys, "plan lamps.nid deep/mondey.nid", 1)
    assert "did you mean `lamps.nid`" in said(capsys, "check lapms.nid", 1)
    with pytest.raises(cleancli.Refused, match=r"did you mean `deep/monday\.nid`\?"):
        cleancli.plan("lamps.nid", "deep/mondey.nid")


def test_a_domain_that_is_nowhere_is_told_at_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    problem = tmp_path / "p.nid"
    problem.write_text("problem p {\n  domain = cleanign\n}\n", encoding="utf-8")
    assert run(["check", str(problem)]) == 1
    out = capsys.readouterr().out
    assert f"{problem}:2:12: error[E001]: no file `cleanign`, and no shipped domain of that name" in out
    assert "did you mean `cleaning`?" in out


def test_a_problem_before_its_domain_is_told_so_in_python() -> None:
    with pytest.raises(cleancli.Refused) as refused:
        cleancli.plan("problem p { domain = cleaning }", "domain d { types { t } reward { } }")
    assert refused.value.diagnostics[0].help == "name the domain first"
    with pytest.raises(cleancli.Refused) as refused:
        cleancli.plan("problem p { domain = cleaning }", "problem q { domain = cleaning }")
    assert refused.value.diagnostics[0].help == ""


def test_rules_that_are_compared_name_the_one_that_says_two_things(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = """domain jugs {
  types { jug }
  predicates { full(?j - jug) }
  derived { filled := count ?j - jug: full(?j) }
  actions { pour(?a ?b - jug) }
  rule pouring: pour(?a, ?b) { when full(?a) then 1: not full(?a), full(?b) }
  reward { filled }
}
"""
    (tmp_path / "jugs.nid").write_text(text, encoding="utf-8")
    assert (
        run(["compare-rules", str(tmp_path / "jugs.nid"), str(tmp_path / "jugs.nid"), "--states", "60"]) == 0
    )
    out = " ".join(capsys.readouterr().out.split())
    assert "left out, where an outcome gives one fact two values (E602); the first: for pour(" in out
    assert "in this outcome of rule `pouring`" in out
