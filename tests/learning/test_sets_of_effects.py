"""What effects set in transitions, counted at once for all, against a count of one fact after the other."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from cleancli.compiler.fluents import Fluent
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Assign, Domain, ForAll, Literal, Shift, Term, Value, Variable
from cleancli.learning.drawn_states import drawn_states
from cleancli.learning.experience import Transition
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.induce import revised
from cleancli.learning.structure.sets import mismatches
from cleancli.learning.structure.terms import Effect, named
from support.walks import flickering

TEXT = """domain many {
  types { box }
  constants { c - box }
  predicates { dirty(?b - box)  near(?a ?b - box) [symmetric]  on(?a ?b - box) }
  functions { height(?b - box): 0..4 }
  derived { left := count ?b - box: dirty(?b) }
  actions { wipe(?x ?y - box) }
  reward { decrease(left) }
}"""
BOUNDS = 0, 4


def test_facts_that_an_outcome_is_wrong_about_are_counted_once_each() -> None:
    """Many effects, of which several may set one fact: arguments may be one object, and `forall` sets others
    too."""
    domain = load_domain(Source("many.nid", TEXT))
    rng = np.random.default_rng(5)
    states = itertools.islice(drawn_states((domain,), rng), 60)
    transitions = list(flickering(domain, states, 0.15, rng))
    given = compiled(domain, transitions)["wipe"]
    action = domain.actions[0]
    outcomes = [_outcome(action.parameters, domain, rng) for _ in range(40)]
    found = mismatches(given.arrays, named(given, action.parameters), outcomes)
    slow = [[_wrong(domain, each, outcome) for outcome in outcomes] for each in transitions]
    assert found.tolist() == slow


def _outcome(parameters: tuple[Variable, ...], domain: Domain, rng: np.random.Generator) -> frozenset[Effect]:
    """Up to a dozen effects, with shifts of any one number by one amount alone."""
    other = Variable("o", "box")
    plain: tuple[Term, ...] = (*parameters, *domain.constants)
    found: list[Effect] = []
    for _ in range(int(rng.integers(1, 13))):
        every = rng.random() < 0.2
        first: Term = other if every else plain[int(rng.integers(3))]
        second = plain[int(rng.integers(3))]
        kinds: list[Assign | Shift] = [
            Assign("dirty", (first,), bool(rng.integers(2))),
            Assign("near", (first, second), bool(rng.integers(2))),
            Assign("on", (second, first), bool(rng.integers(2))),
        ]
        if not every:
            kinds.append(Shift("height", (first,), 1))
        inner = kinds[int(rng.integers(len(kinds)))]
        guard = Literal("on", (other, parameters[0]), frozenset({True}))
        found.append(ForAll((other,), (guard,), (inner,)) if every else inner)
    return frozenset(found)


def _wrong(domain: Domain, transition: Transition, outcome: frozenset[Effect]) -> int:
    """Once for each effect on a fact that is not so after, and once for each fact that changed unsaid."""
    names = dict(zip(domain.actions[0].parameters, transition.arguments, strict=True))
    objects = [*(each.name for each in domain.constants), *(each.name for each in transition.objects)]
    said: list[tuple[Fluent, Value | None]] = []
    shifts: dict[Fluent, int] = {}
    for effect in outcome:
        inner = effect.effects[0] if isinstance(effect, ForAll) else effect
        variable = Variable("o", "box")
        for thing in objects if isinstance(effect, ForAll) else [""]:
            bound = {**names, variable: thing}
            if thing and not transition.before.get(("on", (thing, bound[domain.actions[0].parameters[0]]))):
                continue
            terms = tuple(bound[t] if isinstance(t, Variable) else t.name for t in inner.terms)
            symbol = next(each for each in domain.symbols if each.name == inner.symbol)
            fluent = inner.symbol, symbol.canonical(terms)
            if isinstance(inner, Shift):
                shifts[fluent] = shifts.get(fluent, 0) + inner.amount
            said.append((fluent, None if isinstance(inner, Shift) else inner.value))
    wrong = 0
    for fluent, value in said:
        if value is None:
            before = transition.before[fluent]
            assert isinstance(before, int)
            value = min(max(before + shifts[fluent], BOUNDS[0]), BOUNDS[1])
        wrong += transition.after.get(fluent, False) != value
    return wrong + len(set(transition.changed) - {fluent for fluent, _ in said})


@pytest.mark.parametrize(("effects", "rules"), [(50, 1), (51, 0)])
def test_an_outcome_has_fifty_effects_at_most(effects: int, rules: int) -> None:
    names = [f"p{number}" for number in range(effects)]
    declared = f"predicates {{ {'()  '.join(names)}() }} actions {{ press() }}"
    text = f"domain much {{ {declared} reward {{ goal }} }}"
    domain = load_domain(Source("much.nid", text))
    everything: dict[Fluent, Value] = {(name, ()): True for name in names}
    transitions = [Transition("press", (), (), {}, everything)] * 8
    found = revised(domain, compiled(domain, transitions), ["press"]).domain
    assert len(found.rules) == rules
