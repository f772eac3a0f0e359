"""In which states an action does what: a decision tree over what a context may ask for.

A node is divided by the question that makes the description shortest, as long as one makes it shorter
(Quinlan and Rivest 1989); the probabilities on both sides are fitted for all questions at once. Whether a
question matters is never sure: a leaf says how likely it does not, by how much shorter it makes the
description, and what holds then (Buntine 1992, who averages over all trees that are left when one is cut).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from cleancli.array_types import Bools, Floats, Longs
from cleancli.language.checking.literals import with_terms
from cleancli.language.model import (
    Assign,
    Domain,
    Equality,
    Literal,
    Quantified,
    Reference,
    Term,
    Value,
    Variable,
)
from cleancli.learning.structure.arrays import Arrays, holds, index_of, ranging, some
from cleancli.learning.structure.literals import equalities, is_provable, literals, negated, symbols
from cleancli.learning.structure.mixture import FEW_ROUNDS, fitted, log_likelihoods
from cleancli.learning.structure.outcomes import Possible
from cleancli.learning.structure.sets import Outcome
from cleancli.learning.structure.terms import Named, Parts, effect_terms, needed_by, terms_of, used


@dataclass(frozen=True, slots=True)
class Question:
    """A part of a condition that a node asks for.

    Where it asks whether an object is as a reference says, that is the `reference`, and `further` what is
    asked of it beside; or it asks whether `several` are. `never_several`: in no transition there are. `one`:
    whether exactly one is, which is asked by the two questions before it, one after the other.
    """

    part: Literal | Equality | Quantified
    reference: Reference | None = None
    further: Parts = ()
    several: bool = False
    one: bool = False
    never_several: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Questions:
    """What may be asked, of which kind each is, and the answers, (n, questions). What others ask one after
    the other is asked `by` those, told by the indices of all."""

    listed: tuple[Question, ...]
    by: Mapping[int, tuple[int, ...]]
    kinds: Longs
    answers: Bools


@dataclass(frozen=True, slots=True)
class Asked:
    """A question and its answer on the way to a leaf."""

    question: Question
    answer: bool


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """The transitions of these rows, and what was asked on the way to them.

    `doubt` is how likely some question on the way does not matter, and `otherwise` how likely each outcome
    and noise are then.
    """

    path: tuple[Asked, ...]
    rows: Longs
    doubt: float = 0.0
    otherwise: Floats | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """The leaves, and the length of the description in nats, questions with it."""

    leaves: tuple[Leaf, ...]
    length: float


EACH = 1 / 12
"""The share of the logarithm of how many transitions an action has that each probability of an outcome costs,
on either side of a question; chosen. It is half of that logarithm by Schwarz (1978), which few transitions
cannot pay; a question adds the probabilities of one side alone."""
SHARES = (2 / 5, 1 / 4, 1 / 4, 1 / 4, 1 / 4)
"""The share of questions that each kind is taken to have; chosen. The likely ones, which are of the next two
kinds as well, ask for what an outcome changes, or about an argument that no outcome names: what actions make
untrue held before (Yang, Wu and Jiang 2007, who take that for certain), and arguments matter for something.
The others are about one term, about several, about what a reference names, and about unnamed objects."""
UNLIKELY = 2.0
"""Nats that a question costs beside that which is about an object without a name, or asks if a number is one
between its bounds, where rules mostly ask if it is at most so much; chosen."""
_CERTAIN = 500.0
"""Nats by which a shorter description leaves no doubt, within what `exp` can tell."""


def tree(possible: Possible, questions: Questions, rows: Longs) -> Tree:
    """The tree that describes these transitions best, as far as one question after the other finds it."""
    counts, beliefs = possible.counts(rows), _beliefs(possible, rows)
    length = (
        _free(possible, counts, beliefs) - log_likelihoods(counts[None], possible.likelihoods, beliefs)[0]
    )
    return _grown(possible, questions, Leaf((), rows), float(length))


def _grown(possible: Possible, questions: Questions, leaf: Leaf, length: float) -> Tree:
    """The tree below a node, the answers yes first, where the node by itself has this length."""
    best = _best(possible, questions, leaf.rows)
    if best is None or best.length >= length:
        return Tree((leaf,), length)
    yes = questions.answers[leaf.rows, best.question]
    sides, divided = list[Tree](), best.cost
    for answer, own, alone in zip((True, False), (yes, ~yes), best.lengths, strict=True):
        path = (*leaf.path, Asked(questions.listed[best.question], answer))
        sides.append(_grown(possible, questions, Leaf(path, leaf.rows[own]), alone))
        divided += sides[-1].length
    leaves = tuple(each for side in sides for each in side.leaves)
    if _changes(possible, leaf.rows[yes]) and _changes(possible, leaf.rows[~yes]):
        doubt = 1 / (1 + math.exp(min(length - divided, _CERTAIN)))
        own = _beliefs(possible, leaf.rows)
        leaves = tuple(_doubted(each, doubt, own) for each in leaves)
    return Tree(leaves, divided)


def _changes(possible: Possible, rows: Longs) -> bool:
    """Whether an outcome that changes anything made any of these transitions; where none did, the question
    whether they are such is not in doubt."""
    changing = np.array([*map(bool, possible.outcomes), False])
    return float(_beliefs(possible, rows)[changing].sum()) * len(rows) > 0.5


def _beliefs(possible: Possible, rows: Longs) -> Floats:
    """The probabilities of all outcomes in these transitions."""
    start = np.full(possible.likelihoods.shape[1], 1 / possible.likelihoods.shape[1])
    found: Floats = fitted(possible.counts(rows)[None], possible.likelihoods, start)[0]
    return found


def _doubted(leaf: Leaf, doubt: float, own: Floats) -> Leaf:
    """The leaf where a node above it is divided for nothing by this probability, so that the node's own
    probabilities of outcomes hold."""
    if leaf.otherwise is None:
        return replace(leaf, doubt=doubt, otherwise=own)
    below = leaf.doubt * (1 - doubt)
    otherwise = (below * leaf.otherwise + doubt * own) / (below + doubt)
    return replace(leaf, doubt=below + doubt, otherwise=otherwise)


class _Division(NamedTuple):
    """A question by its index, what it costs, and the lengths of both its sides, yes first; in nats."""

    question: int
    cost: float
    lengths: tuple[float, float]

    @property
    def length(self) -> float:
        """Of the whole node."""
        return self.cost + sum(self.lengths)


def _best(possible: Possible, questions: Questions, rows: Longs) -> _Division | None:
    """The question that leads to the shortest description of a node, if any divides it."""
    counts = possible.counts(rows)
    used = counts > 0
    likelihoods, every = possible.likelihoods[used], counts[used]
    answers = questions.answers[rows].astype(np.float32)
    patterns = (possible.pattern[rows][:, None] == np.flatnonzero(used)[None]).astype(np.float32)
    yes = (answers.T @ patterns).astype(float)
    splits = (yes.sum(axis=1) > 0) & (yes.sum(axis=1) < every.sum())
    listed = np.flatnonzero(splits)
    if len(every) < 2 or not len(listed):
        return None
    start = np.full(likelihoods.shape[1], 1 / likelihoods.shape[1])
    beliefs = fitted(every[None], likelihoods, start)[0]
    free, start = _free(possible, every, beliefs), np.maximum(beliefs, 1e-3)
    kinds = questions.kinds[listed]
    costs = _costs(kinds, questions.answers[np.ix_(rows, listed)], len(possible.pattern))
    sides = []
    for side in (yes[listed], every - yes[listed]):
        below = fitted(side, likelihoods, start / start.sum(), FEW_ROUNDS)
        sides.append(free - log_likelihoods(side, likelihoods, below))
    best = int((costs + sides[0] + sides[1]).argmin())
    by = questions.by.get(int(listed[best]))
    if by is not None:
        best = next(place for place, number in enumerate(listed) if number in by)
    return _Division(int(listed[best]), float(costs[best]), (float(sides[0][best]), float(sides[1][best])))


def _costs(kinds: Longs, answers: Bools, number: int) -> Floats:
    """The nats that each question costs which divides a node, of so many transitions of the action: to say
    which it is of those of its kind, those that divide the node alike taken as one (Quinlan and Rivest 1989:
    of the attributes available at the node), and no more than half of that and of the logarithm of the
    transitions, since few transitions could not pay all of the name."""
    alike = np.ascontiguousarray(np.packbits(answers ^ answers[:1], axis=0).T)
    first = {each.tobytes(): number for number, each in reversed(list(enumerate(alike)))}
    different = np.bincount(kinds[list(first.values())], minlength=len(SHARES))
    naming = np.log(np.maximum(different, 1) / SHARES)[kinds]
    least = np.minimum(naming, (naming + math.log(number)) / 2)
    found: Floats = least + UNLIKELY * (kinds == _UNLIKELY)
    return found


def _free(possible: Possible, counts: Floats, beliefs: Floats) -> float:
    """What the probabilities of a node's outcomes cost; as much on either side of a question, also where an
    outcome is on one side alone."""
    return EACH * math.log(len(possible.pattern)) * float((beliefs * counts.sum() > 0.5).sum())


# ---- what may be asked


_UNLIKELY = len(SHARES) - 1
"""Which kind of questions are the unlikely ones."""


def none_of(arrays: Arrays) -> Questions:
    """No question, where all that happens is noise."""
    return Questions((), {}, np.zeros(0, dtype=np.int64), np.zeros((arrays.size, 0), dtype=bool))


def asked_of(
    arrays: Arrays, known: Named, outcomes: Sequence[Outcome], plain_alone: bool = False
) -> Questions:
    """All questions whose answers differ in some transitions, each kind of answers once: those that are
    likely of an action with these outcomes and the other plain ones first, and no others if `plain_alone`."""
    is_likely = _likely(known, outcomes)
    plain = list(_plain(arrays, known))
    likely = [each for each in plain if is_likely(each[0].part)]
    alone = [each for each in plain if not is_likely(each[0].part) and _is_of_one(each[0].part)]
    related = [each for each in plain if not is_likely(each[0].part) and not _is_of_one(each[0].part)]
    kinds: list[Iterable[tuple[Question, Bools]]] = [likely, alone, related]
    if not plain_alone:
        kinds += [_of_references(arrays, known), _of_others(arrays, known)]
    listed: list[Question] = []
    columns: list[Bools] = []
    numbers: list[int] = []
    seen: dict[bytes, int] = {}
    by: dict[int, tuple[int, ...]] = {}
    about: dict[tuple[Reference | None, bool], int] = {}
    for number, kind in enumerate(kinds):
        for question, answers in kind:
            if answers.all() or not answers.any():
                continue
            key = np.packbits(answers ^ answers[0]).tobytes()
            index = seen.setdefault(key, len(listed))
            if question.one and index == len(listed):
                by[index] = about[question.reference, False], about[question.reference, True]
            elif question.reference is not None and not question.further:
                about[question.reference, question.several] = index
            if index == len(listed):
                listed.append(question)
                columns.append(answers)
                numbers.append(_UNLIKELY if _is_between(arrays.domain, question.part) else number)
    answers = np.column_stack(columns) if columns else np.zeros((arrays.size, 0), dtype=bool)
    return Questions(tuple(listed), by, np.array(numbers, dtype=np.int64), answers)


def _likely(known: Named, outcomes: Sequence[Outcome]) -> Callable[[Literal | Equality | Quantified], bool]:
    """Whether a part of a context asks for a value that an outcome changes and none sets, or for something of
    an argument that no outcome and no reference of one names."""
    effects = [effect for outcome in outcomes for effect in outcome]
    said = {term for effect in effects for term in effect_terms(effect)}
    said |= {term for each in used(known, outcomes) for part in each.condition for term in terms_of(part)}
    unsaid = {term for term in _unreferenced(known)[0] if isinstance(term, Variable) and term not in said}
    sets: dict[tuple[str, tuple[Term, ...]], set[Value]] = {}
    for effect in effects:
        if isinstance(effect, Assign):
            sets.setdefault((effect.symbol, effect.terms), set()).add(effect.value)

    def is_likely(part: Literal | Equality | Quantified) -> bool:
        if not isinstance(part, Literal):
            return False
        changed = sets.get((part.symbol, part.terms))
        return (changed is not None and not part.values & changed) or not unsaid.isdisjoint(part.terms)

    return is_likely


def _is_between(domain: Domain, part: Literal | Equality | Quantified) -> bool:
    """Whether it asks if a number is one between its bounds."""
    if not isinstance(part, Literal) or len(part.values) != 1:
        return False
    (value,) = part.values
    bounds = [(each.values[0], each.values[-1]) for each in domain.symbols if each.name == part.symbol]
    return type(value) is int and value not in bounds[0]


def _is_of_one(part: Literal | Equality | Quantified) -> bool:
    return isinstance(part, Literal) and len(part.terms) < 2


def _unreferenced(known: Named) -> tuple[list[Term], dict[Term, Longs]]:
    """The terms that are no references, and their places."""
    named = {variable for each in known.references for variable in each.variables}
    terms = [term for term in known.columns if term not in named]
    return terms, {term: known.columns[term] for term in terms}


def _plain(arrays: Arrays, known: Named) -> Iterator[tuple[Question, Bools]]:
    terms, columns = _unreferenced(known)
    index = index_of(arrays, columns)
    listed: Iterable[Literal | Equality] = (
        *(each for each in literals(arrays.domain, terms) if is_provable(arrays.domain, each, inside=False)),
        *equalities(arrays.domain, terms),
    )
    for part in listed:
        yield Question(part), np.broadcast_to(holds(arrays, (part,), index), (arrays.size,))


def _of_references(arrays: Arrays, known: Named) -> Iterator[tuple[Question, Bools]]:
    """What is asked of what a reference names: that some such object exists, of which it holds; and whether
    there are several."""
    terms, columns = _unreferenced(known)
    taken = {term.name for term in known.columns if isinstance(term, Variable)}
    for reference in known.references:
        before = needed_by(known, reference)
        variables = tuple(variable for each in before for variable in each.variables)
        definition: Parts = tuple(part for each in before for part in each.condition)
        index, typed = ranging(arrays, index_of(arrays, columns), variables)
        fits = typed & holds(arrays, definition, index)
        several = fits.reshape(arrays.size, -1).sum(axis=1) > 1
        exact = not several.any()
        some_such = Quantified(True, variables, definition)
        yield Question(some_such, reference, never_several=exact), some(fits, len(variables))
        if len(before) == 1:
            yield Question(_several(reference, taken), reference, several=True), several
            exactly = some(fits, 1) & ~several
            yield Question(some_such, reference, one=True, never_several=exact), exactly
        (variable,) = reference.variables
        everything = (*terms, *variables)
        further: Iterable[Literal | Equality] = (
            *_inside(arrays.domain, everything, variable),
            *equalities(arrays.domain, everything, variable),
        )
        for part in further:
            if part not in definition:
                both = fits & holds(arrays, (part,), index)
                asked = replace(some_such, condition=(*definition, part))
                yield Question(asked, reference, (part,), never_several=exact), some(both, len(variables))


def _several(reference: Reference, taken: Collection[str]) -> Quantified:
    """That more than one object is as a reference says."""
    (one,) = reference.variables
    other = Variable(unnamed(taken), one.type)
    renamed = tuple(with_terms(part, {one: other}) for part in reference.condition)
    return Quantified(True, (one, other), (*reference.condition, *renamed, Equality(one, other, False)))


def _inside(domain: Domain, known: Sequence[Term], variable: Variable) -> Iterator[Literal]:
    """The literals about a variable of a quantifier that, like their opposites, `check` can prove to exclude
    these."""
    for literal in literals(domain, known, variable):
        if is_provable(domain, literal, inside=True) and is_provable(
            domain, negated(domain, literal), inside=True
        ):
            yield literal


MOST_PAIRED = 60
"""Literals about an object without a name of which pairs are asked for, the ones that hold of most objects;
chosen."""

_NAMES = "zyxwvutsrqponmlkjihgfedcba"
"""Of objects that nothing else names."""


def unnamed(taken: Collection[str]) -> str:
    """A name for an object that nothing else names."""
    return next(name for name in _NAMES if name not in taken)


def _of_others(arrays: Arrays, known: Named) -> Iterator[tuple[Question, Bools]]:
    """Whether some object exists of which one literal holds, or one that relates it to a term and another
    that may be denied."""
    terms, columns = _unreferenced(known)
    types = dict.fromkeys(p.type for symbol in symbols(arrays.domain) for p in symbol.parameters)
    taken = {term.name for term in known.columns if isinstance(term, Variable)}
    for type_name in types:
        variable = Variable(unnamed(taken), type_name)
        index, typed = ranging(arrays, index_of(arrays, columns), (variable,))
        fitting = []
        for literal in _inside(arrays.domain, (*terms, variable), variable):
            fits = np.broadcast_to(typed & holds(arrays, (literal,), index), typed.shape)
            if fits.any():
                fitting.append((literal, fits))
        fitting.sort(key=lambda each: -int(each[1].sum()))
        for parts, fits in _conjunctions(arrays, fitting):
            yield Question(Quantified(True, (variable,), parts)), some(fits, 1)


def _conjunctions(
    arrays: Arrays, fitting: Sequence[tuple[Literal, Bools]]
) -> Iterator[tuple[tuple[Literal, ...], Bools]]:
    """Each literal; and each that relates an object to a term with another one, or with its opposite."""
    for literal, fits in fitting:
        yield (literal,), fits
    for one, fits in fitting[:MOST_PAIRED]:
        if len(one.terms) < 2:
            continue
        for other, more in fitting[:MOST_PAIRED]:
            if other != one and len(other.terms) < 3:
                if len(other.terms) < 2 or str(other) > str(one):
                    yield (one, other), fits & more
                yield (one, negated(arrays.domain, other)), fits & ~more
