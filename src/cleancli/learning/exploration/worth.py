"""What it is worth to try an action in a state: by about how much less what is foretold will be wrong.

Counts are of transitions in contexts of the rules now believed, never of states: what one state has shown
counts for all that the rules take to be like it. A probability p that rests on n examples is off by about
the square root of p (1 - p) / n, so the next example takes away about that over n; and what has not happened
in n tries happens in about one of n + 1 (Laplace's rule of succession), so the next one takes away about
1 / (n + 1)². Whether a part of a context matters is settled sooner: by as many tries without it as it takes
until it would be odd that none did what the rule does.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import betaln

from cleancli.array_types import Bools, Floats
from cleancli.compiler.fluents import Values
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.model import Action, Domain, Object
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.explored import UNCOVERED, Explored, ExploredAction, covering
from cleancli.learning.exploration.parts import held
from cleancli.learning.structure.arrays import ActionArrays, Arrays, compiled

UNTRIED = 1.0
"""What an action is worth of which there is no transition."""
NEAR, OTHERWISE, FURTHER = 0.5, 0.05, 0.7
"""What it is worth to try an action where one part does not hold of the most specific context in which it is
known to do something, before anything was seen there: to learn whether the part matters, and whether anything
else happens there; and by which factor less for each further part. Chosen by trying
(benchmarks/exploration.py)."""
UNCHANGED = 0.3
"""The same of an action that has changed nothing so far, where two parts hold together for the first time;
chosen alike."""
AGAIN = 0.25
"""By which factor less it is worth for each time that it has changed nothing in this very state; chosen."""
MOST_PAIRS = 2000
"""Arguments of one action that are looked at, drawn where there are more; chosen."""


@dataclass(frozen=True, slots=True)
class Try:
    """An action to be tried on objects, and what that is worth."""

    action: str
    objects: tuple[str, ...]
    worth: float


def least_worth(known: int) -> float:
    """What a try is worth at least where it is not known what happens: as much as one more example of a rule
    that has as many as eq. 6 asks for; like that bound, for the worst probability, which is a half."""
    return float((known + 1) ** -1.5)


def tries(
    found: Explored, objects: tuple[Object, ...], state: Values, rng: np.random.Generator
) -> Iterator[Try]:
    """All that can be tried in a state, with what it is worth."""
    once: Arrays | None = None
    for action in found.domain.actions:
        arguments = arguments_of(found.domain, action, objects, rng)
        if not arguments:
            continue
        known = found.actions.get(action.name)
        pairs = [Transition(action.name, names, objects, state, state) for names in arguments]
        worth = np.full(len(pairs), UNTRIED)
        if known is not None:
            once = once or compiled(found.domain, pairs[:1])[action.name].arrays
            worth = _worth(found.domain, known, pairs, _repeated(once, pairs))
        yield from (
            Try(action.name, names, value) for names, value in zip(arguments, worth.tolist(), strict=True)
        )


def arguments_of(
    domain: Domain, action: Action, objects: Sequence[Object], rng: np.random.Generator
) -> list[tuple[str, ...]]:
    """What an action can be done on; where that is more than MOST_PAIRS, as many that are drawn."""
    everything = (*domain.constants, *objects)
    among = [[o.name for o in everything if domain.is_a(o.type, p.type)] for p in action.parameters]
    number = math.prod(map(len, among))
    if number <= MOST_PAIRS:
        return list(itertools.product(*among))
    drawn = (tuple(names[int(rng.integers(len(names)))] for names in among) for _ in range(MOST_PAIRS))
    return list(dict.fromkeys(drawn))


def _repeated(once: Arrays, pairs: Sequence[Transition]) -> ActionArrays:
    """The arrays of one state, a row for each pair of an action in it."""
    names = (each.name for each in (*once.domain.constants, *pairs[0].objects))
    places = {name: place for place, name in enumerate(dict.fromkeys(names))}
    columns = [[places[name] for name in pair.arguments] for pair in pairs]
    at = np.array(columns, dtype=np.int64).reshape(len(pairs), len(pairs[0].arguments))
    return ActionArrays(once.only(np.zeros(len(pairs), dtype=np.int64)), tuple(at.T))


def _worth(domain: Domain, known: ExploredAction, pairs: Sequence[Transition], given: ActionArrays) -> Floats:
    """What an action is worth to be tried with these arguments in a state, (pairs,); `given` as arrays."""
    here = held(known.action, given, known.parts)
    kinds, kind = np.unique(here, axis=0, return_inverse=True)
    worth = _by_context(known, kinds)[kind.reshape(-1)]
    rules = LiftedRules(replace(domain, rules=known.rules))
    state = rules.state(pairs[0].objects, pairs[0].before)
    still = itertools.compress(known.transitions, ~known.changed)
    seen = [each for each in still if each.before == pairs[0].before]
    for place, pair in enumerate(pairs):
        rule = covering(rules, state, pair)
        if rule == UNCOVERED:
            worth[place] *= AGAIN ** sum(each.arguments == pair.arguments for each in seen)
        else:
            worth[place] = max(worth[place], by_rule(known, rule))
    return worth


def by_rule(known: ExploredAction, rule: int) -> float:
    """What one more example of a rule is worth."""
    return _of_example(known, rule, int((known.by == rule).sum()))


def near(known: ExploredAction, inside: Bools, number: int) -> float:
    """What it is worth to try an action where one part of a specific context does not hold, after so many
    such tries that changed nothing. `inside`: which transitions are in that context, (n,).

    If the part did not matter, they would have changed nothing by a chance of which those inside tell
    (beta-binomial, from a uniform prior); so a few tries settle it. That something else happens there is as
    likely as of anything that has not happened yet.
    """
    changing = int(known.changed[inside].sum())
    still = int(inside.sum()) - changing
    chance = math.exp(betaln(changing + 1, still + 1 + number) - betaln(changing + 1, still + 1))
    return NEAR * chance + OTHERWISE / (number + 1) ** 2


def _of_example(known: ExploredAction, rule: int, number: int) -> float:
    """What one more example is worth where there are so many; something that has not happened yet may."""
    spread = 1.0
    if rule != UNCOVERED:
        likely = [float(outcome.probability) for outcome in known.rules[rule].outcomes]
        spread = sum(math.sqrt(p * (1 - p)) for p in likely)
    return float((spread + (number + 2) ** -0.5) / (number + 1) ** 1.5)


def _by_context(known: ExploredAction, kinds: Bools) -> Floats:
    """What a try is worth by what holds, (kinds,), where `kinds` are as `held` tells it."""
    worth = np.zeros(len(kinds))
    if all(each.rule == UNCOVERED for each in known.specific):
        together = known.held.T.astype(np.float32) @ known.held.astype(np.float32)
        for place, kind in enumerate(kinds):
            worth[place] = (
                UNCHANGED / (float(together[np.ix_(kind, kind)].min(initial=len(known.by))) + 1) ** 2
            )
    for each in known.specific:
        inside = each.covers(known.held)
        outside = known.held[~inside]
        for place, kind in enumerate(kinds):
            missing = int((each.holds & ~kind).sum())
            if missing:
                # With as much of the context as the pair has, and not all: they tell if the rest matters.
                alike = int(outside[:, each.holds & kind].all(axis=1).sum())
                value = near(known, inside, alike) * FURTHER ** (missing - 1)
            else:
                value = _of_example(known, each.rule, int(inside.sum()))
            worth[place] = max(worth[place], value)
    return worth
