"""The search of 2007 for the contexts of an action's rules (Pasula, Zettlemoyer and Kaelbling 2007, §4).

A set of rules is changed by operators as long as its score rises: the log-likelihood less half a nat for each
literal. Of the paper's operators these are here: ExplainExamples, DropRules, DropLits, AddLits, SplitOnLits
and ChangeRanges. A new rule takes the place of those that cover a transition that it covers. What rules may
ask for, their references and their outcomes are the same as for the tree (contexts.py), so that the paper's
operators on references, variables and constants have nothing to do.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from cleancli.array_types import Bools
from cleancli.language.model import Literal
from cleancli.learning.structure.contexts import Asked, Leaf, Questions, Tree
from cleancli.learning.structure.mixture import FEW_ROUNDS, fitted, log_likelihoods
from cleancli.learning.structure.outcomes import Possible, by_default
from cleancli.learning.structure.score import PER_LITERAL

MOST_EXAMPLES = 20
"""Transitions that no rule covers of which rules are made in one step, one of each kind; chosen."""

Context = frozenset[tuple[int, bool]]
"""Questions by their indices, and the answers that a rule asks for."""
Contexts = tuple[Context, ...]


def searched(possible: Possible, questions: Questions) -> Tree:
    """The contexts of the best rules that the search finds, and what no rule covers, as leaves."""
    search = _Search(possible, questions)
    rules: Contexts = ()
    score = search.score(rules)
    while True:
        found = max(search.changed(rules), key=search.score, default=rules)
        if search.score(found) <= score + 1e-9:
            break
        rules, score = found, search.score(found)
    leaves = _apart(search, rules)
    return Tree(tuple(leaves), -score)


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """What is searched; what contexts cover and are worth is remembered."""

    possible: Possible
    questions: Questions
    rows: dict[Context, Bools] = field(default_factory=dict)
    values: dict[Context, float] = field(default_factory=dict)
    scores: dict[frozenset[Context], float] = field(default_factory=dict)

    def covered(self, context: Context) -> Bools:
        """The transitions that a context covers (n,)."""
        if context not in self.rows:
            found = np.ones(len(self.possible.pattern), dtype=bool)
            for number, answer in context:
                found &= self.questions.answers[:, number] == answer
            self.rows[context] = found
        return self.rows[context]

    def value(self, context: Context) -> float:
        """What a rule adds to the score."""
        if context not in self.values:
            counts = self.possible.counts(self.covered(context))
            likelihoods = self.possible.likelihoods
            start = np.full(likelihoods.shape[1], 1 / likelihoods.shape[1])
            beliefs = fitted(counts[None], likelihoods, start, FEW_ROUNDS)
            used = np.flatnonzero(beliefs[0, :-1] * counts.sum() > 0.5)
            literals = len(context) + sum(1 + len(self.possible.outcomes[each]) for each in used)
            likelihood = float(log_likelihoods(counts[None], likelihoods, beliefs)[0])
            self.values[context] = likelihood - PER_LITERAL * literals
        return self.values[context]

    def score(self, rules: Contexts) -> float:
        """The score of a set of rules with its default rule."""
        key = frozenset(rules)
        if key not in self.scores:
            left = np.ones(len(self.possible.pattern), dtype=bool)
            for rule in rules:
                left &= ~self.covered(rule)
            self.scores[key] = sum(map(self.value, rules)) + by_default(self.possible, left)
        return self.scores[key]

    # ---- operators

    def changed(self, rules: Contexts) -> Iterator[Contexts]:
        """All sets of rules that the operators make of one."""
        for number in range(len(rules)):
            yield (*rules[:number], *rules[number + 1 :])
        for new in (*self._explaining(rules), *itertools.chain.from_iterable(map(self._near, rules))):
            yield self._with(rules, new)

    def _with(self, rules: Contexts, new: Contexts) -> Contexts:
        """The rules with new ones in place of those that cover what these cover."""
        covered = np.logical_or.reduce([self.covered(each) for each in new])
        return (*(each for each in rules if not (self.covered(each) & covered).any()), *new)

    def _explaining(self, rules: Contexts) -> Iterator[Contexts]:
        """ExplainExamples: of each kind of transition that no rule covers, a rule that asks for all that held
        of the arguments, less what it can do without."""
        left = np.ones(len(self.possible.pattern), dtype=bool)
        for rule in rules:
            left &= ~self.covered(rule)
        _, first = np.unique(np.where(left, self.possible.pattern, -1), return_index=True)
        for row in [row for row in first.tolist() if left[row]][:MOST_EXAMPLES]:
            plain = [n for n, each in enumerate(self.questions.listed) if not hasattr(each.part, "exists")]
            about = [n for n, each in enumerate(self.questions.listed) if each.reference and not each.further]
            answers = self.questions.answers[row]
            context = frozenset((number, bool(answers[number])) for number in (*plain, *about))
            yield (self._trimmed(context),)

    def _trimmed(self, context: Context) -> Context:
        for part in sorted(context, reverse=True):
            less = context - {part}
            gained = self.covered(less) & ~self.covered(context)
            if self.value(less) - by_default(self.possible, gained) >= self.value(context):
                context = less
        return context

    def _near(self, rule: Context) -> Iterator[Contexts]:
        """DropLits, AddLits, SplitOnLits and ChangeRanges of one rule."""
        asked = {number for number, _ in rule}
        for part in sorted(rule):
            yield (rule - {part},)
            for other in self._ranges(part[0]):
                yield (rule - {part} | {(other, True)},)
        for number in range(len(self.questions.listed)):
            if number not in asked:
                yes, no = rule | {(number, True)}, rule | {(number, False)}
                if self.covered(yes).any() and self.covered(no).any():
                    yield (yes,)
                    yield (no,)
                    yield yes, no

    def _ranges(self, number: int) -> Iterator[int]:
        """Questions about the same function of the same terms."""
        part = self.questions.listed[number].part
        for other, each in enumerate(self.questions.listed):
            match each.part, part:
                case Literal(symbol, terms), Literal(same, others) if other != number:
                    if (symbol, terms) == (same, others):
                        yield other


def _apart(search: _Search, rules: Contexts) -> list[Leaf]:
    """Leaves of rules that exclude each other not only in what was seen: where two do not, the one that
    covers less asks for the opposite of something that the other asks for."""
    ordered = sorted(rules, key=lambda each: (-int(search.covered(each).sum()), sorted(each)))
    found: list[Context] = []
    for rule in ordered:
        for other in found:
            if not any((number, not answer) in rule for number, answer in other):
                options = [rule | {(number, not answer)} for number, answer in sorted(other - rule)]
                rule = max(options, key=lambda each: int(search.covered(each).sum()), default=rule)
        found.append(rule)
    left = np.ones(len(search.possible.pattern), dtype=bool)
    leaves = []
    for rule in found:
        covered = search.covered(rule)
        left &= ~covered
        path = tuple(Asked(search.questions.listed[number], answer) for number, answer in sorted(rule))
        if covered.any():
            leaves.append(Leaf(path, np.flatnonzero(covered)))
    return leaves
