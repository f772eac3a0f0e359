"""What the effects of one outcome come to together (docs/language.md), against a few lines of Python.

Random outcomes with several shifts and assignments, plain and in `forall`, on things that may be the same for
some objects: `explain`, the task and the learner must all say what the document says, or all refuse.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from random import Random

import pytest

from cleancli.compiler.explain import explain
from cleancli.compiler.fluents import values_of
from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import successors
from cleancli.compiler.task import Task
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain, Fact, Problem, State, Value
from cleancli.learning.expectation import likeliest_outcome, prior_beliefs
from cleancli.learning.experience import Transition
from cleancli.learning.match import Matcher

TEXT = """\
domain shifts {{
  types      {{ thing }}
  predicates {{ on(?x - thing)  lit(?x - thing)  link(?x ?y - thing) [symmetric] }}
  functions  {{ load(?x - thing): -1..3  total(): 0..4 }}
  derived    {{ loaded := count ?x - thing: load(?x) >= 2 }}
  actions    {{ both(?x ?y - thing)  flip(?x - thing) }}
  rule both: both(?x, ?y) {{
    then 0.75: {effects}
         0.25: noise
  }}
  rule flip_on:  flip(?x) {{ when not on(?x) then 1: on(?x) }}
  rule flip_off: flip(?x) {{ when on(?x)     then 1: not on(?x) }}
  reward {{ loaded }}
}}
"""
THINGS = ("a", "b", "c")
BOUNDS = {"load": (-1, 3), "total": (0, 4)}
GUARDS = ("", "on(?m)", "not on(?m)", "?m != ?x", "on(?m), ?m != ?y")

Key = tuple[str, tuple[str, ...]]


class Conflict(Exception):
    """One thing is set to two values, or set and shifted."""


@dataclass(frozen=True)
class Effect:
    """`amount` is an integer for a shift; otherwise `value` is assigned."""

    symbol: str
    terms: tuple[str, ...]
    amount: int | None = None
    value: int | bool = 0

    def text(self) -> str:
        applied = f"{self.symbol}({', '.join(f'?{term}' for term in self.terms)})"
        if self.amount is not None:
            return f"{applied} {'+=' if self.amount > 0 else '-='} {abs(self.amount)}"
        if isinstance(self.value, bool):
            return applied if self.value else f"not {applied}"
        return f"{applied} := {self.value}"


@dataclass(frozen=True)
class Item:
    """Effects, for every ?m that fits the guard where `guard` is one (None: for no ?m)."""

    effects: tuple[Effect, ...]
    guard: str | None = None

    def text(self) -> str:
        effects = ", ".join(effect.text() for effect in self.effects)
        if self.guard is None:
            return effects
        condition = f": {self.guard}" if self.guard else ""
        return f"forall ?m - thing{condition} => ({effects})"


def random_outcome(rng: Random) -> tuple[Item, ...]:
    items = []
    for _ in range(rng.randint(1, 4)):
        if rng.random() < 0.4:
            effects = tuple(random_effect(rng, "mmxy") for _ in range(rng.randint(1, 2)))
            if any("m" in effect.terms for effect in effects):
                items.append(Item(effects, rng.choice(GUARDS)))
        else:
            items.append(Item((random_effect(rng, "xy"),)))
    return tuple(items) or (Item((Effect("lit", ("x",), value=True),)),)


def random_effect(rng: Random, terms: str) -> Effect:
    symbol = rng.choice(("load", "load", "load", "total", "lit", "link"))
    chosen = tuple(rng.choice(terms) for _ in range({"total": 0, "link": 2}.get(symbol, 1)))
    if symbol in ("lit", "link"):
        return Effect(symbol, chosen, value=rng.random() < 0.7)
    if rng.random() < 0.2:
        return Effect(symbol, chosen, value=rng.randint(*BOUNDS[symbol]))
    return Effect(symbol, chosen, amount=rng.choice((-3, -2, -1, 1, 1, 2, 3)))


def happening(
    outcome: tuple[Item, ...], x: str, y: str, on: frozenset[str]
) -> Iterator[tuple[Effect, dict[str, str]]]:
    for item in outcome:
        for m in THINGS if item.guard is not None else ("",):
            guard = item.guard or ""
            asks_on, asks_off = "on(?m)" in guard and "not on" not in guard, "not on(?m)" in guard
            if (asks_on and m not in on) or (asks_off and m in on):
                continue
            if ("?m != ?x" in guard and m == x) or ("?m != ?y" in guard and m == y):
                continue
            yield from ((effect, {"x": x, "y": y, "m": m}) for effect in item.effects)


def meaning(
    outcome: tuple[Item, ...], x: str, y: str, on: frozenset[str], before: Mapping[Key, int | bool]
) -> dict[Key, int | bool]:
    """What the outcome sets, by the document."""
    assigned: dict[Key, set[int | bool]] = {}
    amounts: dict[Key, list[int]] = {}
    for effect, binding in happening(outcome, x, y, on):
        objects = tuple(binding[term] for term in effect.terms)
        key = effect.symbol, tuple(sorted(objects)) if effect.symbol == "link" else objects
        if effect.amount is None:
            assigned.setdefault(key, set()).add(effect.value)
        else:
            amounts.setdefault(key, []).append(effect.amount)
    if any(len(values) > 1 for values in assigned.values()) or assigned.keys() & amounts.keys():
        raise Conflict
    after = {key: values.pop() for key, values in assigned.items()}
    for key, sums in amounts.items():
        low, high = BOUNDS[key[0]]
        after[key] = min(max(before[key] + sum(sums), low), high)
    return {key: value for key, value in after.items() if value != before[key]}


def conflicts_somewhere(outcome: tuple[Item, ...], before: Mapping[Key, int | bool]) -> bool:
    for size in range(len(THINGS) + 1):
        for on in itertools.combinations(THINGS, size):
            for x, y in itertools.product(THINGS, repeat=2):
                try:
                    meaning(outcome, x, y, frozenset(on), before)
                except Conflict:
                    return True
    return False


def written_twice(outcome: tuple[Item, ...]) -> bool:
    """Whether one assignment stands there twice, which is a slip of the pen."""
    plain = [effect for item in outcome if item.guard is None for effect in item.effects]
    groups = [plain, *(item.effects for item in outcome if item.guard is not None)]
    said = [[(e.symbol, sorted(e.terms), e.value) for e in group if e.amount is None] for group in groups]
    return any(each in group[:place] for group in said for place, each in enumerate(group))


def random_state(rng: Random) -> tuple[frozenset[str], dict[Key, int | bool]]:
    on = frozenset(thing for thing in THINGS if rng.random() < 0.5)
    values: dict[Key, int | bool] = {("load", (thing,)): rng.randint(-1, 3) for thing in THINGS}
    values["total", ()] = rng.randint(0, 4)
    values |= {("lit", (thing,)): rng.random() < 0.5 for thing in THINGS}
    pairs = itertools.combinations_with_replacement(THINGS, 2)
    return on, values | {("link", pair): rng.random() < 0.3 for pair in pairs}


def problem_text(on: frozenset[str], values: Mapping[Key, int | bool]) -> str:
    facts = [f"on({thing})" for thing in sorted(on)]
    for (symbol, objects), value in values.items():
        applied = f"{symbol}({', '.join(objects)})"
        facts += [f"{applied} = {value}"] if symbol in BOUNDS else [applied] if value else []
    return f"""problem p {{ domain = shifts  objects {{ {" ".join(THINGS)} - thing }}
      init {{ {" ".join(facts)} }} horizon = 2 }}"""


def loaded(outcome: tuple[Item, ...]) -> Domain | None:
    """The domain with the outcome; None where `check` finds that it changes something twice."""
    text = TEXT.format(effects=", ".join(item.text() for item in outcome))
    try:
        return load_domain(Source("shifts.nid", text))
    except Refused as refused:
        if {d.code for d in refused.diagnostics} == {"E308"}:
            return None
        raise


def refuses(work: object, *arguments: object) -> bool:
    assert callable(work)
    try:
        work(*arguments)
    except Refused as refused:
        if [d.code for d in refused.diagnostics] == ["E602"]:
            return True
        raise
    return False


def values_in(problem: Problem) -> dict[Key, int | bool]:
    """All that effects may set."""
    pairs = itertools.combinations_with_replacement(THINGS, 2)
    keys = [*(("lit", (thing,)) for thing in THINGS), *(("link", pair) for pair in pairs)]
    stated = {(fact.symbol, fact.objects): fact.value for fact in problem.state if fact.symbol != "on"}
    return {**dict.fromkeys(keys, False), **stated}  # type: ignore[dict-item]


def moved(problem: Problem, expected: Mapping[Key, int | bool]) -> State:
    """The state after."""
    values = {**{(fact.symbol, fact.objects): fact.value for fact in problem.state}, **expected}
    return frozenset(Fact(*key, value) for key, value in values.items() if value is not False)


def changed_by(task: Task, objects: tuple[str, str]) -> dict[frozenset[tuple[Key, Value]], float]:
    """What may change in the initial state by the action, and how likely."""
    numbers = {(action.name, action.objects): index for index, action in enumerate(task.actions)}
    if ("both", objects) not in numbers:
        return {frozenset(): 1.0}
    found = {}
    for probability, after in successors(task, task.initial, numbers["both", objects]):
        changed = [
            ((v.symbol, v.objects), v.values[new])
            for v, old, new in zip(task.variables, task.initial, after, strict=True)
            if old != new
        ]
        found[frozenset(changed)] = probability
    return found


def outcome_of(domain: Domain, transition: Transition) -> int | None:
    """The outcome by which learning explains a transition."""
    return likeliest_outcome(Matcher(domain).match(transition), prior_beliefs(domain))


@pytest.mark.parametrize("seed", range(150))
def test_effects_of_an_outcome_mean_what_the_document_says(seed: int) -> None:
    rng = Random(seed)
    outcome = random_outcome(rng)
    on, values = random_state(rng)
    domain = loaded(outcome)
    if domain is None:
        certain = conflicts_somewhere(outcome, values) or written_twice(outcome)
        assert certain, "check refuses only what is certain"
        return
    problem = load_problem(Source("p.nid", problem_text(on, values)), domain)
    assert values_in(problem) == values
    task = None if refuses(ground, domain, problem) else ground(domain, problem)
    assert (task is None) == conflicts_somewhere(outcome, values)
    for x, y in itertools.product(THINGS, repeat=2):
        still = Transition(
            "both", (x, y), problem.objects, values_of(problem.state), values_of(problem.state)
        )
        try:
            expected = meaning(outcome, x, y, on, values)
        except Conflict:
            assert refuses(explain, domain, problem, "both", (x, y))
            assert refuses(outcome_of, domain, still)
            continue
        found = explain(domain, problem, "both", (x, y)).covering
        assert found is not None
        assert {(c.fact.symbol, c.fact.objects): c.fact.value for c in found.outcomes[0].changes} == expected
        assert outcome_of(domain, still._replace(after=values_of(moved(problem, expected)))) == 0
        if task is not None:
            wanted = {frozenset(expected.items()): 0.75, frozenset(): 0.25}
            assert changed_by(task, (x, y)) == (wanted if expected else {frozenset(): 1.0})


def test_the_random_outcomes_are_of_every_kind() -> None:
    """So that the test above compares something: refused by `check`, by grounding, and not at all."""
    kinds = []
    for seed in range(150):
        rng = Random(seed)
        outcome = random_outcome(rng)
        values = random_state(rng)[1]
        kinds.append("check" if loaded(outcome) is None else conflicts_somewhere(outcome, values))
    assert min(kinds.count(kind) for kind in ("check", True, False)) >= 10


# ---- the cases that came out wrong

GATHER = """\
domain gather {
  types { area }
  predicates { dirt(?a - area) }
  functions { load(): 0..10  held(?a - area): 0..10 }
  derived { full := count ?a - area: dirt(?a) }
  actions { gather() both(?a ?b - area) }
  rule gather_all: gather() { then 1: forall ?m - area: dirt(?m) => (load() += 1, not dirt(?m)) }
  rule twice: both(?a, ?b)  { then 1: held(?a) += 1, %s }
  reward { decrease(full) }
}
"""
THREE = """problem three { domain = gather  objects { a1 a2 a3 - area }
  init { dirt(a1) dirt(a2) dirt(a3) load() = %d  held(a1) = 0  held(a2) = 0  held(a3) = 0 } }"""


@pytest.mark.parametrize(
    ("second", "load", "action", "expected"),
    [
        ("held(?b) += 1", 0, ("gather", ()), {("load", ()): 3}),
        ("held(?b) += 1", 8, ("gather", ()), {("load", ()): 10}),
        ("held(?b) += 1", 0, ("both", ("a1", "a1")), {("held", ("a1",)): 2}),
        ("held(?b) += 1", 0, ("both", ("a1", "a2")), {("held", ("a1",)): 1, ("held", ("a2",)): 1}),
        ("held(?b) -= 1", 0, ("both", ("a1", "a1")), {}),
        ("held(?b) -= 1", 0, ("both", ("a1", "a2")), {("held", ("a1",)): 1}),
        ("held(?a) += 2", 0, ("both", ("a1", "a2")), {("held", ("a1",)): 3}),
        ("held(?a) -= 5, held(?a) += 7", 0, ("both", ("a1", "a2")), {("held", ("a1",)): 3}),
    ],
)
def test_shifts_of_one_number_add_up_and_the_bounds_hold_for_the_sum(
    second: str, load: int, action: tuple[str, tuple[str, ...]], expected: dict[Key, int]
) -> None:
    domain = load_domain(Source("gather.nid", GATHER % second))
    problem = load_problem(Source("three.nid", THREE % load), domain)
    found = explain(domain, problem, *action).covering
    assert found is not None
    changes = {(c.fact.symbol, c.fact.objects): c.fact.value for c in found.outcomes[0].changes}
    assert {key: value for key, value in changes.items() if key[0] != "dirt"} == expected
    task = ground(domain, problem)
    numbers = {(each.name, each.objects): number for number, each in enumerate(task.actions)}
    if not expected:
        assert action not in numbers
        return
    number = numbers[action]
    ((_, after),) = successors(task, task.initial, number)
    values = {(v.symbol, v.objects): v.values[i] for v, i in zip(task.variables, after, strict=True)}
    assert values.items() >= expected.items()


def test_a_sum_of_many_shifts_is_no_deep_recursion() -> None:
    """2,000 shifts of one number, and 2,000 that wait for one fact, are one case or two."""
    text = GATHER % "forall ?m - area: ?m != ?a => held(?a) += 1, forall ?m - area: dirt(?a) => load() += 1"
    domain = load_domain(
        Source("gather.nid", text.replace("gather_all: gather() { then", "g: gather() { then 0: noise"))
    )
    names = [f"a{number}" for number in range(1, 2001)]
    facts = " ".join(f"held({name}) = 0" for name in names)
    pattern = "problem p {{ domain = gather objects {{ {} - area }} init {{ dirt(a1) load() = 0 {} }} }}"
    problem = load_problem(Source("p.nid", pattern.format(" ".join(names), facts)), domain)
    found = explain(domain, problem, "both", ("a1", "a1")).covering
    assert found is not None
    assert {c.fact.symbol: c.fact.value for c in found.outcomes[0].changes} == {"held": 10, "load": 10}


@pytest.mark.parametrize(
    ("effects", "asks"),
    [
        ("held(?b) := 2", "`?a != ?b` to the condition of `twice`"),
        ("held(?b) := 2", "`?a = ?b`"),
        ("forall ?m - area: dirt(?m) => held(?m) := 0", "`?a != ?m` to the condition of the `forall`"),
        ("forall ?m ?k - area: ?m != ?k => (dirt(?m), not dirt(?k))", "narrow its condition"),
        ("dirt(?b), not dirt(?a)", "`?b != ?a` to the condition of `twice`"),
    ],
)
def test_what_meets_for_some_objects_is_told_with_what_to_write(effects: str, asks: str) -> None:
    domain = load_domain(Source("gather.nid", GATHER % effects))
    problem = load_problem(Source("three.nid", THREE % 0), domain)
    with pytest.raises(Refused) as error:
        ground(domain, problem)
    assert [d.code for d in error.value.diagnostics] == ["E602"]
    assert asks in error.value.diagnostics[0].help
    with pytest.raises(Refused) as alike:
        explain(domain, problem, "both", ("a1", "a1"))
    assert alike.value.diagnostics[0].help == error.value.diagnostics[0].help


def test_an_outcome_that_never_happens_conflicts_with_nothing() -> None:
    text = GATHER.replace("then 1: held(?a)", "then 1: nothing 0: held(?a)") % "held(?b) := 2"
    domain = load_domain(Source("gather.nid", text))
    problem = load_problem(Source("three.nid", THREE % 0), domain)
    ground(domain, problem)
    assert explain(domain, problem, "both", ("a1", "a1")).covering is not None
    still = Transition(
        "both", ("a1", "a1"), problem.objects, values_of(problem.state), values_of(problem.state)
    )
    assert outcome_of(domain, still) == 0
