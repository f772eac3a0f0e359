"""Whole rules from experience alone: what must be found, and how the rules are written."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from cleancli.compiler.fluents import Fluent, Values, values_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import checked_domain, load_domain
from cleancli.language.model import (
    Assign,
    Domain,
    Equality,
    ForAll,
    Object,
    Outcome,
    OutcomeKind,
    Rule,
    Variable,
)
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.printer import print_domain, print_result, print_rule, symbols_of
from cleancli.learning.experience import Transition
from cleancli.learning.structure.arrays import compiled
from cleancli.learning.structure.induce import revised
from cleancli.learning.structure.rules import apart
from cleancli.learning.variation import variation
from support.hidden_rules import TEXTS, domain_of, starts
from support.random_domains import Generator
from support.walks import Start, flickering, walks

EXPECTED = {
    "locks": {
        "unlock": "when not jammed(?d), not open(?d) with ?k - key: held(?k), fits(?k, ?d)"
        " then P: open(?d) P: not held(?k), bent(?k) P: nothing",
        "grab": "when not exists ?z - key: held(?z), not bent(?k) then P: held(?k) P: nothing",
        "slam_jammed": "when jammed(?d) then P: not jammed(?d) P: nothing",
        "slam_not_jammed": "when not jammed(?d), open(?d) then P: not open(?d) P: not open(?d), jammed(?d)",
    },
    "lift": {
        "up": "when load() != 4 then P: floor() += 1 P: nothing",
        "down": "then P: floor() -= 1 P: floor() -= 2",
        "leap": "when load() = 0 then P: floor() := 6",
        "board": "when not inside(?p), load() != 4 then P: inside(?p), load() += 1 P: nothing",
        "leave": "when floor() >= 2, inside(?p) then P: not inside(?p), load() -= 1",
    },
    "weather": {
        "gust_raining": "when raining(?t) then"
        " P: forall ?u - umbrella: at(?u, ?t), spread(?u) => (not spread(?u), torn(?u))"
        " P: not raining(?t), forall ?m - town: beside(?t, ?m), ?m != ?t => raining(?m) P: nothing",
        "gust_not_raining": "when not raining(?t), not sheltered(?t) then P: raining(?t) P: nothing",
        "unfold": "when not torn(?u), exists ?z - town: (at(?u, ?z), raining(?z))"
        " then P: spread(?u) P: torn(?u)",
        "carry": "when not spread(?u) with ?m - town: at(?u, ?m), beside(?t, ?m), ?m != ?t"
        " then P: not at(?u, ?m), at(?u, ?t) P: nothing",
    },
}
"""What 2,000 transitions tell, which is what the hidden rules say: an action that would change nothing at a
bound or under an umbrella needs no literal, and `apart` sees to it that no fact gets two values."""


def drawn(name: str, seed: int, number: int) -> list[Transition]:
    rng = np.random.default_rng(seed)
    return list(itertools.islice(walks(domain_of(name), starts(name, rng), rng), number))


def learned(name: str, transitions: list[Transition]) -> Domain:
    bare = replace(domain_of(name), rules=(), default=())
    return revised(bare, compiled(bare, transitions), [action.name for action in bare.actions]).domain


@pytest.mark.parametrize("name", TEXTS)
def test_the_hidden_rules_are_found(name: str) -> None:
    found = learned(name, drawn(name, 3, 2000))
    symbols = symbols_of(found)
    texts = {rule.name: " ".join(print_rule(rule, symbols).split()) for rule in found.rules}
    bodies = {
        each: re.sub(r"\b[01][.\d]*:", "P:", text[text.index("{") + 2 : -2]) for each, text in texts.items()
    }
    assert bodies == EXPECTED[name]
    assert variation(domain_of(name), found, drawn(name, 4, 300)) < 0.03


@pytest.mark.parametrize(
    ("name", "share", "most"), [("locks", 0.01, 0.05), ("locks", 0.05, 0.1), ("weather", 0.05, 0.1)]
)
def test_facts_that_flicker_spoil_little(name: str, share: float, most: float) -> None:
    """Each fact after a transition is seen wrongly by such a chance, so that most transitions are wrong."""
    seen = flickering(domain_of(name), drawn(name, 3, 600), share, np.random.default_rng(1))
    found = learned(name, list(seen))
    assert variation(domain_of(name), found, drawn(name, 4, 200)) < most


@pytest.mark.parametrize("seed", range(12))
def test_rules_of_random_domains_are_well_formed_whatever_happened(seed: int) -> None:
    """Contradictions and all: a share of the literals after each transition is turned round."""
    rng = np.random.default_rng(seed)
    hidden = Generator(seed).domain()
    problems = [Generator(100 * seed + number).problem() for number in range(10)]
    states = [(problem.objects, values_of(problem.state)) for problem in problems]
    number = int(rng.choice([1, 3, 20, 150]))
    transitions = [
        flipped(each, rng, 0.1) if seed % 2 else each
        for each in itertools.islice(walks(hidden, states, rng), number)
    ]
    bare = replace(hidden, rules=(), counts=hidden.counts[:1], reward=hidden.reward[:1], parameters=())
    found = revised(bare, compiled(bare, transitions), [action.name for action in bare.actions]).domain
    checked = checked_domain(Source("found.nid", layout(print_domain(found))))
    assert not {each.code for each in checked.diagnostics} - {"W201", "W202", "W203"}
    assert checked.get().rules == found.rules


def flipped(transition: Transition, rng: np.random.Generator, share: float) -> Transition:
    """The transition after which some facts that held do not."""
    kept = {
        key: value for key, value in transition.after.items() if value is not True or rng.random() > share
    }
    return transition._replace(after=kept)


def test_an_action_without_arguments_changes_all_objects_that_satisfy_a_guard() -> None:
    text = """domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp)  broken(?l - lamp) }
  derived    { burning := count ?l - lamp: lit(?l) }
  actions    { switch() }
  rule on: switch() {
    then 0.8: forall ?l - lamp: not broken(?l) => lit(?l)
         0.2: nothing
  }
  reward     { decrease(burning) }
}
"""
    domain = load_domain(Source("lamps.nid", text))
    lamps = tuple(Object(f"l{number}", "lamp") for number in range(4))
    rng = np.random.default_rng(1)
    states: list[Start] = [
        (lamps, {(name, (o.name,)): True for name in ("lit", "broken") for o in lamps if rng.random() < 0.4})
        for _ in range(30)
    ]
    transitions = list(itertools.islice(walks(domain, states, rng, steps=1), 200))
    found = revised(domain, compiled(domain, transitions), ["switch"])
    assert found.kept == ("switch",)
    bare = replace(domain, rules=())
    (rule,) = revised(bare, compiled(bare, transitions), ["switch"]).added
    told = [print_result(each, symbols_of(domain)) for each in rule.outcomes]
    assert told == ["forall ?m - lamp: not broken(?m) => lit(?m)", "nothing"]


def test_references_and_guards_of_more_than_two_parts_are_found() -> None:
    """A route may lead back to where it begins, so that a reference and a guard each have to ask for another
    port beside what two literals ask for; and where a storm leaves its port, that port is not one of those
    that it goes to."""
    text = """domain storms {
  types      { port; ship }
  predicates {
    at(?s - ship, ?p - port)  storm(?p - port)  open(?p - port)
    route(?a ?b - port) [symmetric, static]
  }
  derived    { storms := count ?p - port: storm(?p) }
  actions    { sail(?s - ship, ?to - port)  watch(?p - port) }
  rule sail: sail(?s, ?to) {
    with ?f - port: at(?s, ?f), route(?f, ?to), ?f != ?to
    then 0.9: not at(?s, ?f), at(?s, ?to)
         0.1: nothing
  }
  rule watch: watch(?p) {
    when storm(?p)
    then 0.5: not storm(?p), forall ?q - port: route(?p, ?q), open(?q), ?q != ?p => storm(?q)
         0.5: nothing
  }
  reward     { decrease(storms) }
}
"""
    domain = load_domain(Source("storms.nid", text))
    rng = np.random.default_rng(1)
    ports = [f"p{number}" for number in range(4)]
    objects = (*(Object(name, "port") for name in ports), Object("s", "ship"))
    keys: list[Fluent] = [(name, (port,)) for name in ("storm", "open") for port in ports]
    keys += [("at", ("s", port)) for port in ports]
    keys += [("route", pair) for pair in itertools.combinations_with_replacement(ports, 2)]
    states: list[Start] = [(objects, {key: True for key in keys if rng.random() < 0.5}) for _ in range(100)]
    transitions = list(itertools.islice(walks(domain, states, rng, steps=5), 600))
    bare = replace(domain, rules=())
    found = revised(bare, compiled(bare, transitions), ["sail", "watch"]).domain
    (reference,) = next(rule for rule in found.rules if rule.action == "sail").references
    assert {type(part).__name__ for part in reference.condition} == {"Literal", "Equality"}
    assert len(reference.condition) == 3
    (watch,) = (rule for rule in found.rules if rule.action == "watch")
    guards = [each.condition for o in watch.outcomes for each in o.effects if isinstance(each, ForAll)]
    assert [len(each) for each in guards] == [3]
    assert variation(domain, found, transitions[:300]) < 0.03


def test_terms_are_of_the_types_that_symbols_want() -> None:
    """Dirt is of areas alone, and what is moved may be any thing."""
    text = """domain moving {
  types      { thing; area - thing; box - thing }
  predicates { here(?t - thing)  dirt(?a - area)  by(?t ?u - thing) }
  derived    { left := count ?a - area: dirt(?a) }
  actions    { move(?t - thing)  wipe(?a - area) }
  rule move: move(?t) {
    when here(?t)
    with ?u - thing: by(?t, ?u), ?u != ?t
    then 0.9: not here(?t), here(?u)
         0.1: nothing
  }
  rule wipe: wipe(?a) {
    when dirt(?a)
    then 1: not dirt(?a), forall ?u - thing: by(?a, ?u) => here(?u)
  }
  reward     { decrease(left) }
}
"""
    domain = load_domain(Source("moving.nid", text))
    rng = np.random.default_rng(1)
    things = tuple(Object(f"{name}{number}", name) for name in ("area", "box") for number in range(2))
    symbols = (("here", things), ("dirt", things[:2]))
    states: list[Start] = [
        (
            things,
            {(name, (thing.name,)): True for name, among in symbols for thing in among if rng.random() < 0.5}
            | {("by", (one.name, things[int(rng.integers(4))].name)): True for one in things},
        )
        for _ in range(40)
    ]
    transitions = list(itertools.islice(walks(domain, states, rng, steps=3), 300))
    seen = list(flickering(domain, transitions, 0.02, rng))
    bare = replace(domain, rules=())
    for experience in (transitions, seen):
        found = revised(bare, compiled(bare, experience), ["move", "wipe"]).domain
        assert checked_domain(Source("found.nid", print_domain(found))).get().rules == found.rules
        assert variation(domain, found, transitions) < 0.15


def test_symbols_of_many_parameters_and_constant_states_are_no_trouble() -> None:
    text = """domain wide {
  types      { thing }
  constants  { anchor - thing }
  predicates { flag()  many(?a ?b ?c ?d ?e - thing)  red(?a - thing) [static] }
  derived    { reds := count ?a - thing: red(?a) }
  actions    { act(?a - thing)  idle() }
  reward     { decrease(reds) }
}
"""
    domain = load_domain(Source("wide.nid", text))
    things = tuple(Object(f"t{number}", "thing") for number in range(3))
    before: Values = {("many", ("t0", "t1", "t2", "t0", "anchor")): True}
    still = [
        Transition(name, arguments, things, before, before)
        for name, arguments in [("act", ("t0",)), ("idle", ())]
    ]
    found = revised(domain, compiled(domain, 5 * still), ["act", "idle"])
    assert not found.added
    assert not found.default
    raised = [each._replace(after={**before, ("flag", ()): True}) for each in still[1:]]
    found = revised(domain, compiled(domain, 5 * still[:1] + 5 * raised), ["act", "idle"])
    assert [print_rule(rule, symbols_of(domain)) for rule in found.added] == [
        "  rule idle: idle() {\n    then 1: flag()\n  }\n"
    ]


@pytest.mark.parametrize("name", TEXTS)
@pytest.mark.parametrize("number", [1, 7, 40, 150])
def test_rules_from_little_are_a_domain_without_mistakes_and_in_layout(name: str, number: int) -> None:
    found = learned(name, drawn(name, 5, number))
    text = layout(print_domain(found))
    checked = checked_domain(Source("found.nid", text))
    assert not {each.code for each in checked.diagnostics} - {"W201", "W202", "W203"}
    assert layout(text) == text
    assert checked.get().rules == found.rules


def test_the_order_of_transitions_does_not_matter_but_for_rounding() -> None:
    transitions = drawn("locks", 3, 600)
    one, other = learned("locks", transitions), learned("locks", transitions[::-1])
    assert [rule.name for rule in one.rules] == [rule.name for rule in other.rules]
    assert variation(one, other, transitions[:100]) < 0.001


def test_rules_that_explain_as_well_stay() -> None:
    """Beside a rule that stays, what it lacks is added, and asks for the opposite of what it asks for."""
    hidden = domain_of("locks")
    transitions = drawn("locks", 3, 2000)
    wrong = replace(hidden, rules=tuple(r for r in hidden.rules if r.name != "slam_jammed"))
    found = revised(wrong, compiled(wrong, transitions), [action.name for action in wrong.actions])
    assert found.kept == ("unlock", "grab")
    assert found.dropped == ()
    assert found.domain.rules[:3] == wrong.rules
    assert [" ".join(print_rule(rule, symbols_of(hidden)).split()[:5]) for rule in found.added] == [
        "rule slam_jammed: slam(?d) { when"
    ]
    assert found.after["slam"].score > found.before["slam"].score


PRESSES = """domain presses {
  types      { lamp; plug }
  predicates { lit(?l - lamp)  hot(?l - lamp)  broken(?l - lamp)  in(?p - plug, ?l - lamp) [static] }
  derived    { burning := count ?l - lamp: lit(?l) }
  actions    { press(?l - lamp) }
  rule press_dark: press(?a) {
    when not lit(?a), not broken(?a)
    with ?z - plug: in(?z, ?a)
    then 0.8: lit(?a)
         0.2: nothing
  }
  rule press_cold: press(?a) {
    when lit(?a), not hot(?a)
    then 0.6: not lit(?a)
         0.4: hot(?a)
  }
  rule press_hot: press(?a) {
    when lit(?a), hot(?a)
    then 0.5: not lit(?a), broken(?a)
         0.5: not hot(?a)
  }
  reward     { decrease(burning) }
}
"""
WRONG = {
    "press_dark": ("when not lit(?a), not broken(?a)", "when not lit(?a)"),
    "press_cold": ("0.6: not lit(?a)", "0.6: not lit(?a), broken(?a)"),
    "press_hot": ("0.5: not hot(?a)", "0.5: nothing"),
}
"""Of each rule a change by which it is wrong: about when it covers, or about what happens."""


def presses(number: int) -> list[Transition]:
    domain, rng = load_domain(Source("presses.nid", PRESSES)), np.random.default_rng(2)
    lamps = tuple(Object(f"l{each}", "lamp") for each in range(3))
    plugs = tuple(Object(f"p{each}", "plug") for each in range(3))
    symbols = ("lit", "hot", "broken")
    states: list[Start] = [
        (
            (*lamps, *plugs),
            {(name, (lamp.name,)): True for name in symbols for lamp in lamps if rng.random() < 0.4}
            | {
                ("in", (p.name, lamp.name)): True
                for p, lamp in zip(plugs, lamps, strict=True)
                if rng.random() < 0.8
            },
        )
        for _ in range(60)
    ]
    return list(itertools.islice(walks(domain, states, rng, steps=2), number))


@pytest.mark.parametrize("name", WRONG)
def test_only_the_rule_that_is_wrong_gives_way(name: str) -> None:
    """The others stay with their places in the text, and the new ones exclude them."""
    hidden = load_domain(Source("presses.nid", PRESSES))
    wrong = load_domain(Source("presses.nid", PRESSES.replace(*WRONG[name])))
    transitions = presses(600)
    found = revised(wrong, compiled(wrong, transitions), ["press"])
    assert [rule.name for rule in found.dropped] == [name]
    assert [rule.name for rule in wrong.rules if rule in found.domain.rules] == [
        rule.name for rule in wrong.rules if rule.name != name
    ]
    assert len(found.added) == 1
    assert found.added[0].name not in {rule.name for rule in wrong.rules if rule.name != name}
    checked = checked_domain(Source("found.nid", print_domain(found.domain)))
    assert not {each.code for each in checked.diagnostics} - {"W201", "W202", "W203"}
    assert variation(hidden, found.domain, presses(900)[600:]) < 0.04
    again = revised(found.domain, compiled(wrong, transitions), ["press"])
    assert again.domain == found.domain


def test_where_every_rule_is_wrong_all_give_way() -> None:
    hidden = load_domain(Source("presses.nid", PRESSES))
    text = PRESSES
    for change in WRONG.values():
        text = text.replace(*change)
    wrong = load_domain(Source("presses.nid", text))
    found = revised(wrong, compiled(wrong, presses(600)), ["press"])
    assert found.dropped == wrong.rules
    held_out = presses(900)[600:]
    assert variation(hidden, found.domain, held_out) < variation(hidden, wrong, held_out) / 4


def test_an_action_without_transitions_and_one_that_is_not_asked_for_keep_their_rules() -> None:
    hidden = domain_of("locks")
    transitions = [each for each in drawn("locks", 3, 300) if each.action != "grab"]
    found = revised(hidden, compiled(hidden, transitions), ["grab", "slam"])
    assert set(found.after) == {"slam"}
    assert {r.name for r in hidden.rules if r.action != "slam"} <= {r.name for r in found.domain.rules}


def test_what_happened_once_is_no_reason_to_give_up_a_rule() -> None:
    """One result that no outcome says, among few: noise, as the rule says itself."""
    text = PRESSES.replace("0.4: hot(?a)", "0.35: hot(?a)\n         0.05: noise")
    domain = load_domain(Source("presses.nid", text))
    transitions = [each for each in presses(200) if ("lit", each.arguments) in each.before]
    odd = transitions[0]._replace(after={**transitions[0].before, ("broken", ("l0",)): True})
    found = revised(domain, compiled(domain, [odd, *transitions[1:20]]), ["press"])
    assert found.kept == ("press",)


def test_what_keeps_objects_apart_is_said_once() -> None:
    """The guard of the `forall` says it already, the other way round."""
    ports = Variable("p", "port"), Variable("q", "port")
    text = """domain ports {
  types      { port }
  predicates { storm(?p - port) }
  derived    { calm := count ?p - port: not storm(?p) }
  actions    { watch(?p - port) }
  reward     { decrease(calm) }
}
"""
    domain = load_domain(Source("ports.nid", text))
    for left, right in (ports, ports[::-1]):
        guard = (Equality(left, right, False),)
        spread = ForAll((ports[1],), guard, (Assign("storm", (ports[1],), True),))
        outcome = Outcome(Fraction(1), OutcomeKind.CHANGE, (Assign("storm", (ports[0],), False), spread))
        rule = Rule("watch", "watch", (ports[0],), (), (outcome,))
        assert apart(domain, rule) == rule
