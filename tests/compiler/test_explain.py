"""Why an action applies or does not: what covers it, each literal that fails, references that are unclear."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from cleancli.compiler.explain import FactChange, Failure, UnclearReference, explain
from cleancli.language.model import DerivedPredicate, Fact, Outcome, OutcomeKind, Quantified
from support.handmade import JOIN_DRAGS, A, B, M, drags_problem, true


def test_the_covering_rule_with_its_reference_bound() -> None:
    found = explain(JOIN_DRAGS, drags_problem("a", "b", "m"), "join2", ("a", "b"))
    assert found.covering is not None
    assert (found.covering.name, found.attempts, found.default) == ("join_drags", (), ())
    assert found.covering.binding == (("a", "a"), ("b", "b"), ("m", "m"))
    assert found.covering.outcomes[0].changes == (
        FactChange(Fact("dirt", ("a",), False), True),
        FactChange(Fact("dirt", ("m",), False), True),
        FactChange(Fact("size", ("b",), "big"), "small"),
    )


def test_a_reference_that_two_bindings_fit_is_shown_with_both() -> None:
    found = explain(JOIN_DRAGS, drags_problem("a", "b", "m", "n"), "join2", ("a", "b"))
    assert found.covering is None
    assert [o.kind.value for o in found.default] == ["nothing"]
    (attempt,) = found.attempts
    reference = JOIN_DRAGS.rules[0].references[0]
    assert attempt.failures == ()
    assert attempt.unclear == UnclearReference(reference, ((("m", "m"),), (("m", "n"),)))


def test_every_literal_that_fails_is_shown_with_its_value() -> None:
    found = explain(JOIN_DRAGS, drags_problem("a"), "join2", ("b", "m"))
    assert found.attempts[0].failures == (
        Failure(true("dirt", A), ("b",), False),
        Failure(true("dirt", B), ("m",), False),
        Failure(true("near", A, B), ("b", "m"), False),
    )
    assert found.attempts[0].unclear is None


def test_quantified_parts_show_their_witnesses_and_derived_ones_what_they_lack() -> None:
    blocked = Quantified(False, (M,), (true("traversal", A, B, M), true("dirt", M)))
    derived = DerivedPredicate("free", (A, B), (true("dirt", A), blocked))
    idle = Outcome(Fraction(1), OutcomeKind.NOTHING)
    rule = replace(JOIN_DRAGS.rules[0], condition=(true("free", A, B),), references=(), outcomes=(idle,))
    domain = replace(JOIN_DRAGS, rules=(rule,), derived=(derived,))
    (failure,) = explain(domain, drags_problem("m", "n"), "join2", ("a", "b")).attempts[0].failures
    assert (failure.part, failure.objects, failure.actual) == (true("free", A, B), ("a", "b"), False)
    assert failure.because == (
        Failure(true("dirt", A), ("a",), False),
        Failure(blocked, witnesses=((("m", "m"),), (("m", "n"),))),
    )
