"""What is said never to be reached is not reached, and what is missing for it is named (W403)."""

from __future__ import annotations

from collections import deque

import pytest

from cleancli.cli.inputs import check_file
from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import reaches_goal, successors
from cleancli.compiler.task import held
from cleancli.compiler.unreached import Unreached, unreached
from cleancli.language.diagnostics.refused import Refused
from support import from_text
from support.random_domains import Generator

ROOMS = """domain rooms {
  types      { area; room }
  predicates { dirt(?a - area)  wet(?a - area)  open(?r - room)  door(?r ?s - room) [static] }
  functions  { heat(?r - room): 0..5 }
  derived    {
    dirty := count ?a - area: dirt(?a)
    way(?r ?s - room) := closure door
    near_open(?r - room) := exists ?s - room: (way(?s, ?r), open(?s))
  }
  actions    { wipe(?a - area)  push(?r ?s - room)  warm(?r - room) }
  rule wipe: wipe(?a) { when dirt(?a), wet(?a) then 0.8: not dirt(?a) 0.2: nothing }
  rule push: push(?r, ?s) { when door(?r, ?s), open(?r) then 1: open(?s) }
  rule warm: warm(?r) { when open(?r), heat(?r) < 3 then 1: heat(?r) += 1 }
  reward     { decrease(dirty) + 5 * goal }
}"""
FACTS = """dirt(a1) dirt(a2) wet(a1) open(hall) door(hall, kitchen)
  heat(hall) = 0 heat(kitchen) = 0 heat(cellar) = 0"""


def found(goal: str, facts: str = FACTS) -> tuple[Unreached, ...]:
    inside = f"""objects {{ a1 a2 - area  hall kitchen cellar - room }}
      init {{ {facts} }} {f"goal {{ {goal} }}" if goal else ""} horizon = 9"""
    return unreached(*from_text.checked(ROOMS, inside))


@pytest.mark.parametrize(
    ("goal", "never"),
    [
        ("open(cellar)", ("open(cellar)",)),
        ("open(kitchen), open(cellar), heat(kitchen) = 4", ("open(cellar)", "heat(kitchen) = 4")),
        ("forall ?r - room: open(?r)", ("open(cellar)",)),
        ("exists ?a - area: (not dirt(?a), not wet(?a))", ("not dirt(a2)",)),
        ("near_open(cellar)", ("near_open(cellar)",)),
        ("dirt(a1), not dirt(a1)", ()),
        ("heat(cellar) > 0", ("heat(cellar) > 0",)),
    ],
)
def test_what_a_goal_lacks_is_named(goal: str, never: tuple[str, ...]) -> None:
    assert found(goal) == (Unreached(None, never),)


@pytest.mark.parametrize(
    "goal", ["open(kitchen), heat(kitchen) = 3", "not dirt(a1)", "exists ?r - room: open(?r)"]
)
def test_of_a_goal_that_may_be_reached_nothing_is_said(goal: str) -> None:
    assert found(goal) == ()


def test_of_alternatives_those_of_one_that_cannot_be_reached_are_named() -> None:
    """Doors lead to the hall from rooms that are never open, too, but also from the kitchen."""
    doors = "hall, kitchen; kitchen, hall; porch, hall; shed, porch; shed, tower; tower, shed"
    facts = " ".join(f"door({pair})" for pair in doors.split("; "))
    heat = " ".join(f"heat({room}) = 0" for room in ("hall", "kitchen", "porch", "shed", "tower"))
    inside = f"""objects {{ hall kitchen porch shed tower - room }} init {{ open(hall) {facts} {heat} }}
      goal {{ forall ?r - room: near_open(?r) }}"""
    (said,) = unreached(*from_text.checked(ROOMS, inside))
    assert set(said.never) == {"open(shed)", "open(tower)"}


def test_without_a_goal_the_count_is_what_must_fall() -> None:
    assert found("") == (Unreached("dirty", ("not dirt(a2)",)),)
    assert found("", FACTS.replace("dirt(a2)", "")) == ()
    assert found("", FACTS + " wet(a2)") == ()


@pytest.mark.parametrize("seed", range(60))
def test_what_is_said_never_to_be_reached_is_not(seed: int) -> None:
    """In random domains every state is tried, up to some hundreds."""
    generator = Generator(seed)
    domain, problem = generator.domain(), generator.problem()
    said = unreached(domain, problem)
    if not said:
        return
    assert said[0].count is None
    try:
        task = ground(domain, problem)
    except Refused:
        return
    seen, queue = {task.initial}, deque([task.initial])
    while queue and len(seen) < 300:
        state = queue.popleft()
        assert not reaches_goal(task, state)
        for action in range(len(task.actions)):
            after = {successor for _, successor in successors(task, state, action)} - seen
            seen |= after
            queue.extend(after)


def test_some_random_goals_are_never_reached() -> None:
    """So that the test above tests something."""
    generators = [Generator(seed) for seed in range(60)]
    assert sum(bool(unreached(g.domain(), g.problem())) for g in generators) >= 3


def test_check_says_it_and_finds_no_mistake(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(str(tmp_path))
    texts = {
        "rooms.nid": ROOMS,
        "p.nid": f"""problem p {{ domain = rooms objects {{ a1 a2 - area  hall kitchen cellar - room }}
          init {{ {FACTS} }} goal {{ open(cellar) }} }}""",
    }
    for name, text in texts.items():
        with open(name, "w", encoding="utf-8") as file:
            file.write(text)
    diagnostics, sources = check_file("p.nid")
    assert [each.code for each in diagnostics] == ["W403"]
    assert "`open(cellar)`" in diagnostics[0].message
    span = diagnostics[0].span
    assert span is not None
    assert sources[0].text[span.start : span.end] == "goal"


def test_counted_is_what_the_task_counts() -> None:
    inside = f"objects {{ a1 a2 - area  hall kitchen cellar - room }} init {{ {FACTS} }}"
    task = from_text.task(ROOMS, inside)
    assert held(task.counted or (), task.initial) == 2
