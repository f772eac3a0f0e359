"""Goals as libPRADA's reward.dat, and back."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

import cleancli
from cleancli.api.conversion_result import ConversionResult
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Literal, Object, RewardKind, RewardTerm

KITCHEN = Path(__file__).parent / "kitchen"

LAMPS = """
domain lamps {
  types      { lamp }
  predicates { on(?l - lamp)  beside(?a ?b - lamp) [static]  broken(?l - lamp) }
  functions  { heat(?l - lamp): 0..2 }
  derived    { lit() := exists ?l - lamp: on(?l)  dark := count ?l - lamp: not on(?l) }
  actions    { press(?l - lamp) }
  rule press_it: press(?l) {
    when heat(?l) < 2, not on(?l)
    then 0.75: on(?l), heat(?l) += 1
         rest: broken(?l)
  }
  reward { goal - 0.25 * dark }
}
"""


def files_for(goal: str) -> ConversionResult:
    """The files of two lamps with a goal."""
    init = "init { beside(a, b), heat(a) = 0, heat(b) = 2 }"
    objects = "objects { a b - lamp }"
    problem = f"problem two {{ domain = lamps {objects} {init} goal {{ {goal} }} horizon = 3 }}"
    return cleancli.convert(LAMPS, problem, to="libprada")


@pytest.mark.parametrize(
    ("goal", "text"),
    [
        ("on(a)", "0\non(10)\n"),
        ("on(a), heat(b) = 1, not broken(b)", "1\non(10)\nheat_1(11)\n-broken(11)\n"),
        ("forall ?l - lamp: on(?l)", "1\non(10)\non(11)\n"),
    ],
)
def test_a_goal_of_literals_is_a_reward(goal: str, text: str) -> None:
    made = files_for(goal)
    assert made.texts["reward.dat"] == text
    assert "reward.dat pays in each state in which the goal holds" in made.notes
    assert "goal" not in made.notes[0]


def test_a_goal_that_asks_for_more_is_left_out() -> None:
    made = files_for("lit()")
    assert "reward.dat" not in made.texts
    assert "the goal" in made.notes[0]


def test_a_goal_comes_back(tmp_path: Path) -> None:
    files_for("on(a), not broken(b)").write(tmp_path)
    made = cleancli.convert(tmp_path)
    domain = load_domain(Source("domain.nid", made.domain))
    problem = load_problem(Source("problem.nid", made.problems["problem"]), domain)
    assert problem.goal == (
        Literal("on", (Object("o10", "object"),), frozenset({True})),
        Literal("broken", (Object("o11", "object"),), frozenset({False})),
    )
    assert domain.reward == (RewardTerm(Fraction(1), RewardKind.GOAL),)
    assert any("libPRADA pays in each state" in note for note in made.notes)
    assert load_domain(
        Source("domain.nid", cleancli.convert(tmp_path, reward="goal - cost").domain)
    ).reward == (RewardTerm(Fraction(1), RewardKind.GOAL), RewardTerm(Fraction(-1), RewardKind.COST))


def test_a_literal_of_a_function_is_one_of_its_values(tmp_path: Path) -> None:
    for path in KITCHEN.glob("*.dat"):
        (tmp_path / path.name).write_text(path.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "reward.dat").write_text("1\n# LiteralListReward\nlightSoil(3)\n-dirt(3)\n")
    problem = cleancli.convert(tmp_path).problems["problem"]
    assert "soil(o3) = light" in problem
    assert "not dirt(o3)" in problem


@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        ("2\nwater(7)\n", "E911", "rewards of kind 2 are not converted"),
        ("dirt(3)\n", "E911", "expected 0 for a literal, or 1 for several"),
        ("", "E911", "expected 0 or 1, and literals"),
        ("1\n", "E911", "expected 0 or 1, and literals"),
        ("1\ndirt(3) ?\n", "E911", "expected a literal"),
        ("1\ndusty(3)\n", "E912", "`dusty` is not declared"),
        ("1\ndirt(3 3)\n", "E912", "`dirt` is declared with 1 argument"),
        ("1\ndirt(99)\n", "E912", "neither rules nor state have an object `99`"),
        ("1\ncolour(3)\n", "E913", "no rule mentions `colour`"),
        ("1\ndirt(3)\n-dirt(3)\n", "E913", "one outcome gives `dirt` two values"),
        ("1\nlightSoil(3)\nheavySoil(3)\n", "E913", "these literals never hold together"),
    ],
)
def test_mistakes_are_located(tmp_path: Path, text: str, code: str, message: str) -> None:
    for path in KITCHEN.glob("*.dat"):
        (tmp_path / path.name).write_text(path.read_text(encoding="utf-8"), encoding="utf-8")
    (tmp_path / "reward.dat").write_text(text)
    with pytest.raises(Refused) as refused:
        cleancli.convert(tmp_path)
    found = [each for each in refused.value.diagnostics if message in each.message]
    assert [each.code for each in found] == [code], str(refused.value)
    assert found[0].span is not None
    assert found[0].span.path.endswith("reward.dat")
