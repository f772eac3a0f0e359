"""Draws of PPDDL of which no state lets several count: they share one draw, and actions of which they would
make too many outcomes are converted."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.refused import Refused
from support.pddl_compared import converted, disagreements, task_of

LIGHTS = """\
(define (domain lights)
  (:types lamp colour)
  (:constants red green blue white black grey - colour)
  (:predicates (shows ?l - lamp ?c - colour) (lit ?l - lamp) (bright ?l - lamp) (warm ?l - lamp)
               (broken ?l - lamp))
  (:action touch
    :parameters (?l - lamp ?c - colour)
    :effect (and {draws})))
(define (problem one)
  (:domain lights)
  (:objects a - lamp)
  (:init (shows a red) (warm a))
  (:goal (broken a)))
"""


def told_apart(conditions: int) -> str:
    """A domain with a draw under each of some conditions that exclude each other; of the action's last
    parameter, or of what holds of its first."""
    colours = ("red", "green", "blue", "white", "black", "grey")
    asked = [f"(= ?c {colour}) {literal}" for literal in ("(lit ?l)", "(not (lit ?l))") for colour in colours]
    draws = (
        f"(when (and {each}) (probabilistic {place + 1}/20 (broken ?l) 1/4 (bright ?l)))"
        for place, each in enumerate(asked[:conditions])
    )
    return LIGHTS.format(draws="\n                 ".join(draws))


def test_draws_under_conditions_that_exclude_each_other_are_one() -> None:
    """Twelve draws of three results would be 531,441 outcomes; each result ends where one of these does."""
    text = told_apart(12)
    made = converted(text)
    task = task_of(made)
    assert max(len(rule.outcomes) for rule in task.rules) <= 25
    assert disagreements(text, made) == []


def by_colour(facts: str) -> str:
    """A domain with a draw of its own for each colour that a lamp may show."""
    colours = ("red", "green", "blue", "white", "black", "grey", "pink", "gold", "teal", "navy")
    draws = "\n".join(
        f"(when (shows ?l {colour}) (probabilistic {place + 1}/20 (broken ?l)))"
        for place, colour in enumerate(colours)
    )
    text = LIGHTS.format(draws=draws).replace("black grey", "black grey pink gold teal navy")
    return text.replace("(shows a red)", facts)


def test_draws_under_facts_of_which_one_holds_are_one() -> None:
    text = by_colour("(shows a teal)")
    made = converted(text)
    assert "chance decides once where the problem's facts leave at most one object" in made.notes
    assert disagreements(text, made) == []


def test_draws_under_facts_of_which_two_hold_stay_apart() -> None:
    with pytest.raises(Refused, match="`touch` has more than 512 outcomes"):
        converted(by_colour("(shows a teal) (shows a navy)"))


def test_draws_of_which_two_may_count_stay_apart() -> None:
    """Of four lamps each breaks by itself: all of them with a probability of 1/16."""
    lamps = [f"l{n}" for n in range(4)]
    draws = " ".join(f"(when (lit {lamp}) (probabilistic 0.5 (broken {lamp})))" for lamp in lamps)
    text = LIGHTS.format(draws=draws).replace("(:constants", f"(:constants {' '.join(lamps)} - lamp")
    text = text.replace("(warm a)", " ".join(f"(lit {lamp})" for lamp in lamps))
    made = converted(text)
    assert max(len(rule.outcomes) for rule in task_of(made).rules) == 2**4
    assert disagreements(text, made, 3) == []


ROADS = """\
(define (domain roads)
  (:types place car)
  (:predicates (at ?c - car ?p - place) (leads ?p ?q - place) (strays ?p ?q - place) (stopped ?c - car))
  (:action drive
    :parameters (?c - car ?p - place)
    :precondition (at ?c ?p)
    :effect (forall (?q - place)
      (when (leads ?p ?q)
        (forall (?wrong - place)
          (when (strays ?q ?wrong)
            (probabilistic 0.8 (and (not (at ?c ?p)) (at ?c ?q))
                           0.1 (and (not (at ?c ?p)) (at ?c ?wrong))
                           0.05 (stopped ?c))))))){more})
(define (problem round)
  (:domain roads)
  (:objects c - car {places} - place)
  (:init (at c p0) {facts})
  (:goal (stopped c)))
"""


def roads(*, facts: str = "", more: str = "") -> str:
    """Places in a ring, from each of which a road leads to the next, and from there astray to its next."""
    places = [f"p{n}" for n in range(12)]
    ring = " ".join(
        f"(leads {p} {q}) (strays {p} {q})" for p, q in zip(places, places[1:] + places[:1], strict=True)
    )
    return ROADS.format(places=" ".join(places), facts=f"{ring} {facts}", more=more)


def test_chance_for_each_object_of_which_facts_leave_one_is_one_draw() -> None:
    """Written out for the objects the draws would be 144."""
    text = roads()
    made = converted(text)
    assert "chance decides once where the problem's facts leave at most one object" in made.notes
    assert max(len(rule.outcomes) for rule in task_of(made).rules) == 4
    assert disagreements(text, made) == []


@pytest.mark.parametrize(
    "text",
    [
        roads(facts="(leads p3 p7)"),
        roads(facts="(probabilistic 0.5 (leads p3 p7))"),
        roads(more="(:action build :parameters (?p ?q - place) :effect (leads ?p ?q))"),
    ],
    ids=["two roads", "perhaps two", "roads are built"],
)
def test_chance_for_several_objects_is_drawn_for_each(text: str) -> None:
    with pytest.raises(Refused, match="`drive` has more than 512 outcomes"):
        converted(text)


TOLLS = """\
(define (domain tolls)
  (:types place)
  (:predicates (at ?p - place) (leads ?p ?q - place) (told))
  (:functions (total-cost))
  (:action ask
    :parameters (?p - place)
    :precondition (at ?p)
    :effect (and (told) (forall (?q - place)
      (when (leads ?p ?q) (probabilistic 0.5 (increase (total-cost) 3) 0.3 (not (at ?p))))))))
(define (problem way)
  (:domain tolls)
  (:objects p q - place)
  (:init (at p) (leads p q))
  (:goal (told))
  (:metric minimize (total-cost)))
"""


def test_what_is_paid_for_each_object_is_drawn_for_each() -> None:
    """What an outcome pays depends on no variable of a `forall`."""
    made = converted(TOLLS)
    assert "rules are written out for the objects where something is drawn or paid for each" in made.notes
    assert disagreements(TOLLS, made) == []
