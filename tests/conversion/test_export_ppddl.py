"""Domains and problems written as PPDDL: what the files do and pay, what they look like, what is refused."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import cleancli
from cleancli.cli.main import run
from cleancli.conversion.export.written import closure_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.find import find
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Domain, Fact, Problem
from cleancli.planning.plan import BadOption
from support.export_texts import DRIVEN, EVERYTHING, LAMPS, SOME, TOLL, TOUR
from support.exported_ppddl import calls, cost, disagreements, drawn_values, meaning_of, written
from support.random_domains import Generator

BENCHMARKS = Path(__file__).parents[2] / "benchmarks" / "domains"


def models(domain: str, problem: str) -> tuple[Domain, Problem]:
    model = load_domain(Source("everything.nid", domain))
    return model, load_problem(Source("some.nid", problem), model)


# ---- what the files do


def test_each_construct_does_and_pays_in_ppddl_what_it_does_here() -> None:
    domain, problem = models(EVERYTHING, SOME)
    assert list(disagreements(domain, problem, 150, np.random.default_rng(1))) == []


@pytest.mark.parametrize("seed", range(8))
def test_random_domains_do_and_pay_in_ppddl_what_they_do_here(seed: int) -> None:
    """`python benchmarks/languages.py` tries 500."""
    generator = Generator(seed)
    assert list(disagreements(generator.domain(), generator.problem(), 10, np.random.default_rng(seed))) == []


def test_the_shipped_domain_does_and_pays_what_it_does_here() -> None:
    domain = load_domain(read_source(find("cleaning", "domains")))
    problem = load_problem(read_source(find("three_areas", "problems")), domain)
    assert list(disagreements(domain, problem, 40, np.random.default_rng(3))) == []


def test_the_first_state_and_the_goal_are_those_of_the_problem() -> None:
    domain, problem = models(EVERYTHING, SOME)
    meaning = meaning_of(written(domain, problem))
    world = meaning.initial()
    assert {("near", "b1", "s1"), ("near", "s1", "b1"), ("size-big", "s2"), ("load-minus_1", "c1")} <= world
    assert {("below", "b1", "s1"), ("below", "b1", "s2"), ("below", "s1", "s2")} <= world
    assert ("below", "s2", "b1") not in world
    goal = meaning.problem.goal
    assert goal is not None
    assert not meaning.holds(goal, world, {})
    assert not meaning.holds(goal, (world - {("total-2",)}) | {("total-5",), ("wet", "b1")}, {})
    assert meaning.holds(goal, (world - {("total-2",), ("wet", "c1")}) | {("total-5",)}, {})


def test_random_states_are_not_all_one() -> None:
    domain, problem = models(EVERYTHING, SOME)
    rng = np.random.default_rng(0)
    assert len({frozenset(drawn_values(domain, problem, rng).items()) for _ in range(20)}) == 20


def test_a_closure_has_the_pairs_that_steps_lead_between() -> None:
    state = [Fact("p", pair) for pair in (("a", "b"), ("b", "c"), ("c", "b"))]
    assert closure_of(state, "p", False) == {
        ("a", "b"), ("a", "c"), ("b", "c"), ("b", "b"), ("c", "b"), ("c", "c"),
    }  # fmt: skip
    assert len(closure_of(state, "p", True)) == 9
    assert closure_of(state, "q", False) == frozenset()


@pytest.mark.parametrize("horizon", ["horizon = unlimited }", "horizon = 3 }"])
def test_costs_by_objects_are_numeric_functions_and_come_back(horizon: str) -> None:
    domain, problem = models(DRIVEN, TOUR + horizon)
    made = written(domain, problem)
    functions = "(far-cost ?p ?q - place) (far-cost_2 ?p ?q - place) (toll) (steep ?p - place))"
    assert functions in made.texts["driven.pddl"]
    assert "(= (far-cost a b) 1/3)" in made.texts["tour.pddl"]
    assert "(= (far-cost_2 a b) 2)" in made.texts["tour.pddl"]
    assert "(steep-1 b)" in made.texts["tour.pddl"], "a condition asks for it, too"
    assert "far-1" not in made.texts["tour.pddl"], "no condition does"
    back = cleancli.convert(*made.texts.values())
    returned = load_domain(Source("back.nid", back.domain))
    again = load_problem(Source("again.nid", back.problems["tour"]), returned)
    before = {(fact.symbol, fact.objects): fact.value for fact in problem.state}
    after = {(fact.symbol, fact.objects): fact.value for fact in again.state}
    every = list(calls(domain, problem))
    assert len(every) == 9 + 3 + 1
    for call in every:
        assert cost(returned, after, *call) == cost(domain, before, *call)


# ---- what they look like

LAMPS_PPDDL = """\
; Written by `cleancli convert` from a .nid file.
; an action that no rule covers does nothing in .nid, and cannot be taken in PPDDL
; noise makes `(noise)` true
(define (domain lamps)
  (:requirements :adl :probabilistic-effects :rewards)
  (:types lamp - object)
  (:predicates
    (on ?l - lamp)
    ; symmetric: it holds both ways round, or neither
    (beside ?a ?b - lamp)
    ; the function heat: 0..2; one of these holds at a time
    (heat-0 ?l - lamp)
    (heat-1 ?l - lamp)
    (heat-2 ?l - lamp)
    ; an outcome that is not modelled has happened
    (noise))
  (:functions (reward))
  ; rule press_cold of press
  (:action press--press_cold
    :parameters (?l - lamp)
    :precondition (and (not (heat-2 ?l)) (not (on ?l)))
    :effect (and
      (probabilistic
        0.75 (and
          (on ?l)
          (when (heat-0 ?l) (and (not (heat-0 ?l)) (heat-1 ?l)))
          (when (heat-1 ?l) (and (not (heat-1 ?l)) (heat-2 ?l)))
          (increase (reward) 1))
        0.25 (noise))
      (decrease (reward) 0.5)))
  ; rule press_hot of press
  (:action press--press_hot
    :parameters (?l - lamp)
    :precondition (heat-2 ?l)
    :effect (and
      (not (on ?l))
      (heat-0 ?l)
      (not (heat-2 ?l))
      (forall (?o - lamp) (when (beside ?l ?o) (not (on ?o))))
      (forall (?l_2 - lamp) (when (and (on ?l_2) (or (= ?l ?l_2) (beside ?l ?l_2))) (decrease (reward) 1)))
      (decrease (reward) 0.5))))
"""


def test_what_is_written_is_what_a_person_would_write() -> None:
    made = cleancli.convert(LAMPS, to="ppddl", noise="predicate")
    assert str(made) == made.domain == LAMPS_PPDDL
    assert made.texts == {"lamps.pddl": LAMPS_PPDDL}
    assert (made.problems, made.names, made.diagnostics) == ({}, {}, ())


def test_a_goal_without_a_horizon_is_reached_at_little_cost() -> None:
    text = "problem two { domain = lamps objects { l1 l2 - lamp } init { heat(l1) = 0, heat(l2) = 2 } "
    made = cleancli.convert(LAMPS, text + "goal { on(l1) } horizon = unlimited }", to="ppddl")
    assert "(increase (total-cost) 0.5)" in made.domain
    assert "reward" not in made.domain
    assert made.problems["two"] == (
        "; Written by `cleancli convert` from a .nid file.\n"
        "; As many actions as it takes.\n"
        "(define (problem two)\n"
        "  (:domain lamps)\n"
        "  (:objects l1 l2 - lamp)\n"
        "  (:init (heat-0 l1) (heat-2 l2) (= (total-cost) 0))\n"
        "  (:goal (on l1))\n"
        "  (:metric minimize (total-cost)))\n"
    )
    made = cleancli.convert(LAMPS, text + "goal { on(l1) } horizon = 3 discount = 0.5 }", to="ppddl")
    assert "; Horizon: 3. Discount: 0.5. PPDDL has neither.\n" in made.problems["two"]
    assert "  (:metric maximize (reward)))\n" in made.problems["two"]
    assert "horizons and discounts are comments: PPDDL has neither" in made.notes


def test_names_that_ppddl_has_a_use_for_are_others_there() -> None:
    text = """
    domain define {
      types      { object; thing; Thing }
      constants  { _a A a - thing }
      predicates { and(?x - thing)  P(?x ?X - thing)  p(?x - Thing)  total() }
      functions  { p_1(): 0..1 }
      derived    { ands := count ?x - thing: and(?x) }
      actions    { when_(?x - thing) }
      rule object: when_(?x) {
        when P(?x, A), p_1() = 0, not total()
        then 1: and(?x), total()
      }
      reward { ands }
    }
    """
    made = cleancli.convert(text, to="ppddl")
    assert "(:types object_2 - object thing - object Thing_2 - object)" in made.domain
    assert "(:constants n_a A a_2 - thing)" in made.domain
    assert re.search(r"\(P \?x \?X_\d - thing\)", made.domain)
    assert "(p_2 ?x - Thing_2)" in made.domain
    assert "(and (P ?x A) (p_1-0) (not (total)))" in made.domain
    assert "(define (domain define_2)" in made.domain
    assert made.names == {
        "object": "object_2", "Thing": "Thing_2", "_a": "n_a", "a": "a_2", "and": "and_2", "p": "p_2",
    }  # fmt: skip


def test_a_type_above_all_others_may_be_object() -> None:
    text = """
    domain d {
      types { object; box - object }
      predicates { on(?x - object)  open(?x - box) }
      derived { ons := count ?x - object: on(?x) }
      actions { put(?x - box) }
      rule put_it: put(?x) { when not on(?x) then 1: on(?x), open(?x) }
      reward { ons }
    }
    """
    made = cleancli.convert(text, to="ppddl")
    assert "(:types box - object)" in made.domain
    assert "(on ?x - object)" in made.domain
    assert made.names == {}


TOWERS = """
domain towers {
  types { block }
  predicates { on(?x ?y - block) }
  derived { above(?x ?y - block) := closure on  ons := count ?x ?y - block: on(?x, ?y) }
  actions { take(?x ?y - block) }
  rule take_it: take(?x, ?y) { when above(?x, ?y) then 1: not on(?x, ?y) }
  reward { ons }
}
"""


def test_closures_that_change_are_axioms_or_written_out_for_a_few_objects() -> None:
    made = cleancli.convert(TOWERS, to="ppddl")
    assert ":derived-predicates" in made.domain
    assert (
        "  (:derived (above ?x ?y - block)"
        " (or (on ?x ?y) (exists (?via - block) (and (on ?x ?via) (above ?via ?y)))))\n"
    ) in made.domain
    assert any("PDDL 2.2" in note for note in made.notes)
    few = cleancli.convert(
        TOWERS, "problem p { domain = towers objects { a b - block } horizon = 2 }", to="ppddl"
    )
    assert ":derived" not in few.domain
    assert "(or (on ?x ?y) (exists (?via - block) (and (on ?x ?via) (on ?via ?y))))" in few.domain
    many = " ".join(f"b{n}" for n in range(17))
    text = f"problem p {{ domain = towers objects {{ {many} - block }} horizon = 2 }}"
    assert ":derived" in cleancli.convert(TOWERS, text, to="ppddl").domain


# ---- what is refused


def test_all_that_cannot_be_said_is_told_at_once_with_its_place() -> None:
    text = """
    domain d {
      types { box }
      predicates { on(?x ?y - box) }
      functions { load(): 0..9  held(?b - box): 0..9 }
      derived { above(?x ?y - box) := closure on  tall := count ?x ?y - box: above(?x, ?y) }
      actions { gather() lift(?x ?y - box) spread(?a ?b ?c ?d ?e - box) }
      rule gather_all: gather() { then 1: forall ?m - box: on(?m, ?m) => load() += 1 }
      rule lift_it: lift(?x, ?y) { when on(?x, ?y) then 1: not on(?x, ?y) }
      rule spread_it: spread(?a, ?b, ?c, ?d, ?e) {
        then 1: held(?a) += 1, held(?b) += 1, held(?c) += 1, held(?d) += 1, held(?e) += 1
      }
      reward { tall }
    }
    """
    with pytest.raises(Refused) as refused:
        cleancli.convert(text, to="ppddl")
    assert [diagnostic.code for diagnostic in refused.value.diagnostics] == ["E919"] * 3
    shown = str(refused.value)
    assert "`load` is shifted by as much as there are objects that something holds of" in shown
    assert "what is paid follows the closure `above`, which the outcome changes" in shown
    assert "more than 4 shifts of `held` may be of one thing" in shown
    assert "<text 1>:8:" in shown
    assert "<text 1>:9:" in shown
    assert "<text 1>:10:" in shown


def test_formulas_that_grow_without_bounds_are_refused() -> None:
    """Each derived predicate asks twice for the one before it, so that 30 of them say 2^30 literals."""
    levels = "".join(
        f"d{n}(?x - box) := exists ?y - box: (d{n - 1}(?y), not d{n - 1}(?x))  " for n in range(1, 31)
    )
    text = f"""
    domain d {{
      types {{ box }}
      predicates {{ d0(?x - box) }}
      derived {{ {levels} ds := count ?x - box: d0(?x) }}
      actions {{ act(?x - box) }}
      rule act_it: act(?x) {{ when d30(?x) then 1: d0(?x) }}
      reward {{ ds }}
    }}
    """
    with pytest.raises(Refused, match="more than 20000 parts when derived predicates are written out"):
        cleancli.convert(text, to="ppddl")


def test_what_depends_on_whether_a_type_has_objects_is_refused() -> None:
    text = """
    domain d {
      types { box; lid }
      predicates { on(?x - box)  alarm() }
      derived { ons := count ?x - box: on(?x) }
      actions { put(?x - box) }
      rule put_it: put(?x) {
        when not on(?x), exists ?l - lid: alarm()
        then 1: on(?x)
      }
      reward { ons }
    }
    """
    goal = "problem p { domain = d goal { exists ?k - lid: alarm() } horizon = 2 }"
    with pytest.raises(Refused) as refused:
        cleancli.convert(text, goal, to="ppddl")
    assert "`?l` stands for any `lid`, and nothing is said of it" in str(refused.value)
    assert "the goal of `p`: `?k` stands for any `lid`, and nothing is said of it" in str(refused.value)


# ---- the command


def test_the_command_writes_files_that_commands_take(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    domain, problem = str(BENCHMARKS / "tireworld.nid"), "trip.nid"
    Path(problem).write_text(TRIP)
    assert run(["convert", domain, problem, "--to", "ppddl", "--out", "out", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["domain"], data["problems"]) == (
        str(Path("out", "tireworld.pddl")),
        [str(Path("out", "trip.pddl"))],
    )
    assert data["mistakes"] == 0
    assert run(["check", "out"]) == 0
    capsys.readouterr()
    assert run(["plan", "out/tireworld.pddl", "out/trip.pddl"]) == 0
    assert run(["convert", domain, problem, "--to", "ppddl", "--out", "out"]) == 1
    assert "E006" in capsys.readouterr().err
    # What was written as PPDDL can be written as PPDDL again.
    given = ["out/tireworld.pddl", "out/trip.pddl"]
    assert run(["convert", *given, "--to", "ppddl", "--out", "again"]) == 0


TRIP = """
problem trip {
  domain  = tireworld
  objects { a b c - place }
  init    { here(a), spare(b), road(a, b), road(b, c), road(a, c), rough(b) }
  goal    { here(c) }
  horizon = unlimited
}
"""


def test_what_makes_no_sense_is_told(tmp_path: Path) -> None:
    path = tmp_path / "lamps.nid"
    path.write_text(LAMPS)
    with pytest.raises(BadOption, match=r"these are .nid files: say what to write: ppddl"):
        cleancli.convert(path)
    with pytest.raises(BadOption, match="give one domain, and any number of its problems: none of these"):
        cleancli.convert("three_areas", to="ppddl")
    with pytest.raises(BadOption, match="2 of these are one"):
        cleancli.convert("cleaning", path, to="ppddl")
    with pytest.raises(BadOption, match=r"convert libPRADA's files to .nid files first"):
        cleancli.convert("kitchen", format="libprada", to="ppddl")
    with pytest.raises(BadOption, match=r"are for making .nid files"):
        cleancli.convert(path, to="ppddl", horizon=3)
    with pytest.raises(BadOption, match="`to`"):
        cleancli.convert(path, to="strips")
    with pytest.raises(BadOption, match="`noise`"):
        cleancli.convert(path, to="ppddl", noise="loud")
    with pytest.raises(BadOption, match="noise has a word of its own"):
        cleancli.convert("(define (domain d))", noise="predicate")
    with pytest.raises(Refused, match=r"E106.*a scene is no list of facts"):
        cleancli.convert("cleaning", "two_groups", to="ppddl")
    with pytest.raises(Refused, match="E001"):
        cleancli.convert("cleanin", to="ppddl")


def test_libprada_alone_has_no_costs_and_its_notes_say_so() -> None:
    assert "costs" in cleancli.convert(DRIVEN, TOUR + "horizon = 3 }", to="libprada").notes[0]


def test_what_an_outcome_pays_is_paid_in_that_outcome() -> None:
    horizon = "problem p { domain = toll goal { there() } horizon = 3 }"
    made = cleancli.convert(TOLL, horizon, to="ppddl")
    assert (
        "    :effect (and\n"
        "      (probabilistic 0.5 (and (there) (increase (reward) 2)) 0.25 (decrease (reward) 3))\n"
        "      (decrease (reward) 1))"
    ) in made.domain
    made = cleancli.convert(TOLL, horizon.replace("= 3", "= unlimited"), to="ppddl")
    assert (
        "    :effect (and (probabilistic 0.5 (there) 0.25 (increase (total-cost) 1.5))"
        " (increase (total-cost) 0.5))"
    ) in made.domain
