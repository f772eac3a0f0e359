"""docs/report.md: what a plan goes on from after each of its steps."""

from __future__ import annotations

import pytest

from cleancli.recording.journal import Chance, Expected, FactEntry, StepEntry
from cleancli.report.steps import step_text

OUTCOMES = (
    Chance(0.15, "change", (FactEntry("jammed", ("p1",), False),)),
    Chance(0.05, "noise", ()),
    Chance(0.8, "nothing", ()),
)


@pytest.mark.parametrize(
    ("follows", "told"),
    [
        (0, "once it comes to: not jammed(p1) (0.15)"),
        (2, "likeliest: nothing changes (0.80)"),
        (None, "likeliest: nothing changes (0.80)"),
    ],
)
def test_a_step_tells_what_the_plan_goes_on_from(follows: int | None, told: str) -> None:
    assert step_text(StepEntry("clear", ("p1",), Expected("clear_it", OUTCOMES), follows)) == told


def test_a_step_that_no_rule_covers_says_so() -> None:
    assert step_text(StepEntry("clear", ("p1",), Expected(None, ()))) == "no rule says what it does"
