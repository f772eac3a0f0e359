"""Rules as narrow as their failures ask for (docs/learning.md, A teacher)."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest

from cleancli.array_types import Bools
from cleancli.compiler.fluents import Values
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Literal, Object, OutcomeKind
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.explored import Explored, covering, explored
from cleancli.learning.exploration.narrowed import narrowed, telling
from support.hidden_rules import domain_of, starts
from support.locked_doors import VOCABULARY
from support.walks import walks

DOOR = (Object("a", "door"),)


def doors() -> Domain:
    return load_domain(Source("doors.nid", VOCABULARY % ""))


def pushed(is_locked: bool, opens: bool, is_open: bool = False) -> Transition:
    facts = (("locked", is_locked), ("open", is_open))
    before: Values = {(name, ("a",)): True for name, holds in facts if holds}
    after: Values = {**before, ("open", ("a",)): True} if opens else before
    return Transition("push", ("a",), DOOR, before, after)


def test_one_success_among_failures_tells_where_an_action_works() -> None:
    """For so few transitions the rule that is believed asks for nothing, and says that a push is nearly
    always in vain; the narrowed one says where it is not."""
    failures = [pushed(True, False), pushed(False, False, True), pushed(True, False, True)] * 3
    found = explored(doors(), [pushed(False, True), *failures])
    (believed,) = found.domain.rules
    assert (believed.condition, believed.outcomes[0].probability < Fraction(1, 3)) == ((), True)
    (rule,) = narrowed(found).rules
    parts = {part.symbol: part.values for part in rule.condition if isinstance(part, Literal)}
    assert parts == {"locked": frozenset({False}), "open": frozenset({False})}
    assert [each.probability for each in rule.outcomes] == [1]


def test_what_nothing_tells_apart_keeps_its_share() -> None:
    """Of four pushes of an open lock one opened the door, and whatever else is asked for changes nothing of
    that."""
    tried = [pushed(False, opens) for opens in (True, False, False, False)]
    (rule,) = narrowed(explored(doors(), tried + [pushed(True, False)] * 12)).rules
    likely = {each.kind: each.probability for each in rule.outcomes}
    assert likely == {OutcomeKind.CHANGE: Fraction(1, 4), OutcomeKind.NOTHING: Fraction(3, 4)}


def test_rules_that_never_failed_stay_as_they_are() -> None:
    found = explored(doors(), [pushed(False, True)] * 5)
    assert narrowed(found) == found.domain


def drawn(seed: int) -> Explored:
    domain, rng = domain_of("locks"), np.random.default_rng(seed)
    return explored(domain, list(itertools.islice(walks(domain, starts("locks", rng), rng), 60)))


@pytest.mark.parametrize("seed", range(4))
def test_each_change_that_was_seen_is_still_foretold(seed: int) -> None:
    """All transitions in which a rule changed something are in its narrowed condition, and no others are than
    were in its own."""
    found = drawn(seed)
    assert narrowed(found) != found.domain
    of_all, narrow = LiftedRules(found.domain), LiftedRules(narrowed(found))
    for known in found.actions.values():
        for pair, changed in zip(known.transitions, known.changed, strict=True):
            own = covering(of_all, of_all.state(pair.objects, pair.before), pair)
            assert covering(narrow, narrow.state(pair.objects, pair.before), pair) in (
                (own,) if changed else (own, -1)
            )


def _slowly(held: Bools, changed: Bools) -> list[int]:
    """By the definition: each time all parts are tried, and the one after which the score is best is kept."""

    def likelihood(inside: list[int]) -> float:
        share = sum(bool(changed[row]) for row in inside) / len(inside)
        return sum(math.log(share if changed[row] else 1 - share) for row in inside)

    chosen: list[int] = []
    rows = list(range(len(held)))
    while True:
        scored = []
        for part in range(held.shape[1]):
            if all(held[row][part] for row in range(len(held)) if changed[row]):
                left = [row for row in rows if held[row][part]]
                scored.append((likelihood(left) - likelihood(rows), -part, left))
        if not scored or max(scored)[0] <= 0.5:
            return chosen
        _, place, rows = max(scored)
        chosen.append(-place)


def test_parts_are_taken_as_long_as_the_score_of_2007_rises() -> None:
    rng = np.random.default_rng(1)
    numbers = set()
    for _ in range(60):
        held = rng.random((int(rng.integers(2, 16)), 8)) < 0.8
        changed = np.arange(len(held)) < rng.integers(1, len(held))
        assert telling(held, changed) == _slowly(held, changed)
        numbers.add(len(telling(held, changed)))
    assert len(numbers) > 2
