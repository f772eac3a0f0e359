"""Grounding as libPRADA does, and its files where CLEANCLI_LIBPRADA names the folder of d2, d4 ... d14."""

from __future__ import annotations

import os
import random
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import product
from math import prod
from pathlib import Path

import pytest

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task, holds
from cleancli.conversion.convert import Converted, Wishes, convert
from cleancli.conversion.read import read
from cleancli.conversion.records import Atom, Library, LibraryRule, is_variable, variables_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, load_domain, load_problem, read_source
from cleancli.language.printing.formatter import layout
from cleancli.planning.evaluation.belief_value import plan_value
from support import from_text, reference_prada, small_tasks

REFERENCE = """
domain d {
  types      { area }
  predicates { dirt(?a - area) between(?a ?b ?m - area) }
  derived    { dirty := count ?a - area: dirt(?a) }
  actions    { join(?a ?b - area) }
  rule drags: join(?a, ?b) {
    when dirt(?a)
    with ?m - area: between(?a, ?b, ?m), dirt(?m)
    then 0.6: not dirt(?a), not dirt(?m)
         0.4: not dirt(?a)
  }
  reward { decrease(dirty) }
}
"""
PROBLEM = "objects { a b m n - area } init { dirt(a), dirt(m), dirt(n), between(a, b, m), between(a, b, n) }"


def task(problem: str, compat: bool) -> Task:
    domain = from_text.domain(REFERENCE)
    source = Source("p.nid", f"problem p {{ domain = d {problem} }}")
    return ground(domain, load_problem(source, domain), compat=compat)


def test_each_binding_of_a_reference_is_a_rule_of_its_own() -> None:
    assert task(PROBLEM, compat=False).rules == ()
    both = task(PROBLEM, compat=True)
    assert [holds(rule.condition, both.initial) for rule in both.rules] == [True, True]
    assert [str(action) for action in both.actions] == ["join(a, b)"]
    # Two rules of probability 1 leave nothing of each other: P(r) = φ(r) (1 - φ(r')).
    assert reference_prada.value(both, [0], independent_rules=True) == 0.0


def test_one_binding_is_the_same_either_way() -> None:
    problem = PROBLEM.replace("dirt(n), ", "")
    assert task(problem, compat=True) == task(problem, compat=False)
    assert reference_prada.value(task(problem, compat=True), [0], independent_rules=True) == pytest.approx(
        1.6
    )


def test_rules_may_overlap() -> None:
    domain = from_text.domain(REFERENCE)
    again = replace(domain.rules[0], name="again", condition=(), references=(), outcomes=domain.default)
    several = replace(domain, rules=(*domain.rules, again))
    source = Source("p.nid", f"problem p {{ domain = d {PROBLEM.replace('dirt(n), ', '')} }}")
    problem = load_problem(source, domain)
    with pytest.raises(Refused, match="E603"):
        ground(several, problem)
    found = ground(several, problem, compat=True)
    assert [rule.rule for rule in found.rules if holds(rule.condition, found.initial)] == [0, 1]


# ---- its own files, read literally


Ground = tuple[str, ...]
"""A symbol and its constants."""


class Literally:
    """What libPRADA computes of its own files, one line per formula of its description (§4.1): each ground
    literal has a marginal, and each binding of a rule's variables is a rule."""

    def __init__(self, library: Library) -> None:
        self.library = library
        self.constants = sorted({term for fact in library.facts for term in fact.terms})
        self.first = {(fact.symbol, *fact.terms): 1.0 for fact in library.facts if fact.value is True}

    def value(self, plan: list[Ground], discount: float) -> float:
        """The discounted decrease of the expected number of `dirt` (eq. 2)."""
        belief, total = dict(self.first), 0.0
        for step, action in enumerate(plan):
            after = self.advanced(belief, action)
            total += discount**step * (self.dirty(belief) - self.dirty(after))
            belief = after
        return total

    def dirty(self, belief: dict[Ground, float]) -> float:
        return sum(p for literal, p in belief.items() if literal[0] == "dirt")

    def advanced(self, belief: dict[Ground, float], action: Ground) -> dict[Ground, float]:
        rules = list(self.rules(action))
        phi = [cut(self.probability(belief, rule, bound)) for rule, bound in rules]
        alone = [cut(p * prod(1 - q for j, q in enumerate(phi) if j != i)) for i, p in enumerate(phi)]
        w = sum(alone)
        literals = {*belief, *(at(e, b) for rule, b in rules for r in rule.results for e in r.effects)}
        after = {}
        for literal in literals:
            p = belief.get(literal, 0.0)
            after[literal] = (1 - w) * p
            for q, (rule, bound) in zip(alone, rules, strict=True):
                made, unmade = (self.impact(rule, bound, literal, value) for value in (True, False))
                after[literal] += q * (made + (1 - made - unmade) * p)
        return after

    def rules(self, action: Ground) -> Iterator[tuple[LibraryRule, dict[str, str]]]:
        """The ground rules of a ground action."""
        for rule in self.library.rules:
            names = variables_of(rule.action, *rule.context)
            for objects in product(self.constants, repeat=len(names)):
                bound = dict(zip(names, objects, strict=True))
                if at(rule.action, bound) == action:
                    yield rule, bound

    def probability(self, belief: dict[Ground, float], rule: LibraryRule, bound: dict[str, str]) -> float:
        found = [(belief.get(at(atom, bound), 0.0), atom.value) for atom in rule.context]
        return prod(p if value is True else 1 - p for p, value in found)

    def impact(self, rule: LibraryRule, bound: dict[str, str], literal: Ground, value: bool) -> float:
        return sum(
            float(result.probability)
            for result in rule.results
            if any(at(effect, bound) == literal and effect.value is value for effect in result.effects)
        )


def at(atom: Atom, bound: dict[str, str]) -> Ground:
    return (atom.symbol, *(bound[term] if is_variable(term) else term for term in atom.terms))


def cut(probability: float) -> float:
    return probability if probability >= reference_prada.CUT else 0.0


SYMBOLS = """\
push 1 action binary
sweep 2 action binary
dirt 1 primitive binary
small 1 primitive binary
large 1 primitive binary
spread 1 primitive binary
beside 2 primitive binary
"""
RULES = """\
#rules = 4
ACTION:
  push(X)
CONTEXT:
  dirt(X) small(X)
OUTCOMES:
  0.6 -dirt(X)
  0.3 spread(X) small(X)
  0.1 <noise>

ACTION:
  push(X)
CONTEXT:
  dirt(X) large(X)
OUTCOMES:
  0.3 -dirt(X)
  0.5 -large(X) small(X)
  0.2 <no-change>

ACTION:
  push(X)
CONTEXT:
  spread(X) beside(X Y) dirt(Y)
OUTCOMES:
  0.5 -dirt(Y) -spread(X)
  0.5 <no-change>

ACTION:
  sweep(X Y)
CONTEXT:
  dirt(X) dirt(Y) beside(X Y) -large(Y)
OUTCOMES:
  0.5 -dirt(X) -small(Y) large(Y)
  0.2 -dirt(X) spread(Y)
  0.3 <noise>
"""
STATE = "dirt(1) small(1) dirt(2) large(2) dirt(3) large(3) spread(3) beside(1 2) beside(2 3) beside(3 1)"
OVERLAPPING = (Source("rules.dat", RULES), Source("state.dat", STATE), Source("symbols.dat", SYMBOLS))


def literal_task(files: tuple[Source, Source, Source]) -> Task:
    """The files' task as libPRADA grounds it, with all its predicates."""
    made = convert(*files, Wishes(predicates=True), ("domain.nid", "problem.nid"))
    domain = checked_domain(made.sources[0], compat=True).get()
    return ground(domain, load_problem(made.sources[1], domain), compat=True)


def differences(files: tuple[Source, Source, Source], plans: int) -> list[float]:
    """How far values of random plans are from those of the files read literally."""
    task, literally, rng = literal_task(files), Literally(read(*files)), random.Random(1)
    found = []
    for _ in range(plans):
        steps = [rng.randrange(len(task.actions)) for _ in range(task.horizon)]
        chosen = [task.actions[step] for step in steps]
        named = [(action.name, *(name.removeprefix("o") for name in action.objects)) for action in chosen]
        found.append(abs(plan_value(task, steps, compat=True) - literally.value(named, task.discount)))
    return found


def test_rules_that_overlap_are_refused_but_for_this() -> None:
    made = convert(*OVERLAPPING, Wishes(predicates=True), ("domain.nid", "problem.nid"))
    assert made.diagnostics == ()
    with pytest.raises(Refused, match="E307"):
        load_domain(made.sources[0])


def test_values_are_those_of_files_read_literally() -> None:
    assert max(differences(OVERLAPPING, 200)) < 1e-12


FOLDER = os.environ.get("CLEANCLI_LIBPRADA", "")
needs_files = pytest.mark.skipif(not FOLDER, reason="CLEANCLI_LIBPRADA names no folder of libPRADA's files")

GROUND = {2: (44, 15), 4: (70, 23), 6: (120, 39), 8: (212, 79), 10: (318, 123), 14: (474, 188)}
"""libPRADA's ground rules and actions for each number of areas."""


@cache
def converted(areas: int) -> Converted:
    rules, state, symbols = (
        read_source(Path(FOLDER) / f"d{areas}" / f"{name}.dat") for name in ("rules", "state", "symbols")
    )
    return convert(rules, state, symbols, Wishes(), ("domain.nid", "problem.nid"))


def task_of(areas: int, compat: bool) -> Task:
    made = converted(areas)
    domain = load_domain(made.sources[0])
    return ground(domain, load_problem(made.sources[1], domain), compat=compat)


@needs_files
@pytest.mark.parametrize("areas", GROUND)
def test_its_files_are_converted_without_a_warning(areas: int) -> None:
    made = converted(areas)
    assert made.diagnostics == ()
    assert made.functions == {"size": ("smallSize", "mediumSize", "bigSize")}
    assert (layout(made.domain), layout(made.problem)) == (made.domain, made.problem)


@needs_files
@pytest.mark.parametrize("areas", GROUND)
def test_its_ground_rules_are_found_but_for_those_about_the_container(areas: int) -> None:
    """It keeps rules that need a dirty container: 13 for the actions of one argument, 2 for join3 of each
    area that is aligned with it; and it counts the default rule."""
    aligned = converted(areas).problem.count("aligned(")
    task = task_of(areas, compat=True)
    rules, actions = GROUND[areas]
    assert len(task.rules) == rules - 13 - 2 * aligned - 1
    assert len(task.actions) == actions - 4 - aligned
    assert task.horizon == 1 + areas


@needs_files
def test_its_value_of_a_plan_is_found() -> None:
    task = replace(task_of(2, compat=True), horizon=3)
    steps = [small_tasks.action(task, f"moveToContainerStraight({name})") for name in ("o11", "o10", "o10")]
    assert reference_prada.value(task, steps, independent_rules=True) == pytest.approx(1.4024, abs=5e-5)


@needs_files
@pytest.mark.parametrize("areas", GROUND)
def test_values_of_its_own_problems_are_those_of_its_files_read_literally(areas: int) -> None:
    names = ("rules.dat", "state.dat", "symbols.dat")
    rules, state, symbols = (read_source(Path(FOLDER) / f"d{areas}" / name) for name in names)
    assert max(differences((rules, state, symbols), 5)) < 1e-12
