"""What the product says of a drawn domain and problem: the one place that calls it."""

from __future__ import annotations

import contextlib
import io
import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from cleancli.cli.main import run
from cleancli.compiler.explain import Explanation, explain
from cleancli.compiler.ground import ground
from cleancli.compiler.semantics import (
    covering_rule,
    exact_value,
    outcome_cost,
    reaches_goal,
    reward,
    standing,
)
from cleancli.compiler.task import GroundState, Task, by_time
from cleancli.environment.symbolic import SymbolicVector
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, checked_problem, load_domain, read_source
from cleancli.language.model import Domain, Fact, Problem
from cleancli.learning.compared import compared
from cleancli.learning.experience import Transition, decode
from cleancli.learning.learn import learn
from cleancli.learning.method import Method
from cleancli.planning.compiled_task import prepare
from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS
from cleancli.simulation.symbolic_world import DrawnStep, World, do, world_of
from support.differential.abstract import Domain as DrawnDomain
from support.differential.abstract import Problem as DrawnProblem
from support.differential.abstract import Value
from support.differential.interpreter import Call, Meaning, State
from support.differential.writing import Writer, call

DOMAIN, PROBLEM = "drawn.nid", "drawn_problem.nid"


class NoAnswer(Exception):
    """The product refused a command, or its answer cannot be read."""


def write(folder: Path, domain: DrawnDomain, problem: DrawnProblem, seed: int) -> None:
    """The files of a drawn domain and problem."""
    writer = Writer(Random(seed))
    text, base = writer.domain(domain)
    (folder / DOMAIN).write_text(text, encoding="utf-8")
    (folder / "base.nid").unlink(missing_ok=True)
    if base is not None:
        (folder / "base.nid").write_text(base, encoding="utf-8")
    (folder / PROBLEM).write_text(writer.problem(problem, domain), encoding="utf-8")


@dataclass(frozen=True, slots=True)
class Loaded:
    """A checked domain and problem, beside what they mean."""

    domain: Domain
    problem: Problem
    meaning: Meaning

    def facts(self, state: State) -> frozenset[Fact]:
        """A state as the product writes one: a predicate that is missing is false."""
        symmetric = {symbol.name: symbol for symbol in self.domain.symbols}
        return frozenset(
            Fact(symbol, symmetric[symbol].canonical(objects), value)
            for (symbol, objects), value in zip(self.meaning.keys, state, strict=True)
            if value is not False
        )

    def explanation(self, state: State, asked: Call) -> Explanation:
        return explain(self.domain, replace(self.problem, state=self.facts(state)), *asked)


def load(folder: Path, meaning: Meaning) -> tuple[Loaded | None, tuple[Diagnostic, ...]]:
    """The checked domain and problem, and all that `check` says."""
    domain = checked_domain(read_source(folder / DOMAIN))
    if domain.model is None:
        return None, domain.diagnostics
    problem = checked_problem(read_source(folder / PROBLEM), domain.model)
    said = (*domain.diagnostics, *problem.diagnostics)
    return (None if problem.model is None else Loaded(domain.model, problem.model, meaning)), said


@dataclass(frozen=True, slots=True)
class Grounded:
    """The task of a problem, asked by states and calls of the interpreter."""

    loaded: Loaded
    task: Task
    world: World
    numbers: dict[Call, int]

    def assignment(self, task: Task, state: State) -> GroundState | None:
        """The task's state; None where it has no variable for what has changed, or not this value."""
        meaning = self.loaded.meaning
        found = []
        known = set()
        for variable in task.variables:
            place = meaning.place[meaning.key(variable.symbol, variable.objects)]
            known.add(place)
            values: Sequence[Value] = variable.values
            if state[place] not in values:
                return None
            found.append(values.index(state[place]))
        initial = meaning.initial()
        if any(state[place] != initial[place] for place in range(len(state)) if place not in known):
            return None
        return tuple(found)

    def state(self, task: Task, assignment: GroundState) -> State:
        meaning = self.loaded.meaning
        state = list(meaning.initial())
        for variable, value in zip(task.variables, assignment, strict=True):
            state[meaning.place[meaning.key(variable.symbol, variable.objects)]] = variable.values[value]
        return tuple(state)

    def successors(self, assignment: GroundState, number: int) -> tuple[str | None, dict[State, Fraction]]:
        """The covering rule's name, and what may follow by the ground rule, in exact numbers."""
        rule = covering_rule(self.task, assignment, number)
        if rule is None:
            return None, {self.state(self.task, assignment): Fraction(1)}
        after: dict[State, Fraction] = {}
        for outcome in rule.outcomes:
            if outcome.probability:
                effects = dict(outcome.effects)
                changed = tuple(effects.get(i, value) for i, value in enumerate(assignment))
                state = self.state(self.task, changed)
                after[state] = after.get(state, Fraction(0)) + outcome.probability
        return self.loaded.domain.rules[rule.rule].name, after

    def reward(self, before: GroundState, number: int, after: GroundState) -> float:
        return reward(self.task, before, number, after)

    def outcome_cost(self, state: GroundState, number: int) -> float:
        return outcome_cost(self.task, state, number)

    def standing(self, state: GroundState) -> float:
        return standing(self.task, state)

    def goal(self, state: GroundState) -> bool:
        return reaches_goal(self.task, state)

    def draws(self, state: State, asked: Call, number: int, seed: int) -> Iterator[tuple[DrawnStep, State]]:
        """So many draws of what the symbolic world makes of an action."""
        rng = np.random.default_rng(seed)
        assignment = self.assignment(self.world.task, state)
        assert assignment is not None, "the world knows fewer states than the task"
        action = self.action(asked)
        for _ in range(number):
            step, after = do(self.world, assignment, action, rng)
            yield step, self.state(self.world.task, after)

    def action(self, asked: Call) -> Any:
        numbers = {(action.name, action.objects): action for action in self.world.task.actions}
        known = numbers.get(asked) or numbers.get((asked[0], ()))
        assert known is not None or self.task.actions, "an action to copy"
        return replace(known or self.task.actions[0], name=asked[0], objects=asked[1])

    def plan(self, planner: str, arithmetic: str, *, timed: bool) -> tuple[list[Call], float]:
        """What a planner wants done, and what it says that is worth."""
        prepared = prepare(by_time(self.task) if timed else self.task)
        plan = PLANNERS[planner].having(**own(planner, arithmetic))(prepared, Options(seed=1, threads=1))
        return [(action.name, action.objects) for action in plan.actions], plan.value

    def value(self, calls: Sequence[Call], *, timed: bool) -> float | None:
        """What a sequence is worth by the exact meaning; None where one of the actions was dropped."""
        if any(each not in self.numbers for each in calls):
            return None
        task = by_time(self.task) if timed else self.task
        return exact_value(task, [self.numbers[each] for each in calls])


def grounded(loaded: Loaded) -> Grounded | tuple[str, ...]:
    """The task, or the codes of the refusal."""
    try:
        task = ground(loaded.domain, loaded.problem)
        world = world_of(loaded.domain, loaded.problem)
    except Refused as refused:
        return tuple(sorted({diagnostic.code for diagnostic in refused.diagnostics}))
    numbers = {(action.name, action.objects): i for i, action in enumerate(task.actions)}
    return Grounded(loaded, task, world, numbers)


def learned(loaded: Loaded, experience: str) -> dict[tuple[str, int], Fraction]:
    """How often each outcome of each rule was seen; those of the default rule are left out."""
    transitions = decode(io.BytesIO(experience.encode()), "experience.jsonl", loaded.domain)
    return {
        (loaded.domain.rules[each.rule].name, index): seen
        for each in learn(loaded.domain, transitions, Method(match="strict")).rules
        if each.rule is not None
        for index, seen in enumerate(each.seen)
    }


def respelt(domain: DrawnDomain, seed: int) -> Domain | None:
    """A domain without its file, in other words than those of a seed; None where it is refused."""
    text, _ = Writer(Random(f"another text of {seed}")).domain(domain)
    try:
        return load_domain(Source("other.nid", text))
    except Refused:
        return None


@dataclass(frozen=True, slots=True)
class RulePair:
    """As `cleancli.learning.compared.RulePair`, with the names of the rules."""

    first: str | None
    second: str | None
    likeness: str
    states: int
    total: float


def rules_compared(loaded: Loaded, other: Domain, asked: Sequence[tuple[State, Call]]) -> Iterator[RulePair]:
    """What two domains foretell of actions in states, side by side."""
    transitions = []
    for state, (name, objects) in asked:
        values = {(fact.symbol, fact.objects): fact.value for fact in loaded.facts(state)}
        transitions.append(Transition(name, objects, loaded.problem.objects, values, values))
    for pair in compared(loaded.domain, other, transitions).pairs:
        first = None if pair.first is None else loaded.domain.rules[pair.first].name
        second = None if pair.second is None else other.rules[pair.second].name
        yield RulePair(first, second, pair.likeness.value, pair.states, pair.total)


def environment(folder: Path, episodes: int, actions: int) -> SymbolicVector | None:
    """So many episodes side by side; None where there is nothing to do."""
    try:
        return SymbolicVector(
            episodes, str(folder / PROBLEM), str(folder / DOMAIN), max_actions=actions, observation="array"
        )
    except ValueError:
        return None


# ---- the command line


def command(folder: Path, name: str, *words: str) -> dict[str, Any]:
    """The answer of a command as data."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = run([name, str(folder / DOMAIN), str(folder / PROBLEM), *words, "--json"])
    if code != 0:
        raise NoAnswer(f"{name} {' '.join(words)}: exit code {code}: {err.getvalue()[:400]}")
    found = json.loads(out.getvalue())
    assert isinstance(found, dict)
    return found


def own(planner: str, arithmetic: str) -> dict[str, object]:
    """The options that only some planners have, so that what is worth anything is planned."""
    return {"arithmetic": arithmetic} if planner == "exact" else {"margin": 0.0}


def planned(folder: Path, planner: str, arithmetic: str, *, timed: bool) -> tuple[list[Call], float]:
    """As `Grounded.plan`, by the command line."""
    objective = ("--objective", "time") if timed else ()
    named = (f"{name}={value}" for name, value in own(planner, arithmetic).items())
    options = [part for text in named for part in ("--option", text)]
    said = command(folder, "plan", "--planner", planner, *options, *objective)
    return calls_of(said["plan"]), said["value"]


def evaluated(folder: Path, calls: Sequence[Call], *, timed: bool = False) -> dict[str, Any]:
    objective = ("--objective", "time") if timed else ()
    text = " ".join(call(*each) for each in calls)
    return command(folder, "plan", "--evaluate", text, *objective, *(() if timed else ("--explain",)))


def near(one: float | Fraction, other: float | Fraction, within: float = 1e-9) -> bool:
    return math.isclose(float(one), float(other), rel_tol=within, abs_tol=within)


def changed(meaning: Meaning, state: State, effects: Sequence[str]) -> State:
    """The state after effects as the product prints them: `p(a)`, `not p(a)`, `f(a) = 2`."""
    after = list(state)
    for text in effects:
        atom, _, written = text.removeprefix("not ").partition(" = ")
        ((name, objects),) = calls_of([atom])
        value: Value = not text.startswith("not ")
        if written:
            values = meaning.symbols[name].values
            value = next(each for each in values if str(each) == written)
        after[meaning.place[meaning.key(name, objects)]] = value
    return tuple(after)


def calls_of(texts: Sequence[str]) -> list[Call]:
    """Actions as the product prints them."""
    found = []
    for text in texts:
        name, rest = text.rstrip(")").split("(")
        found.append((name, tuple(rest.replace(" ", "").split(",")) if rest else ()))
    return found
