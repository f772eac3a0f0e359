"""From leaves to rules: conditions that exclude each other, references, outcomes, and names.

What a leaf asks for was divided by the tree, so two rules differ in one question at least, one asking for it
and the other for its opposite. A question about what a reference names is part of the reference where the
rule has one and nothing else asks for the opposite.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeVar

import numpy as np

from cleancli.array_types import Floats, Longs
from cleancli.language.model import (
    Action,
    Assign,
    Condition,
    Domain,
    Equality,
    ForAll,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Quantified,
    Reference,
    Rule,
    Shift,
    Term,
    Variable,
)
from cleancli.learning.share import DIGITS, rounded
from cleancli.learning.structure.arrays import UNDEFINED
from cleancli.learning.structure.contexts import Asked, Leaf, Question
from cleancli.learning.structure.literals import meet, negated
from cleancli.learning.structure.mixture import log_likelihoods
from cleancli.learning.structure.outcomes import Possible, by_default, chosen
from cleancli.learning.structure.terms import Effect, Named, used

LEAST, PER_EFFECT = 1.0, 0.1
"""Nats that an outcome of a rule must save, and more for each effect, so that what changes nothing is
`nothing`; chosen."""


@dataclass(frozen=True, slots=True, eq=False)
class Described:
    """A leaf with the outcomes that describe its transitions best, their probabilities with that of noise at
    the end, and the references that these use.

    `likelihood` is how likely that makes the transitions of the leaf that was described, as a logarithm;
    those that are not its own any more follow the default rule.
    """

    leaf: Leaf
    outcomes: tuple[frozenset[Effect], ...]
    probabilities: Floats
    references: tuple[Reference, ...]
    likelihood: float

    @property
    def changes(self) -> bool:
        """Whether it says more than that nothing happens."""
        return any(self.outcomes)


def described(possible: Possible, everything: Possible, known: Named, leaf: Leaf) -> tuple[Described, float]:
    """The leaf with its outcomes, and how many nats it costs that a rule covers only transitions in which
    all its references name something.

    Either only these are its own, or outcomes are done without whose references name nothing in some: as
    describes the transitions better. The probabilities are the mean of those in its transitions and of those
    that hold where its questions do not matter. An outcome gives way to the simplest of `everything` that
    explains as much of the leaf.
    """
    best = _with_outcomes(possible, everything, known, leaf)
    named = [known.columns[each.variables[0]][leaf.rows] != UNDEFINED for each in best.references]
    partial = {each for each, where in zip(best.references, named, strict=True) if not where.all()}
    if not partial:
        return best, 0.0
    always = [n for n, each in enumerate(possible.outcomes) if partial.isdisjoint(used(known, [each]))]
    less = leaf if leaf.otherwise is None else replace(leaf, otherwise=leaf.otherwise[[*always, -1]])
    found = [_with_outcomes(possible.only(always), everything, known, less)]
    everywhere = np.logical_and.reduce(named)
    if everywhere.any():
        own = _with_outcomes(possible, everything, known, replace(leaf, rows=leaf.rows[everywhere]))
        left = by_default(possible, leaf.rows[~everywhere])
        found.append(replace(own, likelihood=own.likelihood + left))
    chosen_one = max(found, key=lambda each: each.likelihood)
    return chosen_one, best.likelihood - chosen_one.likelihood


def _with_outcomes(possible: Possible, everything: Possible, known: Named, leaf: Leaf) -> Described:
    costs = np.array([LEAST + PER_EFFECT * len(outcome) for outcome in possible.outcomes])
    counts = possible.counts(leaf.rows)
    kept, probabilities = chosen(possible, counts, costs)
    likelihoods = possible.likelihoods[:, [*kept, -1]]
    likelihood = float(log_likelihoods(counts[None], likelihoods, probabilities)[0])
    if leaf.otherwise is not None:
        mixed = (1 - leaf.doubt) * probabilities + leaf.doubt * leaf.otherwise[[*kept, -1]]
        probabilities = mixed / mixed.sum()
    outcomes = _simplest(possible, everything, kept, leaf.rows)
    return Described(leaf, outcomes, probabilities, used(known, outcomes), likelihood)


def _simplest(
    possible: Possible, everything: Possible, kept: Sequence[int], rows: Longs
) -> tuple[frozenset[Effect], ...]:
    """The outcomes that are kept, or those with the fewest effects that explain all that they do there."""
    may = everything.likelihoods[everything.pattern[rows]]
    by_length = sorted(range(len(everything.outcomes)), key=lambda each: len(everything.outcomes[each]))
    found: list[frozenset[Effect]] = []
    for number in kept:
        own = possible.likelihoods[possible.pattern[rows], number]
        as_much = (each for each in by_length if (may[:, each] >= own).all())
        outcome = everything.outcomes[next(as_much)]
        found.append(possible.outcomes[number] if outcome in found else outcome)
    return tuple(found)


def rules_of(
    domain: Domain, action: Action, leaves: Sequence[Described], beside: bool = False
) -> tuple[Rule, ...]:
    """The rules of an action, one for each leaf that changes anything; `beside`: it has others, too."""
    written = [each for each in leaves if each.changes]
    names = _names(domain, action, [each.leaf.path for each in written], beside)
    return tuple(
        _rule(domain, action, each, [other.leaf.path for other in written], name)
        for each, name in zip(written, names, strict=True)
    )


def _rule(
    domain: Domain, action: Action, described: Described, paths: Sequence[tuple[Asked, ...]], name: str
) -> Rule:
    condition, references = _condition(domain, described, paths)
    outcomes = _outcomes(domain, described, condition)
    return apart(domain, Rule(name, action.name, action.parameters, condition, outcomes, references))


# ---- conditions


def _condition(
    domain: Domain, described: Described, paths: Sequence[tuple[Asked, ...]]
) -> tuple[Condition, tuple[Reference, ...]]:
    references = list(described.references)
    path = described.leaf.path
    parts: list[Literal | Equality | Quantified] = []
    for asked, alone in zip(path, _alone(path, paths), strict=True):
        question = asked.question
        if question.reference in described.references:
            place = described.references.index(question.reference)
            more = _of_reference(domain, asked, alone)
            if more is not None:
                condition = (*references[place].condition, *more)
                references[place] = replace(references[place], condition=condition)
                continue
        parts.append(answered(domain, question.part, asked.answer))
    references = [replace(each, condition=_merged(each.condition)) for each in references]
    return _merged(parts), tuple(references)


def _of_reference(domain: Domain, asked: Asked, alone: bool) -> tuple[Literal | Equality, ...] | None:
    """What an answer about one of a rule's references adds to it; None where it has to be asked for itself:
    where a rule asks for the opposite, or where it is about one of several objects."""
    question = asked.question
    if question.several:
        return () if alone and not asked.answer else None
    if asked.answer and not question.further:
        return ()
    if not question.never_several or not (asked.answer or alone):
        return None
    return question.further if asked.answer else tuple(_opposite(domain, p) for p in question.further)


def answered(
    domain: Domain, part: Literal | Equality | Quantified, answer: bool
) -> Literal | Equality | Quantified:
    """The part where the answer is yes, else its opposite."""
    if isinstance(part, Quantified):
        return replace(part, exists=answer)
    return part if answer else _opposite(domain, part)


def _alone(path: tuple[Asked, ...], paths: Sequence[tuple[Asked, ...]]) -> list[bool]:
    """Of each question whether no rule is written that gave it the other answer."""
    answers = set(itertools.chain.from_iterable(paths))
    return [Asked(asked.question, not asked.answer) not in answers for asked in path]


def _opposite(domain: Domain, part: Literal | Equality) -> Literal | Equality:
    if isinstance(part, Equality):
        return replace(part, equal=not part.equal)
    return negated(domain, part)


_Part = TypeVar("_Part", Literal | Equality, Literal | Equality | Quantified)


def _merged(parts: Sequence[_Part]) -> tuple[_Part, ...]:
    """The parts with what is asked of one fluent in one literal."""
    found: dict[object, _Part] = {}
    for part in parts:
        if isinstance(part, Literal):
            key = part.symbol, part.terms
            before = found.get(key)
            values = part.values & before.values if isinstance(before, Literal) else part.values
            relation = part.relation if values == part.values else ""
            found[key] = replace(part, values=values, relation=relation)
        else:
            found[part] = part
    return tuple(found.values())


# ---- outcomes


def _outcomes(domain: Domain, described: Described, condition: Condition) -> tuple[Outcome, ...]:
    shares: dict[frozenset[Effect] | None, float] = {}
    for outcome, share in zip((*described.outcomes, None), map(float, described.probabilities), strict=True):
        kind = None if outcome is None else _as_asked(outcome, condition)
        shares[kind] = shares.get(kind, 0.0) + share
    if shares[None] * len(described.leaf.rows) < 0.5:
        del shares[None]
    total = sum(shares.values())
    exact = rounded([share / total for share in shares.values()], Fraction(1), 10**DIGITS)
    listed = [
        (share, _outcome(domain, share, outcome))
        for share, outcome in zip(exact, shares, strict=True)
        if share
    ]
    order = (OutcomeKind.CHANGE, OutcomeKind.NOTHING, OutcomeKind.NOISE)
    listed.sort(key=lambda each: (order.index(each[1].kind), -each[0]))
    return tuple(outcome for _, outcome in listed)


def _as_asked(outcome: frozenset[Effect], condition: Condition) -> frozenset[Effect]:
    """The effects with one name for what the condition says is one object, without those that set what it
    asks for already."""
    same: dict[Term, Term] = {
        part.right: part.left for part in condition if isinstance(part, Equality) and part.equal
    }
    held = {(p.symbol, p.terms, p.values) for p in condition if isinstance(p, Literal)}
    found: set[Effect] = set()
    for effect in outcome:
        if isinstance(effect, ForAll):
            found.add(effect)
            continue
        terms = tuple(same.get(term, term) for term in effect.terms)
        if not isinstance(effect, Assign) or (effect.symbol, terms, frozenset({effect.value})) not in held:
            found.add(replace(effect, terms=terms))
    return frozenset(found)


def _outcome(domain: Domain, share: Fraction, outcome: frozenset[Effect] | None) -> Outcome:
    if outcome is None:
        return Outcome(share, OutcomeKind.NOISE)
    if not outcome:
        return Outcome(share, OutcomeKind.NOTHING)
    order = {symbol.name: number for number, symbol in enumerate(domain.symbols)}
    plain = sorted(
        (each for each in outcome if not isinstance(each, ForAll)),
        key=lambda each: (order[each.symbol], str(each)),
    )
    foralls: dict[tuple[tuple[Variable, ...], Condition], list[Assign | Shift]] = {}
    for each in sorted((each for each in outcome if isinstance(each, ForAll)), key=str):
        foralls.setdefault((each.variables, each.condition), []).extend(each.effects)
    together = (
        ForAll(variables, condition, tuple(effects))  # type: ignore[arg-type]
        for (variables, condition), effects in foralls.items()
    )
    return Outcome(share, OutcomeKind.CHANGE, (*plain, *together))


def apart(domain: Domain, rule: Rule) -> Rule:
    """The rule with what keeps the objects apart that one outcome would give two values."""
    for outcome in rule.outcomes:
        plain = [each for each in outcome.effects if not isinstance(each, ForAll)]
        for one, other in itertools.combinations(plain, 2):
            different = _different(domain, one, other)
            if different is not None:
                rule = _with_part(rule, different)
    outcomes = tuple(
        replace(outcome, effects=tuple(_narrowed(domain, each, outcome.effects) for each in outcome.effects))
        for outcome in rule.outcomes
    )
    return replace(rule, outcomes=outcomes)


def _narrowed(
    domain: Domain, effect: Assign | Shift | ForAll, others: Sequence[Assign | Shift | ForAll]
) -> Assign | Shift | ForAll:
    """A `forall` that passes over the objects to which an effect beside it gives another value."""
    if not isinstance(effect, ForAll):
        return effect
    for inner, other in itertools.product(effect.effects, others):
        if not isinstance(other, ForAll):
            part = _different(domain, inner, other)
            if part is not None and not _keeps_apart(effect.condition, part):
                effect = replace(effect, condition=(*effect.condition, part))
    return effect


def _different(domain: Domain, one: Assign | Shift, other: Assign | Shift) -> Equality | None:
    """That two terms are not one object, where two effects would otherwise give one fluent two values."""
    agree = (isinstance(one, Shift) and isinstance(other, Shift)) or (
        isinstance(one, Assign) and isinstance(other, Assign) and one.value == other.value
    )
    if one.symbol != other.symbol or agree:
        return None
    pairs = [(a, b) for a, b in zip(one.terms, other.terms, strict=True) if a != b]
    if not pairs or not all(_may_be_one(domain, a, b) for a, b in pairs):
        return None
    return Equality(*pairs[0], False)


def _keeps_apart(condition: Condition, part: Equality) -> bool:
    """Whether a condition asks already for the two terms to differ, in either order."""
    both = {part.left, part.right}
    return any(isinstance(p, Equality) and {p.left, p.right} == both and not p.equal for p in condition)


def _may_be_one(domain: Domain, one: Term, other: Term) -> bool:
    """Whether two terms may stand for one object."""
    is_named = isinstance(one, Object) and isinstance(other, Object)
    return not is_named and meet(domain, one.type, other.type)


def _with_part(rule: Rule, part: Equality) -> Rule:
    """The rule with one more equality, where it does not have it."""
    both = {part.left, part.right}
    if _keeps_apart((*rule.condition, *(p for each in rule.references for p in each.condition)), part):
        return rule
    for number in reversed(range(len(rule.references))):
        reference = rule.references[number]
        if both & set(reference.variables):
            changed = replace(reference, condition=(*reference.condition, part))
            references = (*rule.references[:number], changed, *rule.references[number + 1 :])
            return replace(rule, references=references)
    return replace(rule, condition=(*rule.condition, part))


# ---- names


def _names(domain: Domain, action: Action, paths: Sequence[tuple[Asked, ...]], beside: bool) -> list[str]:
    """The action's name, with what tells its rules apart where there are several."""
    if len(paths) == 1 and not beside:
        return [action.name]
    found: list[str] = []
    for path in paths:
        tell_apart = [beside or not alone for alone in _alone(path, paths)]
        parts = itertools.compress(path, tell_apart)
        name = "_".join([action.name, *dict.fromkeys(filter(None, (_word(domain, each) for each in parts)))])
        number = 2
        while name in found:
            name = f"{name.removesuffix(f'_{number - 1}')}_{number}"
            number += 1
        found.append(name)
    return found


def _word(domain: Domain, asked: Asked) -> str:
    """What a name says of an answer."""
    part = asked.question.part
    if asked.question.several:
        return "several" if asked.answer else "one"
    if isinstance(part, Quantified):
        return ("" if asked.answer else "no_") + _word(domain, Asked(Question(part.condition[-1]), True))
    if isinstance(part, Equality):
        return "same" if part.equal == asked.answer else "different"
    literal = part if asked.answer else negated(domain, part)
    symbol = next((each for each in domain.symbols if each.name == literal.symbol), None)
    if symbol is None or symbol.is_predicate:
        return literal.symbol if True in literal.values else f"not_{literal.symbol}"
    chosen_values = [value for value in symbol.values if value in literal.values]
    others = [value for value in symbol.values if value not in literal.values]
    if len(chosen_values) == 1:
        return _value(chosen_values[0])
    if len(others) == 1:
        return f"not_{_value(others[0])}"
    if chosen_values[0] == symbol.values[0]:
        return f"up_to_{_value(chosen_values[-1])}"
    return f"from_{_value(chosen_values[0])}"


def _value(value: object) -> str:
    return str(value).replace("-", "minus_")


def default_of(nothing: int, noise: float) -> tuple[Outcome, ...]:
    """What actions do where no rule covers them; empty where nothing ever happened."""
    total = nothing + noise
    if noise < 0.5 or not total:
        return ()
    still, odd = rounded([nothing / total, noise / total], Fraction(1), 10**DIGITS)
    listed = ((still, OutcomeKind.NOTHING), (odd, OutcomeKind.NOISE))
    return tuple(Outcome(share, kind) for share, kind in listed if share)


def rows_of(leaves: Sequence[Described]) -> Longs:
    """The transitions that rules cover."""
    rows = [each.leaf.rows for each in leaves if each.changes]
    return np.concatenate(rows) if rows else np.zeros(0, dtype=np.int64)
