"""The interpreter of the differential test, on examples whose values were worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from support.differential.abstract import (
    Action,
    Count,
    Domain,
    ForEach,
    Outcome,
    Payment,
    Price,
    Priced,
    Problem,
    Rule,
    SetTruth,
    SetValue,
    Shift,
    Symbol,
    Truth,
    Variable,
)
from support.differential.interpreter import Meaning, TwoRules, TwoValues
from support.differential.worth import STOP, Worth

A, B, M = Variable("?a", "area"), Variable("?b", "area"), Variable("?m", "area")
DIRT, OPEN = Symbol("dirt", ("area",)), Symbol("open", ("area",))
LEFT = Count("left", (A,), (Truth("dirt", ("?a",)),))
OPENED = Count("opened", (A,), (Truth("open", ("?a",)),))


def outcome(*effects: object, probability: str = "1", idle: str = "") -> Outcome:
    return Outcome(Fraction(probability), probability, "", effects, idle)  # type: ignore[arg-type]


def rule(
    name: str, *outcomes: Outcome, when: tuple[Truth, ...] = (), of: tuple[Variable, ...] = (A,)
) -> Rule:
    return Rule(f"rule_{name}", name, of, when, (), outcomes)


WIPE = rule("wipe", outcome(SetTruth("dirt", ("?a",), False)), when=(Truth("dirt", ("?a",)),))
START = rule("start", outcome(SetTruth("open", ("?a",), True)), when=(Truth("open", ("?a",), False),))


def meaning(
    rules: tuple[Rule, ...],
    reward: tuple[Payment, ...],
    *,
    symbols: tuple[Symbol, ...] = (DIRT, OPEN),
    areas: tuple[str, ...] = ("a1",),
    facts: tuple[tuple[tuple[str, tuple[str, ...]], bool | int], ...] = (),
    goal: tuple[Truth, ...] = (),
    horizon: int = 4,
    discount: str = "1",
    durations: dict[str, str] | None = None,
) -> Meaning:
    parameters = {each.action: each.parameters for each in rules}
    actions = tuple(
        Action(name, variables, (durations or {}).get(name), None) for name, variables in parameters.items()
    )
    domain = Domain("d", (("area", None),), (), symbols, (), (LEFT, OPENED), (), actions, rules, None, reward)
    objects = tuple(Variable(name, "area") for name in areas)
    return Meaning(domain, Problem("p", objects, facts, goal, (horizon, None), discount))


GOAL_PAYS = (Payment(Fraction(5), "goal"), Payment(Fraction(-1), "count", "opened"))


def test_stopping_is_final_where_it_would_pay_to_wait() -> None:
    worth = Worth(meaning((START,), GOAL_PAYS, goal=(Truth("open", ("a1",)),)))
    best = worth.choice(worth.meaning.initial(), 4)
    assert (best.value, best.equals) == (1, (("start", ("a1",)),))


def test_an_action_that_does_nothing_is_waiting() -> None:
    wait = rule("wait", outcome(idle="nothing"), of=())
    worth = Worth(meaning((START, wait), GOAL_PAYS, goal=(Truth("open", ("a1",)),)))
    best = worth.choice(worth.meaning.initial(), 4)
    assert (best.value, best.equals) == (4, (("wait", ()),))
    assert worth.of_sequence([("wait", ())] * 3 + [("start", ("a1",))]) == 4
    assert worth.of_sequence([("wait", ())] * 4 + [("start", ("a1",))]) == 0


def test_acting_on_the_way_puts_off_what_costs() -> None:
    reward = (Payment(Fraction(1), "decrease", "left"), *GOAL_PAYS)
    dirty = ((("dirt", ("a1",)), True),)
    midway = meaning((WIPE, START), reward, facts=dirty, goal=(Truth("open", ("a1",)),), discount="0.9")
    worth = Worth(midway)
    best = worth.choice(midway.initial(), 4)
    assert float(best.value) == pytest.approx(3.061)
    assert best.equals == (("wipe", ("a1",)),)
    assert worth.of_sequence([("wipe", ("a1",)), ("start", ("a1",))]) == best.value


def test_with_discount_one_nothing_is_put_off() -> None:
    wait = rule("wait", outcome(idle="nothing"), of=())
    reward = (Payment(Fraction(1), "decrease", "left"),)
    worth = Worth(meaning((WIPE, wait), reward, facts=((("dirt", ("a1",)), True),)))
    assert worth.choice(worth.meaning.initial(), 4).equals == (("wipe", ("a1",)),)
    clean = worth.meaning.initial().__class__(False for _ in worth.meaning.keys)
    assert worth.choice(clean, 3).equals == (STOP,)


def test_time_has_one_scale() -> None:
    scrub = rule("scrub", outcome(SetTruth("dirt", ("?a",), False)), when=(Truth("dirt", ("?a",)),))
    look = rule("look", outcome(idle="nothing"), of=())
    dirty = tuple((("dirt", (name,)), True) for name in ("a1", "a2"))
    durations = {"wipe": "2 s", "scrub": "4 s", "look": "20 s"}
    reward = (Payment(Fraction(1), "decrease", "left"),)
    timed = meaning(
        (WIPE, scrub, look), reward, areas=("a1", "a2"), facts=dirty, discount="0.5", durations=durations
    )
    worth = Worth(timed, by_time=True)
    wiped = [("wipe", ("a1",)), ("wipe", ("a2",))]
    assert worth.of_sequence(wiped) == pytest.approx(2.0536, abs=5e-5)
    assert worth.of_sequence([*wiped, ("look", ())]) == pytest.approx(2.0536, abs=5e-5)


LOAD = Symbol("load", ("area",), tuple(range(4)))


def test_shifts_add_up_before_the_bounds_hold() -> None:
    both = rule("both", outcome(Shift("load", ("?a",), 3), Shift("load", ("?b",), -2)), of=(A, B))
    loads = ((("load", ("a1",)), 2), (("load", ("a2",)), 1))
    shifted = meaning((both,), (), symbols=(DIRT, OPEN, LOAD), areas=("a1", "a2"), facts=loads)
    start = shifted.initial()

    def load(first: str, second: str) -> tuple[object, object]:
        (after,) = shifted.successors(("both", (first, second)), start)
        return shifted.value("load", ("a1",), after), shifted.value("load", ("a2",), after)

    assert load("a1", "a2") == (3, 0)
    assert load("a1", "a1") == (3, 1)
    assert load("a2", "a2") == (2, 2)


def test_bindings_of_a_forall_add_up() -> None:
    gathered = ForEach((M,), (Truth("dirt", ("?m",)),), (Shift("load", ("?a",), 1),))
    gather = rule("gather", outcome(gathered))
    facts = (
        (("dirt", ("a1",)), True),
        (("dirt", ("a2",)), True),
        (("load", ("a1",)), 0),
        (("load", ("a2",)), 0),
    )
    found = meaning((gather,), (), symbols=(DIRT, OPEN, LOAD), areas=("a1", "a2"), facts=facts)
    (after,) = found.successors(("gather", ("a1",)), found.initial())
    assert found.value("load", ("a1",), after) == 2


@pytest.mark.parametrize(
    "effects",
    [
        (SetTruth("dirt", ("?a",), False), SetTruth("dirt", ("?b",), True)),
        (SetValue("load", ("?a",), 1), SetValue("load", ("?b",), 2)),
        (SetValue("load", ("?a",), 1), Shift("load", ("?b",), 1)),
    ],
)
def test_two_values_of_one_thing_conflict(effects: tuple[object, ...]) -> None:
    both = rule("both", outcome(*effects), of=(A, B))
    facts = ((("load", ("a1",)), 0), (("load", ("a2",)), 0))
    found = meaning((both,), (), symbols=(DIRT, OPEN, LOAD), areas=("a1", "a2"), facts=facts)
    assert len(found.successors(("both", ("a1", "a2")), found.initial())) == 1
    with pytest.raises(TwoValues):
        found.successors(("both", ("a1", "a1")), found.initial())


def test_two_equal_values_are_fine_and_two_rules_are_not() -> None:
    both = rule("both", outcome(SetTruth("open", ("?a",), True), SetTruth("open", ("?b",), True)), of=(A, B))
    found = meaning((both,), ())
    (after,) = found.successors(("both", ("a1", "a1")), found.initial())
    assert found.value("open", ("a1",), after) is True
    again = meaning((both, Rule("other", "both", (A, B), (), (), both.outcomes)), ())
    with pytest.raises(TwoRules):
        again.successors(("both", ("a1", "a1")), again.initial())


def test_prices_are_counted_with_the_values_for_objects() -> None:
    """Docking costs 1 + 2 * far(?a, ?b), and their outcome pays far(?b, ?b) less half of far(?a, ?b)."""
    far = Symbol("far", ("area", "area"), tuple(range(10)), static=True)
    farther = Price(Fraction(1), (Priced(Fraction(2), "far", ("?a", "?b")),))
    pays = Price(
        parts=(Priced(Fraction(1), "far", ("?b", "?b")), Priced(Fraction(-1, 2), "far", ("?a", "?b")))
    )
    earned = Outcome(Fraction(1), "1", "", (), reward=pays, cost=Price(Fraction(3)))
    pairs = {("a1", "a1"): 0, ("a1", "a2"): 5, ("a2", "a1"): 7, ("a2", "a2"): 4}
    facts = tuple((("far", pair), value) for pair, value in pairs.items())
    reward = (Payment(Fraction(-10), "cost"),)
    of_areas = meaning(
        (rule("dock", earned, of=(A, B)),), reward, symbols=(far,), areas=("a1", "a2"), facts=facts
    )
    costly = replace(of_areas.domain, counts=(), actions=(Action("dock", (A, B), None, farther),))
    worth = Worth(Meaning(costly, of_areas.problem))
    start = worth.meaning.initial()
    assert worth.meaning.cost(("dock", ("a1", "a2")), start) == 11
    assert worth.results(start, ("dock", ("a1", "a2"))) == [
        (Fraction(1), start, -110 + 4 - Fraction(5, 2) - 30)
    ]
    assert worth.results(start, ("dock", ("a2", "a1"))) == [
        (Fraction(1), start, -150 + 0 - Fraction(7, 2) - 30)
    ]
