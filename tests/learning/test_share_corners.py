"""Corners of shared, fixed and `rest` probabilities: who is left without room, zeros, totals like 2/3."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

import pytest

from cleancli.compiler.fluents import values_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.text_edit import apply_edits
from cleancli.language.load import load_domain
from cleancli.language.model import Fact, Object, Outcome, OutcomeKind, State
from cleancli.learning.edits import edits
from cleancli.learning.experience import Transition
from cleancli.learning.learn import learn
from cleancli.learning.share import exactly, shared_out

TEXT = """\
domain mop {
  types      { area }
  predicates { dirt(?a - area)  wet(?a - area) }
  derived    { left := count ?a - area: dirt(?a) }
  parameters { %s }
  actions    { wipe(?a - area) }
  rule wipe_it: wipe(?a) {
    when dirt(?a)
    then %s
  }
  reward { decrease(left) }
}
"""
ROOM = (Object("a", "area"),)
DIRTY, CLEAN, WET = (
    frozenset(Fact(name, ("a",)) for name in names) for names in (("dirt",), (), ("dirt", "wet"))
)


def learned(parameters: str, outcomes: str, *after: State) -> str:
    """The text after learning from the first state's changes to each of these."""
    text = TEXT % (parameters, outcomes)
    domain = load_domain(Source("mop.nid", text))
    experience = [Transition("wipe", ("a",), ROOM, values_of(DIRTY), values_of(state)) for state in after]
    new = apply_edits(text, edits(domain, [Source("mop.nid", text)], learn(domain, experience).rules))
    rule = load_domain(Source("mop.nid", new)).rules[0]
    assert sum(outcome.probability for outcome in rule.outcomes) == 1
    return new


@pytest.mark.parametrize(
    ("parameters", "outcomes"),
    [
        ("spill = 0.6", "0.4 [fixed]: not dirt(?a)  spill: wet(?a)"),
        ("spill = 0.6  dry = 0.4", "dry: not dirt(?a)  spill: wet(?a)"),
        ("spill = 0.6  dry = 0.2", "dry: not dirt(?a)  spill: wet(?a)  0.2 [fixed]: noise"),
    ],
    ids=["one fixed", "all shared", "shared and fixed"],
)
def test_a_parameter_that_no_outcome_could_make_up_for_stays(parameters: str, outcomes: str) -> None:
    text = learned(parameters, outcomes, WET, WET, WET, CLEAN)
    assert "spill = 0.6" in text
    assert "0.8" not in text


def test_a_fixed_parameter_stays_and_the_others_share_what_it_leaves() -> None:
    text = learned("spill = 0.2 [fixed]", "spill: wet(?a)  0.5: not dirt(?a)  rest: noise", WET, CLEAN)
    assert "spill = 0.2 [fixed]" in text
    rule = load_domain(Source("mop.nid", text)).rules[0]
    # Eq. 5 with 1 and 0 of 2: m / sqrt(2) = 7.0711; of the estimates' sum, 0.8 is left.
    gone, rest = 1 + 7.0711 * 0.5, 7.0711 * 0.3
    shares = [0.2, 0.8 * gone / (gone + rest), 0.8 * rest / (gone + rest)]
    assert [float(o.probability) for o in rule.outcomes] == pytest.approx(shares, abs=1e-4)


def test_a_rest_alone_makes_up_for_what_parameters_leave() -> None:
    text = learned("spill = 0.2", "spill: wet(?a)  0.3: not dirt(?a)  rest: noise", WET, WET, CLEAN)
    rule = load_domain(Source("mop.nid", text)).rules[0]
    spill, gone, rest = (outcome.probability for outcome in rule.outcomes)
    # Eq. 5 with 2 and 1 of 3: m / sqrt(3) = 5.7735.
    assert float(spill) == pytest.approx((2 + 5.7735 * 0.2) / 8.7735, abs=1e-4)
    assert float(gone) == pytest.approx((1 + 5.7735 * 0.3) / 8.7735, abs=1e-4)
    assert rest == 1 - spill - gone
    assert "rest [seen 0]: noise" in text


def outcome(held: str) -> Outcome:
    match held.split():
        case ["fixed", number]:
            return Outcome(Fraction(number), OutcomeKind.NOTHING, fixed=True)
        case ["shared", name]:
            return Outcome(Fraction(0), OutcomeKind.NOTHING, parameter=name)
        case ["rest"]:
            return Outcome(Fraction(0), OutcomeKind.NOISE, is_rest=True)
        case _:
            return Outcome(Fraction(0), OutcomeKind.NOTHING)


def shared_exactly(
    outcomes: Sequence[Outcome], estimates: Sequence[float], shared: Mapping[str, Fraction]
) -> tuple[Fraction, ...]:
    """What outcomes get, as the text says it."""
    found = shared_out(outcomes, estimates, {name: float(value) for name, value in shared.items()})
    return exactly(outcomes, found, shared)


THIRD = Fraction(1, 3)


@pytest.mark.parametrize(
    ("outcomes", "estimates", "expected"),
    [
        (["free", "free"], [0.0, 0.0], [0.5, 0.5]),
        (["free", "free", "fixed 1/3"], [0.0, 0.0, 0.9], [THIRD, THIRD, THIRD]),
        (["free", "free", "free"], [0.0, 0.25, 0.75], [0, 0.25, 0.75]),
        (["free", "free", "free"], [0.0, 1 / 3, 2 / 3], [0, 1 / 3, 2 / 3]),
        (["free", "free", "fixed 1/3"], [0.5, 0.5, 0.0], [THIRD, THIRD, THIRD]),
        (["free", "free", "free", "fixed 1/3"], [0.2, 0.0, 0.2, 0.6], [THIRD, 0, THIRD, THIRD]),
        (["free", "rest", "fixed 1/2"], [0.3, 0.1, 0.6], [0.375, 0.125, 0.5]),
        (["free", "free", "rest", "shared p"], [0.3, 0.5, 0.0, 0.2], [0.3, 0.5, 0, 0.2]),
        (["free", "free", "rest", "shared p"], [0.3, 0.3, 0.2, 0.2], [0.3, 0.3, 0.2, 0.2]),
        (["free", "free", "rest", "shared p"], [0.6, 0.6, 0.0, 0.2], [0.4, 0.4, 0, 0.2]),
        (["free", "rest", "shared p"], [0.9, 0.3, 0.2], [0.6, 0.2, 0.2]),
        (["fixed 1/3", "fixed 2/3"], [0.1, 0.9], [THIRD, 2 * THIRD]),
        (["shared p", "fixed 4/5"], [0.7, 0.3], [0.2, 0.8]),
        (["rest", "shared p"], [0.1, 0.9], [0.8, 0.2]),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, list) else None,
)
def test_what_is_left_is_shared_in_proportion(
    outcomes: Sequence[str], estimates: Sequence[float], expected: Sequence[float]
) -> None:
    found = shared_exactly([outcome(held) for held in outcomes], estimates, {"p": Fraction(1, 5)})
    assert sum(found) == 1
    assert [float(value) for value in found] == pytest.approx([float(value) for value in expected], abs=1e-4)
    zeros = [value for value, wanted in zip(found, expected, strict=True) if wanted == 0]
    assert not any(zeros), "what was never seen and has no prior stays impossible"


@pytest.mark.parametrize("free", [2, 3, 6, 7])
@pytest.mark.parametrize("total", ["1", "2/3", "1/7", "1/30000"])
def test_rounding_keeps_the_order_and_the_sum(free: int, total: str) -> None:
    estimates = [1 / (index + 2) for index in range(free)]
    outcomes = [*(outcome("free") for _ in estimates), outcome(f"fixed {1 - Fraction(total)}")]
    found = shared_exactly(outcomes, [*estimates, 0.0], {})
    assert sum(found) == 1
    assert list(found[:-1]) == sorted(found[:-1], reverse=True)
    share = float(Fraction(total)) / sum(estimates)
    assert [float(p) for p in found[:-1]] == pytest.approx([e * share for e in estimates], abs=1.01e-4)
    units = [value * 10_000 for value in found[1:-1]]
    assert all(value.denominator == 1 for value in units), "all but the largest have four decimals"


@pytest.mark.parametrize("times", [1, 40])
def test_parameters_take_no_more_than_fixed_outcomes_leave(times: int) -> None:
    text = learned(
        "spill = 0.2  slip = 0.1",
        "0.5 [fixed]: noise  spill: wet(?a)  slip: not dirt(?a), wet(?a)  rest: not dirt(?a)",
        *[WET, WET, frozenset({Fact("wet", ("a",))})] * times,
    )
    domain = load_domain(Source("mop.nid", text))
    spill, slip = (float(parameter.probability) for parameter in domain.parameters)
    # Eq. 5 with 2 and 1 of 3 (times 1 or 40), and 10 / sqrt(examples) for the prior.
    weight = 10 / (3 * times) ** 0.5
    wanted = [(seen * times + weight * prior) / (3 * times + weight) for seen, prior in ((2, 0.2), (1, 0.1))]
    factor = min(1.0, 0.5 / sum(wanted))
    assert factor < 1
    assert [spill, slip] == pytest.approx([value * factor for value in wanted], abs=2e-4)
    assert spill + slip <= 0.5
