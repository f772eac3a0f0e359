"""Whole rules from experience: the new text of a domain, and how much better its rules are (§7.1)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from cleancli.api.checks import check_least, check_one_of
from cleancli.api.experience_paths import experience_files
from cleancli.api.inputs import GivenDomain, LoadedDomain, load_domain
from cleancli.api.learned import Change, check_writable
from cleancli.api.lessons import edited, is_own_file, knowledge, method_of
from cleancli.api.structure_notes import about_held_out, notes_of, unasked, unpaid
from cleancli.api.structure_result import ActionStructure, StructureResult, StructureScore
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain
from cleancli.language.model import Domain
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.learned_edits import learned_edits
from cleancli.language.printing.rule_edits import rule_edits
from cleancli.learning.edits import edits
from cleancli.learning.experience import Transition, read_experience
from cleancli.learning.gathered import GivenFile, gather
from cleancli.learning.learn import learned_from
from cleancli.learning.method import DEFAULT
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.induce import SEARCHES, TREE, Revised, revised
from cleancli.learning.structure.score import Score, scored, together
from cleancli.planning.plan import BadOption

HELD_OUT = 5
"""One transition of so many is held out, to see how well rules from the others foretell it; chosen."""


def learn_structure(
    domain: GivenDomain,
    *experience: str | Path,
    vocabulary: bool = False,
    actions: Sequence[str] = (),
    search: str = TREE.search,
    seed: int = 0,
    jobs: int = 1,
    write: bool = False,
) -> StructureResult:
    """Learn the rules of a domain from experience files or run folders: their conditions, references,
    outcomes and probabilities. Nothing is written unless asked for: by `write`, or by the result's method.

    Each rule stays that explains the experience as well as those that were learned, and all rules of an
    action stay where one of them is `fixed`; with `vocabulary`, none stays. `actions` names those to learn
    the rules of, by default all. `search` says how contexts are found: "tree", by a decision tree, or
    "pasula", by the search of Pasula, Zettlemoyer and Kaelbling (2007). `seed` draws the transitions that are
    held out; `jobs` is on how many processes, which changes nothing else.

    Raises Refused for mistakes in the texts and in the experience, ValueError for what makes no sense, and
    OSError.
    """
    check_least(0, seed=seed)
    check_least(1, jobs=jobs)
    check_one_of("search", search, SEARCHES)
    if not experience:
        raise BadOption("name experience files or run folders to learn from")
    loaded, is_writable = load_domain(domain), is_own_file(domain)
    if write:
        check_writable(loaded.sources[0], is_writable)
    wanted = Wanted(vocabulary, tuple(actions), search, seed, jobs)
    result = structures(loaded, [Path(each) for each in experience], wanted, is_writable)
    if write:
        result.write()
    return result


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is to be learned: see `learn_structure`."""

    vocabulary: bool = False
    actions: tuple[str, ...] = ()
    search: str = TREE.search
    seed: int = 0
    jobs: int = 1


def structures(
    domain: LoadedDomain,
    experience: Sequence[Path],
    wanted: Wanted,
    is_writable: bool,
    include_outside: bool = False,
    done: Callable[[], None] = lambda: None,
) -> StructureResult:
    """What was learned, after the new text was checked; `done` is called as the rules of each action are
    found, and again as those for what is held out are. Raises Refused, OSError, BadOption."""
    model = domain.model
    names, notes = _actions(model, wanted)
    files, passed_over = experience_files(experience, model)
    transitions = [each for file in files for each in read_experience(file.path, model)]
    start = _without_rules(model, names) if wanted.vocabulary else model
    if not start.rules:
        _refuse_nothing(names, transitions)
    found = revised(start, compiled(model, transitions), names, wanted.search, wanted.jobs, done)
    dropped = {rule.name for rule in found.dropped}
    if wanted.vocabulary:
        dropped |= {rule.name for rule in model.rules if rule.action in names}
    changed = rule_edits(model, domain.sources, dropped, found.added, found.default)
    texts, main = edited(domain.sources, changed), domain.sources[0].path
    if changed:
        texts[main] = Source(main, layout(texts[main].text, main))
    new = checked_domain(texts[main], include_outside, lambda file: texts[str(file)]).get()
    if found.added and len(found.added) == len(new.rules):
        texts = _rested(new, list(texts.values()), files)
        texts[main] = Source(main, layout(texts[main].text, main))
    scores = _Scores(found.before, found.after, *_held_out(start, transitions, names, wanted, done))
    return StructureResult(
        tuple(_row(name, [name], start, found, scores) for name in found.after),
        _row("all", list(found.after), start, found, scores),
        tuple(Change(source.path, source.text, texts[source.path].text) for source in domain.sources),
        (
            *about_held_out(together(list(scores.held_after.values())).transitions),
            *passed_over,
            *notes,
            *notes_of(names, found, wanted.vocabulary),
            *unasked(model, dropped, replace(model, rules=found.added), transitions, wanted.vocabulary),
            *unpaid(model, dropped, wanted.vocabulary),
        ),
        is_writable,
    )


def _rested(model: Domain, sources: Sequence[Source], files: Sequence[GivenFile]) -> dict[str, Source]:
    """The texts of a domain whose rules were all learned from files, as resting on these alone: its `learned`
    block names them, and what else had counts, of durations and of the default rule, is counted anew."""
    method = DEFAULT if model.learned is None else method_of(model.learned)
    gathered = gather(model, files, method.is_strict, adding=False, replacing=True)
    lesson = learned_from(model, gathered.evidence, method, adding=False)
    has_counts = any(outcome.seen is not None for outcome in model.default)
    rules = [each for each in lesson.rules if each.rule is None and has_counts]
    timed = {action.name for action in model.actions if action.duration_seen is not None}
    durations = [each for each in lesson.durations if each.action in timed]
    rests_on = knowledge(method, gathered.experience)
    changed = (*edits(model, sources, rules, durations), *learned_edits(model, sources[0], rests_on))
    return edited(sources, changed)


def _actions(model: Domain, wanted: Wanted) -> tuple[tuple[str, ...], list[str]]:
    """The actions to learn the rules of, and what a person should know of the others."""
    declared = [action.name for action in model.actions]
    for name in wanted.actions:
        if name not in declared:
            raise BadOption(f"the domain has no action `{name}`; it has {', '.join(declared)}")
    fixed = {rule.action for rule in model.rules if any(outcome.fixed for outcome in rule.outcomes)}
    names = [name for name in declared if name in wanted.actions or not wanted.actions]
    notes = [f"{name}: a rule of it is fixed, so all stay" for name in names if name in fixed]
    return tuple(name for name in names if name not in fixed), notes


def _without_rules(model: Domain, names: Sequence[str]) -> Domain:
    return replace(model, rules=tuple(rule for rule in model.rules if rule.action not in names))


class _Scores(NamedTuple):
    """The scores of each action before and after, and those of what is held out."""

    before: Mapping[str, Score]
    after: Mapping[str, Score]
    held_before: Mapping[str, Score]
    held_after: Mapping[str, Score]


def _held_out(
    model: Domain,
    transitions: Sequence[Transition],
    names: Sequence[str],
    wanted: Wanted,
    done: Callable[[], None],
) -> tuple[dict[str, Score], dict[str, Score]]:
    """The scores of what is held out of each action, by the rules as they are, and by those that are learned
    from the others."""
    held = np.random.default_rng(wanted.seed).permutation(len(transitions))[: len(transitions) // HELD_OUT]
    out = set(held.tolist())
    kept = [each for number, each in enumerate(transitions) if number not in out]
    learned = revised(model, compiled(model, kept), names, wanted.search, wanted.jobs, done).domain
    tested = compiled(model, [transitions[number] for number in sorted(out)])
    concerned = [name for name in names if name in tested]
    before, after = ({n: scored(d, n, tested[n]) for n in concerned} for d in (model, learned))
    return before, after


def _row(title: str, names: Sequence[str], start: Domain, found: Revised, scores: _Scores) -> ActionStructure:
    before, after, held_before, held_after = (
        together([each[name] for name in names if name in each]) for each in scores
    )
    return ActionStructure(
        title,
        before.transitions,
        tuple(rule.name for rule in start.rules if rule.action in names and rule not in found.dropped),
        _score(before, sum(rule.action in names for rule in start.rules), held_before),
        _score(after, sum(rule.action in names for rule in found.domain.rules), held_after),
    )


def _score(score: Score, rules: int, held_out: Score) -> StructureScore:
    number = held_out.transitions
    each = round(held_out.log_likelihood / number, 4) + 0.0 if number else None  # -0.0 + 0.0 is 0.0
    return StructureScore(rules, score.literals, round(score.log_likelihood, 2), round(score.score, 2), each)


def _refuse_nothing(names: Sequence[str], transitions: Sequence[Transition]) -> None:
    """Raises Refused (E708) where no transition is of an action that is to get rules."""
    if names and not any(each.action in names for each in transitions):
        what = f"the experience has no transition of {', '.join(names)}: there is nothing to learn rules from"
        help = "record some: `cleancli simulate DOMAIN PROBLEM --record FILE`, or `cleancli execute`"
        raise Refused([Diagnostic("E708", what, None, help=help)])
