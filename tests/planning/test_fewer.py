"""Problems made smaller where the reward counts too much (§4.2.1)."""

from __future__ import annotations

import pytest

from cleancli.compiler.task import held
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Domain, Fact, Problem, without_objects
from cleancli.planning.reductions.subproblem import fewer
from support import from_text

SPOTS = """
domain spots {
  types      { spot }
  constants  { sink - spot }
  predicates { dirt(?a - spot)  near(?a ?b - spot) [symmetric] }
  derived    { dirty := count ?a - spot: dirt(?a) }
  actions    { wipe(?a - spot)  sweep(?a ?b - spot) }
  rule wiped: wipe(?a)      { when dirt(?a) then 0.8: not dirt(?a)  rest: nothing }
  rule swept: sweep(?a, ?b) {
    when dirt(?a), dirt(?b), near(?a, ?b)
    then 0.6: not dirt(?a), not dirt(?b)
         rest: nothing
  }
  reward     { decrease(dirty) }
}
"""
DIRTY = "dirt(a), dirt(b), dirt(c), dirt(d), dirt(sink), near(b, d), near(d, c), near(e, a)"


def spots(goal: str = "", text: str = SPOTS) -> tuple[Domain, Problem]:
    return from_text.checked(text, f"objects {{ a b c d e - spot }} init {{ {DIRTY} }} {goal} horizon = 5")


def names(problem: Problem) -> list[str]:
    return [o.name for o in problem.objects]


def test_a_problem_that_is_small_enough_stays_as_it_is() -> None:
    domain, problem = spots()
    assert fewer(domain, problem, 5).problem == problem
    assert fewer(domain, problem, 5).ignored == ()


@pytest.mark.parametrize(
    ("most", "ignored"), [(4, ("c",)), (3, ("b", "c")), (2, ("a", "b", "c")), (1, ("a", "b", "c", "d"))]
)
def test_what_shares_fewest_facts_is_ignored_first_and_of_equals_the_last(
    most: int, ignored: tuple[str, ...]
) -> None:
    domain, problem = spots()
    found = fewer(domain, problem, most)
    assert found.ignored == ignored
    assert names(found.problem) == [name for name in "abcde" if name not in ignored]
    assert found.problem.state == {f for f in problem.state if not set(f.objects) & set(ignored)}


def test_what_is_not_counted_and_what_the_goal_names_stay() -> None:
    domain, problem = spots("goal { forall ?x - spot: not near(?x, b), not dirt(c) }")
    assert fewer(domain, problem, 3).ignored == ("a", "d")
    clean = Problem(problem.name, problem.domain, problem.objects, frozenset({Fact("dirt", ("a",))}))
    assert fewer(domain, clean, 1).ignored == ()


def test_without_a_count_of_single_objects_nothing_is_ignored() -> None:
    paid = SPOTS.replace("decrease(dirty)", "dirty")
    pairs = SPOTS.replace("count ?a - spot: dirt(?a)", "count ?a ?b - spot: dirt(?a), dirt(?b)")
    for text in (paid, pairs):
        assert fewer(*spots(text=text), 1).ignored == ()


def test_without_objects_their_facts_go_too_and_nothing_else() -> None:
    _, problem = spots()
    left = without_objects(problem, {"b", "sink"})
    assert names(left) == ["a", "c", "d", "e"]
    assert {fact.objects for fact in left.state} == {("a",), ("c",), ("d",), ("c", "d"), ("a", "e")}
    assert without_objects(problem, ()) == problem


@pytest.mark.parametrize("turned", [False, True])
def test_what_is_to_grow_is_not_what_is_counted(turned: bool) -> None:
    """A `decrease` of negative weight wants more: horizon and what is left out go by the other count."""
    terms = ["2 * decrease(dry)", "- decrease(dirty)"]
    reward = " + ".join(reversed(terms) if turned else terms).replace("+ -", "-")
    text = """
    domain d {
      types { area }
      predicates { dirt(?a - area) wet(?a - area) }
      derived { dirty := count ?a - area: dirt(?a)  dry := count ?a - area: not wet(?a) }
      actions { soak(?a - area) }
      rule s: soak(?a) { then 1: wet(?a), dirt(?a) }
      reward { %s }
    }"""
    inside = "objects { a1 a2 a3 - area } init { dirt(a1), wet(a1) }"
    task = from_text.task(text % reward, inside)
    assert task.horizon == 3
    assert task.counted is not None
    assert held(task.counted, task.initial) == 2
    domain = from_text.domain(text % reward)
    assert fewer(domain, from_text.problem(domain, inside), 1).ignored == ("a3",)


def test_where_nothing_is_wanted_decreased_the_horizon_must_be_given() -> None:
    domain = from_text.domain(SPOTS.replace("{ decrease(dirty) }", "{ - decrease(dirty) }"))
    with pytest.raises(Refused, match="needs a horizon"):
        from_text.problem(domain, "objects { a - spot }")
