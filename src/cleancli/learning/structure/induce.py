"""Rules of a domain from transitions alone, action by action (Pasula, Zettlemoyer and Kaelbling 2007)."""

from __future__ import annotations

import itertools
import multiprocessing
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import checked_domain
from cleancli.language.model import Action, Domain, Outcome, Rule
from cleancli.language.printing.printer import print_domain
from cleancli.learning.edits import is_written
from cleancli.learning.structure.arrays import ActionArrays
from cleancli.learning.structure.contexts import asked_of, tree
from cleancli.learning.structure.effects import changes_of, with_foralls, with_references
from cleancli.learning.structure.outcomes import needed, possible
from cleancli.learning.structure.pasula import searched
from cleancli.learning.structure.rules import Described, default_of, described, rows_of, rules_of
from cleancli.learning.structure.score import Score, scored
from cleancli.learning.structure.sets import Change
from cleancli.learning.structure.terms import Named, named


@dataclass(frozen=True, slots=True)
class Induced:
    """The rules of an action; of the transitions that none covers, in how many nothing happened and in how
    many anything did."""

    action: str
    rules: tuple[Rule, ...]
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


def induced(domain: Domain, action: Action, given: ActionArrays, way: Way = Way()) -> Induced:
    """The rules that describe the transitions of an action best, as far as the search finds them.

    Changes of objects that the action does not name are told by references first and by `forall` where these
    do not do, or the other way round: as is shorter.
    """
    changes = changes_of(given.arrays)
    known = named(given, action.parameters)
    names = [with_foralls(given, with_references(given, known, changes), changes)]
    if names[0].references:
        names.append(with_references(given, with_foralls(given, known, changes), changes))
    leaves, _ = min((_described(given, each, changes, way) for each in names), key=lambda each: each[1])
    left = np.delete(given.arrays.changed, rows_of(leaves))
    rules = rules_of(domain, action, leaves)
    return Induced(action.name, rules, int((left == 0).sum()), int((left > 0).sum()))


def _described(
    given: ActionArrays, known: Named, changes: Sequence[Change], way: Way
) -> tuple[list[Described], float]:
    """What the leaves of the best contexts do, and the length of the description in nats."""
    everything = possible(given.arrays, known, changes)
    results = needed(everything)
    questions = asked_of(given.arrays, known, way.plain)
    if way.search == "pasula":
        grown = searched(results, questions)
    else:
        grown = tree(results, questions, np.arange(given.arrays.size))
    return [described(results, everything, known, leaf) for leaf in grown.leaves], grown.length


# ---- whole domains


@dataclass(frozen=True, slots=True)
class Revised:
    """A domain with rules that were induced where they are better than those that it had.

    `before` and `after` are the scores of the actions that there are transitions of, `kept` the actions among
    them whose rules stay, and `dropped` and `added` the rules of the others. `default` says what a default
    rule says that the domain had none of; empty where none is needed.
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
) -> Revised:
    """The domain with better rules for those of these actions that there are transitions of, found by a
    search of `SEARCHES`, on so many processes: for any number of them the same.

    The rules of an action stay where their score, with probabilities that fit, is no worse than that of those
    that were induced, so that names and comments of rules that somebody wrote are kept.
    """
    declared = {each.name: each for each in domain.actions}
    tasks = [(domain, declared[name], compiled[name], Way(search)) for name in actions if name in compiled]
    found = {each.action: each for each in _all_induced(tasks, jobs)}
    for name in _refused(domain, list(found.values())):
        found[name] = induced(domain, declared[name], compiled[name], Way(search, plain=True))
        if _is_refused(domain, found[name].rules):
            found[name] = replace(found[name], rules=())
    default = _default(domain, list(found.values()))
    new = tuple(rule for each in found.values() for rule in each.rules)
    others = tuple(rule for rule in domain.rules if rule.action not in found)
    whole = replace(domain, rules=(*others, *new), default=default or domain.default)
    before = {name: scored(domain, name, compiled[name]) for name in found}
    after = {name: scored(whole, name, compiled[name]) for name in found}
    has_rules = {rule.action for rule in domain.rules}
    kept = tuple(
        name
        for name in found
        if name in has_rules
        and scored(domain, name, compiled[name], refitted=True).score >= after[name].score
    )
    added = named_apart([rule for rule in new if rule.action not in kept], [*others, *_of(domain, kept)])
    dropped = tuple(rule for rule in domain.rules if rule.action in found and rule.action not in kept)
    stays = tuple(rule for rule in domain.rules if rule not in dropped)
    return Revised(
        replace(whole, rules=(*stays, *added)),
        before,
        {name: before[name] if name in kept else score for name, score in after.items()},
        kept,
        dropped,
        added,
        default,
    )


def _all_induced(tasks: Sequence[tuple[Domain, Action, ActionArrays, Way]], jobs: int) -> list[Induced]:
    if min(jobs, len(tasks)) < 2:
        return list(itertools.starmap(induced, tasks))
    with ProcessPoolExecutor(min(jobs, len(tasks)), multiprocessing.get_context("spawn")) as executor:
        return list(executor.map(induced, *zip(*tasks, strict=True)))


def _refused(domain: Domain, found: Sequence[Induced]) -> list[str]:
    """The actions whose rules `check` refuses or cannot tell apart, where too much has to be looked at."""
    rules = [rule for each in found for rule in each.rules]
    if not _is_refused(domain, rules):
        return []
    return [each.action for each in found if _is_refused(domain, each.rules)]


def _is_refused(domain: Domain, rules: Sequence[Rule]) -> bool:
    bare = replace(domain, rules=tuple(rules), default=(), parameters=(), learned=None)
    checked = checked_domain(Source(domain.name, print_domain(bare)))
    return checked.model is None or any(each.code == "W307" for each in checked.diagnostics)


def _of(domain: Domain, actions: Sequence[str]) -> list[Rule]:
    return [rule for rule in domain.rules if rule.action in actions]


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
