"""Rules give way to others in a text, and everything else stays."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.text_edit import apply_edits
from cleancli.language.load import load_domain
from cleancli.language.model import Outcome, OutcomeKind
from cleancli.language.parsing.parse import parse
from cleancli.language.printing.rule_edits import rule_edits

TEXT = """domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp) }
  derived    { burning := count ?l - lamp: lit(?l) }
  actions    { press(?l - lamp)  hit(?l - lamp) }

  # ---- Pressing.

  # goes out
  # sometimes
  rule go_out: press(?l) { when lit(?l) then 0.9: not lit(?l)  0.1: nothing }  # as a rule
  rule go_on: press(?l) {
    when not lit(?l)
    then 1: lit(?l)
  }
  rule hit_it: hit(?l) { then 1: lit(?l) }
  reward { decrease(burning) }
}
"""
SOURCE = Source("lamps.nid", TEXT)


def edited(dropped: list[str], added: list[str], noise: bool = False) -> str:
    domain = load_domain(SOURCE)
    rules = [replace(domain.rules[0], name=name) for name in added]
    default = (Outcome(Fraction(1, 4), OutcomeKind.NOISE), Outcome(Fraction(3, 4), OutcomeKind.NOTHING))
    return apply_edits(TEXT, rule_edits(domain, [SOURCE], dropped, rules, default if noise else ()))


def test_a_rule_goes_with_the_comments_right_above_it_and_others_come_in_its_place() -> None:
    start, end = TEXT.index("  # goes out"), TEXT.index("  rule go_on")
    new = "  rule new: press(?l) {\n    when lit(?l)\n    then 0.9: not lit(?l)\n         0.1: nothing\n  }\n"
    assert edited(["go_out"], ["new"]) == TEXT[:start] + new + TEXT[end:]
    assert edited(["go_out"], []) == TEXT[:start] + TEXT[end:]


def test_rules_come_before_the_reward_where_none_goes() -> None:
    text = edited([], ["new", "newer"], noise=True)
    places = ["rule hit_it", "rule new:", "rule newer:", "default {", "reward"]
    assert sorted(map(text.index, places)) == list(map(text.index, places))
    parse(Source("new.nid", text))


def test_all_rules_of_an_action_go_and_nothing_comes() -> None:
    text = edited(["go_out", "go_on"], [])
    assert [line for line in text.splitlines() if "rule" in line] == [
        "  rule hit_it: hit(?l) { then 1: lit(?l) }"
    ]
    assert edited([], []) == TEXT


def test_a_rule_comes_where_one_of_its_action_stood() -> None:
    domain = load_domain(SOURCE)
    new = [replace(domain.rules[2], name="hit_new"), replace(domain.rules[0], name="press_new")]
    text = apply_edits(TEXT, rule_edits(domain, [SOURCE], ["go_out", "hit_it"], new))
    places = ["rule press_new", "rule go_on", "rule hit_new", "reward"]
    assert sorted(map(text.index, places)) == list(map(text.index, places))
    assert "go_out" not in text
