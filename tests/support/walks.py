"""Experience that is drawn from a domain's rules: walks of random actions from given states."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from cleancli.compiler.conflict import results
from cleancli.compiler.fluents import Values
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.model import Domain, Object
from cleancli.learning.experience import Transition

Start = tuple[tuple[Object, ...], Values]
"""The objects of a state, without constants, and its values."""


def walks(
    domain: Domain, starts: Sequence[Start], rng: np.random.Generator, steps: int = 12, covered: float = 0.75
) -> Iterator[Transition]:
    """Transitions without end, from one of the starts so many `steps` each. The action is drawn uniformly,
    its arguments from those that a rule covers with the probability `covered`, else from all."""
    rules = LiftedRules(domain)
    while True:
        objects, values = starts[int(rng.integers(len(starts)))]
        for _ in range(steps):
            action = domain.actions[int(rng.integers(len(domain.actions)))]
            everything = [*domain.constants, *objects]
            among = [[o.name for o in everything if domain.is_a(o.type, p.type)] for p in action.parameters]
            arguments = list(itertools.product(*among))
            if rng.random() < covered:
                state = rules.state(objects, values)
                fitting = [each for each in arguments if rules.covering(state, action.name, each)]
                arguments = fitting or arguments
            if arguments:
                chosen = arguments[int(rng.integers(len(arguments)))]
                after = drawn_after(domain, rules, objects, values, action.name, chosen, rng)
                yield Transition(action.name, chosen, objects, values, after)
                values = after


def drawn_after(
    domain: Domain,
    rules: LiftedRules,
    objects: tuple[Object, ...],
    values: Values,
    action: str,
    arguments: tuple[str, ...],
    rng: np.random.Generator,
) -> Values:
    """The state after an action, noise changing nothing."""
    state = rules.state(objects, values)
    found = rules.covering(state, action, arguments)
    if found is None:
        return values
    number, names = found
    outcomes = domain.rules[number].outcomes
    drawn = rng.choice(len(outcomes), p=[float(outcome.probability) for outcome in outcomes])
    changes = results(rules, state, number, names)[drawn]
    return {key: value for key, value in {**values, **changes}.items() if value is not False}


def flickering(
    domain: Domain, transitions: Iterable[Transition], share: float, rng: np.random.Generator
) -> Iterator[Transition]:
    """The transitions, after which each fact that actions may change is seen wrongly with a probability."""
    for transition in transitions:
        after = dict(transition.after)
        everything = [*domain.constants, *transition.objects]
        for symbol in (symbol for symbol in domain.symbols if not symbol.static):
            among = [[o.name for o in everything if domain.is_a(o.type, p.type)] for p in symbol.parameters]
            for names in itertools.product(*among):
                key = symbol.name, names
                if names != symbol.canonical(names) or rng.random() >= share:
                    continue
                if not symbol.is_predicate:
                    after[key] = symbol.values[int(rng.integers(len(symbol.values)))]
                elif after.pop(key, None) is None:
                    after[key] = True
        yield transition._replace(after=after)
