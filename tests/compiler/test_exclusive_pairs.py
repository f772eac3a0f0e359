"""Values that exclude each other, and the cases that are left out for it.

The reference is slow and obvious: all states that the interpreter of docs/language.md reaches, breadth first.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from cleancli.compiler import exclusive_pairs, outcome_ways
from cleancli.compiler import ground as ground_module
from cleancli.compiler.column_join import ColumnJoin
from cleancli.compiler.disjoint_cases import Case
from cleancli.compiler.exclusive_pairs import Pairs, pairs_of
from cleancli.compiler.fluents import Fluent
from cleancli.compiler.ground import ground
from cleancli.compiler.ground_formula import Possible, anything
from cleancli.compiler.instances import instances
from cleancli.compiler.outcome_ways import each_of
from cleancli.compiler.partial_evaluation import Conditions
from cleancli.compiler.relaxed_reachability import Reach
from cleancli.compiler.semantics import covering_rule, successors
from cleancli.compiler.static_join import Universe
from cleancli.compiler.task import Task, is_unreachable
from cleancli.execution.session import symbolic_session
from cleancli.execution.setup import EpisodeOptions
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Fact, Problem, Value
from cleancli.simulation.agent import Agent
from cleancli.simulation.symbolic_world import assignment_of, changing_facts
from support import from_text
from support.differential import product
from support.differential.comparing import explore
from support.differential.comparing_states import compare_states
from support.differential.comparison import Comparison
from support.differential.drawing import draw
from support.differential.interpreter import Meaning, State
from support.differential.product import Grounded
from support.differential.worth import Worth
from support.exclusive_domains import (
    BLOCKS,
    DISKS,
    LAMP_NAMES,
    MANY_LAMPS,
    NONE_LIT,
    PACKETS,
    blocks,
    disks,
    packets,
)

Held = tuple[Fluent, Value]
Divide = Callable[[Domain, Reach, Conditions, Possible], dict[int, list[Case]]]


def pairs_found(domain: Domain, problem: Problem) -> Pairs | None:
    universe = Universe(domain, problem)
    conditions, join = Conditions(universe), ColumnJoin(universe)
    return pairs_of(Reach(instances(domain, conditions, join), universe), conditions)


def together(found: Pairs, one: Held, other: Held) -> bool:
    """Whether two values may hold together."""
    return bool(found.beside[found.numbers.of(*one)] >> found.numbers.of(*other) & 1)


def of(text: str, inside: str) -> Pairs:
    found = pairs_found(*from_text.checked(text, inside))
    assert found is not None
    return found


def cases_by_action(task: Task) -> Mapping[str, int]:
    """The most ground rules of one action, by its name."""
    found: Counter[str] = Counter()
    for action, number in Counter(rule.action for rule in task.rules).items():
        found[task.actions[action].name] = max(found[task.actions[action].name], number)
    return found


@pytest.fixture
def always_by_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every instance is divided as if it had too many cases."""
    divide: Divide = ground_module._divided

    def refusing(
        domain: Domain, reach: Reach, conditions: Conditions, possible: Possible
    ) -> dict[int, list[Case]]:
        if possible is anything:
            raise Refused([])
        return divide(domain, reach, conditions, possible)

    monkeypatch.setattr(ground_module, "_divided", refusing)


# ---- against all states that are reached


@pytest.mark.usefixtures("always_by_pairs")
@pytest.mark.parametrize("first", range(0, 200, 50))
def test_what_excludes_each_other_never_occurs_and_transitions_stay(first: int, tmp_path: Path) -> None:
    """In 200 drawn domains with all constructs of the language, of which most are small enough to meet every
    state."""
    compared = excluded = left_out = 0
    for seed in range(first, first + 50):
        drawn, drawn_problem = draw(seed)
        product.write(tmp_path, drawn, drawn_problem, seed)
        meaning = Meaning(drawn, drawn_problem)
        loaded, _ = product.load(tmp_path, meaning)
        if loaded is None:
            continue
        worth = Worth(meaning)
        explored = explore(worth)
        if explored.refusals:
            continue
        found = pairs_found(loaded.domain, loaded.problem)
        assert found is not None
        assert not occurring(found, meaning, explored.states) & excluding(found), seed
        grounded = product.grounded(loaded)
        assert isinstance(grounded, Grounded), (seed, grounded)
        comparison = Comparison(seed)
        compare_states(comparison, grounded, worth, explored.states[:4])
        assert not comparison.differences, (seed, comparison.differences[:3])
        for state in explored.states:
            assert assignment_of(grounded.task, loaded.facts(state)) is not None, seed
        compared += 1
        excluded += len(excluding(found))
        left_out += bool(grounded.task.unreachable)
    assert compared > 20
    assert excluded > 100, "so that there is something to be wrong about"
    assert left_out > 1


def occurring(found: Pairs, meaning: Meaning, states: Collection[State]) -> set[tuple[int, int]]:
    """The pairs of numbers that hold together in some state."""
    pairs = set()
    for state in states:
        held = [
            found.numbers.of(key, value)
            for key, value in zip(meaning.keys, state, strict=True)
            if key in found.numbers
        ]
        pairs |= {(one, other) for one in held for other in held}
    return pairs


def excluding(found: Pairs) -> set[tuple[int, int]]:
    """The pairs of numbers that exclude each other."""
    every = (1 << len(found.beside)) - 1
    return {(one, other) for one, beside in enumerate(found.beside) for other in each_of(every & ~beside)}


# ---- which pairs are found


THINGS = """
domain things {{
  types      {{ thing }}
  predicates {{ p(?x - thing)  q(?x - thing)  r(?x - thing)  done() }}
  functions  {{ n(): 0..3  m(): 0..3  kind(): low < middle < high }}
  derived    {{ some := count ?x - thing: p(?x)  both(?x - thing) := p(?x), q(?x) }}
  actions    {{ act(?x - thing)  other(?x - thing) }}
  rule act: act(?x) {{ {act} }}
  rule other: other(?x) {{ {other} }}
  reward     {{ some }}
}}
"""
ONE = "objects {{ a - thing }} init {{ n() = 0  m() = 0  kind() = low {facts} }} horizon = 2"
P, Q, R = (("p", ("a",)), True), (("q", ("a",)), True), (("r", ("a",)), True)


def is_not(held: Held) -> Held:
    return held[0], False


def has(name: str, value: Value) -> Held:
    return (name, ()), value


@pytest.mark.parametrize(
    ("act", "other", "facts", "one", "second", "expected"),
    [
        # what is set together, and what each undoes of the other
        ("then 1: p(?x), not q(?x)", "then 1: q(?x), not p(?x)", "", P, Q, False),
        ("when not q(?x) then 1: p(?x)", "then 1: q(?x), not p(?x)", "", P, Q, False),
        ("then 1: p(?x)", "when not p(?x) then 1: q(?x)", "", P, Q, True),
        # an outcome that never happens sets nothing
        ("then 1: q(?x) 0: p(?x), q(?x)", "then 1: not q(?x), p(?x)", "", P, Q, True),
        ("then 1: nothing 0: p(?x), q(?x)", "then 0.5: not q(?x), p(?x) rest: q(?x), not p(?x)",
         "", P, Q, False),
        # under conditions of which both hold, or one alone
        ("then 1: if r(?x) => p(?x), if r(?x) => q(?x)", "then 1: r(?x)", "", P, is_not(R), False),
        ("then 1: if r(?x) => p(?x), if not r(?x) => q(?x)", "then 1: r(?x), not p(?x), not q(?x)",
         "", P, Q, False),
        ("then 1: if r(?x) => p(?x), if not r(?x) => q(?x)", "then 1: r(?x)", "", P, Q, True),
        # what is undone where something holds stays where it does not
        ("then 1: q(?x), if r(?x) => not p(?x)", "then 1: r(?x)", "p(a)", P, Q, True),
        ("when r(?x) then 1: q(?x), if r(?x) => not p(?x)", "then 1: r(?x)", "p(a)", P, Q, False),
        ("then 1: q(?x), if not done() => not p(?x)", "then 1: r(?x)", "p(a)", P, Q, False),
        # disjunctions and derived predicates
        ("when (p(?x) or q(?x)) then 1: r(?x)", "then 1: p(?x)", "", R, is_not(P), False),
        ("when (p(?x) or q(?x)) then 1: r(?x)", "then 0.5: p(?x) rest: q(?x)", "", R, is_not(P), True),
        ("when both(?x) then 1: r(?x)", "then 0.5: p(?x) rest: q(?x)", "", R, is_not(Q), False),
        ("when not both(?x) then 1: r(?x)", "when r(?x) then 1: p(?x), q(?x)", "", P, is_not(R), False),
        # shifts, also under conditions, and what stops at a bound
        ("then 1: n() += 1, m() += 1", "when p(?x) then 1: nothing", "", has("n", 1), has("m", 0), False),
        ("then 1: n() += 1, m() += 1", "when n() = 3 then 1: p(?x)", "", P, has("m", 2), False),
        ("then 1: n() += 1, if p(?x) => m() += 1", "then 1: p(?x)", "", has("n", 2), has("m", 1), True),
        ("then 1: n() += 1, if p(?x) => m() += 1", "then 1: p(?x)", "", has("n", 0), has("m", 1), False),
        ("then 1: n() += 2, n() -= 1, q(?x)", "then 1: nothing", "", is_not(Q), has("n", 1), False),
        ("then 1: n() += 2, n() -= 1, q(?x)", "then 1: nothing", "", Q, has("n", 1), True),
        # a function has one value at a time
        ("then 1: kind() := high, p(?x)", "then 1: kind() := middle, not p(?x)",
         "", P, has("kind", "middle"), False),
        ("then 1: kind() := high, p(?x)", "when kind() > low then 1: q(?x)", "", Q, is_not(P), False),
        ("then 1: nothing", "then 1: kind() := high", "", has("kind", "low"), has("kind", "high"), False),
    ],
)  # fmt: skip
def test_pairs(act: str, other: str, facts: str, one: Held, second: Held, expected: bool) -> None:
    found = of(THINGS.format(act=act, other=other), ONE.format(facts=facts))
    assert together(found, one, second) == together(found, second, one) == expected


def test_many_shifts_of_one_number_count_as_possible_together() -> None:
    """More sums than are told apart: all amounts may come about, wherever that is."""
    text = THINGS.replace("n(): 0..3", "n(): 0..9").format(
        act="then 1: forall ?y - thing: q(?y) => n() += 1", other="then 1: q(?x)"
    )
    names = " ".join(f"t{number}" for number in range(8))
    inside = f"objects {{ {names} - thing }} init {{ n() = 0  m() = 0  kind() = low }} horizon = 2"
    found = of(text, inside)
    assert together(found, has("n", 8), (("q", ("t0",)), False))


# ---- cases


@pytest.mark.parametrize(
    ("text", "inside", "action", "cases"),
    [
        (PACKETS, packets(4), "tick", 5**4),  # none, or the first one to four of the facts
        (
            BLOCKS,
            blocks(11),
            "put",
            1 + 10,
        ),  # spent, or not and what it lies on: no other than the block on top
        (DISKS, disks(5), "move", 360),
    ],
)
def test_cases_that_no_state_is_of_are_left_out(text: str, inside: str, action: str, cases: int) -> None:
    checked = from_text.checked(text, inside)
    started = time.process_time()
    task = ground(*checked)
    assert time.process_time() - started < 8, "under two seconds on a machine that does nothing else"
    assert cases_by_action(task)[action] == cases
    assert task.unreachable
    assert not is_unreachable(task, task.initial)


@pytest.mark.usefixtures("always_by_pairs")
@pytest.mark.parametrize(("text", "inside"), [(PACKETS, packets(2)), (BLOCKS, blocks(4)), (DISKS, disks(3))])
def test_nothing_changes_in_states_that_are_reached(
    text: str, inside: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All states of smaller problems, by the task without what is left out."""
    checked = from_text.checked(text, inside)
    left = ground(*checked)
    monkeypatch.undo()
    whole = ground(*checked)
    assert len(left.rules) < len(whole.rules)
    assert set(left.rules) <= {replace(rule, action=rule.action) for rule in whole.rules}
    assert (left.variables, left.actions) == (whole.variables, whole.actions)
    seen, waiting = {whole.initial}, [whole.initial]
    while waiting:
        state = waiting.pop()
        assert not is_unreachable(left, state)
        for action in range(len(whole.actions)):
            assert covering_rule(left, state, action) == covering_rule(whole, state, action)
            new = {after for _, after in successors(whole, state, action)} - seen
            seen |= new
            waiting += new
    assert len(seen) > 20


def test_where_few_cases_are_none_is_left_out() -> None:
    """What was accepted is the same as ever."""
    assert not ground(*from_text.checked(PACKETS, packets(2))).unreachable


# ---- what is refused


def refusal(domain: Domain, problem: Problem, compat: bool = False) -> str:
    with pytest.raises(Refused) as refused:
        ground(domain, problem, compat=compat)
    return ", ".join(diagnostic.code for diagnostic in refused.value.diagnostics)


@pytest.mark.parametrize(("text", "inside"), [(PACKETS, packets(5)), (DISKS, disks(6))])
def test_more_cases_than_may_be_are_refused_if_no_pairs_exclude_them(text: str, inside: str) -> None:
    assert refusal(*from_text.checked(text, inside)) == "E605"


def test_libprada_takes_all_values_as_possible_together() -> None:
    assert refusal(MANY_LAMPS, NONE_LIT, compat=True) == "E605"


@pytest.mark.parametrize("limit", ["MOST_VALUES", "MOST_WAYS", "MOST_LOOKS", "MOST_DROPPED"])
def test_where_it_would_take_too_long_the_refusal_stands(limit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert ground(MANY_LAMPS, NONE_LIT).unreachable
    monkeypatch.setattr(exclusive_pairs, limit, 5)
    assert refusal(MANY_LAMPS, NONE_LIT) == "E605"


def test_ways_are_counted_before_they_are_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exclusive_pairs, "MOST_WAYS", 5)
    monkeypatch.setattr(outcome_ways, "_Maker", None)
    assert pairs_found(MANY_LAMPS, NONE_LIT) is None


# ---- states that came about otherwise


def test_states_that_actions_do_not_lead_to_are_not_of_the_task() -> None:
    task = ground(MANY_LAMPS, NONE_LIT)
    lit = [{Fact("lit", (name,)) for name in LAMP_NAMES[:number]} for number in range(3)]
    found = [assignment_of(task, frozenset(facts)) for facts in lit]
    assert None not in found[:2]
    assert found[2] is None


def test_a_planner_whose_rules_are_not_the_worlds_grounds_anew_where_they_lead_to_no_such_state() -> None:
    """The world may light two lamps, which the planner's rules never do: then both go out by `stop()`."""
    agent = Agent(lambda *_: None, MANY_LAMPS, NONE_LIT)  # type: ignore[arg-type]
    known = [agent.prepared(frozenset({Fact("lit", (name,))}), 100).task for name in ("l00", "l03")]
    assert known[0].rules is known[1].rules, "grounded once for all states that its rules lead to"
    both = frozenset({Fact("lit", ("l00",)), Fact("lit", ("l03",))})
    task = agent.prepared(both, 100).task
    stop = [str(action) for action in task.actions].index("stop()")
    (half, out), (_, same) = sorted(
        successors(task, task.initial, stop), key=lambda each: each[1] == task.initial
    )
    assert (half, same) == (0.5, task.initial)
    assert changing_facts(task, out) == {Fact("used", ("l00",)), Fact("used", ("l03",))}


def test_no_world_goes_on_from_a_state_that_nothing_leads_to() -> None:
    """A checkpoint that another problem's or version's run has left."""
    session = symbolic_session(MANY_LAMPS, NONE_LIT, EpisodeOptions())
    saved = session.save()
    assert symbolic_session(MANY_LAMPS, NONE_LIT, EpisodeOptions(), saved).save().keys() == saved.keys()
    saved["assignment"][:] = 1
    with pytest.raises(ValueError, match="two facts have values that they cannot have together"):
        symbolic_session(MANY_LAMPS, NONE_LIT, EpisodeOptions(), saved)
