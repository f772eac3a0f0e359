"""The tree of contexts: what is asked, and how much its answers are doubted."""

from __future__ import annotations

import itertools
import math
from collections import Counter

import numpy as np
import pytest

from cleancli.array_types import Bools, Longs
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Assign, Literal, Reference, Variable
from cleancli.learning.drawn_states import drawn_states
from cleancli.learning.structure.arrays import UNDEFINED, compiled
from cleancli.learning.structure.contexts import EACH, Leaf, Question, Questions, Tree, asked_of, tree
from cleancli.learning.structure.outcomes import Possible, chosen
from cleancli.learning.structure.rules import described
from cleancli.learning.structure.terms import Named, named

NOISE = 0.01
TRUE = frozenset({True})


def grown(answers: Bools, happened: Longs) -> Tree:
    """The tree of transitions in which one of several outcomes happened, all of them told apart."""
    number = int(happened.max()) + 1
    outcomes = tuple(frozenset({Assign(f"p{each}", (), True)}) for each in range(number))
    likelihoods = np.column_stack([np.eye(number), np.full(number, NOISE)])
    listed = tuple(Question(Literal(f"q{each}", (), frozenset({True}))) for each in range(answers.shape[1]))
    kinds = np.ones(len(listed), dtype=np.int64)
    possible = Possible(outcomes, likelihoods, happened)
    return tree(possible, Questions(listed, {}, kinds, answers), np.arange(len(happened)))


def length(happened: Longs, outcomes: int) -> float:
    """Of a node by itself, where all outcomes of the action happen: by their frequencies."""
    counts = Counter(happened.tolist())
    return EACH * math.log(90) * outcomes - sum(n * math.log(n / len(happened)) for n in counts.values())


@pytest.mark.parametrize("rare", [2, 5, 12])
def test_a_leaf_is_doubted_by_how_much_its_question_saves(rare: int) -> None:
    """One question, of which 30 transitions say yes; the second outcome happens there, and now and then
    where the answer is no."""
    happened = np.array([1] * (30 - rare) + [0] * rare + [1] * rare + [0] * (60 - rare))
    answers = np.arange(90)[:, None] < 30
    found = grown(answers, happened)
    divided = math.log(4) + length(happened[:30], 2) + length(happened[30:], 2)
    doubt = 1 / (1 + math.exp(length(happened, 2) - divided))
    assert doubt < 0.5
    assert len(found.leaves) == 2
    for leaf in found.leaves:
        assert leaf.doubt == pytest.approx(doubt, rel=0.01)
        assert leaf.otherwise is not None
        assert leaf.otherwise[:2] == pytest.approx([1 - happened.mean(), happened.mean()], abs=1e-3)


def test_of_questions_that_tell_nothing_few_are_asked() -> None:
    """Of 40 actions whose outcomes have nothing to do with any of 20 questions."""
    rng = np.random.default_rng(2)
    leaves = [
        len(grown(rng.random((100, 20)) < 0.5, (rng.random(100) < 0.5).astype(np.int64)).leaves)
        for _ in range(40)
    ]
    assert sum(number > 1 for number in leaves) <= 10


def test_a_question_that_tells_rules_from_nothing_is_not_doubted() -> None:
    """Where the answer is no, nothing ever happened."""
    happened = np.array([1] * 8 + [0] * 12)
    answers = np.arange(20)[:, None] < 10
    number = Possible(
        (frozenset(), frozenset({Assign("p", (), True)})),
        np.column_stack([np.eye(2), np.full(2, NOISE)]),
        happened,
    )
    question = Question(Literal("q", (), frozenset({True})))
    kinds = np.zeros(1, dtype=np.int64)
    found = tree(number, Questions((question,), {}, kinds, answers), np.arange(20))
    assert [len(leaf.rows) for leaf in found.leaves] == [10, 10]
    assert all(leaf.doubt == 0 for leaf in found.leaves)


@pytest.mark.parametrize(("rare", "covered"), [(1, 20), (4, 5)])
def test_a_rare_outcome_of_a_reference_costs_no_rule_its_transitions(rare: int, covered: int) -> None:
    """The reference names something in 5 of 20 transitions. In some of these a second outcome happens, which
    is about what it names, in all others the first: either that outcome is worth that the rule covers no
    more than the 5, or it gives way, and what it did is noise."""
    variable = Variable("m", "thing")
    column = np.where(np.arange(20) < 5, 0, UNDEFINED)
    reference = Reference((variable,), (Literal("near", (variable,), frozenset({True})),))
    known = Named(20, {variable: column}, (reference,))
    first = frozenset({Assign("lit", (), True)})
    second = frozenset({Assign("hit", (variable,), True)})
    happened = np.where(np.arange(20) < rare, 1, 0)
    possible = Possible((first, second), np.column_stack([np.eye(2), np.full(2, NOISE)]), happened)
    rows = np.arange(20) if rare == 1 else np.arange(7)
    found, lost = described(possible, possible, known, Leaf((), rows))
    assert len(found.leaf.rows) == covered
    assert found.references == (() if covered == 20 else (reference,))
    assert lost > 0


def test_what_nothing_explains_is_noise_however_much_it_changed() -> None:
    """Of a change of hundreds of facts even the likelihood as noise is 0 in floats."""
    everything = Possible((), np.zeros((1, 1)), np.zeros(7, dtype=np.int64))
    kept, probabilities = chosen(everything, np.array([7.0]), np.zeros(0))
    assert (kept, probabilities.tolist()) == ([], [1.0])


def test_what_an_outcome_changes_is_a_likely_question_and_so_is_an_argument_that_nothing_names() -> None:
    """That a box is held, which the action ends, and whatever is asked about the second argument; what the
    action brings about is not."""
    text = """domain hold {
      types { box }
      predicates { held(?b - box)  down(?b - box)  red(?b - box) }
      actions { drop(?x ?y - box) }
      reward { goal }
    }"""
    domain = load_domain(Source("hold.nid", text))
    drawn = list(itertools.islice(drawn_states((domain,), np.random.default_rng(1)), 40))
    given = compiled(domain, drawn)["drop"]
    x, y = domain.actions[0].parameters
    outcome = frozenset({Assign("held", (x,), False), Assign("down", (x,), True)})
    questions = asked_of(given.arrays, named(given, (x, y)), [outcome], plain_alone=True)
    likely = {str(questions.listed[each].part) for each in np.flatnonzero(questions.kinds == 0)}
    expected = [Literal("held", (x,), TRUE), *(Literal(name, (y,), TRUE) for name in ("held", "down", "red"))]
    assert likely == set(map(str, expected))
