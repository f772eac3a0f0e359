"""What would not fit is counted before it is built, and refused with its number and what to blame."""

from __future__ import annotations

import itertools
import time
import tracemalloc
from dataclasses import replace
from fractions import Fraction

import pytest

from cleancli.compiler import ground as ground_module
from cleancli.compiler import grounding_size
from cleancli.compiler.ground import ground
from cleancli.compiler.grounding_size import PART_BYTES, RULE_BYTES, count_groundings
from cleancli.language.diagnostics.diagnostic import Diagnostic, Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, load_domain, load_problem
from cleancli.language.model import (
    Action,
    Assign,
    Condition,
    Count,
    DerivedPredicate,
    Domain,
    Equality,
    Fact,
    ForAll,
    Horizon,
    Object,
    Outcome,
    OutcomeKind,
    Problem,
    Quantified,
    RewardKind,
    RewardTerm,
    Rule,
    Shift,
    Symbol,
    Type,
)
from support.handmade import A, B, M, false, noise, one_of, outcome, put, true

SPAN = Span("d.nid", 3, 7)


@pytest.fixture(autouse=True)
def a_gigabyte(monkeypatch: pytest.MonkeyPatch) -> None:
    """The limits of a machine with two gigabytes."""
    for module in (grounding_size, ground_module):
        monkeypatch.setattr(module, "RULE_LIMIT", 10**9 // RULE_BYTES)
    monkeypatch.setattr(grounding_size, "PART_LIMIT", 10**9 // PART_BYTES)


def domain(condition: Condition, *effects: Assign | Shift | ForAll) -> Domain:
    """One rule for three areas, which makes the first dirty; what else it does is up to the test."""
    outcomes = (Outcome(Fraction(1, 2), OutcomeKind.CHANGE, (put("dirt", A), *effects)), noise("0.5"))
    return Domain(
        name="d",
        types=(Type("area"),),
        constants=(),
        symbols=(
            Symbol("dirt", (A,)),
            Symbol("on", (A, B)),
            Symbol("near", (A, B), static=True),
            Symbol("load", (A,), tuple(range(20))),
        ),
        counts=(Count("dirty", (A,), (true("dirt", A),)),),
        actions=(Action("act", (A, B, M)),),
        rules=(Rule("rule_one", "act", (A, B, M), condition, outcomes, span=SPAN),),
        default=(outcome("1"),),
        reward=(RewardTerm(Fraction(1), RewardKind.DECREASE, "dirty"),),
    )


def problem(objects: int, *facts: Fact) -> Problem:
    names = [f"a{index:04d}" for index in range(objects)]
    loads = {Fact("load", (name,), 0) for name in names}
    things = tuple(Object(name, "area") for name in names)
    return Problem("p", "d", things, frozenset(loads | {*facts}), Horizon(2))


def refusal(domain: Domain, problem: Problem) -> Diagnostic:
    with pytest.raises(Refused) as error:
        ground(domain, problem)
    (diagnostic,) = error.value.diagnostics
    return diagnostic


def test_a_billion_groundings_are_counted_at_once_and_refused() -> None:
    started = time.process_time()
    found = refusal(domain((true("dirt", A),)), problem(1000))
    assert time.process_time() - started < 2
    assert (found.code, found.span) == ("E604", SPAN)
    assert found.message == (
        "rule `rule_one` has 1,000,000,000 groundings, about 10,240.0 GB;"
        " half of the memory is the most that may be taken"
    )
    assert found.label == "no fact restricts `?a`: 1,000 objects fit"


def test_differing_objects_are_counted_from_above() -> None:
    differ = (Equality(A, B, False), Equality(B, M, False), Equality(A, M, False))
    (found,) = count_groundings(domain(differ), problem(1000))
    assert (found.count, found.exact) == (10**9, False)
    (few,) = count_groundings(domain(differ), problem(20))
    assert (few.count, few.exact) == (20 * 19 * 18, True)
    (partly,) = count_groundings(domain(differ[:1]), problem(1000))
    assert (partly.count, partly.exact) == (10**9, False), "one of them may be any object"


def test_the_literal_that_leaves_most_is_blamed() -> None:
    names = [f"a{index:04d}" for index in range(150)]
    facts = {Fact("near", (one, other)) for one in names for other in names[:145]}
    rule = (true("near", A, B), true("near", B, M), one_of("load", A, 0))
    found = refusal(domain(rule), problem(150, *facts))
    assert found.label == "`near(?a, ?b)` holds in 21,750 ways"
    assert found.message.startswith("rule `rule_one` has up to 3,153,750 groundings, about 32.3 GB;")


def test_a_join_that_leaves_little_is_counted_exactly() -> None:
    facts = {Fact("near", (f"a{i:04d}", f"a{i + 1:04d}")) for i in range(499)}
    chain = domain((true("near", A, B), true("near", B, M)))
    (found,) = count_groundings(chain, problem(500, *facts))
    assert (found.name, found.count, found.exact) == ("rule_one", 498, True)


def test_the_count_is_what_is_built() -> None:
    facts = {Fact("near", ("a0000", "a0001")), Fact("near", ("a0001", "a0002"))}
    one = domain((true("near", A, B), Equality(A, M, False)))
    (found,) = count_groundings(one, problem(4, *facts))
    assert (found.count, found.exact) == (6, True)
    assert len(ground(one, problem(4, *facts)).rules) <= found.count


def test_long_effects_are_counted_too() -> None:
    every = ForAll((B, M), (), (put("on", B, M),))
    found = refusal(domain((Equality(B, M, True), Equality(A, B, True)), every), problem(200))
    assert found.code == "E604"
    assert "forall ?b ?m" in found.label


def test_too_many_cases_are_refused_with_the_part_to_blame() -> None:
    loads = tuple(Shift("load", (v,), 1) for v in (A, B, M))
    found = refusal(domain((false("dirt", A),), *loads), problem(3))
    assert (found.code, found.span) == ("E605", SPAN)
    assert found.message == (
        "for act(a0000, a0001, a0002), rule `rule_one` falls into more than 1,000 cases,"
        " most of them because of the effects on `load`"
    )


def test_a_quantifier_with_too_many_cases_is_named() -> None:
    exists = Quantified(False, (A, B), (true("on", A, B), true("on", B, A)))
    rule = domain((exists, Equality(A, B, True), Equality(B, M, True)), put("on", A, B))
    anywhere = Outcome(Fraction(1), OutcomeKind.CHANGE, (put("on", A, B), put("dirt", A)))
    rule = replace(rule, rules=(*rule.rules, Rule("fill", "fill", (A, B), (), (anywhere,))))
    found = refusal(rule, problem(7))
    assert found.code == "E605"
    assert "because of `not exists ?a ?b: on(?a, ?b), on(?b, ?a)`" in found.message


def test_a_closure_with_too_many_paths_is_refused() -> None:
    above = DerivedPredicate("above", (A, B), closure="on")
    rule = domain((true("above", A, B), Equality(A, M, True)), put("on", A, B))
    found = refusal(replace(rule, derived=(above,)), problem(12))
    assert (found.code, found.span) == ("E606", SPAN)
    assert found.message.startswith("there are too many ways in which `above(a0000, a000")


def test_a_closure_over_what_stays_is_decided_at_once() -> None:
    facts = {Fact("near", (f"a{i:04d}", f"a{i + 1:04d}")) for i in range(29)}
    joined = DerivedPredicate("joined", (A, B), closure="near")
    rule = domain((true("joined", A, B), Equality(B, M, True)))
    found = ground(replace(rule, derived=(joined,)), problem(30, *facts))
    assert len(found.actions) == 30 * 29 // 2
    assert {v.symbol for v in found.variables} == {"dirt"}


SEVEN = """\
domain refs {
  types      { thing }
  predicates { p(?a - thing)  q(?a ?b - thing) }
  derived    { n := count ?a - thing: p(?a) }
  actions    { act(?a - thing) }
  rule r: act(?a) {
    when p(?a) %s
    then 1: not p(?a), forall ?b - thing => not q(?a, ?b)
  }
  reward     { decrease(n) }
}
"""


@pytest.mark.parametrize(("references", "objects"), [(7, 60), (2, 60), (3, 200)])
def test_bindings_of_references_multiply_and_are_refused_before_they_are_built(
    references: int, objects: int
) -> None:
    names = [f"o{number}" for number in range(objects)]
    others = " ".join(
        f"with ?r{n} - thing: q({'?a' if n == 0 else f'?r{n - 1}'}, ?r{n})" for n in range(references)
    )
    text = (SEVEN % others).replace("not q(?a, ?b)", f"not q(?r{references - 1}, ?b)")
    found = load_domain(Source("refs.nid", text))
    facts = " ".join(f"p({name}) q({name}, {name})" for name in names)
    things = f"problem many {{ domain = refs objects {{ {' '.join(names)} - thing }} init {{ {facts} }} }}"
    given = load_problem(Source("many.nid", things), found)
    tracemalloc.start()
    started = time.process_time()
    diagnostic = refusal(found, given)
    seconds = time.process_time() - started
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert diagnostic.code == "E604"
    assert "q(" in diagnostic.label
    assert peak < 300_000_000
    assert seconds < 10, "a second without a tracer on a machine that does nothing else"


def test_references_that_facts_decide_are_counted_by_the_facts() -> None:
    """200 objects, of which each is beside two: no bound of 200 bindings each refuses it."""
    text = SEVEN.replace("q(?a ?b - thing)", "q(?a ?b - thing)  beside(?a ?b - thing) [static]")
    found = load_domain(
        Source("refs.nid", text % "with ?r - thing: beside(?a, ?r) with ?s - thing: beside(?r, ?s)")
    )
    names = [f"o{number}" for number in range(60)]
    pairs = [*itertools.pairwise(names), *zip(names[30:], names[32:], strict=False)]
    facts = " ".join([*(f"p({name})" for name in names), *(f"beside({one}, {two})" for one, two in pairs)])
    things = f"problem many {{ domain = refs objects {{ {' '.join(names)} - thing }} init {{ {facts} }} }}"
    assert ground(found, load_problem(Source("many.nid", things), found)).actions


def test_a_closure_over_2000_symmetric_facts_is_decided_at_once() -> None:
    text = """domain clos {
      types { thing } predicates { link(?a ?b - thing) [symmetric, static]  p(?a - thing) }
      derived { reach(?a ?b - thing) := closure link  n := count ?a - thing: p(?a) }
      actions { act(?a ?b - thing) }
      rule r: act(?a, ?b) { when p(?a), %s then 1: not p(?a) }
      reward { decrease(n) } }"""
    names = [f"o{number}" for number in range(2000)]
    facts = [f"link({one}, {two})" for one, two in itertools.pairwise(names)]
    facts += [f"p({name})" for name in names[::200]]
    stated = f"objects {{ {' '.join(names)} - thing }} init {{ {' '.join(facts)} }}"
    things = f"problem many {{ domain = clos {stated} }}"
    started = time.process_time()
    found = load_domain(Source("clos.nid", text % "reach(?a, ?b), ?b = ?a"))
    assert len(ground(found, load_problem(Source("p.nid", things), found)).actions) == 10
    every = load_domain(Source("clos.nid", text % "reach(?a, ?b)"))
    assert refusal(every, load_problem(Source("p.nid", things), every)).code == "E604"
    assert time.process_time() - started < 12, "under two seconds on a machine that does nothing else"


def test_20000_types_in_a_chain_are_read_at_once() -> None:
    chain = "; ".join(f"t{number} - t{number - 1}" for number in range(1, 20_000))
    text = f"""domain chain {{
      types {{ t0; {chain} }} predicates {{ p(?a - t0) }} derived {{ n := count ?a - t0: p(?a) }}
      actions {{ act(?a - t19999) }} rule r: act(?a) {{ when p(?a) then 1: not p(?a) }}
      reward {{ decrease(n) }} }}"""
    started = time.process_time()
    found = load_domain(Source("chain.nid", text))
    things = "problem p { domain = chain objects { a - t19999 b - t10000 } init { p(a) p(b) } }"
    assert len(ground(found, load_problem(Source("p.nid", things), found)).actions) == 1
    assert time.process_time() - started < 12, "under two seconds on a machine that does nothing else"


def test_types_in_circles_are_told_once_each() -> None:
    """Also where thousands of types lie below a circle that is declared after them."""
    tail = "; ".join(f"t{number} - t{number - 1}" for number in range(1, 3000))
    text = f"domain c {{ types {{ {tail}; t0 - u; u - v; v - u; w - w }} reward {{ decrease(n) }} }}"
    found = [d for d in checked_domain(Source("c.nid", text)).diagnostics if d.code == "E215"]
    assert [d.message for d in found] == ["the type `u` is below itself", "the type `w` is below itself"]
