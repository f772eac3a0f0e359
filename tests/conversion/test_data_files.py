"""Experience as libPRADA's data.dat, and back: what comes back, how files may look, what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import cleancli
from cleancli.api.conversion_result import ConversionResult
from cleancli.cli.main import run
from cleancli.conversion.experience.chains import chains_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.learning.experience import encode, read_experience
from cleancli.planning.plan import BadOption
from support.damaged import count_read
from support.export_texts import LAMPS
from support.random_transitions import drawn

KITCHEN = Path(__file__).parent / "kitchen"

TWO = """
problem two {
  domain  = lamps
  objects { A1 b - lamp }
  init    { beside(A1, b), heat(A1) = 0, heat(b) = 2 }
  horizon = 2
}
"""

LINES = [
    '{"action": "press", "arguments": ["A1"], "objects": {"A1": "lamp", "b": "lamp"}, "before":'
    ' [["beside", ["A1", "b"], true], ["heat", ["A1"], 0], ["heat", ["b"], 2]], "after":'
    ' [["beside", ["A1", "b"], true], ["heat", ["A1"], 1], ["heat", ["b"], 2], ["on", ["A1"], true]]}',
    '{"action": "press", "arguments": ["b"], "objects": {"A1": "lamp", "b": "lamp"}, "before":'
    ' [["beside", ["A1", "b"], true], ["heat", ["A1"], 1], ["heat", ["b"], 2], ["on", ["A1"], true]],'
    ' "after": [["beside", ["A1", "b"], true], ["heat", ["A1"], 1], ["heat", ["b"], 0]]}',
]

DATA = """\
lamp(10) lamp(11) beside(10 11) beside(11 10) heat_0(10) heat_2(11)
press(10)
lamp(10) lamp(11) beside(10 11) beside(11 10) heat_1(10) heat_2(11) on(10)
press(11)
lamp(10) lamp(11) beside(10 11) beside(11 10) heat_0(11) heat_1(10)
"""


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def plain(text: str) -> str:
    """The lamps without what libPRADA cannot say."""
    return text.replace(", forall ?o - lamp: beside(?l, ?o) => not on(?o)", "")


def experience(text: str) -> list[str]:
    """The lines that data of the lamps become."""
    Path("data.dat").write_text(text)
    return cleancli.convert(plain(LAMPS), TWO, "data.dat").texts["experience.jsonl"].splitlines()


def test_data_has_a_line_for_each_state_and_action() -> None:
    Path("seen.jsonl").write_text("\n".join(LINES) + "\n")
    made = cleancli.convert(plain(LAMPS), TWO, "seen.jsonl", to="libprada")
    assert list(made.texts) == ["rules.dat", "symbols.dat", "state.dat", "data.dat"]
    assert made.texts["data.dat"] == DATA
    assert "lamp 1 primitive binary" in made.texts["symbols.dat"]
    assert "data.dat has states and actions in turn" in made.notes
    assert experience(DATA) == LINES


def test_transitions_that_follow_from_no_other_have_two_states_each() -> None:
    Path("seen.jsonl").write_text(f"{LINES[0]}\n{LINES[0]}\n")
    made = cleancli.convert(plain(LAMPS), TWO, "seen.jsonl", to="libprada")
    state, action, after = DATA.splitlines()[:3]
    assert made.texts["data.dat"].splitlines() == [state, action, after, state, action, after]
    assert "data.dat has each action between two states of its own" in made.notes
    assert experience(made.texts["data.dat"]) == [LINES[0], LINES[0]]


CASES = """
domain cases {
  types      { thing; box - thing; shelf - thing }
  constants  { top - shelf }
  predicates { on(?b - box, ?s - shelf)  near(?a ?b - box) [symmetric]  alarm()  Wet(?t - thing) }
  functions  { load(?b - box): -1..1  size(?t - thing): small < big }
  derived    { wets := count ?t - thing: Wet(?t) }
  actions    { lift(?b - box, ?s - shelf)  ring() }
  rule lift_it: lift(?b, ?s) { when not on(?b, ?s)  then 0.5: on(?b, ?s), load(?b) := 1  rest: nothing }
  rule ring_it: ring() { when not alarm()  then 1: alarm(), Wet(top) }
  reward     { decrease(wets) }
}
"""

SOME = """
problem some {
  domain  = cases
  objects { b1 o12 - box  low - shelf }
  init    { load(b1) = 0, load(o12) = 1, size(b1) = small, size(o12) = big, size(low) = big, size(top) = big }
  horizon = 3
}
"""


@pytest.mark.parametrize("seed", range(4))
def test_what_was_written_comes_back_to_the_letter(seed: int) -> None:
    domain = load_domain(Source("cases.nid", CASES))
    problem = load_problem(Source("some.nid", SOME), domain)
    before = list(drawn(domain, problem, seed, further="o99"))
    assert len(list(chains_of(before))) > 1
    lines = "".join(f"{encode(each, {})}\n" for each in before)
    Path("seen.jsonl").write_text(lines)
    made = cleancli.convert(CASES, SOME, "seen.jsonl", to="libprada")
    Path("data.dat").write_text(made.texts["data.dat"])
    back = cleancli.convert(CASES, SOME, "data.dat")
    assert back.texts == {"experience.jsonl": lines}


# ---- files of the library


def kitchen(data: str, *, predicates: bool = False) -> ConversionResult:
    for path in KITCHEN.glob("*.dat"):
        Path(path.name).write_text(path.read_text(encoding="utf-8"), encoding="utf-8")
    Path("data.dat").write_text(data, encoding="utf-8")
    return cleancli.convert(".", format="libprada", predicates=predicates)


STATE = "on(8 7) dirt(8) lightSoil(8) water(7)=1 running()"


def test_data_beside_rules_is_experience_of_the_domain_that_these_become() -> None:
    made = kitchen(
        f"# two of them\n{STATE}\nwash(8)\n{STATE.replace('dirt(8) ', '-dirt(8) ')} wet(8)\n\n"
        f"{STATE}\nswitchOn()\n{STATE}\n"
    )
    assert list(made.texts) == ["domain.nid", "problem.nid", "experience.jsonl"]
    made.write("out")
    first, second = read_experience("out/experience.jsonl", load_domain(Source("domain.nid", made.domain)))
    assert (first.action, first.arguments) == ("wash", ("o8",))
    assert first.changed == {("dirt", ("o8",)), ("wet", ("o8",))}
    assert first.before["water", ("o7",)] == 1
    assert (second.action, second.changed) == ("switchOn", set())


def test_actions_that_no_rule_is_for_are_told() -> None:
    made = kitchen(f"{STATE}\nrest()\n{STATE}\n")
    assert made.texts["experience.jsonl"] == ""
    assert "left out: what actions have done that the domain lacks: rest" in made.notes


def test_experience_goes_with_rules_that_overlap() -> None:
    """As they stand in the library's files, which `--predicates` keeps; the checker would refuse them."""
    made = kitchen(f"{STATE}\nwash(8)\n{STATE.replace('dirt(8) ', '')} wet(8)\n", predicates=True)
    (line,) = map(json.loads, made.texts["experience.jsonl"].splitlines())
    assert (line["action"], line["arguments"]) == ("wash", ["o8"])
    assert ["lightSoil", ["o8"], True] in line["before"]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (f"{STATE}\nwash(8)\n", "no state stands behind this action"),
        (f"wash(8)\n{STATE}\n", "no state stands before this action"),
        (f"{STATE}\nwash(8)\nwash(8)\n{STATE}\n", "no state stands before this action"),
        (f"{STATE} ?\nwash(8)\n{STATE}\n", "expected a literal, but there is `?`"),
        (f"{STATE}\nwash(8)\nloud(8)\n", "`loud` is not declared in symbols.dat"),
        (f"{STATE}\nwash(8)\non(8)\n", "`on` is declared with 2 arguments, and has 1"),
        (f"{STATE}\nwash(8)\nwater(7)=99\n", "`water(o7)` is 99 around this action"),
    ],
)
def test_mistakes_of_the_librarys_data_are_located(data: str, message: str) -> None:
    with pytest.raises(Refused) as refused:
        kitchen(data)
    found = [each for each in refused.value.diagnostics if message in each.message]
    assert found, str(refused.value)
    assert all(each.span is not None and each.span.path == "data.dat" for each in found)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("heat_0(10)", "heat_7(10)", "`lamps` has no predicate `heat_7` there"),
        ("heat_0(10)", "heat_0(10) heat_1(10)", "`heat(A1)` is `0` and `1` at once"),
        ("heat_0(10)", "heat_0(10 11)", "`heat_0` takes 1 object, not 2"),
        ("press(10)", "press(10 11)", "`press` takes 1 object, not 2"),
        ("press(10)", "pres(10)", "no action stands before or behind this state"),
    ],
)
def test_mistakes_are_located(old: str, new: str, message: str) -> None:
    with pytest.raises(Refused) as refused:
        experience(DATA.replace(old, new, 1))
    found = [each for each in refused.value.diagnostics if message in each.message]
    assert [each.code for each in found] in (["E912"], ["E911"] * 2), str(refused.value)


PIECES = ("", "(", ")", "\n", "=", "-", "X", "é", "1e9", "# ", "press(10)\n", "9" * 30)


def test_damaged_files_are_refused_or_read() -> None:
    assert count_read(experience, DATA, PIECES, times=300, seed=4) > 5


def test_the_problem_names_the_objects() -> None:
    Path("data.dat").write_text(DATA)
    with pytest.raises(BadOption, match="give the problem too"):
        cleancli.convert(plain(LAMPS), "data.dat")
    with pytest.raises(BadOption, match="leave out `to`"):
        cleancli.convert(plain(LAMPS), TWO, "data.dat", to="libprada")


def test_the_command_takes_experience_there_and_back(capsys: pytest.CaptureFixture[str]) -> None:
    Path("lamps.nid").write_text(plain(LAMPS))
    Path("two.nid").write_text(TWO)
    Path("seen.jsonl").write_text("\n".join(LINES) + "\n")
    assert run(["convert", "lamps.nid", "two.nid", "seen.jsonl", "--to", "libprada", "--out", "out"]) == 0
    capsys.readouterr()
    assert run(["convert", "lamps.nid", "two.nid", "out/data.dat", "--out", "back", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["experience"] == [str(Path("back", "experience.jsonl"))]
    assert Path("back", "experience.jsonl").read_text() == "\n".join(LINES) + "\n"
    assert Path("out", "data.dat").read_text() == DATA
