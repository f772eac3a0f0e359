"""Domains and problems written as RDDL: what pyRDDLGym makes of them, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

import cleancli
from cleancli.compiler.lifted_state import LiftedRules
from cleancli.conversion.export.rddl_formulas import WORDS
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.planning.plan import BadOption
from support import exported_ppddl
from support.export_texts import DRIVEN, EVERYTHING, FISHING, LAMPS, POND, SOME, TOLL, TOUR
from support.exported_rddl import Simulated, chance_of, expected
from support.shipped import shipped_domain, shipped_problem

CONSTANTS = """
domain shelves {
  types      { thing; box - thing; shelf - thing }
  constants  { top - shelf }
  predicates { on(?b - box, ?s - shelf)  wet(?t - thing) }
  derived    { high := count ?b - box: on(?b, top)  wets := count ?t - thing: wet(?t) }
  actions    { lift(?b - box) }
  rule lift_it: lift(?b) {
    when not on(?b, top)
    then 2/3: on(?b, top), forall ?s - shelf: ?s != top => not on(?b, ?s)
         1/3: wet(?b), if wet(top) => wet(top), forall ?o - thing: ?o != ?b => wet(?o)
  }
  reward { high - 0.25 * wets + 2 * goal }
}
"""

TWO = """
problem two {
  domain  = shelves
  objects { b1 b2 - box  low - shelf }
  init    { on(b1, low), on(b2, low) }
  goal    { on(b1, top) }
  horizon = 2 + high
}
"""


def test_pyrddlgym_draws_what_the_rules_say(tmp_path: Path) -> None:
    """`python benchmarks/languages.py --rddl 10000` draws more."""
    pytest.importorskip("pyRDDLGym")
    everything = load_domain(Source("everything.nid", EVERYTHING))
    some = load_problem(Source("some.nid", SOME), everything)
    shelves = load_domain(Source("shelves.nid", CONSTANTS))
    two = load_problem(Source("two.nid", TWO), shelves)
    cleaning = shipped_domain("cleaning")
    areas = shipped_problem("three_areas", cleaning)
    for domain, problem, action, names in (
        (everything, some, "push", ("b1", "b2")),
        (shelves, two, "lift", ("b1",)),
        (cleaning, areas, "moveToContainerFast", ("a2",)),
    ):
        simulated = Simulated(domain, problem, tmp_path, 3)
        likely = expected(domain, problem, action, names)
        found, paid = simulated.drawn(action, names, 80, seed=1)
        assert len(likely) > 1
        assert chance_of(found, likely) > 0.001, (action, found, likely)
        values = {(fact.symbol, fact.objects): fact.value for fact in problem.state}
        wanted = exported_ppddl.expected(LiftedRules(domain), problem, values, action, names)
        assert wanted is not None
        # Reaching the goal is paid for in RDDL, and left out of what is wanted.
        gained = sum(n for after, n in found.items() if ("on___b1__top", True) in after) / 80 * 2
        assert paid - gained == pytest.approx(float(wanted[1]), abs=0.5)


def test_an_episode_ends_after_the_horizon_of_the_first_state(tmp_path: Path) -> None:
    pytest.importorskip("pyRDDLGym")
    domain = shipped_domain("cleaning")
    simulated = Simulated(domain, shipped_problem("three_areas", domain), tmp_path, 4)
    simulated.reset(0)
    assert [simulated.step("join3", ("a1", "a1", "a1"))[2] for _ in range(4)] == [False, False, False, True]
    assert (
        "    horizon = 4;\n" in cleancli.convert("cleaning", "three_areas", to="rddl").problems["three_areas"]
    )
    assert "    horizon = 2;\n" in cleancli.convert(CONSTANTS, TWO, to="rddl").problems["two"]


def test_costs_by_objects_are_paid(tmp_path: Path) -> None:
    pytest.importorskip("pyRDDLGym")
    domain = load_domain(Source("driven.nid", DRIVEN))
    problem = load_problem(Source("tour.nid", TOUR + "horizon = 3 }"), domain)
    simulated = Simulated(domain, problem, tmp_path, 3)
    simulated.reset(0)
    # 1.5 + 1/3 * far(?p, ?q) + 2 * far(?q, home) + toll()
    assert simulated.step("drive", ("a", "home"))[1] == pytest.approx(-(1.5 + 2 / 3 + 0 + 2))
    simulated.reset(0)
    assert simulated.step("drive", ("a", "b"))[1] == pytest.approx(-(1.5 + 1 / 3 + 2 + 2))
    assert simulated.step("sleep", ())[1] == pytest.approx(-0.25)


def test_what_an_outcome_pays_is_paid_in_that_outcome(tmp_path: Path) -> None:
    pytest.importorskip("pyRDDLGym")
    domain = load_domain(Source("toll.nid", TOLL))
    problem = load_problem(Source("p.nid", "problem p { domain = toll horizon = 3 }"), domain)
    simulated = Simulated(domain, problem, tmp_path, 3)
    paid: dict[bool, set[float]] = {True: set(), False: set()}
    simulated.reset(0)
    for _ in range(60):
        simulated.reset(None)
        state, reward, _ = simulated.step("go", ())
        paid[bool(state["there"])].add(reward)
    assert paid == {True: {2.0 - 1.0}, False: {-3.0 - 1.0, -1.0}}


@pytest.mark.parametrize(
    ("action", "names"),
    [("cast", ("lake",)), ("sail", ("raft", "moor", "lake")), ("sail", ("punt", "lake", "sea"))],
)
def test_what_is_paid_by_functions_is_paid_with_what_happens(
    tmp_path: Path, action: str, names: tuple[str, ...]
) -> None:
    """Of objects of the action, of what is referred to and of constants, and with each outcome its own."""
    pytest.importorskip("pyRDDLGym")
    domain = load_domain(Source("fishing.nid", FISHING))
    problem = load_problem(Source("pond.nid", POND), domain)
    values = {(fact.symbol, fact.objects): fact.value for fact in problem.state}
    happen = exported_ppddl.happening(LiftedRules(domain), problem, values, action, names)
    assert happen is not None
    due = {
        (("torn", ()) in after, ("stocked", ("lake",)) in after, round(float(paid), 6))
        for _, after, paid in happen
    }
    simulated = Simulated(domain, problem, tmp_path, 3)
    simulated.reset(3)
    seen = set()
    for _ in range(60):
        simulated.reset(None)
        state, paid, _ = simulated.step(action, names)
        seen.add((bool(state["torn"]), bool(state["stocked___lake"]), round(paid, 6)))
    assert seen == due


def test_no_word_that_pyrddlgym_reserves_is_a_name() -> None:
    """`row` and `col` are among them."""
    parser = pytest.importorskip("pyRDDLGym.core.parser.parser")
    assert {word for word in parser.RDDLlex().reserved if word.isidentifier()} <= WORDS
    made = cleancli.convert(FISHING.replace("sail(", "row("), POND, to="rddl")
    assert "row_2(boat, pond_2, pond_2): {action-fluent" in made.texts["fishing.rddl"]


LAMPS_RDDL = """\
// Written by `cleancli convert` from a .nid file.
// noise makes `noise` true
domain lamps {

    types {
        lamp: object;
        cold_outcome: {@cold_1, @cold_2};
    };

    pvariables {
        on(lamp): {state-fluent, bool, default = false};
        beside(lamp, lamp): {non-fluent, bool, default = false};
        heat(lamp): {state-fluent, int, default = 0};
        noise: {state-fluent, bool, default = false};
        cold_applies(lamp): {interm-fluent, bool};
        cold_drawn: {interm-fluent, cold_outcome};
        hot_applies(lamp): {interm-fluent, bool};
        press(lamp): {action-fluent, bool, default = false};
    };

    cpfs {
        cold_applies(?l) = press(?l) ^ (~(heat(?l) == 2) ^ ~on(?l));
        cold_drawn = Discrete(cold_outcome, @cold_1: 0.75, @cold_2: 0.25);
        hot_applies(?l) = press(?l) ^ (heat(?l) == 2);
        on'(?l_2) =
            if ((exists_{?l: lamp} [cold_applies(?l) ^ (cold_drawn == @cold_1) ^ (?l == ?l_2)]))
            then true else
            if ((exists_{?l: lamp} [hot_applies(?l) ^ (?l == ?l_2)]) |
                (exists_{?l: lamp} [hot_applies(?l) ^ beside(?l, ?l_2)]))
            then false else
            on(?l_2);
"""


def test_what_is_written_is_what_a_person_would_write() -> None:
    lamps = LAMPS.replace("rule press_", "rule ")
    problem = (
        "problem two { domain = lamps objects { l1 l2 - lamp } init { on(l1), beside(l1, l2) heat(l1) = 0, "
    )
    made = cleancli.convert(
        lamps, problem + "heat(l2) = 2 } horizon = 3 discount = 1 }", to="rddl", noise="predicate"
    )
    assert made.domain.startswith(LAMPS_RDDL)
    assert "noise' = noise | (exists_{?l: lamp} [cold_applies(?l) ^ (cold_drawn == " in made.domain
    assert "forall_{?l: lamp} [press(?l) =>\n" in made.domain
    assert list(made.texts) == ["lamps.rddl", "two.rddl"]
    assert made.problems["two"] == (
        "// Written by `cleancli convert` from a .nid file.\n"
        "non-fluents two_facts {\n"
        "    domain = lamps;\n"
        "    objects {\n"
        "        lamp: {l1, l2};\n"
        "    };\n"
        "    non-fluents {\n"
        "        beside(l1, l2);\n"
        "        beside(l2, l1);\n"
        "    };\n"
        "}\n"
        "\n"
        "instance two {\n"
        "    domain = lamps;\n"
        "    non-fluents = two_facts;\n"
        "    init-state {\n"
        "        heat(l1) = 0;\n"
        "        heat(l2) = 2;\n"
        "        on(l1);\n"
        "    };\n"
        "    max-nondef-actions = 1;\n"
        "    horizon = 3;\n"
        "    discount = 1.0;\n"
        "}\n"
    )


def test_names_end_in_letters_and_have_single_underscores() -> None:
    text = """
    domain action {
      types      { bool }
      predicates { is__on_(?x - bool)  sum(?x - bool) }
      derived    { ons := count ?x - bool: is__on_(?x) }
      actions    { press_(?x - bool) }
      rule press_it: press_(?x) { when not sum(?x) then 1: is__on_(?x), sum(?x) }
      reward { ons }
    }
    """
    made = cleancli.convert(
        text, "problem p { domain = action objects { a__1 - bool } horizon = 2 }", to="rddl"
    )
    assert made.names == {
        "is__on_": "is_on", "sum": "sum_2", "press_": "press", "bool": "bool_2", "a__1": "a_1",
    }  # fmt: skip
    assert "bool_2: {a_1};" in made.problems["p"]


def test_what_rddl_cannot_say_is_told() -> None:
    problem = "problem p { domain = lamps objects { l1 - lamp } init { heat(l1) = 0 } goal { on(l1) } "
    with pytest.raises(Refused, match=r"E919.*`horizon = unlimited` of `p`"):
        cleancli.convert(LAMPS, problem + "horizon = unlimited }", to="rddl")
    with pytest.raises(Refused, match=r"(?s)E919.*`p` has no object of the type `lamp`.*add one, or"):
        cleancli.convert(LAMPS, "problem p { domain = lamps horizon = 1 }", to="rddl")
    with pytest.raises(BadOption, match="give one problem"):
        cleancli.convert(LAMPS, to="rddl")
    with pytest.raises(BadOption, match="RDDL is not converted"):
        cleancli.convert("lamps.rddl")
    many = " ".join(f"b{n}" for n in range(17))
    towers = """
    domain towers {
      types { block }
      predicates { on(?x ?y - block) }
      derived { above(?x ?y - block) := closure on  ons := count ?x ?y - block: above(?x, ?y) }
      actions { take(?x ?y - block) }
      rule take_it: take(?x, ?y) { when above(?x, ?y) then 1: not on(?x, ?y) }
      reward { ons }
    }
    """
    problem = (
        f"problem p {{ domain = towers objects {{ {many} - block }} goal {{ above(b1, b2) }} horizon = 1 }}"
    )
    with pytest.raises(Refused) as refused:
        cleancli.convert(towers, problem, to="rddl")
    assert [each.message.split(": ", 1)[1] for each in refused.value.diagnostics] == [
        "the closure `above` of more than a few objects",
        "the count `ons`: the closure `above` of more than a few objects",
    ]
