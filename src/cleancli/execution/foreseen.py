"""What the rules foresee of a move in the situation in which it begins."""

from __future__ import annotations

from dataclasses import dataclass

from cleancli.compiler.conflict import results
from cleancli.compiler.lifted_state import StateView
from cleancli.execution.episode_state import Move, Situation
from cleancli.language.model import Domain, OutcomeKind


@dataclass(frozen=True, slots=True)
class Foreseen:
    """The index of the `rule` that covers a move, and the probability by it that `nothing` changes; None and
    0 for moves that are no actions, and where only the default rule says what they do."""

    rule: int | None = None
    nothing: float = 0.0


def foreseen(domain: Domain, before: Situation, move: Move) -> Foreseen:
    """What the rules of a domain foresee; noise may be anything on a table, and where nothing has a place it
    changes nothing (docs/simulation.md). Raises `Refused` (E602)."""
    if move.path is not None:
        return Foreseen()
    view = StateView(domain, before.objects, before.state)
    found = view.covering(move.action, move.objects)
    if found is None:
        return Foreseen()
    rule, binding = found
    changes = results(view.rules, view.state, rule, tuple(binding.values()))
    nothing = [
        outcome.probability
        for outcome, sets in zip(domain.rules[rule].outcomes, changes, strict=True)
        if (not before.areas or outcome.kind is not OutcomeKind.NOISE)
        and all(view.value(key) == value for key, value in sets.items())
    ]
    return Foreseen(rule, float(sum(nothing)))
