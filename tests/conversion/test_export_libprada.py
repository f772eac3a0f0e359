"""Domains and problems written for libPRADA: what the files do, what they look like, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cleancli
from cleancli.cli.main import run
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Assign, Domain, Problem
from cleancli.planning.plan import BadOption
from support.export_texts import LAMPS, TOLL
from support.exported_libprada import disagreements, library_of, written
from support.shipped import shipped_domain, shipped_problem

PEER = Path(__file__).parents[2] / "benchmarks" / "libprada"

CASES = """
domain cases {
  types      { thing; box - thing; shelf - thing }
  constants  { top - shelf }
  predicates { on(?b - box, ?s - shelf)  wet(?t - thing)  near(?a ?b - thing) [symmetric]  alarm() }
  functions  { load(?b - box): 0..3  size(?t - thing): small < medium < big < huge }
  derived    { dry(?t - thing) := not wet(?t), size(?t) != huge  wets := count ?t - thing: wet(?t) }
  actions    { lift(?b - box, ?s - shelf) dry_off(?t - thing) }
  rule lift_it: lift(?b, ?s) {
    when not alarm(), load(?b) < 2, ?s != top
    with ?o - thing: near(?b, ?o), ?o != ?b
    then 0.5: on(?b, ?s), load(?b) += 1, if wet(?o) => wet(?b)
         0.25: not near(?b, ?o), size(?o) := big
         rest: noise
  }
  rule lift_to_top: lift(?b, ?s) {
    when not alarm(), ?s = top, size(?b) <= medium
    then 0.4: on(?b, top)
         rest: alarm(), load(?b) -= 2
  }
  rule dry_it: dry_off(?t) {
    when not dry(?t)
    then 1: not wet(?t)
  }
  default { 0.9: nothing  0.1: noise }
  reward  { decrease(wets) }
}
"""

SOME = """
problem some {
  domain  = cases
  objects { b1 b2 - box  low - shelf }
  init    { load(b1) = 0, load(b2) = 3, near(b1, b2), size(b1) = small, size(b2) = huge, size(low) = big,
            size(top) = big, wet(b2) }
  horizon = 3
}
"""


def test_each_case_does_there_what_it_does_here() -> None:
    domain = load_domain(Source("cases.nid", CASES))
    problem = load_problem(Source("some.nid", SOME), domain)
    assert list(disagreements(domain, problem, 150, np.random.default_rng(2))) == []


def test_the_shipped_domain_does_there_what_it_does_here() -> None:
    """What sweeps take along is written out for the three areas of the problem."""
    domain, made = shipped_domain("cleaning"), cleancli.convert("cleaning", "three_areas", to="libprada")
    problem = shipped_problem("three_areas", domain)
    assert made.texts["rules.dat"].startswith("#rules = 35\n")
    assert "traversal(A 10 13)\nOUTCOMES:\n  0.8 -dirt(A) -dirt(13)\n" in made.texts["rules.dat"]
    assert "what is said of all objects is written out for those of the problem" in made.notes
    assert list(disagreements(domain, problem, 150, np.random.default_rng(4))) == []


QUANTIFIED = """
domain shelves {
  types      { thing; box - thing; shelf - thing }
  constants  { top - shelf }
  predicates { on(?b - box, ?s - shelf)  under(?a ?b - shelf) [static]  wet(?t - thing)  full(?s - shelf) }
  derived    { free(?s - shelf) := not exists ?b - box: on(?b, ?s)  wets := count ?t - thing: wet(?t) }
  actions    { put(?b - box, ?s - shelf)  spill(?s - shelf)  wipe() }
  rule put_free: put(?b, ?s) {
    when free(?s), exists ?t - shelf: under(?t, ?s)
    then 0.75: on(?b, ?s), forall ?o - shelf: on(?b, ?o), ?o != ?s => not on(?b, ?o)
         rest: nothing
  }
  rule put_full: put(?b, ?s) { when not free(?s)  then 1: full(?s) }
  rule spill_it: spill(?s) {
    then 0.5: wet(?s), forall ?t - shelf: under(?t, ?s) => (wet(?t), not full(?t))
         0.5: wet(top)
  }
  rule wipe_all: wipe() { when forall ?b - box: not wet(?b)  then 1: forall ?s - shelf => not wet(?s) }
  reward { decrease(wets) }
}
"""

THREE = """
problem three {
  domain  = shelves
  objects { b1 b2 - box  low mid - shelf }
  init    { under(low, mid), under(mid, top), on(b1, low), wet(b2) }
  horizon = 3
}
"""


def test_quantifiers_and_effects_on_all_are_written_out_for_the_problem() -> None:
    domain = load_domain(Source("shelves.nid", QUANTIFIED))
    problem = load_problem(Source("three.nid", THREE), domain)
    assert list(disagreements(domain, problem, 200, np.random.default_rng(6))) == []
    rules = written(domain, problem).texts["rules.dat"]
    # What never changes in the problem leaves one case for each shelf, and not one for each set of shelves.
    assert rules.count("  spill(S)") == 3


def test_the_librarys_own_rules_come_back_as_they_were(tmp_path: Path) -> None:
    """Cleaning rules in its files become .nid files, its files and .nid files again, and say the same."""
    for name, given in (("rules", "rules"), ("symbols", "symbols"), ("state", "d4.state")):
        text = (PEER / f"{given}.dat").read_text(encoding="utf-8")
        (tmp_path / f"{name}.dat").write_text(text, encoding="utf-8")
    first = cleancli.convert(tmp_path)
    out = cleancli.convert(first.domain, first.problems["problem"], to="libprada")
    assert list(out.texts) == ["rules.dat", "symbols.dat", "state.dat"]
    assert out.write(tmp_path / "out")
    again = cleancli.convert(tmp_path / "out")
    one, other = (load_domain(Source("domain.nid", each.domain)) for each in (first, again))
    assert one.default == other.default
    assert [rule.condition for rule in one.rules] == [rule.condition for rule in other.rules]
    assert [rule.references for rule in one.rules] == [rule.references for rule in other.rules]
    for before, after in zip(one.rules, other.rules, strict=True):
        assert [each.probability for each in before.outcomes] == [each.probability for each in after.outcomes]
        # That an object has no size was a value, which is a predicate now.
        done = [
            {e for e in each.effects if isinstance(e, Assign) and e.symbol != "size_none"}
            for each in after.outcomes
        ]
        assert [set(each.effects) for each in before.outcomes] == done
    start, again_start = (
        load_problem(Source("problem.nid", each.problems["problem"]), domain).state
        for each, domain in ((first, one), (again, other))
    )
    assert start == {fact for fact in again_start if fact.symbol != "size_none"}


def test_an_object_of_which_nothing_holds_is_there_all_the_same() -> None:
    text = """
    domain d {
      types { box }
      predicates { wet(?x - box) }
      derived { wets := count ?x - box: wet(?x) }
      actions { dry(?x - box) }
      rule dry_it: dry(?x) { when wet(?x)  then 1: not wet(?x) }
      reward { decrease(wets) }
    }
    """
    problem = "problem p { domain = d objects { a b - box } init { wet(a) } horizon = 2 }"
    made = cleancli.convert(text, problem, to="libprada")
    assert made.texts["state.dat"] == "box(10) box(11)\nwet(10)\n"
    assert "box(X) wet(X)" in made.texts["rules.dat"]
    without = cleancli.convert(text, problem.replace("wet(a)", "wet(a), wet(b)"), to="libprada")
    assert without.texts["state.dat"] == "wet(10) wet(11)\n"


def test_rules_for_each_case_of_what_is_referred_to_are_told() -> None:
    """In each the one object must fit, and not the one object of all: near(b1, b2) and near(b1, low) here."""
    made = cleancli.convert(CASES, SOME, to="libprada")
    (told,) = [note for note in made.notes if "refer to" in note]
    assert told.endswith(": lift_it")
    plain = CASES.replace("if wet(?o) => wet(?b)", "wet(?b)")
    assert not any("refer to" in note for note in cleancli.convert(plain, SOME, to="libprada").notes)


AGAIN = """
domain again {
  types      { thing; box - thing }
  constants  { one - thing }
  predicates { wet(?t - thing)  near(?t - thing)  gone(?t - thing) }
  functions  { load(?t - thing): 0..2 }
  actions    { act() }
  rule act_it: act() {
    with ?o - thing: near(?o)
    with REFERENCE
    then 0.5: EFFECTS
         rest: gone(one)
  }
  reward     { goal }
}
"""


def _again(reference: str, effects: str) -> tuple[Domain, Problem]:
    text = AGAIN.replace("REFERENCE", reference).replace("EFFECTS", effects)
    domain = load_domain(Source("again.nid", text))
    some = "problem some { domain = again objects { b c - box } init { near(b), load(b) = 0, load(c) = 2, "
    some += "load(one) = 1 } goal { gone(b) } horizon = 3 }"
    return domain, load_problem(Source("some.nid", some), domain)


@pytest.mark.parametrize(
    ("reference", "effects"),
    [
        ("?s - thing: ?s = ?o", "not near(?s)"),
        ("?s - thing: ?o = ?s", "load(?s) := 1, if wet(?s) => gone(?s)"),
        ("?s - thing: ?s = ?o", "load(?o) += 1, load(?s) += 1, not near(?o)"),
        ("?s - thing: ?s = ?o", "forall ?t - thing: near(?t), ?t != ?s => gone(?t), wet(?s)"),
        ("?s - thing: ?s = one", "not near(?s), near(?o)"),
        ("?s ?t - thing: ?s = ?t, ?t = ?o", "not near(?s), gone(?t)"),
        ("?s - thing: ?s = ?o with ?t - thing: ?t = ?s", "not near(?t)"),
    ],
)
def test_effects_on_what_a_later_reference_asks_of_again(reference: str, effects: str) -> None:
    domain, problem = _again(reference, effects)
    assert not any("all references" in note for note in written(domain, problem).notes)
    assert list(disagreements(domain, problem, 60, np.random.default_rng(3))) == []


@pytest.mark.parametrize(
    ("reference", "context"),
    [
        ("?s - thing: ?s = ?o, not wet(?s)", "thing(O) near(O) -wet(O)"),
        ("?s - box: ?s = ?o", "thing(O) box(O) near(O)"),
    ],
)
def test_a_later_reference_that_asks_more_is_told(reference: str, context: str) -> None:
    """There one of several that are near is found where the others are wet, or no boxes."""
    domain, problem = _again(reference, "not near(?s)")
    made = written(domain, problem)
    (told,) = [note for note in made.notes if "refer to" in note]
    assert told.endswith(": act_it")
    assert f"CONTEXT:\n  {context}\n" in made.texts["rules.dat"]
    assert list(disagreements(domain, problem, 60, np.random.default_rng(3))) == []


LAMPS_RULES = """\
#rules = 4
ACTION:
  default()
CONTEXT:
  --
OUTCOMES:
  1 <no-change>

ACTION:
  press(L)
CONTEXT:
  -heat_2(L) -on(L) heat_0(L)
OUTCOMES:
  0.75 on(L) -heat_0(L) heat_1(L)
  0.25 <noise>

ACTION:
  press(L)
CONTEXT:
  -heat_2(L) -on(L) -heat_0(L) heat_1(L)
OUTCOMES:
  0.75 on(L) -heat_1(L) heat_2(L)
  0.25 <noise>

ACTION:
  press(L)
CONTEXT:
  heat_2(L)
OUTCOMES:
  1 -on(L) heat_0(L) -heat_2(L)
"""


def test_what_is_written_is_what_a_person_would_write() -> None:
    lamps = LAMPS.replace(", forall ?o - lamp: beside(?l, ?o) => not on(?o)", "")
    problem = "problem two { domain = lamps objects { l1 l2 - lamp } init { on(l1), beside(l1, l2) "
    problem += "heat(l1) = 0, heat(l2) = 2 } horizon = 3 }"
    made = cleancli.convert(lamps, problem, to="libprada")
    assert made.domain == LAMPS_RULES
    assert made.texts["symbols.dat"] == (
        "press 1 action binary\n"
        "heat_0 1 primitive binary\n"
        "heat_1 1 primitive binary\n"
        "heat_2 1 primitive binary\n"
        "on 1 primitive binary\n"
        "beside 2 primitive binary\n"
        "dark 0 count integers <-- Num L -on(L)\n"
    )
    assert made.problems["two"] == "beside(10 11) beside(11 10)\nheat_0(10)\nheat_2(11)\non(10)\n"
    assert made.names == {"l1": "10", "l2": "11"}


def test_what_the_library_cannot_say_is_told_at_once_with_its_place() -> None:
    text = """
    domain d {
      types { box }
      predicates { on(?x ?y - box)  in(?x ?y - box) }
      derived { ons := count ?x ?y - box: on(?x, ?y) }
      actions { lift(?x - box) drop(?x - box) }
      rule lift_it: lift(?x) { then 1: forall ?y - box: on(?y, ?x) => not on(?y, ?x) }
      rule drop_it: drop(?x) {
        when on(?x, ?x)
        with ?y - box: on(?x, ?y), ?y != ?x
        with ?z - box: in(?y, ?z)
        then 1: not on(?x, ?y), in(?x, ?z)
      }
      reward { ons }
    }
    """
    problem = "problem p { domain = d objects { a b c d e f g - box } horizon = 2 }"
    with pytest.raises(Refused) as refused:
        cleancli.convert(text, problem, to="libprada")
    assert [each.message.split(": ")[1] for each in refused.value.diagnostics] == [
        "the rule has more than 64 cases",
        "a rule has several references, each of which has to be the only one",
    ]
    assert "<text 1>:7:" in str(refused.value)
    assert "<text 1>:8:" in str(refused.value)
    with pytest.raises(BadOption, match="give one problem"):
        cleancli.convert(text, to="libprada")


def test_a_closure_that_changes_is_no_fact() -> None:
    """Of few objects it is written out; the facts of more would stay what they are at first."""
    text = """
    domain tow {
      types { block }
      predicates { on(?a ?b - block)  red(?a - block) }
      derived { above(?a ?b - block) := closure on  aboves := count ?a ?b - block: above(?a, ?b) }
      actions { drop(?a ?b - block)  paint(?a ?b - block) }
      rule drop_it: drop(?a, ?b) { when on(?a, ?b)  then 1: not on(?a, ?b) }
      rule paint_it: paint(?a, ?b) { when above(?a, ?b), not red(?a)  then 1: red(?a) }
      reward { decrease(aboves) + goal }
    }
    """
    many = " ".join(f"b{number}" for number in range(17))
    problem = f"problem p {{ domain = tow objects {{ {many} - block }} init {{ on(b1, b2) }}"
    problem += " goal { above(b1, b3) } horizon = 2 }"
    with pytest.raises(Refused, match="libPRADA cannot say this: the closure `above` of more than a few"):
        cleancli.convert(text, problem, to="libprada")
    without = text.replace("above(?a, ?b), not red", "not red")
    made = cleancli.convert(without, problem, to="libprada")
    assert list(made.texts) == ["rules.dat", "symbols.dat", "state.dat"]
    assert not any("above" in each for each in made.texts.values())
    assert "left out: counts that ask for more than literals: aboves" in made.notes
    assert any("the goal" in note for note in made.notes)


def test_a_closure_of_no_object_is_written_out() -> None:
    """docs/from-pddl.md: a closure is written out for few objects, and none are few."""
    text = """
    domain tow {
      types { block lamp }
      predicates { on(?a ?b - block)  lit(?l - lamp) }
      derived { above(?a ?b - block) := closure on }
      actions { drop(?a ?b - block)  light(?l - lamp) }
      rule drop_it: drop(?a, ?b) { when on(?a, ?b)  then 1: not on(?a, ?b) }
      rule light_it: light(?l) {
        when not lit(?l), not exists ?a ?b - block: above(?a, ?b)
        then 1: lit(?l)
      }
      reward { goal }
    }
    """
    problem = "problem p { domain = tow objects { l - lamp } goal { lit(l) } horizon = 2 }"
    for target in ("ppddl", "libprada"):
        made = cleancli.convert(text, problem, to=target)
        assert not any("above" in each for each in made.texts.values())
    with pytest.raises(Refused, match="`p` has no object of the type `block`") as refused:
        cleancli.convert(text, problem, to="rddl")
    assert "above" not in str(refused.value)


def test_a_closure_that_only_a_count_asks_for_is_declared() -> None:
    text = """
    domain roads {
      types { town }
      predicates { road(?a ?b - town) [static]  seen(?a - town) }
      derived { linked(?a ?b - town) := closure road
                links := count ?a ?b - town: linked(?a, ?b), not seen(?a) }
      actions { see(?a - town) }
      rule see_it: see(?a) { when not seen(?a)  then 1: seen(?a) }
      reward { decrease(links) }
    }
    """
    domain = load_domain(Source("roads.nid", text))
    problem = (
        "problem p { domain = roads objects { a b c - town } init { road(a, b), road(b, c) } horizon = 2 }"
    )
    made = written(domain, load_problem(Source("p.nid", problem), domain))
    (counted,) = [fact for fact in library_of(made).symbols if fact.name == "links"]
    assert [atom.symbol for atom in counted.condition] == ["linked", "seen"]


def test_a_rule_of_too_many_cases_is_refused() -> None:
    effects = ", ".join(f"if p{n}(?x) => q{n}(?x)" for n in range(7))
    symbols = " ".join(f"p{n}(?x - box) q{n}(?x - box)" for n in range(7))
    text = f"""
    domain d {{
      types {{ box }}
      predicates {{ {symbols} }}
      derived {{ ons := count ?x - box: q0(?x) }}
      actions {{ act(?x - box) }}
      rule act_it: act(?x) {{ then 1: {effects} }}
      reward {{ ons }}
    }}
    """
    problem = "problem p { domain = d objects { b - box } horizon = 2 }"
    with pytest.raises(Refused, match="the rule has more than 64 cases"):
        cleancli.convert(text, problem, to="libprada")


def test_the_command_writes_a_folder_that_it_reads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, text in (("cases.nid", CASES), ("some.nid", SOME)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    files = [str(tmp_path / "cases.nid"), str(tmp_path / "some.nid")]
    assert run(["convert", *files, "--to", "libprada", "--out", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out
    assert "types are predicates" in out
    assert "`b1` is called `11` there" in out
    back = ["convert", str(tmp_path / "out"), "--out", str(tmp_path / "back"), "--reward", "decrease(wets)"]
    assert run(back) == 0


def test_probabilities_that_are_no_decimals_sum_to_1() -> None:
    """Rounded one by one, two thirds and two sixths would sum to more."""
    text = """
domain d {
  predicates { p() q() r() }
  reward     { goal }
  actions    { a() }
  rule a: a() { when not p() then 2/3: p() 1/6: q() 1/6: r() }
}
"""
    domain = load_domain(Source("d.nid", text))
    text = "problem p { domain = d init { } goal { p() } horizon = 3 }"
    (rule,) = library_of(written(domain, load_problem(Source("p.nid", text), domain))).rules
    digits = [result.probability * 10**15 for result in rule.results]
    assert digits == [666_666_666_666_666, 166_666_666_666_667, 166_666_666_666_667]


def test_the_rules_whose_payments_are_left_out_are_named() -> None:
    problem = "problem twice { domain = toll goal { there() } horizon = 2 }"
    told = [note for note in cleancli.convert(TOLL, problem, to="libprada").notes if "outcomes pay" in note]
    assert told == ["left out: what outcomes pay, of the rules go_there"]
    free = TOLL.replace(", reward += 2", "").replace("0.25: cost += 1.5  ", "")
    assert not any("outcomes pay" in note for note in cleancli.convert(free, problem, to="libprada").notes)
