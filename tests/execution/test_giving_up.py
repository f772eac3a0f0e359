"""docs/execution.md, "Failures and limits": when an action that changes nothing is given up."""

from __future__ import annotations

from fractions import Fraction

import pytest

from cleancli.execution.episode_state import Move, Situation
from cleancli.execution.events import Checkpoint, Ended, Started
from cleancli.execution.foreseen import Foreseen, foreseen
from cleancli.execution.loop import clean
from cleancli.execution.session import symbolic_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.geometry.ellipse import Ellipse
from cleancli.language.model import Domain, Fact, Object
from cleancli.learning.method import Method
from cleancli.motion.actions import tool_path
from cleancli.perception.area import Area
from support.from_text import domain, problem
from support.shipped import shipped_domain, shipped_scene

FERRY = """
domain ferry {{
  types      {{ bank boat }}
  predicates {{ full(?b - boat)  over() }}
  actions    {{ load(?b - boat) sail() }}
  rule load_it: load(?b) {{
    when not full(?b)
    then {load}
  }}
  rule sail_it: sail() {{
    when exists ?b - boat: full(?b)
    then {sail}
  }}
  reward {{ goal }}
}}
"""
CROSSING = "objects { b - boat }  init { }  goal { over() }  horizon = 99"


def ferry(load: str = "1: full(?b)", sail: str = "1: over()") -> Domain:
    return domain(FERRY.format(load=load, sail=sail))


def tries(believed: Domain, true: Domain) -> tuple[list[str], str]:
    """The actions carried out where the world acts by other rules, and why the episode ended."""
    options = EpisodeOptions("plan-1", "exact", max_actions=300)
    here = symbolic_session(believed, problem(believed, CROSSING), options, acting=true)
    events = list(clean(here.setup, here.cell))
    ended = events[-1]
    assert isinstance(ended, Ended)
    return [str(event.move) for event in events if isinstance(event, Started)], ended.reason


@pytest.mark.parametrize(
    ("nothing", "times"),
    [
        ("0", 4),  # never before four
        ("0.3", 4),  # 0.3^4 = 0.0081
        ("0.4", 6),  # 0.4^5 = 0.01024, 0.4^6 = 0.0041
        ("0.9", 44),  # 0.9^43 = 0.0108, 0.9^44 = 0.0097
    ],
)
@pytest.mark.parametrize("kind", ["nothing", "noise"])
def test_an_action_is_given_up_once_so_many_failures_are_improbable(
    nothing: str, times: int, kind: str
) -> None:
    """By its rule; here the boat is in truth never filled. Noise changes nothing in the symbolic world."""
    outcomes = f"rest: full(?b) {nothing}: {kind}"
    done, reason = tries(ferry(outcomes), ferry("1: nothing"))
    assert done == ["load(b)"] * times
    assert reason == "nothing seems worth doing; in vain: load(b)"


def test_an_action_without_objects_is_given_up_as_others_are() -> None:
    done, reason = tries(ferry(sail="0.5: over() 0.5: nothing"), ferry(sail="1: nothing"))
    assert done == ["load(b)"] + ["sail()"] * 7  # 0.5^6 = 0.0156, 0.5^7 = 0.0078
    assert reason == "nothing seems worth doing; in vain: sail()"


def test_an_action_that_changes_what_it_does_not_name_was_not_in_vain() -> None:
    """In the symbolic world all facts count: each push moves the far counter, and none the button."""
    lift = domain("""
        domain lift {
          types      { button cabin }
          functions  { floor(?c - cabin): 0..9 }
          predicates { lit(?b - button) }
          actions    { push(?b - button) }
          rule up: push(?b) { with ?c - cabin: floor(?c) < 9  then 1: floor(?c) += 1 }
          reward     { goal }
        }
    """)
    inside = """objects { b - button c - cabin } init { floor(c) = 0 }
                goal { forall ?c - cabin: floor(?c) = 9 } horizon = 9"""
    here = symbolic_session(lift, problem(lift, inside), EpisodeOptions("plan-1", "exact"))
    *_, ended = clean(here.setup, here.cell)
    assert isinstance(ended, Ended)
    assert (ended.clean, ended.actions) == (True, 9)


def test_what_is_learned_counts_from_when_it_was_learned() -> None:
    """The chance of failures in a row is the product of what was believed before each of them: here
    1/10, 2/11, 3/12 and 4/13, by eq. 4 with a prior of ten examples, one of which changed nothing."""
    believed = ferry("0.9: full(?b) 0.1: nothing")
    learning = Method(estimator="m", m=10.0)
    options = EpisodeOptions("plan-1", "exact", max_actions=300, learning=learning)
    here = symbolic_session(believed, problem(believed, CROSSING), options, acting=ferry("1: nothing"))
    states = [event.state for event in clean(here.setup, here.cell) if isinstance(event, Checkpoint)]
    chances = {vain.times: vain.chance for state in states for vain in state.vain}
    expected = Fraction(1)
    for failures in range(4):
        expected *= Fraction(1 + failures, 10 + failures)
        assert chances[failures + 1] == pytest.approx(float(expected), abs=1e-4)  # of four digits
    assert max(chances) == 4


def test_on_a_table_noise_may_be_anything() -> None:
    """There a rule's own word counts alone, and what only the default rule tells is not foreseen."""
    cleaning = shipped_domain("cleaning")
    here = Area(Ellipse((0.0, 0.0), (0.03, 0.02), 0.0), 1e-3, "a1")
    facts = {Fact("dirt", ("a1",)), Fact("scattered", ("a1",)), Fact("size", ("a1",), "small")}
    table = Situation((here,), (Object("a1", "area"),), frozenset(facts))
    move = Move("pickUp", ("a1",))
    names = [rule.name for rule in cleaning.rules]
    assert foreseen(cleaning, table, move) == Foreseen(names.index("pick_scattered"), 0.3)
    symbolic = Situation((), table.objects, table.state)
    assert foreseen(cleaning, symbolic, move) == Foreseen(names.index("pick_scattered"), 0.5)
    assert foreseen(cleaning, Situation((), table.objects, frozenset()), move) == Foreseen()
    path = tool_path("moveToContainerFast", (here.ellipse,), shipped_scene("two_groups"))
    assert foreseen(cleaning, table, Move("moveToContainerFast", ("a1",), path)) == Foreseen()


def test_rules_that_ship_give_a_push_up_after_four_on_a_table() -> None:
    """Noise may be anything there. So no rule lets its action change nothing with more than 0.316, the fourth
    root of 0.01."""
    for name in ("cleaning", "sweeping", "piles", "wiping_ink"):
        for rule in shipped_domain(name).rules:
            nothing = sum(outcome.probability for outcome in rule.outcomes if outcome.kind.value == "nothing")
            assert nothing**4 < Fraction(1, 100), rule.name
