"""Grounding as libPRADA does, and its files where CLEANCLI_LIBPRADA names the folder of d2, d4 ... d14."""

from __future__ import annotations

import os
from dataclasses import replace
from functools import cache
from pathlib import Path

import domains
import pytest
import reference

from cleancli.compiler.ground import ground
from cleancli.compiler.task import Task, holds
from cleancli.conversion.convert import Converted, Wishes, convert
from cleancli.language.diagnostics import Refused, Source
from cleancli.language.layout import layout
from cleancli.language.load import load_domain, load_problem, read_source

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
    domain = domains.domain(REFERENCE)
    source = Source("p.nid", f"problem p {{ domain = d {problem} }}")
    return ground(domain, load_problem(source, domain), compat=compat)


def test_each_binding_of_a_reference_is_a_rule_of_its_own() -> None:
    assert task(PROBLEM, compat=False).rules == ()
    both = task(PROBLEM, compat=True)
    assert [holds(rule.condition, both.initial) for rule in both.rules] == [True, True]
    assert [str(action) for action in both.actions] == ["join(a, b)"]
    # Two rules of probability 1 leave nothing of each other: P(r) = φ(r) (1 - φ(r')).
    assert reference.value(both, [0], independent_rules=True) == 0.0


def test_one_binding_is_the_same_either_way() -> None:
    problem = PROBLEM.replace("dirt(n), ", "")
    assert task(problem, compat=True) == task(problem, compat=False)
    assert reference.value(task(problem, compat=True), [0], independent_rules=True) == pytest.approx(1.6)


def test_rules_may_overlap() -> None:
    domain = domains.domain(REFERENCE)
    again = replace(domain.rules[0], name="again", condition=(), references=(), outcomes=domain.default)
    several = replace(domain, rules=(*domain.rules, again))
    source = Source("p.nid", f"problem p {{ domain = d {PROBLEM.replace('dirt(n), ', '')} }}")
    problem = load_problem(source, domain)
    with pytest.raises(Refused, match="E603"):
        ground(several, problem)
    found = ground(several, problem, compat=True)
    assert [rule.rule for rule in found.rules if holds(rule.condition, found.initial)] == [0, 1]


FOLDER = os.environ.get("CLEANCLI_LIBPRADA", "")
needs_files = pytest.mark.skipif(not FOLDER, reason="CLEANCLI_LIBPRADA names no folder of libPRADA's files")

GROUND = {2: (44, 15), 4: (70, 23), 6: (120, 39), 8: (212, 79), 10: (318, 123), 14: (474, 188)}
"""libPRADA's ground rules and actions for each number of areas."""


@cache
def converted(areas: int) -> Converted:
    files = (
        read_source(Path(FOLDER) / f"d{areas}" / f"{name}.dat") for name in ("rules", "state", "symbols")
    )
    return convert(*files, Wishes(), ("domain.nid", "problem.nid"))


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
    steps = [domains.action(task, f"moveToContainerStraight({name})") for name in ("o11", "o10", "o10")]
    assert reference.value(task, steps, independent_rules=True) == pytest.approx(1.4024, abs=5e-5)
