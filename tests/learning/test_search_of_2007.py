"""The greedy search of Pasula, Zettlemoyer and Kaelbling (2007): what it climbs, and where it ends."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from cleancli.compiler.fluents import values_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import checked_domain
from cleancli.language.printing.printer import print_domain
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.contexts import Questions, asked_of
from cleancli.learning.structure.effects import changes_of, with_foralls, with_references
from cleancli.learning.structure.induce import revised
from cleancli.learning.structure.outcomes import Possible, needed, possible
from cleancli.learning.structure.pasula import Context, _Search, searched
from cleancli.learning.structure.score import PER_LITERAL
from cleancli.learning.structure.terms import named
from cleancli.learning.variation import variation
from support.hidden_rules import TEXTS, domain_of, starts
from support.random_domains import Generator
from support.walks import walks


def parts(name: str, action: str, number: int) -> tuple[Possible, Questions]:
    """What is searched for an action of a hidden domain."""
    domain = domain_of(name)
    rng = np.random.default_rng(3)
    transitions = list(itertools.islice(walks(domain, starts(name, rng), rng), number))
    given = compiled(domain, transitions)[action]
    changes = changes_of(given.arrays)
    declared = next(each for each in domain.actions if each.name == action)
    known = with_references(given, named(given, declared.parameters), changes)
    known = with_foralls(given, known, changes)
    results = needed(possible(given.arrays, known, changes))
    return results, asked_of(given.arrays, known, results.outcomes)


def slow_score(found: Possible, questions: Questions, rules: tuple[Context, ...]) -> float:
    """The score by its definition, a transition after the other."""
    rows: dict[int, list[int]] = {number: [] for number in (-1, *range(len(rules)))}
    for row in range(len(found.pattern)):
        covering = [
            number
            for number, rule in enumerate(rules)
            if all(questions.answers[row, each] == answer for each, answer in rule)
        ]
        rows[covering[0] if covering else -1].append(row)
    total = 0.0
    for number, own in rows.items():
        kinds = [n for n, outcome in enumerate(found.outcomes) if number >= 0 or not outcome] + [-1]
        likely = [[float(found.likelihoods[found.pattern[row], kind]) for kind in kinds] for row in own]
        beliefs = [1 / len(kinds)] * len(kinds)
        for _ in range(12):
            seen = [0.0] * len(kinds)
            for each_likely in likely:
                joint = [belief * each for belief, each in zip(beliefs, each_likely, strict=True)]
                seen = [one + each / sum(joint) for one, each in zip(seen, joint, strict=True)]
            beliefs = [each / sum(seen) for each in seen] if own else beliefs
        total += sum(math.log(sum(b * p for b, p in zip(beliefs, each, strict=True))) for each in likely)
        if number >= 0:
            used = [
                kind for kind, belief in zip(kinds[:-1], beliefs, strict=False) if belief * len(own) > 0.5
            ]
            literals = len(rules[number]) + sum(1 + len(found.outcomes[kind]) for kind in used)
            total -= PER_LITERAL * literals
    return total


@pytest.mark.parametrize(("name", "action"), [("locks", "unlock"), ("lift", "leave"), ("weather", "gust")])
def test_scores_are_what_the_definition_says_and_no_operator_betters_the_end(name: str, action: str) -> None:
    found, questions = parts(name, action, 200)
    search = _Search(found, questions)
    tree = searched(found, questions)
    rules: tuple[Context, ...] = ()
    assert search.score(rules) == pytest.approx(slow_score(found, questions, rules))
    for changed in itertools.islice(search.changed(rules), 20):
        assert search.score(changed) == pytest.approx(slow_score(found, questions, changed))
    assert -tree.length > search.score(())
    indices = {question: number for number, question in enumerate(questions.listed)}
    ended = tuple(frozenset((indices[a.question], a.answer) for a in leaf.path) for leaf in tree.leaves)
    for one, other in itertools.combinations(ended, 2):
        assert any((number, not answer) in other for number, answer in one), "they exclude each other"


@pytest.mark.parametrize("name", TEXTS)
def test_hidden_rules_are_foretold(name: str) -> None:
    rng = np.random.default_rng(3)
    domain = domain_of(name)
    transitions = list(itertools.islice(walks(domain, starts(name, rng), rng), 600))
    bare = replace(domain, rules=(), default=())
    actions = [action.name for action in domain.actions]
    found = revised(bare, compiled(bare, transitions), actions, "pasula").domain
    assert variation(domain, found, list(itertools.islice(walks(domain, starts(name, rng), rng), 200))) < 0.05


@pytest.mark.parametrize("seed", [1, 3])
def test_rules_of_random_domains_exclude_each_other(seed: int) -> None:
    hidden = Generator(seed).domain()
    states = [
        (p.objects, values_of(p.state)) for p in (Generator(100 * seed + n).problem() for n in range(10))
    ]
    transitions = list(itertools.islice(walks(hidden, states, np.random.default_rng(seed)), 60))
    bare = replace(hidden, rules=(), counts=hidden.counts[:1], reward=hidden.reward[:1], parameters=())
    found = revised(bare, compiled(bare, transitions), ["one", "two"], "pasula").domain
    codes = {each.code for each in checked_domain(Source("found.nid", print_domain(found))).diagnostics}
    assert not codes - {"W201", "W202", "W203"}
