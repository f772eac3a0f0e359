"""Transitive closures against the definition: one or more steps lead from the first name to the second."""

from __future__ import annotations

import itertools
import time
from random import Random

import pytest

from cleancli.compiler.ground import ground
from cleancli.compiler.lifted_state import StateView
from cleancli.compiler.paths import Paths
from support import from_text


@pytest.mark.parametrize("seed", range(60))
def test_a_closure_is_what_steps_lead_to(seed: int) -> None:
    rng = Random(seed)
    names = [f"n{number}" for number in range(rng.randint(1, 9))]
    share = rng.choice((0.05, 0.15, 0.3))
    steps = {one: [two for two in names if rng.random() < share] for one in names}
    steps = {one: targets for one, targets in steps.items() if targets}
    paths = Paths(steps)
    for start in names:
        reached: set[str] = set()
        frontier = [start]
        while frontier:
            new = set(steps.get(frontier.pop(), ())) - reached
            reached |= new
            frontier += new
        assert {goal for goal in [*names, "elsewhere"] if paths.lead(start, goal)} == reached


def test_long_ways_are_no_deep_recursion() -> None:
    names = [f"n{number:05d}" for number in range(5000)]
    started = time.process_time()
    there = Paths({one: [two] for one, two in itertools.pairwise(names)})
    assert there.lead(names[0], names[-1])
    assert not there.lead(names[-1], names[0])
    around = Paths({one: [two] for one, two in zip(names, [*names[1:], names[0]], strict=True)})
    assert around.lead(names[-1], names[-1])
    assert time.process_time() - started < 5


def test_a_step_leads_only_between_objects_of_its_types() -> None:
    """`next` is of a room and a place: what is no room has no next one, though nothing there is locked."""
    domain, problem = from_text.checked(
        """
        domain d {
          types { place; room - place }
          predicates { locked(?x - place)  lit(?x - place) }
          derived {
            next(?x - room ?y - place) := not locked(?x), ?x != ?y
            way(?x - room ?y - place) := closure next
          }
          actions { light(?x - room) }
          rule light: light(?x) { when way(?x, ?x) then 1: lit(?x) }
          reward { goal }
        }
        """,
        "objects { hall - room  yard - place } init { } goal { lit(hall) } horizon = 3",
    )
    assert StateView(domain, problem.objects, problem.state).covering("light", ("hall",)) is None
    assert ground(domain, problem).rules == ()
