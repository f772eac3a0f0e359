"""Rules that stay: what new rules ask for so that none of them covers what a rule covers that stays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from cleancli.array_types import Bools
from cleancli.language.checking.literals import with_terms
from cleancli.language.model import Action, Domain, Equality, Literal, Quantified, Rule, Term, Variable
from cleancli.learning.structure.arrays import ActionArrays, Arrays, holds, index_of
from cleancli.learning.structure.contexts import Asked, Leaf, Question, unnamed
from cleancli.learning.structure.rules import answered
from cleancli.learning.structure.score import bound
from cleancli.learning.structure.terms import Named

Part = Literal | Equality | Quantified


def left_by(rules: Sequence[Rule], given: ActionArrays) -> ActionArrays:
    """The transitions that none of the rules covers."""
    covered: Bools = np.zeros(given.arrays.size, dtype=bool)
    for rule in rules:
        covered |= bound(rule, given)[1]
    rows = np.flatnonzero(~covered)
    return ActionArrays(given.arrays.only(rows), tuple(column[rows] for column in given.columns))


def parts_of(rule: Rule, action: Action, known: Named) -> Iterator[Part]:
    """What a rule asks for, said of the action's parameters: its condition, and for each reference that rests
    on no other one that something is as it says. Variables of quantifiers get names that nothing has."""
    terms: dict[Term, Term] = dict(zip(rule.variables, action.parameters, strict=True))
    own = {variable for each in rule.references for variable in each.variables}
    for part in rule.condition:
        yield _renamed(part, terms, known) if isinstance(part, Quantified) else with_terms(part, terms)
    for each in rule.references:
        some_such = Quantified(True, each.variables, each.condition)
        if not own - set(each.variables) & _terms(each.condition):
            yield _renamed(some_such, terms, known)


def _renamed(part: Quantified, terms: dict[Term, Term], known: Named) -> Quantified:
    taken = {term.name for term in known.columns if isinstance(term, Variable)}
    variables: list[Variable] = []
    for each in part.variables:
        variables.append(Variable(unnamed(taken), each.type))
        taken.add(variables[-1].name)
    names = terms | dict(zip(part.variables, variables, strict=True))
    return Quantified(part.exists, tuple(variables), tuple(with_terms(p, names) for p in part.condition))


def _terms(condition: Iterable[Literal | Equality]) -> set[Term]:
    return {
        term
        for part in condition
        for term in (part.terms if isinstance(part, Literal) else (part.left, part.right))
    }


def outside(arrays: Arrays, known: Named, action: Action, leaf: Leaf, rules: Sequence[Rule]) -> list[Leaf]:
    """A leaf in parts, each of which asks for the opposite of something that each of these rules asks for.

    Transitions that no rule covers and that are told apart by nothing that can be asked for, such as that a
    reference fits several objects, are in no part.
    """
    index = index_of(arrays, known.columns)
    leaves = [leaf]
    for rule in rules:
        asked = [(part, holds(arrays, (part,), index)) for part in parts_of(rule, action, known)]
        leaves = [part for each in leaves for part in _outside(arrays, each, asked)]
    return leaves


def _outside(arrays: Arrays, leaf: Leaf, asked: Sequence[tuple[Part, Bools]]) -> Iterator[Leaf]:
    """The parts of a leaf, first the one in which most happened: where nothing did, no rule is needed."""
    if any(_excludes(arrays.domain, each, part) for each in leaf.path for part, _ in asked):
        yield leaf
        return
    left = list(asked)
    while left and len(leaf.rows):
        changed = arrays.changed[leaf.rows] > 0
        sizes = [(int((changed & ~yes[leaf.rows]).sum()), int((~yes[leaf.rows]).sum())) for _, yes in left]
        best = max(sizes)
        if not best[1]:
            return
        part, answers = left.pop(sizes.index(best))
        question, yes = Question(part), answers[leaf.rows]
        yield Leaf((*leaf.path, Asked(question, False)), leaf.rows[~yes])
        leaf = Leaf((*leaf.path, Asked(question, True)), leaf.rows[yes])


def _excludes(domain: Domain, asked: Asked, part: Part) -> bool:
    """Whether what was asked for says already that a part does not hold."""
    own = answered(domain, asked.question.part, asked.answer)
    if own == answered(domain, part, False):
        return True
    if not isinstance(own, Literal) or not isinstance(part, Literal):
        return False
    return (own.symbol, own.terms) == (part.symbol, part.terms) and not part.values & own.values
