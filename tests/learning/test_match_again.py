"""What a matcher remembers of transitions changes nothing: all are matched as if they were the first."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

import pytest

from cleancli.compiler.fluents import Values
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Object
from cleancli.learning.experience import Transition
from cleancli.learning.match import Match, Matcher

DOMAIN = load_domain(
    Source(
        "sweep.nid",
        """domain sweep {
  types { box }
  constants { bin - box }
  predicates { dirty(?b - box)  way(?b ?c ?m - box)  near(?b ?c - box) [symmetric] }
  functions { load(?b - box): 0..3 }
  derived { left := count ?b - box: dirty(?b) }
  actions { push(?b - box)  fill(?b ?c - box) }
  rule pushed: push(?b) {
    when dirty(?b)
    then 0.4: not dirty(?b), forall ?m - box: way(?b, bin, ?m) => (not dirty(?m), not near(?m, bin))
         0.2: not dirty(?b)
         0.1: near(?b, bin), forall ?m - box: way(?b, bin, ?m) => dirty(?m)
         rest: noise
  }
  rule filled: fill(?b, ?c) {
    when ?b != ?c
    then 0.5: load(?b) += 1
         0.2: load(?b) += 2, load(?c) := 0
         0.1: nothing
         rest: noise
  }
  reward { decrease(left) }
}""",
    )
)
NAMES = ("b1", "b2", "b3", "bin")
BOXES = tuple(Object(name, "box") for name in NAMES[:3])


def state(random: Random) -> dict[tuple[str, tuple[str, ...]], bool | int]:
    """Few boxes, so that the same happens again."""
    values: dict[tuple[str, tuple[str, ...]], bool | int] = {}
    for name in NAMES:
        if random.random() < 0.6:
            values["dirty", (name,)] = True
        if random.random() < 0.5:
            values["near", (min(name, "bin"), max(name, "bin"))] = True
        values["load", (name,)] = random.randrange(4)
    for one, other in (("b1", "b2"), ("b1", "b3"), ("b2", "b3")):
        if random.random() < 0.5:
            values["way", (one, "bin", other)] = True
    return values


def after(random: Random, before: Values) -> Values:
    """The state with a few things changed."""
    values = dict(before)
    for name in NAMES:
        if random.random() < 0.3 and not values.pop(("dirty", (name,)), False):
            values["dirty", (name,)] = True
        if random.random() < 0.2:
            values["load", (name,)] = random.randrange(4)
    return values


def transitions(number: int) -> Iterator[Transition]:
    random = Random(5)
    for _ in range(number):
        before = state(random)
        arguments = (random.choice(NAMES), random.choice(NAMES))
        action = random.choice(["push", "fill"])
        yield Transition(action, arguments[: 1 + (action == "fill")], BOXES, before, after(random, before))


@pytest.mark.parametrize("strict", [False, True])
def test_what_was_matched_before_changes_nothing(strict: bool) -> None:
    matcher, seen = Matcher(DOMAIN, strict), set[Match]()
    for transition in transitions(1500):
        found = matcher.match(transition)
        assert found == Matcher(DOMAIN, strict).match(transition)
        seen.add(found)
    # There were slips of all kinds, and the same was met again.
    assert {match.rule for match in seen} == {0, 1, None}
    fits = {fit for match in seen for fit in match.fits if fit is not None}
    assert strict or all(any(fit[part] for fit in fits) for part in range(4))
    assert len(seen) < 500
