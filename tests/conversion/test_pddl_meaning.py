"""Converted PPDDL means what the file means by definition: small files of each construct, of every two, and
drawn ones, in all reachable states."""

from __future__ import annotations

from itertools import combinations_with_replacement
from pathlib import Path
from random import Random

import pytest

import cleancli
from cleancli.compiler.semantics import covering_rule, successors
from cleancli.compiler.task import GroundState
from cleancli.conversion.pddl.models import models_of
from cleancli.conversion.pddl.words import Group, groups_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.sink import Findings
from cleancli.language.load import load_domain, load_problem
from support.pddl_compared import converted, disagreements, meaning_of, state_of, task_of
from support.pddl_drawn import Drawn

CORPUS = Path(__file__).parent.parent / "corpus"
FEATURES = sorted(path.stem for path in CORPUS.glob("*.pddl"))
EARNING = frozenset(feature for feature in FEATURES if feature.startswith("reward"))
"""Files that are to earn rewards, each with all others: without a metric, the others would earn them too."""
_IN_PAIRS = 5
"""States in which pairs are compared: enough to meet each branch, few enough for seconds."""


def text_of(feature: str) -> str:
    return (CORPUS / f"{feature}.pddl").read_text(encoding="utf-8")


@pytest.mark.parametrize("feature", FEATURES)
def test_a_construct_means_what_it_does(feature: str) -> None:
    text = text_of(feature)
    made = converted(text)
    assert {d.code for d in made.diagnostics} <= {"W402"}
    assert disagreements(text, made) == []


@pytest.mark.parametrize("feature", FEATURES)
def test_constructs_mean_the_same_beside_each_other(feature: str) -> None:
    """The actions of a domain have the conditions and effects of this construct and another each."""
    pairs = combinations_with_replacement(FEATURES, 2)
    if feature in EARNING:
        others = [pair for pair in pairs if feature in pair]
    else:
        others = [pair for pair in pairs if pair[0] == feature and EARNING.isdisjoint(pair)]
    actions = "\n".join(_joined(one, other) for one, other in others)
    (action,) = _actions(text_of(feature))
    text = text_of(feature)
    text = f"{text[: action.start]}{actions}{text[action.end :]}"
    made = converted(text)
    assert {d.code for d in made.diagnostics} <= {"W402"}
    assert disagreements(text, made, _IN_PAIRS) == []


DRAWN = [Drawn(Random(seed)).text() for seed in range(40)]


@pytest.mark.parametrize("text", [*map(text_of, FEATURES), *DRAWN], ids=[*FEATURES, *map(str, range(40))])
def test_what_commands_check_and_take_is_what_the_written_files_say(text: str) -> None:
    """Commands have no text of the .nid files checked, but trees that say the same."""
    source = Source("given.pddl", text)
    models, made = models_of(source, source), converted(text)
    domain = load_domain(Source("domain.nid", made.domain))
    assert models.domain == domain
    assert models.problems == tuple(
        load_problem(Source("p", each), domain) for each in made.problems.values()
    )
    assert [(d.code, d.message, d.help) for d in models.diagnostics] == [
        (d.code, d.message, d.help) for d in made.diagnostics
    ]
    assert all(d.span is not None and d.span.path == "given.pddl" for d in models.diagnostics)


def _joined(one: str, other: str) -> str:
    """An action with the parameters, conditions and effects of both files' actions."""
    first, second = _parts(one), _parts(other)
    parameters = {**first[0], **second[0]}
    shown = " ".join(f"{name} - {kind}" for name, kind in parameters.items())
    return (
        f"(:action {one}-and-{other} :parameters ({shown}) :precondition (and {first[1]} {second[1]})"
        f" :effect (and {first[2]} {second[2]}))"
    )


def _parts(feature: str) -> tuple[dict[str, str], str, str]:
    """The parameters with their types, the condition and the effect of a file's action."""
    text = text_of(feature)
    (action,) = _actions(text)
    found = {":parameters": "()", ":precondition": "()"}
    for name, value in zip(action.items[2::2], action.items[3::2], strict=True):
        found[text[name.start : name.end].lower()] = text[value.start : value.end].lower()
    names, _, kind = found[":parameters"][1:-1].partition(" - ")
    return dict.fromkeys(names.split(), kind), found[":precondition"], found[":effect"]


def _actions(text: str) -> list[Group]:
    source = Source("given.pddl", text)
    domain = groups_of(text, source.path, Findings(source))[0]
    return [item for item in domain.items if isinstance(item, Group) and item.head == ":action"]


@pytest.mark.parametrize("feature", sorted(set(FEATURES) - EARNING))
def test_the_goal_is_as_likely_as_it_can_be(feature: str) -> None:
    """With an action more, which changes nothing or has a chance that is seldom there twice."""
    last = "(:action last :precondition (or (ready) (exists (?a - area) (dirt ?a))) :effect {})\n"
    for effect in ("(and)", "(and (probabilistic 0.1 (done)) (probabilistic 0.5 (not (ready))))"):
        text = text_of(feature)
        (action,) = _actions(text)
        text = f"{text[: action.start]}{last.format(effect)}{text[action.start :]}"
        wanted = meaning_of(text).goal_probability(200)
        assert wanted is not None, "the file is too large to compare"
        assert cleancli.plan(text, text, objective="probability").value == pytest.approx(wanted, abs=1e-9)


def test_quantifiers_over_no_object_at_all() -> None:
    text = text_of("bare").replace("area container - place", "area container rag - place")
    effect = (
        "(and (forall (?r - rag) (done)) (when (forall (?r - rag) (wet ?r)) (forall (?a - area) (wet ?a))))"
    )
    for condition in (
        "(not (exists (?r - rag) (wet ?r)))",
        "(exists (?r - rag) (ready))",
        "(forall (?r - rag) (done))",
    ):
        changed = text.replace(":effect (done)", f":precondition {condition} :effect {effect}")
        assert disagreements(changed, converted(changed)) == []


CHANCES = (
    "(probabilistic 0.25 (dirt a2) 0.5 (not (dirt a1))) (probabilistic 1/3 (forall (?a - area) (wet ?a)))"
)


@pytest.mark.parametrize("feature", ["chance", "add_wins", "each_when", "disjunction"])
def test_chance_decides_of_the_initial_state(feature: str) -> None:
    """The first action leads to each initial world as often as it is one, and nothing else can be done."""
    text = text_of(feature).replace("(ready) (open bin)", f"(ready) (open bin) {CHANCES}")
    meaning, made = meaning_of(text), converted(text)
    assert {d.code for d in made.diagnostics} <= {"W402"}
    task = task_of(made)
    (begin,) = [n for n, action in enumerate(task.actions) if action.name == "begin"]
    found: dict[GroundState, float] = {}
    for world, chance in meaning.initial_worlds().items():
        state = state_of(task, world | {("begun",)})
        found[state] = found.get(state, 0.0) + float(chance)
    drawn = {state: chance for chance, state in successors(task, task.initial, begin)}
    assert drawn == pytest.approx(found, abs=1e-12)
    others = [n for n in range(len(task.actions)) if n != begin]
    assert all(covering_rule(task, task.initial, number) is None for number in others)
    wanted = meaning.goal_probability(200)
    assert cleancli.plan(text, text, objective="probability").value == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("seed", range(24))
def test_drawn_domains_mean_what_they_say(seed: int) -> None:
    text = Drawn(Random(seed)).text()
    made = converted(text)
    assert {d.code for d in made.diagnostics} <= {"W402", "W911"}
    assert disagreements(text, made, 25) == []


def test_the_comparison_can_fail() -> None:
    """A text that means something else than what was converted is noticed."""
    text = text_of("chance")
    assert disagreements(text, converted(text.replace("0.8 (not", "0.7 (not")))
    assert disagreements(text, converted(text.replace("(dirt ?a)\n", "(wet ?a)\n")))
