"""One mistake in a rule's probabilities is one message: what follows from it is not told besides."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain

TEXT = """domain d {
  types { area }
  predicates { dirt(?a - area)  wet(?a - area) }
  derived { dirty := count ?a - area: dirt(?a) }
  parameters { spill = 0.25 }
  actions { wipe(?a - area) }
  rule wiped: wipe(?a) { when dirt(?a) then %s }
  default { %s }
  reward { decrease(dirty) }
}"""


def codes(outcomes: str, default: str = "1: nothing") -> list[str]:
    try:
        load_domain(Source("d.nid", TEXT % (outcomes, default)))
    except Refused as refused:
        return [diagnostic.code for diagnostic in refused.diagnostics]
    return []


@pytest.mark.parametrize(
    ("outcomes", "expected"),
    [
        ("spill: wet(?a)  0.75: nothing", []),
        ("spill: wet(?a)  0.5: nothing", ["E301"]),
        ("spill: wet(?a)  0.8: nothing", ["E301"]),
        ("slip: wet(?a)  0.5: nothing", ["E226"]),
        ("0.5: nothing  slip: wet(?a)", ["E226"]),
        ("slip: wet(?a)  spill: not dirt(?a)", ["E226"]),
        ("slip: wet(?a)  1.5: nothing", ["E226", "E302"]),
        ("1/0: wet(?a)  0.5: nothing", ["E302"]),
        ("0.5: wet(?a)  1.2: nothing", ["E302"]),
        ("rest: wet(?a)  rest: nothing", ["E303"]),
        ("0.7: wet(?a)  0.7: noise  rest: nothing", ["E301"]),
        ("1: wet(?a)  rest: nothing", []),
    ],
)
def test_outcomes(outcomes: str, expected: list[str]) -> None:
    assert sorted(codes(outcomes)) == expected


@pytest.mark.parametrize(
    ("default", "expected"),
    [
        ("0.5: wet(?a)  0.2: noise", ["E310"]),
        ("0.9: wet(?a)  0.1: noise", ["E310"]),
        ("1: wet(?a)", ["E310"]),
        ("0.5: nothing  0.2: noise", ["E301"]),
        ("0.5: nothing  0.5: noise", []),
    ],
)
def test_a_default_that_says_more_than_it_can(default: str, expected: list[str]) -> None:
    assert codes("1: not dirt(?a)", default) == expected


@pytest.mark.parametrize(
    ("head", "outcome", "expected"),
    [
        ("wipe(?a, ?h)", "not dirt(?a), kept(?a)", ["E203", "E208"]),
        ("wipe(?a, ?h)", "not dirt(?h), wet(?b)", ["E204", "E208"]),
        ("wipe(?a, ?h)", "not dirt(?h), wet(?a)", ["E208"]),
        ("wipe()", "not dirt(?a)", ["E208"]),
    ],
)
def test_too_many_variables_of_a_rule_hide_nothing_else_in_it(
    head: str, outcome: str, expected: list[str]
) -> None:
    """docs/language.md: all mistakes of a text are told, and none that follows from another."""
    text = TEXT.replace("wipe(?a) {", f"{head} {{") % (f"1: {outcome}", "1: nothing")
    with pytest.raises(Refused) as refused:
        load_domain(Source("d.nid", text))
    assert sorted(each.code for each in refused.value.diagnostics) == expected
