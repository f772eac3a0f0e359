"""What is printed reads back as the same model, for shipped files and for generated ones."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import kind_of, load_domain, load_problem, read_source
from cleancli.language.model import (
    Action,
    Assign,
    Condition,
    Count,
    Domain,
    Equality,
    Fact,
    ForAll,
    Horizon,
    Literal,
    Object,
    Outcome,
    OutcomeKind,
    Price,
    PricePart,
    Problem,
    RewardKind,
    RewardTerm,
    Rule,
    Symbol,
    Type,
    Variable,
)
from cleancli.language.printing.printer import print_domain, print_float, print_fraction, print_problem
from cleancli.resources import shipped
from cleancli.scene.check import load_scene
from cleancli.scene.format import print_scene
from support.shipped import shipped_domain

HERE = Path(__file__).parent
TYPES = (Type("thing"), Type("dish", "thing"), Type("cup", "dish"))
CONSTANTS = (Object("sink", "thing"), Object("mug", "cup"))
A, B = Variable("a", "dish"), Variable("b", "dish")
PREDICATES = (
    Symbol("clean", (Variable("x", "thing"),)),
    Symbol("beside", (Variable("x", "dish"), Variable("y", "dish")), symmetric=True),
    Symbol("open", ()),
)
FUNCTION = Symbol("heat", (Variable("x", "dish"),), ("cold", "warm", "hot", "burnt"))
FAR = Symbol("far", (Variable("x", "dish"), Variable("y", "dish")), tuple(range(10)), static=True)
REWARD = (RewardTerm(Fraction(1), RewardKind.DECREASE, "dirty"),)
VALUE_SETS = [{"cold"}, {"warm"}, {"cold", "warm"}, {"hot", "burnt"}, {"cold", "hot", "burnt"}]


def _effects() -> st.SearchStrategy[tuple[Assign | ForAll, ...]]:
    inner = Variable("m", "cup")
    hidden = ForAll(
        (inner,), (Literal("beside", (A, inner), frozenset({True})),), (Assign("heat", (inner,), "hot"),)
    )
    every = ForAll((inner,), (), (Assign("clean", (inner,), True), Assign("heat", (inner,), "warm")))
    single: st.SearchStrategy[Assign | ForAll] = st.sampled_from(
        [Assign("clean", (A,), False), Assign("heat", (A,), "hot"), Assign("open", (), True), hidden, every]
    )
    return st.lists(single, min_size=1, max_size=4, unique=True).map(tuple)


def _counts() -> st.SearchStrategy[Fraction]:
    """What a transition that several outcomes share leaves of whole numbers: four digits after the point."""
    return st.integers(0, 10**6).map(lambda count: Fraction(count, 10**4))


def _prices(least: int) -> st.SearchStrategy[Price]:
    """Prices whose number and weights are from `least` up, which is 0 or -1."""
    number = st.fractions(least, 5, max_denominator=12)
    terms = st.sampled_from([(A, B), (B, A), (A, CONSTANTS[1])])
    part = st.builds(lambda weight, terms: Price(parts=(PricePart(weight, "far", terms),)), number, terms)
    parts = st.lists(part, max_size=2)
    return st.builds(lambda parts, n: sum(parts, Price(n)), parts, number)


@st.composite
def _outcomes(draw: st.DrawFn) -> tuple[Outcome, ...]:
    results: list[tuple[OutcomeKind, tuple[Assign | ForAll, ...]]] = [(OutcomeKind.NOISE, ())]
    results += [(OutcomeKind.CHANGE, e) for e in draw(st.lists(_effects(), max_size=3, unique_by=frozenset))]
    weights = draw(st.lists(st.integers(0, 50), min_size=len(results), max_size=len(results)))
    total = sum(weights) + 1
    probabilities = [Fraction(w, total) for w in weights]
    probabilities[-1] += 1 - sum(probabilities)
    outcomes = []
    for number, (kind, effects) in enumerate(results):
        rest = number == len(results) - 1 and draw(st.booleans())
        prior = None if rest else draw(st.none() | st.fractions(0, 1, max_denominator=1000))
        seen = draw(st.none() | _counts())
        paid = (draw(_prices(-1)), draw(_prices(0))) if kind is OutcomeKind.CHANGE else ()
        noted = prior, seen, rest, None, False, None, None
        outcomes.append(Outcome(probabilities[number], kind, effects, *noted, *paid))
    return tuple(outcomes)


def _moves(duration: float | None) -> st.SearchStrategy[Action]:
    """An action, with what the learner noted of its duration if it has one."""
    if duration is None:
        return st.just(Action("move", (A, B)))
    prior, seen = st.none() | st.floats(1e-6, 1e6), st.none() | _counts()
    return st.builds(
        Action, st.just("move"), st.just((A, B)), st.just(duration), _prices(0), prior, seen, st.booleans()
    )


@st.composite
def _domains(draw: st.DrawFn) -> Domain:
    extra: list[Literal | Equality] = [
        Literal("clean", (B,), frozenset({draw(st.booleans())})),
        Literal("beside", (A, B), frozenset({draw(st.booleans())})),
        Equality(A, B, False),
        Equality(A, CONSTANTS[1], False),
        Literal("clean", (CONSTANTS[0],), frozenset({draw(st.booleans())})),
    ]
    common: Condition = tuple(draw(st.lists(st.sampled_from(extra), unique=True)))
    values = draw(st.sampled_from(VALUE_SETS))
    chosen = Literal("heat", (A,), frozenset(values))
    others = Literal("heat", (A,), frozenset(FUNCTION.values) - frozenset(values))
    rules = tuple(
        Rule(name, "move", (A, B), (*common, literal), draw(_outcomes()))
        for name, literal in (("one", chosen), ("two", others))
    )
    duration = draw(st.none() | st.floats(1e-6, 1e6))
    return Domain(
        "kitchen", TYPES, CONSTANTS, (*PREDICATES, FUNCTION, FAR),
        (Count("dirty", (A,), (Literal("clean", (A,), frozenset({False})),)),),
        (draw(_moves(duration)), Action("wait", ())),
        rules, (Outcome(Fraction(1), OutcomeKind.NOTHING),), REWARD,
    )  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(_domains())
def test_a_printed_domain_reads_as_itself(domain: Domain) -> None:
    assert load_domain(Source("printed", print_domain(domain))) == domain


@settings(max_examples=40, deadline=None)
@given(
    st.sets(st.sampled_from(["clean(sink)", "clean(mug)", "open()"])),
    st.sampled_from(FUNCTION.values),
    st.none() | st.builds(Horizon, st.integers(1, 99), st.sampled_from([None, "dirty"])),
    st.floats(0, 1),
)
def test_a_printed_problem_reads_as_itself(
    true: set[str], heat: str, horizon: Horizon | None, discount: float
) -> None:
    domain = Domain(
        "kitchen", TYPES, CONSTANTS, (*PREDICATES, FUNCTION),
        (Count("dirty", (A,), (Literal("clean", (A,), frozenset({False})),)),),
        (), (), (Outcome(Fraction(1), OutcomeKind.NOTHING),), REWARD,
    )  # fmt: skip
    facts = (
        {Fact(text.split("(")[0], tuple(text.split("(")[1].rstrip(")").split())) for text in true}
        | {Fact("heat", (name,), heat) for name in ("mug", "plate")}
        | {Fact("beside", ("mug", "plate"))}
    )
    problem = Problem("p", "kitchen", (Object("plate", "dish"),), frozenset(facts), horizon, discount)
    text = print_problem(problem)
    assert load_problem(Source("printed", text), domain) == problem


@pytest.mark.parametrize("path", sorted(shipped("domains").glob("*.nid")), ids=lambda path: path.stem)
def test_shipped_domains(path: Path) -> None:
    domain = load_domain(read_source(path))
    assert load_domain(Source("printed", print_domain(domain))) == domain


@pytest.mark.parametrize("path", sorted(shipped("problems").glob("*.nid")), ids=lambda path: path.stem)
def test_shipped_problems_and_scenes(path: Path) -> None:
    source = read_source(path)
    if kind_of(source) == "scene":
        scene = load_scene(source)
        assert load_scene(Source("printed", print_scene(scene))) == scene
    else:
        domain = shipped_domain("cleaning")
        problem = load_problem(source, domain)
        assert load_problem(Source("printed", print_problem(problem)), domain) == problem


def test_the_small_domain_in_canonical_layout() -> None:
    printed = print_domain(load_domain(read_source(HERE / "small.nid")))
    assert printed == (HERE / "small.printed.txt").read_text(encoding="utf-8")


@given(st.fractions(0, 1))
def test_fractions_are_exact(value: Fraction) -> None:
    assert Fraction(print_fraction(value)) == value


@given(st.floats(0, 1e12))
def test_floats_are_exact(value: float) -> None:
    text = print_float(value)
    assert float(Fraction(text)) == value
    assert "e" not in text
