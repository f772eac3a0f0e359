"""What converted PPDDL looks like: texts that a person could have written."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import pytest

import cleancli
from cleancli.cli.main import run
from cleancli.conversion.pddl.convert import Converted, Wishes, convert
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.language.model import Domain, Horizon, Price, Problem, RewardKind, Unlimited
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.printer import print_price

TIDY = Path(__file__).parent / "tidy"


def tidy(*, horizon: int | None = None, **changes: str) -> Converted:
    """The tidy domain and problem, converted; a change is a text of either, `=>`, and what replaces it."""
    texts = [(TIDY / name).read_text(encoding="utf-8") for name in ("tidy.pddl", "tidy_two.pddl")]
    for change in changes.values():
        old, new = change.split(" => ")
        assert any(old in text for text in texts)
        texts = [text.replace(old, new) for text in texts]
    sources = [Source(name, text) for name, text in zip(("tidy.pddl", "tidy_two.pddl"), texts, strict=True)]
    return convert(sources, Wishes(horizon=horizon))


def models(made: Converted) -> tuple[Domain, Problem]:
    domain = load_domain(Source("domain.nid", made.domain))
    return domain, load_problem(Source("problem.nid", made.problems["two"]), domain)


def test_texts_are_laid_out_and_without_a_warning() -> None:
    made = tidy()
    assert made.diagnostics == ()
    assert layout(made.domain) == made.domain
    assert layout(made.problems["two"]) == made.problems["two"]


def test_a_condition_inside_of_an_effect_makes_two_rules() -> None:
    domain, _ = models(tidy())
    assert [rule.name for rule in domain.rules] == ["push_wet", "push_not_wet", "move", "empty_bin"]
    chances = [[outcome.probability for outcome in rule.outcomes] for rule in domain.rules]
    assert chances[0] == [Fraction(2, 25), Fraction(18, 25), Fraction(1, 50), Fraction(9, 50)]
    assert chances[1] == [Fraction(4, 5), Fraction(1, 5)]


def test_the_page_shows_what_is_written() -> None:
    """The two texts of docs/from-pddl.md are one domain."""
    page = (Path(__file__).parents[2] / "docs" / "from-pddl.md").read_text(encoding="utf-8")
    given, written = (
        re.findall(rf"^```{kind}\n(.*?)^```$", page, re.M | re.S)[0] for kind in ("text", "nid")
    )
    made = convert([Source("watering.pddl", given)], Wishes())
    assert made.diagnostics == ()
    assert load_domain(Source("made", made.domain)) == load_domain(Source("page", written))


def test_many_conditions_stay_in_the_effect() -> None:
    several = " ".join(f"(when (next-to ?from a{n}) (wet a{n}))" for n in (1, 2, 3))
    made = tidy(
        constants="(:constants bin - container) => (:constants bin - container a1 a2 a3 - area)",
        objects="(:objects a1 a2 - area) => (:objects)",
        effect=f"(not (dirt ?from)) (dirt ?to) => (not (dirt ?from)) (dirt ?to) {several}",
    )
    assert made.diagnostics == ()
    (rule,) = [rule for rule in models(made)[0].rules if rule.action == "move"]
    assert rule.name == "move"
    assert "if next_to(?from, a1) => wet(a1), if next_to(?from, a2) => wet(a2)" in made.domain
    assert "if ?to != ?from => not dirt(?from), dirt(?to)" in made.domain


def test_comments_say_what_is_from_where() -> None:
    made = tidy()
    assert made.domain.startswith("# Converted from tidy.pddl by `cleancli convert`.\n# left out: predicates")
    assert "  # tidy.pddl, line 9\n  rule push_wet:" in made.domain
    assert made.problems["two"].startswith("# Converted from tidy_two.pddl by `cleancli convert`.\n")


def test_names_are_those_of_the_file() -> None:
    made = tidy(
        hyphens="next-to => Next-To-It",
        reserved="(wet => (nothing",
        digits="a2 => 2",
        clash="colour => next_to_it",
        asked="(dirt ?from)\n => (and (dirt ?from) (next_to_it ?from))\n",
    )
    assert "Next_To_It(?a ?b - area) [static]" in made.domain
    assert "nothing_(?a - area)" in made.domain
    assert "next_to_it(?a - area)" in made.domain
    assert "a1 o2 - area" in made.problems["two"]
    assert made.diagnostics == ()


def test_the_problem_says_how_it_ends() -> None:
    domain, problem = models(tidy())
    assert isinstance(problem.horizon, Unlimited)
    assert [term.kind for term in domain.reward] == [RewardKind.GOAL, RewardKind.COST]
    assert [action.cost.number for action in domain.actions] == [2, 1, 5]
    rewarded = "minimize (total-cost) => maximize (reward)"
    made = tidy(metric=rewarded, paid="increase (total-cost) => decrease (reward)")
    domain, problem = models(made)
    assert problem.horizon == Horizon(40)
    assert "# the horizon is a guess: PPDDL has none" in made.problems["two"]
    assert [term.kind for term in domain.reward] == [RewardKind.COST]
    assert models(tidy(horizon=7, metric=rewarded))[1].horizon == Horizon(7)
    paid = models(tidy(metric="(:metric minimize (total-cost)) => (:goal-reward 3/2)"))[0]
    assert [(term.kind, term.weight) for term in paid.reward] == [(RewardKind.GOAL, Fraction(3, 2))]


def test_what_chance_pays_is_paid_by_its_outcome() -> None:
    half = "(probabilistic 0.5 (increase (total-cost) 5))"
    domain, _ = models(tidy(cost=f"(increase (total-cost) 5) => (and (increase (total-cost) 1) {half})"))
    action = domain.actions[2]
    own = [rule for rule in domain.rules if rule.action == action.name]
    paid = {(o.cost.number, o.probability) for rule in own for o in rule.outcomes}
    assert action.cost == Price(Fraction(1))
    assert {cost for cost, _ in paid} == {0, 5}


def test_what_costs_depend_on_is_said_by_rules() -> None:
    made = tidy(cost="(increase (total-cost) 1) => (when (wet ?to) (increase (total-cost) 1))")
    domain, _ = models(made)
    assert made.diagnostics == ()
    assert [action.cost for action in domain.actions if action.name == "move"] == [Price()]
    rules = [rule for rule in domain.rules if rule.action == "move"]
    paid = {("not_wet" in rule.name, outcome.cost.number) for rule in rules for outcome in rule.outcomes}
    assert paid == {(False, Fraction(1)), (True, Fraction(0))}


def test_functions_that_costs_depend_on_by_a_condition_are_said_by_rules() -> None:
    made = tidy(
        declared="(:functions (total-cost)) => (:functions (total-cost) (far ?p - place))",
        cost="(increase (total-cost) 1) => (when (wet ?to) (increase (total-cost) (far ?to)))",
        values="(:init => (:init (= (far a1) 1) (= (far a2) 4) (= (far bin) 4)",
    )
    domain, _ = models(made)
    assert made.diagnostics == ()
    assert [action.cost for action in domain.actions if action.name.startswith("move")] == [Price()]
    rules = [rule for rule in domain.rules if rule.action == "move"]
    paid = {("not_wet" in rule.name, print_price(o.cost)) for rule in rules for o in rule.outcomes}
    assert paid == {(False, "far(?to)"), (True, "0")}


def test_what_is_earned_is_said_by_outcomes() -> None:
    rewarded = "minimize (total-cost) => maximize (reward)"
    made = tidy(metric=rewarded, paid="increase (total-cost) => increase (reward)")
    domain, _ = models(made)
    assert [action.cost for action in domain.actions] == [Price()] * 3
    assert {outcome.reward.number for rule in domain.rules for outcome in rule.outcomes} == {2, 1, 5}


def test_a_function_of_objects_says_what_an_action_costs() -> None:
    """In whole numbers of halves; where it is not known it has no cost, and cannot be done."""
    made = tidy(
        declared="(:functions (total-cost)) => (:functions (total-cost) (far-off ?p ?q - place))",
        cost="(increase (total-cost) 1) => (increase (total-cost) (far-off ?from ?to))",
        values="(:init => (:init (= (far-off a1 a2) 1.5) (= (far-off a2 a2) 4)",
    )
    domain, problem = models(made)
    assert made.diagnostics == ()
    (move,) = [action for action in domain.actions if action.name.startswith("move")]
    assert (move.name, print_price(move.cost)) == ("move", "0.5 * far_off(?from, ?to)")
    assert (
        "# `far_off` counts parts of 1/2 and has a value in PDDL where `far_off_known` holds" in made.domain
    )
    values = {fact.objects: fact.value for fact in problem.state if fact.symbol == "far_off"}
    assert {objects for objects, value in values.items() if value} == {("a1", "a2"), ("a2", "a2")}
    assert (values["a1", "a2"], values["a2", "a2"], values["bin", "a1"]) == (3, 8, 0)
    known = {fact.objects for fact in problem.state if fact.symbol == "far_off_known"}
    assert known == {("a1", "a2"), ("a2", "a2")}


def test_untyped_files_have_one_type() -> None:
    text = "(define (domain d) (:predicates (p ?x)) (:action a :parameters (?x) :effect (p ?x)))"
    problem = "(define (problem q) (:domain d) (:objects o) (:goal (p o)))"
    made = convert([Source("d.pddl", text), Source("q.pddl", problem)], Wishes())
    assert "types {\n    object\n  }" in made.domain
    assert made.diagnostics == ()


def test_several_problems_share_the_domain() -> None:
    texts = [(TIDY / name).read_text(encoding="utf-8") for name in ("tidy.pddl", "tidy_two.pddl")]
    other = texts[1].replace("problem two", "problem tidy").replace("(dirt a1)", "")
    sources = [Source(f"{n}.pddl", text) for n, text in enumerate((texts[1], texts[0], other))]
    made = convert(sources, Wishes())
    assert list(made.problems) == ["two", "tidy_"]
    with pytest.raises(Refused, match="wants something else"):
        convert([*sources, Source("3.pddl", other.replace("minimize", "maximize"))], Wishes())


def test_python_converts_paths_and_texts(tmp_path: Path) -> None:
    paths = [TIDY / "tidy.pddl", TIDY / "tidy_two.pddl"]
    made = cleancli.convert(*paths, domain_name="clean")
    assert cleancli.convert(*(path.read_text(encoding="utf-8") for path in paths)).problems.keys() == {"two"}
    assert made.write(tmp_path) == (tmp_path / "clean.nid", tmp_path / "two.nid")
    assert (tmp_path / "clean.nid").read_text(encoding="utf-8") == str(made)
    with pytest.raises(Refused, match="already exists"):
        made.write(tmp_path)
    assert made.write(tmp_path, force=True) == tuple(made.files(tmp_path))
    assert made.to_dict()["notes"] == list(made.notes)
    assert cleancli.convert(TIDY.parent / "kitchen").problems.keys() == {"problem"}
    with pytest.raises(ValueError, match="RDDL is not converted"):
        cleancli.convert("tidy.rddl")
    with pytest.raises(ValueError, match="are for libPRADA"):
        cleancli.convert(*paths, predicates=True)


def test_the_command_writes_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = [str(TIDY / "tidy.pddl"), str(TIDY / "tidy_two.pddl")]
    assert run(["convert", *files, "--out", str(tmp_path), "--json", "--domain-name", "clean"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["domain"] == str(tmp_path / "clean.nid")
    assert told["problems"] == [str(tmp_path / "two.nid")]
    assert run(["check", str(tmp_path)]) == 0
    assert run(["plan", told["domain"], told["problems"][0], "--json"]) == 0
    assert run(["convert", *files, "--out", str(tmp_path), "--domain-name", "clean"]) == 1
    assert run(["convert", *files, "--out", str(tmp_path), "--domain-name", "clean", "--force"]) == 0


def test_other_names_need_to_be_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "tidy.txt"
    file.write_text((TIDY / "tidy.pddl").read_text(encoding="utf-8"), encoding="utf-8")
    assert run(["convert", str(file), "--from", "pddl", "--out", str(tmp_path / "out")]) == 0
    assert run(["convert", str(tmp_path / "tidy.rddl"), "--out", str(tmp_path / "out")]) == 2
    assert re.search(r"RDDL is not\s+converted", capsys.readouterr().err)


def test_nothing_is_written_after_a_mistake(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "tidy.pddl"
    text = (TIDY / "tidy.pddl").read_text(encoding="utf-8").replace("(dirt ?to)", "(dirt ?too)")
    file.write_text(text, encoding="utf-8")
    assert run(["convert", str(file), "--out", str(tmp_path / "out")]) == 1
    assert "tidy.pddl:20:69: error[E916]: the variable `?too` is not bound" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_what_is_earned_back_lowers_a_cost_that_stays() -> None:
    made = tidy(
        cost="(increase (total-cost) 5) => (and (increase (total-cost) 5) (decrease (total-cost) 3/2))"
    )
    assert models(made)[0].actions[2].cost == Price(Fraction(7, 2))
