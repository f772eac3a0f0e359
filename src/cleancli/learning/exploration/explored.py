"""What experience has shown of each action: the rules that it teaches, and in which contexts it was seen."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cleancli.array_types import Bools, Longs
from cleancli.compiler.lifted import LiftedState
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.language.model import Action, Domain, Rule
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.parts import Part, held, parts_of
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.induce import revised

GROWTH = 1.1
"""The rules of an action are learned anew when there are so many times as many transitions of it; chosen, so
that all learning takes as long as about ten times the last."""

UNCOVERED = -1
"""In place of the number of a rule, where none covers."""


@dataclass(frozen=True, slots=True, eq=False)
class Specific:
    """The most specific context of what an action does by a rule (by its number among those of the action, or
    UNCOVERED): all that held in each transition in which it changed anything, (2 * parts,). It and the rule's
    own, which asks for as little as explains the transitions, bound where the rule may hold (version spaces,
    Mitchell 1982)."""

    rule: int
    holds: Bools

    def covers(self, held: Bools) -> Bools:
        """Which transitions are in the context, (n,), by what held in each (`held` of parts.py)."""
        found: Bools = np.logical_and.reduce(held[:, self.holds], axis=1)
        return found


@dataclass(frozen=True, slots=True, eq=False)
class ExploredAction:
    """An action with its n transitions: the `rules` that the first `learned` of them teach, what held in each
    of them (`held` of parts.py), by which rule each happened (n,), and which `changed` anything (n,)."""

    action: Action
    transitions: tuple[Transition, ...]
    learned: int
    rules: tuple[Rule, ...]
    parts: tuple[Part, ...]
    held: Bools
    by: Longs
    changed: Bools
    specific: tuple[Specific, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Explored:
    """A domain with the rules that are believed, and the actions that there is experience of, by name."""

    domain: Domain
    actions: Mapping[str, ExploredAction]
    number: int


def explored(domain: Domain, transitions: Sequence[Transition], before: Explored | None = None) -> Explored:
    """What transitions have shown of a domain, whose own rules count until others explain more.

    It depends on the transitions alone: what was known `before`, of the first of them, saves time.
    """
    known = {} if before is None else dict(before.actions)
    new = transitions[0 if before is None else before.number :]
    for name in dict.fromkeys(each.action for each in new):
        own = tuple(each for each in new if each.action == name)
        known[name] = _with(domain, known.get(name), name, own)
    untouched = tuple(rule for rule in domain.rules if rule.action not in known)
    learned = tuple(rule for action in domain.actions if (e := known.get(action.name)) for rule in e.rules)
    return Explored(replace(domain, rules=(*untouched, *learned)), known, len(transitions))


def _with(
    domain: Domain, before: ExploredAction | None, name: str, new: tuple[Transition, ...]
) -> ExploredAction:
    """What is known of an action with more transitions of it."""
    transitions = new if before is None else (*before.transitions, *new)
    learned = _last_lesson(len(transitions))
    if before is None or before.learned < learned:
        return _learned(domain, name, transitions, learned)
    return _extended(domain, before, new)


def _last_lesson(number: int) -> int:
    """After how many of so many transitions rules were learned last."""
    lesson = 1
    while (after := max(lesson + 1, math.ceil(lesson * GROWTH))) <= number:
        lesson = after
    return lesson


def _learned(domain: Domain, name: str, transitions: tuple[Transition, ...], learned: int) -> ExploredAction:
    action = next(each for each in domain.actions if each.name == name)
    given = compiled(domain, transitions[:learned])
    found = revised(domain, given, [name]).domain
    rules = tuple(rule for rule in found.rules if rule.action == name)
    parts = parts_of(domain, action, given[name])
    none, of_none = np.zeros((0, 2 * len(parts)), dtype=bool), np.zeros(0, dtype=np.int64)
    bare = ExploredAction(action, (), learned, rules, parts, none, of_none, of_none.astype(bool), ())
    return _extended(domain, bare, transitions)


def _extended(domain: Domain, before: ExploredAction, new: tuple[Transition, ...]) -> ExploredAction:
    """The same rules, with more transitions."""
    action, rules = before.action, LiftedRules(replace(domain, rules=before.rules))
    given = compiled(domain, new)[action.name]
    truth = np.concatenate([before.held, held(action, given, before.parts)])
    found = [covering(rules, rules.state(each.objects, each.before), each) for each in new]
    by = np.concatenate([before.by, found]).astype(np.int64)
    transitions = (*before.transitions, *new)
    changed = np.concatenate([before.changed, [bool(each.changed) for each in new]]).astype(bool)
    specific = tuple(
        Specific(int(rule), truth[changed & (by == rule)].all(axis=0)) for rule in np.unique(by[changed])
    )
    return replace(before, transitions=transitions, held=truth, by=by, changed=changed, specific=specific)


def covering(rules: LiftedRules, state: LiftedState, pair: Transition) -> int:
    """The number of the rule that covers the action of a pair in its state, or UNCOVERED."""
    found = rules.covering(state, pair.action, pair.arguments)
    return UNCOVERED if found is None else found[0]
