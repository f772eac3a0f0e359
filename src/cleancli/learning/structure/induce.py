"""Rules of a domain from transitions alone, action by action (Pasula, Zettlemoyer and Kaelbling 2007)."""

from __future__ import annotations

import itertools
import multiprocessing
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import checked_domain
from cleancli.language.model import Action, Domain, Outcome, Rule
from cleancli.language.printing.printer import print_domain
from cleancli.learning.edits import is_written
from cleancli.learning.structure.arrays import ActionArrays
from cleancli.learning.structure.contexts import asked_of, none_of, tree
from cleancli.learning.structure.effects import changes_of, with_foralls, with_references
from cleancli.learning.structure.kept import left_by, outside
from cleancli.learning.structure.outcomes import needed, possible
from cleancli.learning.structure.pasula import searched
from cleancli.learning.structure.rules import Described, default_of, described, rows_of, rules_of
from cleancli.learning.structure.score import Score, literals_of, scored
from cleancli.learning.structure.sets import Change
from cleancli.learning.structure.terms import Named, named


@dataclass(frozen=True, slots=True)
class Induced:
    """The rules of an action that were induced beside those that are `kept`; of the transitions that none
    covers, in how many nothing happened and in how many anything did."""

    action: str
    rules: tuple[Rule, ...]
    kept: tuple[Rule, ...]
    still: int
    odd: int


SEARCHES = ("tree", "pasula")
"""How contexts are found: by a decision tree, or by the search of 2007."""


@dataclass(frozen=True, slots=True)
class Way:
    """How rules are found: the `search` for contexts, and whether these ask for nothing but the action's
    arguments (`plain`)."""

    search: str = "tree"
    plain: bool = False


TREE = Way()

PER_FORALL = 2.0
"""Nats that each `forall` has to save against a reference; chosen. Most actions are on single objects."""
PER_CHANGED_LITERAL = 1.0
"""Nats that each literal must save by which rules are changed that somebody wrote: those of a rule that is
given up, and those of rules in its place; chosen. A result that no outcome says costs about five, so that
what happened once is no reason to give a rule up. To change as little as the examples ask for is the aim of
theory revision (Richards and Mooney 1995)."""


def induced(
    domain: Domain, action: Action, given: ActionArrays, way: Way = Way(), kept: tuple[Rule, ...] = ()
) -> Induced:
    """The rules that describe best the transitions of an action that none of those covers that are `kept`, as
    far as the search finds them. They cover nothing that these cover.

    Changes of objects that the action does not name are told by references first and by `forall` where these
    do not do, or the other way round: as is shorter.
    """
    given = left_by(kept, given) if kept else given
    if not given.arrays.changed.any():
        return Induced(action.name, (), kept, given.arrays.size, 0)
    changes = changes_of(given.arrays)
    known = named(given, action.parameters)
    names = [with_foralls(given, with_references(given, known, changes), changes)]
    if names[0].references:
        names.append(with_references(given, with_foralls(given, known, changes), changes))
    described = (_described(given, each, changes, way, action, kept) for each in names)
    leaves, _ = min(described, key=lambda each: each[1])
    left = np.delete(given.arrays.changed, rows_of(leaves))
    rules = rules_of(domain, action, leaves, beside=bool(kept))
    return Induced(action.name, rules, kept, int((left == 0).sum()), int((left > 0).sum()))


def _described(
    given: ActionArrays,
    known: Named,
    changes: Sequence[Change],
    way: Way,
    action: Action,
    kept: Sequence[Rule],
) -> tuple[list[Described], float]:
    """What the leaves of the best contexts do, and the length of the description in nats."""
    everything = possible(given.arrays, known, changes)
    results = needed(everything)
    has_some = any(results.outcomes)
    questions = (
        asked_of(given.arrays, known, results.outcomes, way.plain) if has_some else none_of(given.arrays)
    )
    if way.search == "pasula":
        grown = searched(results, questions)
    else:
        grown = tree(results, questions, np.arange(given.arrays.size))
    told = [described(results, everything, known, leaf) for leaf in grown.leaves]
    length = grown.length + sum(lost for _, lost in told) + PER_FORALL * len(known.foralls)
    if kept:
        changing = (each.leaf for each, _ in told if each.changes)
        parts = (part for leaf in changing for part in outside(given.arrays, known, action, leaf, kept))
        told = [described(results, everything, known, part) for part in parts]
    return [each for each, _ in told], length


def improved(domain: Domain, action: Action, given: ActionArrays, way: Way = Way()) -> Induced:
    """The rules of an action of which those of the domain stay that explain its transitions as well.

    One after the other is left out, and stays so if that and what is induced in its place raise the
    log-likelihood, by probabilities that fit, by more than the change costs. All may be left out at once,
    too.
    """
    own = tuple(rule for rule in domain.rules if rule.action == action.name)
    if not own:
        return induced(domain, action, given, way)
    best = _Candidate(Induced(action.name, (), own, 0, 0), _worth(domain, action, given, own, ()))
    best = _better(best, domain, action, given, way, own)
    for rule in own:
        stays = tuple(each for each in best.found.kept if each != rule)
        best = _better(best, domain, action, given, way, stays)
    return _better(best, domain, action, given, way, ()).found


class _Candidate(NamedTuple):
    """Rules of an action, and what they are worth."""

    found: Induced
    worth: float


def _better(
    best: _Candidate, domain: Domain, action: Action, given: ActionArrays, way: Way, kept: tuple[Rule, ...]
) -> _Candidate:
    """What is induced beside the rules that are kept, where that is worth more and can be written."""
    found = induced(domain, action, given, way, kept)
    worth = _worth(domain, action, given, kept, found.rules)
    if worth <= best.worth or (kept and _is_refused(domain, _beside(found))):
        return best
    return _Candidate(found, worth)


def _worth(
    domain: Domain, action: Action, given: ActionArrays, kept: Sequence[Rule], new: Sequence[Rule]
) -> float:
    score = scored(replace(domain, rules=(*kept, *new)), action.name, given, refitted=True)
    dropped = (rule for rule in domain.rules if rule.action == action.name and rule not in kept)
    return score.log_likelihood - PER_CHANGED_LITERAL * sum(map(literals_of, (*new, *dropped)))


# ---- whole domains


@dataclass(frozen=True, slots=True)
class Revised:
    """A domain with rules that were induced where they are better than those that it had.

    `before` and `after` are the scores of the actions that there are transitions of, `kept` the actions among
    them whose rules all stay as they are, and `dropped` and `added` the rules of the others that give way and
    that take their place. `default` says what a default rule says that the domain had none of; empty where
    none is needed.
    """

    domain: Domain
    before: Mapping[str, Score]
    after: Mapping[str, Score]
    kept: tuple[str, ...]
    dropped: tuple[Rule, ...]
    added: tuple[Rule, ...]
    default: tuple[Outcome, ...]


def revised(
    domain: Domain,
    compiled: Mapping[str, ActionArrays],
    actions: Sequence[str],
    search: str = TREE.search,
    jobs: int = 1,
    done: Callable[[], None] = lambda: None,
) -> Revised:
    """The domain with better rules for those of these actions that there are transitions of, found by a
    search of `SEARCHES`, on so many processes: for any number of them the same. `done` is called after each
    action.

    Each rule stays that explains its transitions as well, with probabilities that fit, as those that were
    induced, so that names and comments of rules that somebody wrote are kept.
    """
    declared = {each.name: each for each in domain.actions}
    tasks = [(domain, declared[name], compiled[name], Way(search)) for name in actions if name in compiled]
    found = {}
    for each in _all_improved(tasks, jobs):
        found[each.action] = each
        done()
    for name in _refused(domain, list(found.values())):
        found[name] = improved(domain, declared[name], compiled[name], Way(search, plain=True))
        if _is_refused(domain, _beside(found[name])):
            own = tuple(rule for rule in domain.rules if rule.action == name)
            found[name] = replace(found[name], rules=(), kept=own)
    stay = {rule.name for each in found.values() for rule in each.kept}
    dropped = tuple(rule for rule in domain.rules if rule.action in found and rule.name not in stay)
    stays = tuple(rule for rule in domain.rules if rule not in dropped)
    added = named_apart([rule for each in found.values() for rule in each.rules], stays)
    default = _default(domain, list(found.values()))
    whole = replace(domain, rules=(*stays, *added), default=default or domain.default)
    changed = {rule.action for rule in (*dropped, *added)}
    before = {name: scored(domain, name, compiled[name]) for name in found}
    after = {name: scored(whole, name, compiled[name]) if name in changed else before[name] for name in found}
    has_rules = {rule.action for rule in domain.rules}
    kept = tuple(name for name in found if name in has_rules - changed)
    return Revised(whole, before, after, kept, dropped, added, default)


def _all_improved(tasks: Sequence[tuple[Domain, Action, ActionArrays, Way]], jobs: int) -> Iterator[Induced]:
    if min(jobs, len(tasks)) < 2:
        yield from itertools.starmap(improved, tasks)
        return
    with ProcessPoolExecutor(min(jobs, len(tasks)), multiprocessing.get_context("spawn")) as executor:
        yield from executor.map(improved, *zip(*tasks, strict=True))


def _refused(domain: Domain, found: Sequence[Induced]) -> list[str]:
    """The actions whose rules `check` refuses or cannot tell apart, where too much has to be looked at."""
    together = {each.action: _beside(each) for each in found}
    if not _is_refused(domain, list(itertools.chain.from_iterable(together.values()))):
        return []
    return [action for action, rules in together.items() if _is_refused(domain, rules)]


def _beside(found: Induced) -> tuple[Rule, ...]:
    """The rules of an action, those that stay first."""
    return (*found.kept, *named_apart(found.rules, found.kept))


def _is_refused(domain: Domain, rules: Sequence[Rule]) -> bool:
    bare = replace(domain, rules=tuple(rules), default=(), learned=None)
    checked = checked_domain(Source(domain.name, print_domain(bare)))
    return checked.model is None or any(each.code == "W307" for each in checked.diagnostics)


def named_apart(rules: Sequence[Rule], others: Sequence[Rule]) -> tuple[Rule, ...]:
    """The rules, those whose names others have with a number behind it."""
    taken = {rule.name for rule in others}
    found = []
    for rule in rules:
        name, number = rule.name, 2
        while name in taken:
            name, number = f"{rule.name}_{number}", number + 1
        taken.add(name)
        found.append(replace(rule, name=name))
    return tuple(found)


def _default(domain: Domain, found: Sequence[Induced]) -> tuple[Outcome, ...]:
    """What a default rule says of what no rule covers, where the domain says nothing of that."""
    if any(map(is_written, domain.default)):
        return ()
    return default_of(sum(each.still for each in found), sum(each.odd for each in found))
