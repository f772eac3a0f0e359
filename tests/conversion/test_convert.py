"""Domains and problems made from libPRADA's files: what they say, and what they mean."""

from __future__ import annotations

import json
import random
import re
import time
from fractions import Fraction
from pathlib import Path

import pytest

from cleancli.cli.main import run
from cleancli.compiler.ground import ground
from cleancli.conversion.convert import Converted, Wishes, convert
from cleancli.conversion.names import called
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Domain, Problem
from cleancli.language.printing.formatter import layout
from support import libprada_records

KITCHEN = Path(__file__).parent / "kitchen"
FILES = ("rules.dat", "state.dat", "symbols.dat")


def texts() -> dict[str, str]:
    return {name: (KITCHEN / name).read_text(encoding="utf-8") for name in FILES}


def converted(files: dict[str, str], wishes: Wishes | None = None) -> Converted:
    rules, state, symbols = (Source(name, files[name]) for name in FILES)
    return convert(rules, state, symbols, wishes or Wishes(), ("domain.nid", "problem.nid"))


def models(made: Converted) -> tuple[Domain, Problem]:
    domain = load_domain(made.sources[0])
    return domain, load_problem(made.sources[1], domain)


def small(symbols: str, rules: str, state: str) -> dict[str, str]:
    """Files with one action `do(X)`, or what the symbols say more."""
    return {"rules.dat": rules, "state.dat": state, "symbols.dat": f"do 1 action binary\n{symbols}\n"}


def rule(context: str, *outcomes: str, action: str = "do(X)") -> str:
    return f"ACTION:\n {action}\nCONTEXT:\n {context}\nOUTCOMES:\n " + "\n ".join(outcomes) + "\n"


# ---- the command


def test_the_kitchen_is_converted_as_expected(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Regenerate with `cleancli convert tests/conversion/kitchen --out ... --domain-name kitchen --force`."""
    assert run(["convert", str(KITCHEN), "--out", str(tmp_path), "--domain-name", "kitchen"]) == 0
    for name in ("kitchen.nid", "problem.nid"):
        expected = (KITCHEN / "expected" / name).read_text(encoding="utf-8")
        assert (tmp_path / name).read_text(encoding="utf-8") == expected
    out = capsys.readouterr().out
    assert "lightSoil, heavySoil are the function `soil` now" in out
    assert "  the reward is a guess: " in out
    assert run(["check", str(tmp_path)]) == 0
    assert "0 mistakes in 2 files" in capsys.readouterr().out
    assert run(["fmt", "--check", str(tmp_path)]) == 0
    assert run(["compile", str(tmp_path / "kitchen.nid"), str(tmp_path / "problem.nid")]) == 0


def test_files_are_replaced_only_when_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paths = [str(KITCHEN / name) for name in FILES]
    assert run(["convert", *paths, "--out", str(tmp_path)]) == 0
    before = (tmp_path / "problem.nid").read_text(encoding="utf-8")
    (tmp_path / "domain.nid").unlink()
    assert run(["convert", *paths, "--out", str(tmp_path), "--horizon", "7"]) == 1
    assert "E006" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["problem.nid"]
    assert (tmp_path / "problem.nid").read_text(encoding="utf-8") == before
    wishes = ["--horizon", "7", "--discount", "0.5", "--reward", "2 * decrease(dirty) - wetThings", "--json"]
    capsys.readouterr()
    assert run(["convert", *paths, "--out", str(tmp_path), "--force", *wishes]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["functions"] == {"soil": ["lightSoil", "heavySoil"]}
    assert (data["mistakes"], data["warnings"]) == (0, 0)
    problem = (tmp_path / "problem.nid").read_text(encoding="utf-8")
    assert "horizon  = 7\n" in problem
    assert "discount = 0.5\n" in problem
    domain = load_domain(read_source(tmp_path / "domain.nid"))
    assert [(term.weight, term.count) for term in domain.reward] == [
        (Fraction(2), "dirty"),
        (Fraction(-1), "wetThings"),
    ]


@pytest.mark.parametrize("reward", ["decrease(dirtyy)", "1 +", "} rule x", "no_count"])
def test_a_wrong_reward_is_located(reward: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert run(["convert", str(KITCHEN), "--out", str(out), "--reward", reward]) == 1
    assert "--reward:" in capsys.readouterr().err
    assert not out.exists()


def test_the_folder_is_made_however_deep_it_lies(tmp_path: Path) -> None:
    out = tmp_path / "a" / "b"
    assert run(["convert", str(KITCHEN), "--out", str(out)]) == 0
    assert {path.name for path in out.iterdir()} == {"domain.nid", "problem.nid"}


@pytest.mark.parametrize("name", ["a b", "../x", "problem", "when", ""])
def test_a_domain_has_a_name_and_a_file_of_its_own(name: str, tmp_path: Path) -> None:
    assert run(["convert", str(KITCHEN), "--out", str(tmp_path / "out"), "--domain-name", name]) == 2
    assert run(["convert", str(KITCHEN), str(KITCHEN), "--out", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()


# ---- groups


SIZES = "bigPot 1 primitive binary\nsmallPot 1 primitive binary\nn 0 count integers <-- Num X bigPot(X)"
CHOICE = rule("bigPot(X)", "0.5 -bigPot(X) smallPot(X)", "0.5 <noise>") + rule("smallPot(X)", "1 <noise>")


def functions(symbols: str, rules: str, state: str) -> dict[str, tuple[str, ...]]:
    return dict(converted(small(symbols, rules, state)).functions)


def test_predicates_that_exclude_each_other_become_a_function() -> None:
    made = converted(small(SIZES, CHOICE, "bigPot(1) smallPot(2)"))
    assert made.functions == {"pot": ("bigPot", "smallPot")}
    assert "pot(?x - object): big < small" in made.domain
    assert "none" not in made.domain
    assert "count ?x - object: pot(?x) = big" in made.domain
    assert not made.diagnostics
    other = converted(small(SIZES, CHOICE, "bigPot(1) smallPot(2) do2(3)".replace(" do2(3)", " -bigPot(3)")))
    assert "pot(?x - object): none < big < small" in other.domain
    assert "pot(o3) = none" in other.problem


@pytest.mark.parametrize(
    ("rules", "state"),
    [
        (CHOICE, "bigPot(1) smallPot(1)"),
        (CHOICE + rule("smallPot(X)", "1 bigPot(X)"), "bigPot(1)"),
        (CHOICE + rule("smallPot(X)", "1 -smallPot(X)"), "bigPot(1)"),
        (CHOICE + rule("--", "1 bigPot(X)"), "bigPot(1)"),
        (CHOICE + rule("--", "1 bigPot(X) smallPot(X)"), "bigPot(1)"),
        (rule("bigPot(X)", "0.5 -bigPot(X) smallPot(X)", "0.5 <noise>"), "bigPot(1)"),
    ],
)
def test_predicates_that_may_hold_together_stay_what_they_are(rules: str, state: str) -> None:
    assert functions(SIZES, rules, state) == {}


def test_a_rule_may_know_that_a_member_does_not_hold() -> None:
    more = rule("-smallPot(X)", "1 bigPot(X)")
    assert functions(SIZES, CHOICE + more, "bigPot(1)") == {"pot": ("bigPot", "smallPot")}
    third = SIZES + "\nhugePot 1 primitive binary"
    more = CHOICE + rule("hugePot(X)", "1 -hugePot(X) bigPot(X)")
    assert functions(third, more, "hugePot(1)") == {"pot": ("bigPot", "smallPot", "hugePot")}


def test_a_member_that_no_rule_asks_for_comes_where_another_goes() -> None:
    third = SIZES + "\nhugePot 1 primitive binary"
    more = CHOICE + rule("smallPot(X)", "1 -smallPot(X) hugePot(X)")
    assert functions(third, more, "bigPot(1)") == {"pot": ("bigPot", "smallPot", "hugePot")}
    # Another that comes there, too, holds together with some of them.
    wet = third + "\nwet 1 primitive binary"
    more = CHOICE.replace("smallPot(X)\n 0.5 <noise>", "smallPot(X) wet(X)\n 0.5 <noise>")
    more += rule("smallPot(X)", "1 -smallPot(X) hugePot(X) wet(X)") + rule("wet(X)", "1 -wet(X)")
    assert functions(wet, more, "bigPot(1)") == {"pot": ("bigPot", "smallPot", "hugePot")}


def test_predicates_without_arguments_become_a_function_too() -> None:
    symbols = "low 0 primitive binary\nhigh 0 primitive binary\np 1 primitive binary"
    rules = rule("low()", "1 -low() high() p(X)") + rule("high()", "0.5 -high() low()", "0.5 <no-change>")
    made = converted(small(symbols, rules, "low()"), Wishes(reward="cost"))
    assert made.functions == {"low_or_high": ("low", "high")}
    assert "low_or_high(): low < high" in made.domain
    assert "low_or_high() = low" in made.problem
    assert not made.diagnostics
    partly = converted(small(symbols, rules, "p(1)"), Wishes(reward="cost"))
    assert "low_or_high(): none < low < high" in partly.domain
    assert not converted(small(symbols, rules, "low() high()"), Wishes(reward="cost")).functions


def test_a_group_is_called_by_what_its_members_share() -> None:
    def named(first: str, second: str) -> str:
        files = small(SIZES, CHOICE, "bigPot(1)")
        text = {k: v.replace("bigPot", first).replace("smallPot", second) for k, v in files.items()}
        return next(line for line in converted(text).domain.splitlines() if " < " in line).strip()

    assert named("sizeVeryBig", "size_small") == "size(?x - object): veryBig < small"
    assert named("red", "blue") == "red_or_blue(?x - object): red < blue"
    assert named("isNone", "is1") == "is(?x - object): none < v1"
    assert named("bigN", "n_n") == "n_(?x - object): big < n"


def test_each_of_many_constants_gets_a_name_of_its_own() -> None:
    """In time that grows with their number: each of these would be compared with all before it."""
    started = time.process_time()
    names = called({"7": "o7_"}, [*map(str, range(20_000)), "o5"])
    assert time.process_time() - started < 2
    assert (names["5"], names["7"], names["o5"]) == ("o5", "o7_", "o5_")
    assert len(set(names.values())) == 20_001


# ---- rules


def test_comments_and_a_byte_order_mark_change_nothing() -> None:
    def remarked(text: str) -> str:
        first, *lines = text.splitlines()
        return "\ufeff" + "\n".join([first, "// rules = 7", *(f"{line}  # {line}" for line in lines), "#"])

    plain = converted(texts())
    made = converted({name: remarked(text) for name, text in texts().items()})
    assert made.problem == plain.problem
    assert re.sub("line:? [0-9]+", "", made.domain) == re.sub("line:? [0-9]+", "", plain.domain)


def test_names_that_mean_something_in_the_language_get_an_underscore() -> None:
    words = ["when", "prior", "rule", "types", "domain", "s", "x", "seen", "fixed", "horizon"]
    symbols = "\n".join(f"{word} 1 primitive binary" for word in words)
    symbols += "\ngoal 0 count integers <-- Num X when(X)"
    rules = rule(" ".join(f"{word}(X)" for word in words), "1 " + " ".join(f"-{word}(X)" for word in words))
    made = converted(small(symbols, rules, "when(rule) prior(noise) x(1)"))
    assert not [d for d in made.diagnostics if d.code != "W402"]
    assert [term.count for term in models(made)[0].reward] == ["goal_"]
    assert "objects {\n    o1 rule noise_ - object\n  }" in made.problem


def test_what_a_rule_refers_to_is_not_found_by_its_kind_alone() -> None:
    """It would have to be the only place there is."""
    symbols = "place 1 primitive binary\nnear 2 primitive binary\nwet 1 primitive binary"
    rules = rule("place(Y) near(X Y)", "1 -near(X Y)") + rule("place(Y) -near(X Y)", "1 wet(Y)")
    made = converted(small(symbols, rules, "place(1) place(2) near(1 2)"), Wishes(reward="cost"))
    assert "with ?y - object: place(?y), near(?x, ?y)" in made.domain
    assert "with ?y - object: place(?y), not near(?x, ?y)" in made.domain


def test_rules_that_stay_overlapping_are_written_and_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = texts()
    files["rules.dat"] = files["rules.dat"].replace("heavySoil(X) running()", "running()")
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert run(["convert", str(tmp_path), "--out", str(tmp_path / "out")]) == 1
    assert "error[E307]" in capsys.readouterr().err
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"domain.nid", "problem.nid"}


def test_without_dirt_more_of_the_first_count_pays() -> None:
    made = converted(small(SIZES, CHOICE, "bigPot(1) smallPot(2)"))
    assert "horizon  = 3" in made.problem
    domain, problem = models(made)
    assert [(term.weight, term.count) for term in domain.reward] == [(Fraction(-1), "n")]
    task = ground(domain, problem)
    assert [r.decrease for r in task.rewards] == [-1]
    with pytest.raises(Refused, match="no reward"):
        converted(small("p 1 primitive binary", rule("p(X)", "1 -p(X)"), "p(1)"))
    paid = converted(small("p 1 primitive binary", rule("p(X)", "1 -p(X)"), "p(1)"), Wishes(reward="- cost"))
    assert not paid.diagnostics


# ---- meaning


def test_the_task_means_what_the_records_do() -> None:
    assert libprada_records.disagreements(texts(), steps=60, seed=1) == []


def test_a_task_that_means_something_else_is_noticed() -> None:
    """The comparison can fail: the rule's outcome is another one in the records."""
    files = texts()
    other = {**files, "rules.dat": files["rules.dat"].replace("0.8 -dirt(X) wet(X)", "0.8 -dirt(X)")}
    assert libprada_records.disagreements(files, steps=60, seed=1, read_from=other)


# ---- nothing but refusals


@pytest.mark.parametrize("seed", range(4))
def test_damaged_files_are_refused_or_converted(seed: int) -> None:
    """Whatever stands in the files, it is a located refusal, or texts that the checker can read."""
    rng = random.Random(seed)
    original = texts()
    refused = 0
    for _ in range(40):
        files = dict(original)
        name = rng.choice(FILES)
        for _ in range(rng.choice([1, 1, 3])):
            files[name] = damaged(files[name], rng)
        made = converted_or_refused(files)
        if isinstance(made, Refused):
            refused += 1
            assert {d.code for d in made.diagnostics} <= {"E911", "E912", "E913", "E914"}
            assert all(d.span is not None and d.span.path in FILES for d in made.diagnostics)
        else:
            assert not [d for d in made.diagnostics if d.code.startswith("E1")]
            assert layout(made.domain) == made.domain
            assert layout(made.problem) == made.problem
    assert refused >= 10


def converted_or_refused(files: dict[str, str]) -> Converted | Refused:
    try:
        return converted(files)
    except Refused as refused:
        return refused


def damaged(text: str, rng: random.Random) -> str:
    """The text with a word lost, doubled or exchanged, or a character in a wrong place."""
    words = re.findall(r"\s+|\w+|.", text) or [""]
    place = rng.randrange(len(words))
    match rng.randrange(5):
        case 0:
            words[place] = ""
        case 1:
            words[place] *= 2
        case 2:
            words[place] = rng.choice(words)
        case 3:
            words[place] = rng.choice("()-<>=:#.,%\x00é\u20280 X")
        case _:
            words = words[:place]
    return "".join(words)
