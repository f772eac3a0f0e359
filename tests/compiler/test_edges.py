"""Limits just below and at, defaults of the reward, what libPRADA's grounding keeps (docs/planners.md)."""

from __future__ import annotations

import pytest

from cleancli.compiler import rewards, semantics
from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import SupportTooLargeError, exact_value, forward
from cleancli.compiler.task import Task
from cleancli.language.diagnostics.refused import Refused
from support import from_text

MOP = """domain d {
  types { area }
  predicates { dirt(?a - area)  wet(?a - area)  seen(?a - area) }
  derived {
    dirty := count ?a - area: dirt(?a)
    damp := count ?a - area: wet(?a)
  }
  actions { wipe(?a - area)  dry(?a - area) }
  rule wiped: wipe(?a) { when dirt(?a) then 0.5: not dirt(?a), wet(?a)  0.25: wet(?a)  rest: noise }
  rule dried: dry(?a) { when wet(?a) then 0.5: not wet(?a), not dirt(?a)  rest: nothing }
  reward { %s }
}"""
DIRTY = "objects { a b c - area } init { dirt(a), dirt(b), wet(c) }"


def task(reward: str, problem: str, *, compat: bool = False) -> Task:
    return ground(*from_text.checked(MOP % reward, problem), compat=compat)


@pytest.mark.parametrize(
    ("reward", "horizon"),
    [("decrease(dirty)", 3), ("decrease(damp)", 2), ("2 * decrease(damp) + decrease(dirty)", 2),
     ("decrease(dirty) + decrease(damp)", 3)],
)  # fmt: skip
def test_the_first_count_that_decreases_makes_the_horizon(reward: str, horizon: int) -> None:
    found = task(reward, DIRTY)
    assert found.horizon == horizon
    assert found.counted is not None
    decreasing = reward.split(")")[0].split("(")[1]
    counted = {found.variables[variable].symbol for ((variable, _),) in found.counted}
    assert counted == {"dirt" if decreasing == "dirty" else "wet"}
    assert task(reward, DIRTY + " horizon = 7").horizon == 7


def test_without_a_goal_none_is_paid_for() -> None:
    assert task("decrease(dirty)", DIRTY).goal == ()
    never = task("decrease(dirty) + 5 * goal", DIRTY + " goal { seen(a) }")
    assert never.goal == ()
    assert never.rewards == task("decrease(dirty)", DIRTY).rewards
    reached = task("decrease(dirty) + 5 * goal", DIRTY + " goal { not dirt(a), not dirt(b) }")
    assert len(reached.goal) == 1


@pytest.mark.parametrize(("most", "refused"), [(3, False), (2, True)])
def test_a_goal_of_just_as_many_cases_as_fit(
    most: int, refused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rewards, "CASE_LIMIT", most)
    problem = DIRTY + " goal { exists ?a - area: wet(?a) }"
    if refused:
        with pytest.raises(Refused) as said:
            task("decrease(dirty)", problem)
        assert [diagnostic.code for diagnostic in said.value.diagnostics] == ["E605"]
    else:
        assert len(task("decrease(dirty)", problem).goal) == 3


def test_just_as_many_states_as_fit_are_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    found = task("decrease(dirty)", DIRTY)
    wipe = [str(action) for action in found.actions].index("wipe(a)")
    whole = forward(found, {found.initial: 1.0}, wipe)
    assert len(whole) == 3
    monkeypatch.setattr(semantics, "SUPPORT_LIMIT", 3)
    assert forward(found, {found.initial: 1.0}, wipe) == whole
    assert exact_value(found, [wipe]) == pytest.approx(0.5)
    monkeypatch.setattr(semantics, "SUPPORT_LIMIT", 2)
    with pytest.raises(SupportTooLargeError):
        forward(found, {found.initial: 1.0}, wipe)


def test_libprada_keeps_effects_that_set_what_is_asked() -> None:
    text = (MOP % "decrease(dirty)").replace(
        "then 0.5: not dirt(?a), wet(?a)  0.25: wet(?a)", "then 0.5: dirt(?a), wet(?a)  0.25: not dirt(?a)"
    )

    def wiped(*, compat: bool) -> list[int]:
        found = ground(*from_text.checked(text, DIRTY), compat=compat)
        rule = next(r for r in found.rules if str(found.actions[r.action]) == "wipe(a)")
        return [len(outcome.effects) for outcome in rule.outcomes]

    assert wiped(compat=False) == [1, 1, 0]
    assert wiped(compat=True) == [2, 1, 0]


def test_an_effect_that_depends_on_the_state_and_a_plain_one_on_another_object() -> None:
    """`forall` over all, and a plain effect on one of them: both happen, each where it says so."""
    text = (MOP % "decrease(dirty)").replace(
        "then 0.5: not dirt(?a), wet(?a)",
        "then 0.5: not dirt(?a), forall ?b - area: dirt(?b), ?a != ?b => wet(?b)",
    )
    found = ground(*from_text.checked(text, DIRTY))
    names = [(variable.symbol, *variable.objects) for variable in found.variables]
    wipe = [str(action) for action in found.actions].index("wipe(a)")
    after = forward(found, {found.initial: 1.0}, wipe)
    told = {
        frozenset(name for name, value in zip(names, state, strict=True) if value): chance
        for state, chance in after.items()
    }
    dirty = {("dirt", "a"), ("dirt", "b"), ("wet", "c")}
    assert told == pytest.approx(
        {
            frozenset({("dirt", "b"), ("wet", "b"), ("wet", "c")}): 0.5,
            frozenset({*dirty, ("wet", "a")}): 0.25,
            frozenset(dirty): 0.25,
        }
    )


def test_what_is_paid_for_stands_in_one_order() -> None:
    """By variable, and then by value: sets of values have no order of their own."""
    text = """domain d {
      types { area }
      functions { load(?a - area): 0..5 }
      derived {
        %s
      }
      actions { fill(?a - area) }
      rule filled: fill(?a) { when load(?a) < 5 then 0.5: load(?a) += 1  rest: noise }
      reward { %s }
    }"""
    asked = [
        "load(?a) = 3",
        "load(?a) >= 2",
        "load(?a) = 1",
        "load(?a) >= 4",
        "load(?a) != 2",
        "load(?a) < 2",
    ]
    counts = "  ".join(f"c{n} := count ?a - area: {what}" for n, what in enumerate(asked))
    reward = " + ".join(f"decrease(c{n})" for n in range(len(asked)))
    inside = "objects { a b - area } init { load(a) = 0, load(b) = 0 } horizon = 3"
    found = ground(*from_text.checked(text % (counts, reward), inside))
    conditions = [[(variable, sorted(values)) for variable, values in r.condition] for r in found.rewards]
    assert len(conditions) == 12
    assert conditions == sorted(conditions)
