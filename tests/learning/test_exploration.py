"""Where experience is wanted (docs/learning.md, Exploration): what a try is worth, and plans towards it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest

from cleancli.compiler.fluents import Values
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.load import load_domain
from cleancli.language.model import Domain, Fact, Object, Problem
from cleancli.learning.experience import Transition
from cleancli.learning.exploration.explored import UNCOVERED, Explored, ExploredAction, explored
from cleancli.learning.exploration.parts import signed
from cleancli.learning.exploration.seeking import hopes_of, next_try, optimistic
from cleancli.learning.exploration.worth import NEAR, OTHERWISE, UNCHANGED, UNTRIED, Try, least_worth, tries
from cleancli.learning.method import Method
from cleancli.planning.plan import Options
from cleancli.planning.registry import PLANNERS
from support.hidden_rules import domain_of, starts
from support.walks import walks

CORRIDOR = """\
domain corridor {
  types      { lamp }
  predicates { lit(?l - lamp) }
  functions  { room(): 0..5 }
  derived    { dark := count ?l - lamp: not lit(?l) }
  actions    { go() back() dig() light(?l - lamp) }
  reward     { decrease(dark) }
}
"""
LAMP = (Object("l1", "lamp"),)


def corridor() -> Domain:
    return load_domain(Source("corridor.nid", CORRIDOR))


def step(
    action: str, room: int, after: int, arguments: tuple[str, ...] = (), lit: bool = False
) -> Transition:
    return Transition(action, arguments, LAMP, {("room", ()): room}, {("room", ()): after})


def walked(times: int = 40) -> list[Transition]:
    """Going moves one room on, going back one back; digging in the first rooms does nothing, and no lamp can
    be lit anywhere."""
    on = [step("go", room % 6, min(room % 6 + 1, 5)) for room in range(times)]
    back = [step("back", room % 6, max(room % 6 - 1, 0)) for room in range(times)]
    dug = [step("dig", room % 3, room % 3) for room in range(times)]
    unlit = [step("light", room % 6, room % 6, ("l1",)) for room in range(times)]
    return on + back + dug + unlit


def at_room(number: int) -> Problem:
    return Problem("p", "corridor", LAMP, frozenset({Fact("room", (), number)}))


def asked(found: Explored, room: int, known: int = 12, seed: int = 1) -> Try | None:
    return next_try(found, at_room(room), known, PLANNERS["prada+"], Options(200, seed, threads=1))


def test_an_action_without_experience_is_tried_at_once() -> None:
    found = asked(explored(corridor(), walked()[:80]), 2)
    assert found is not None
    assert (found.action in ("dig", "light"), found.worth) == (True, UNTRIED)


def test_a_plan_leads_to_where_something_is_not_known() -> None:
    """Digging was never seen in the last rooms: from the first one the way there is known, and is taken."""
    found = explored(corridor(), walked())
    assert [asked(found, room).action for room in range(3)] == ["go", "go", "go"]  # type: ignore[union-attr]
    there = asked(found, 3)
    assert there is not None
    assert there.action == "dig"


def test_nothing_is_sought_where_all_is_known() -> None:
    """Each action was seen twenty times in each room: that is enough for twelve examples, and not for more
    than there are."""
    everywhere = [step("dig", room % 6, room % 6) for room in range(120)]
    lamps = [step("light", room % 6, room % 6, ("l1",)) for room in range(120)]
    found = explored(corridor(), [*walked(120)[:240], *everywhere, *lamps])
    assert asked(found, 0) is None
    assert asked(found, 0, known=400) is not None


@pytest.mark.parametrize("seed", range(4))
def test_a_plan_that_comes_to_little_is_no_better_than_a_try_here(seed: int) -> None:
    """Of forty times, going has led out of the first room once. What may be found out here, where the lamp is
    lit for the first time, is better than tens of steps in vain; where nothing is, these are."""
    lit: Values = {("lit", ("l1",)): True}

    def alight(given: Sequence[Transition]) -> list[Transition]:
        return [
            Transition(t.action, t.arguments, t.objects, {**t.before, **lit}, {**t.after, **lit})
            for t in given
        ]

    went = [step("go", 0, int(number == 0)) for number in range(40)]
    rest = [step("dig", 0, 0), step("back", 0, 0), step("light", 0, 0, ("l1",))] * 20
    problem = Problem("p", "corridor", LAMP, at_room(0).state | {Fact("lit", ("l1",))})
    options = Options(200, seed, threads=1)
    seen = [*went, *alight(went), *rest]
    here = next_try(explored(corridor(), seen), problem, 12, PLANNERS["prada+"], options)
    away = next_try(explored(corridor(), [*seen, *alight(rest)]), problem, 12, PLANNERS["prada+"], options)
    assert here is not None
    assert here.action in ("dig", "back", "light")
    assert away is not None
    assert away.action == "go"


def test_what_is_excluded_is_not_tried() -> None:
    found = explored(corridor(), walked()[:80])
    options = Options(200, 1, threads=1)
    chosen = next_try(found, at_room(0), 12, PLANNERS["prada+"], options, {("dig", ())})
    assert chosen is not None
    assert chosen.action == "light"


def test_the_same_seed_draws_the_same_try() -> None:
    found = explored(corridor(), [])
    drawn = {seed: [asked(found, 0, seed=seed) for _ in range(2)] for seed in range(8)}
    assert all(one == other for one, other in drawn.values())
    assert len({each[0].action for each in drawn.values() if each[0] is not None}) > 1


@pytest.mark.parametrize("name", ["locks", "lift"])
def test_what_was_explored_depends_on_the_transitions_alone(name: str) -> None:
    """One after the other they show the same as all at once."""
    domain, given = drawn(name, 3, 60)
    slowly = explored(domain, [])
    for number in range(0, 60, 7):
        slowly = explored(domain, given[: number + 7], slowly)
    at_once = explored(domain, given)
    assert slowly.domain == at_once.domain
    for action, known in at_once.actions.items():
        other = slowly.actions[action]
        assert (known.transitions, known.parts, known.learned) == (
            other.transitions,
            other.parts,
            other.learned,
        )
        assert (known.held == other.held).all()
        assert (known.by == other.by).all()


def test_rules_of_a_domain_count_until_there_is_experience() -> None:
    domain = domain_of("locks")
    assert explored(domain, []).domain.rules == domain.rules


LAMPS = """\
domain lamps {
  types      { lamp }
  predicates { lit(?l - lamp) }
  parameters { often = 0.9 }
  derived    { dark := count ?l - lamp: not lit(?l) }
  actions    { light(?l - lamp)  snuff(?l - lamp)  swap(?l - lamp) }
  rule light: light(?l) { when not lit(?l) then 0.9%s: lit(?l) rest%s: nothing }
  rule snuff: snuff(?l) { when lit(?l) then often: not lit(?l) rest: nothing }
  rule swap:  swap(?l)  { when lit(?l) then often: not lit(?l) rest: nothing }
  reward     { decrease(dark) }
}
"""


def lamps(light: str = "", rest: str = "") -> Domain:
    return load_domain(Source("lamps.nid", LAMPS % (light, rest)))


def switched(action: str, before: bool, after: bool, times: int) -> list[Transition]:
    lit: list[Values] = [{("lit", ("l1",)): holds} for holds in (before, after)]
    return [Transition(action, ("l1",), LAMP, lit[0], lit[1])] * times


def likely(found: Explored) -> dict[str, float]:
    """How likely the first outcome of each rule is."""
    return {rule.name: float(rule.outcomes[0].probability) for rule in found.domain.rules}


def test_rules_that_stay_have_the_probabilities_that_experience_tells() -> None:
    """By eq. 5, from those of the text: 40 of 100 are taken to be 0.4 and a little more. The rule stays, and
    so does that of an action that was not carried out."""
    given = switched("light", False, True, 40) + switched("light", False, False, 60)
    found = explored(lamps(), given)
    learned = found.actions["light"].learned
    weight = 10 / math.sqrt(learned)
    by_equation = (40 + weight * 0.9) / (learned + weight)
    assert learned > 90
    assert likely(found) == {"light": pytest.approx(by_equation, abs=1e-4), "snuff": 0.9, "swap": 0.9}
    (rule,) = found.actions["light"].rules
    assert rule in found.domain.rules
    assert rule.condition == lamps().rules[0].condition


def test_what_the_text_has_counted_counts_on_and_what_is_fixed_stays() -> None:
    given = switched("light", False, True, 40) + switched("light", False, False, 60)
    counted = explored(lamps(" [prior 0.9, seen 900]", " [seen 100]"), given)
    learned = counted.actions["light"].learned
    weight = 10 / math.sqrt(1000 + learned)
    by_equation = (940 + weight * 0.9) / (1000 + learned + weight)
    assert likely(counted)["light"] == pytest.approx(by_equation, abs=1e-4)
    assert likely(explored(lamps(" [fixed]"), given))["light"] == 0.9


def test_a_shared_parameter_pools_the_examples_of_all_actions() -> None:
    """One action was carried out; the rule of the other says of it what was learned, too."""
    found = explored(lamps(), switched("snuff", True, False, 30) + switched("snuff", True, True, 30))
    told = likely(found)
    assert told["snuff"] == told["swap"]
    assert told["snuff"] < 0.6


def test_another_estimator_is_used_where_it_is_asked_for() -> None:
    given = switched("light", False, True, 40) + switched("light", False, False, 60)
    found = explored(lamps(), given, None, Method("likelihood"))
    learned = found.actions["light"].learned
    assert likely(found)["light"] == pytest.approx(40 / learned, abs=1e-4)


def test_probabilities_of_rules_that_stay_depend_on_the_transitions_alone() -> None:
    given = [
        *switched("light", False, True, 9),
        *switched("snuff", True, True, 7),
        *switched("light", False, False, 17),
        *switched("swap", True, False, 11),
    ]
    slowly = explored(lamps(), [])
    for number in range(len(given)):
        slowly = explored(lamps(), given[: number + 1], slowly)
    assert slowly.domain == explored(lamps(), given).domain


def drawn(name: str, seed: int, number: int) -> tuple[Domain, list[Transition]]:
    """Transitions of a domain whose rules are known, and the domain."""
    domain, rng = domain_of(name), np.random.default_rng(seed)
    return domain, list(itertools.islice(walks(domain, starts(name, rng), rng), number))


def _slow_worth(known: ExploredAction, here: Sequence[bool]) -> float:
    """What a try is worth by its context, from the definition, transition by transition."""
    columns, worth = range(len(here)), 0.0
    if all(each.rule == UNCOVERED for each in known.specific):
        pairs = [(a, b) for a in columns for b in columns if here[a] and here[b]]
        worth = UNCHANGED / (min(sum(row[a] and row[b] for row in known.held) for a, b in pairs) + 1) ** 2
    for each in known.specific:
        wanted = [column for column in columns if each.holds[column]]
        has = [column for column in wanted if here[column]]
        missing = len(wanted) - len(has)
        if missing:
            alike = [
                row for row in known.held if all(row[c] for c in has) and not all(row[c] for c in wanted)
            ]
            own = [
                t for t, row in zip(known.transitions, known.held, strict=True) if all(row[c] for c in wanted)
            ]
            still = sum(not t.changed for t in own)
            # Rule of succession, again after each try in vain: the chance that none of them changes anything.
            chance = math.prod((still + 1 + tried) / (len(own) + 2 + tried) for tried in range(len(alike)))
            value = NEAR * chance + OTHERWISE / (len(alike) + 1) ** 2
            worth = max(worth, value * 0.7 ** (missing - 1))
        else:
            number = sum(all(row[c] for c in wanted) for row in known.held)
            likely = [float(o.probability) for o in known.rules[each.rule].outcomes]
            spread = 1.0 if each.rule == UNCOVERED else sum(math.sqrt(p * (1 - p)) for p in likely)
            worth = max(worth, (spread + 1 / math.sqrt(number + 2)) / (number + 1) ** 1.5)
    return worth


@pytest.mark.parametrize("name", ["locks", "lift"])
def test_worth_is_by_counts_in_contexts_of_rules(name: str) -> None:
    """In a state in which nothing was done in vain yet, a try is worth what its context makes it by the
    definition, or more by the rule that covers it."""
    domain, given = drawn(name, 5, 80)
    found, compared = explored(domain, given), 0
    rng = np.random.default_rng(6)
    objects, state = starts(name, rng)[0]
    for each in tries(found, objects, state, rng):
        known = found.actions[each.action]
        pair = explored(domain, [Transition(each.action, each.objects, objects, state, state)])
        if pair.actions[each.action].parts == known.parts:
            here = pair.actions[each.action].held[0]
            assert each.worth >= _slow_worth(known, here.tolist()) - 1e-12
            compared += 1
    assert compared


def test_an_example_is_worth_as_much_as_it_takes_away_of_the_error() -> None:
    """The mean error of a share of a half falls by a fifth of this with one more example, by the binomial
    distribution; in the same measure as all else here."""

    def error(number: int, p: float) -> float:
        likely = [math.comb(number, k) * p**k * (1 - p) ** (number - k) for k in range(number + 1)]
        return sum(chance * abs(k / number - p) for k, chance in enumerate(likely))

    for number in (20, 40, 80):
        fall = (error(number, 0.5) - error(number + 2, 0.5)) / 2
        assert least_worth(number) == pytest.approx(fall / 0.2, rel=0.15)


def test_hopes_are_actions_of_which_the_first_alone_is_paid() -> None:
    found = explored(corridor(), walked())
    hopes = [each for each in hopes_of(found) if each.action == "dig"][:3]
    hoping = optimistic(found.domain, hopes)
    assert len(hoping.rules) == len(found.domain.rules) + 3
    assert [term.weight for term in hoping.reward] == pytest.approx([each.worth for each in hopes], abs=1e-6)
    assert all(action.name.partition("!")[0] in ("go", "back", "dig", "light") for action in hoping.actions)


def test_a_part_and_its_opposite_stand_in_opposite_columns() -> None:
    domain, given = drawn("locks", 2, 30)
    for known in explored(domain, given).actions.values():
        half = len(known.parts)
        assert (known.held[:, :half] != known.held[:, half:]).all()
        assert all(signed(domain, known.parts, c) == known.parts[c] for c in range(half))
        assert all(signed(domain, known.parts, c + half) != known.parts[c] for c in range(half))
