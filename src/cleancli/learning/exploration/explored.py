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
from cleancli.learning.evidence import collected
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.parts import Part, held, parts_of
from cleancli.learning.learn import learned_from
from cleancli.learning.learn import revised as with_lesson
from cleancli.learning.match import Matcher
from cleancli.learning.method import DEFAULT, Method
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
    of them (`held` of parts.py), by which rule each happened (n,), and which `changed` anything (n,). The
    first of the rules are those of the domain that stay, as its text has them `kept`."""

    action: Action
    transitions: tuple[Transition, ...]
    learned: int
    kept: tuple[Rule, ...]
    rules: tuple[Rule, ...]
    parts: tuple[Part, ...]
    held: Bools
    by: Longs
    changed: Bools
    specific: tuple[Specific, ...]

    @property
    def lesson(self) -> tuple[Transition, ...]:
        """The transitions that the rules were learned from."""
        return self.transitions[: self.learned]


@dataclass(frozen=True, slots=True, eq=False)
class Explored:
    """A domain with the rules that are believed, and the actions that there is experience of, by name."""

    domain: Domain
    actions: Mapping[str, ExploredAction]
    number: int


def explored(
    domain: Domain,
    transitions: Sequence[Transition],
    before: Explored | None = None,
    method: Method = DEFAULT,
) -> Explored:
    """What transitions have shown of a domain, whose own rules count until others explain more; the
    probabilities of those that stay are learned by a `method`.

    It depends on the transitions alone: what was known `before`, of the first of them, saves time. Raises
    Refused (E602).
    """
    known = {} if before is None else dict(before.actions)
    new = transitions[0 if before is None else before.number :]
    for name in dict.fromkeys(each.action for each in new):
        own = tuple(each for each in new if each.action == name)
        known[name] = _with(domain, known.get(name), name, own)
    if before is not None and _lessons(known) == _lessons(before.actions):
        return Explored(before.domain, known, len(transitions))
    return Explored(*_estimated(domain, known, method), len(transitions))


def _lessons(known: Mapping[str, ExploredAction]) -> dict[str, int]:
    return {name: each.learned for name, each in known.items()}


def _estimated(
    domain: Domain, known: Mapping[str, ExploredAction], method: Method
) -> tuple[Domain, dict[str, ExploredAction]]:
    """The domain with the rules that are believed, and the actions with theirs: those of the domain that stay
    have the probabilities that the transitions teach beside what its text has counted, as with `learn
    --add`."""
    kept = tuple(r for r in domain.rules if r.action not in known or r in known[r.action].kept)
    own = replace(domain, rules=kept)
    seen = [each for e in known.values() for each in e.lesson] if kept else []
    evidence = collected(Matcher(own, method.is_strict), seen)
    estimated = with_lesson(own, learned_from(own, evidence, method, adding=True)).rules
    now = {rule.name: rule for rule in estimated}
    actions = {
        name: replace(e, rules=(*(now[rule.name] for rule in e.kept), *e.rules[len(e.kept) :]))
        for name, e in known.items()
    }
    untouched = (rule for rule in estimated if rule.action not in known)
    found = (rule for action in domain.actions if (e := actions.get(action.name)) for rule in e.rules)
    return replace(domain, rules=(*untouched, *found)), actions


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
    kept = tuple(rule for rule in rules if rule in domain.rules)
    parts = parts_of(domain, action, given[name])
    none, of_none = np.zeros((0, 2 * len(parts)), dtype=bool), np.zeros(0, dtype=np.int64)
    bare = ExploredAction(action, (), learned, kept, rules, parts, none, of_none, of_none.astype(bool), ())
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
