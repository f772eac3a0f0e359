"""Experience as trajectories of PDDL, and back: what comes back, how files may look, what is refused."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import pytest

import cleancli
from cleancli.cli.main import run
from cleancli.conversion.experience.chains import chains_of
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, load_problem
from cleancli.language.printing.printer import print_domain
from cleancli.learning.experience import encode, read_experience
from cleancli.planning.plan import BadOption
from support.damaged import count_read
from support.export_texts import EVERYTHING, LAMPS, SOME
from support.random_domains import Generator
from support.random_transitions import drawn

LAMPS_LINES = [
    '{"action": "press", "arguments": ["A1"], "objects": {"A1": "lamp", "b": "lamp"}, "before":'
    ' [["beside", ["A1", "b"], true], ["heat", ["A1"], 0], ["heat", ["b"], 2]], "after":'
    ' [["beside", ["A1", "b"], true], ["heat", ["A1"], 1], ["heat", ["b"], 2], ["on", ["A1"], true]]}',
    '{"action": "press", "arguments": ["b"], "objects": {"A1": "lamp", "b": "lamp"}, "before":'
    ' [["beside", ["A1", "b"], true], ["heat", ["A1"], 1], ["heat", ["b"], 2], ["on", ["A1"], true]],'
    ' "after": [["beside", ["A1", "b"], true], ["heat", ["A1"], 1], ["heat", ["b"], 0]]}',
]

LAMPS_TRAJECTORY = """\
(:trajectory
  (:objects A1 b - lamp)
  (:init (beside A1 b) (beside b A1) (heat-0 A1) (heat-2 b))
  (:action (press A1))
  (:state (beside A1 b) (beside b A1) (heat-1 A1) (heat-2 b) (on A1))
  (:action (press b))
  (:state (beside A1 b) (beside b A1) (heat-0 b) (heat-1 A1)))
"""


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def experience(text: str, name: str = "lamps.trajectory", domain: str = LAMPS) -> list[str]:
    """The lines that a trajectory of the lamps becomes."""
    Path(name).write_text(text)
    return cleancli.convert(domain, name).texts["experience.jsonl"].splitlines()


# ---- there and back


TRIED = """
domain tried {
  types      { lamp }
  predicates { lit(?l - lamp) }
  actions    { press(?l - lamp) }
  rule press: press(?l) { when not lit(?l) then 1: lit(?l) }
  reward     { goal }
}
"""


def test_actions_that_no_rule_covers_are_counted() -> None:
    """PPDDL forbids them, and who learns preconditions from a trajectory would think them possible."""
    before: list[object] = []
    after: list[object] = [["lit", ["a"], True]]
    for states, count in (((before, after, after, after), 2), ((before, after), 0)):
        lines = [
            json.dumps(
                {"action": "press", "arguments": ["a"], "objects": {"a": "lamp"}, "before": b, "after": a}
            )
            for b, a in pairwise(states)
        ]
        Path("seen.jsonl").write_text("\n".join(lines) + "\n")
        notes = cleancli.convert(TRIED, "seen.jsonl", to="ppddl").notes
        told = [note for note in notes if "no rule covers" in note and "in the trajectories" in note]
        assert [note.split(" in the")[0] for note in told] == [f"{count} actions"] * bool(count)


def test_a_trajectory_is_what_tools_that_learn_models_read() -> None:
    Path("Two.jsonl").write_text("\n".join(LAMPS_LINES) + "\n")
    made = cleancli.convert(LAMPS, "Two.jsonl", to="ppddl")
    assert list(made.texts) == ["lamps.pddl", "Two.trajectory"]
    assert made.texts["Two.trajectory"] == LAMPS_TRAJECTORY
    assert any("how long actions took" in note for note in made.notes)
    assert experience(LAMPS_TRAJECTORY) == LAMPS_LINES


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 5])
def test_what_was_written_comes_back_to_the_letter(seed: int) -> None:
    if seed < 2:
        domain = load_domain(Source("domain.nid", EVERYTHING))
        problem = load_problem(Source("problem.nid", SOME), domain)
    else:
        generator = Generator(seed)
        domain, problem = generator.domain(), generator.problem()
    before = list(drawn(domain, problem, seed))
    lines = "".join(f"{encode(each, {})}\n" for each in before)
    Path("seen.jsonl").write_text(lines)
    assert list(read_experience("seen.jsonl", domain)) == before
    given = print_domain(domain)
    made = cleancli.convert(given, "seen.jsonl", to="ppddl")
    traced = [name for name in made.texts if name.endswith(".trajectory")]
    assert len(traced) == len(list(chains_of(before))) > 1
    made.write("out")
    back = cleancli.convert(given, *(Path("out", name) for name in sorted(traced)))
    assert back.texts == {"experience.jsonl": lines}
    assert back.domain == given


# ---- files of others


def test_a_file_may_have_no_head_and_no_objects_where_the_problem_is_given() -> None:
    problem = (
        "problem p { domain = lamps objects { A1 b - lamp } init { heat(A1) = 0, heat(b) = 0 } horizon = 1 }"
    )
    text = """
    ((:init (beside a1 b) (= (heat a1) 0) (= (heat b) 2) (not (on b)))
    (operator: (press--press_cold a1))
    (:state (beside a1 b) (heat-1 a1) (heat-2 b) (on a1)))
    """
    Path("n.trajectory").write_text(text)
    made = cleancli.convert(LAMPS, problem, "n.trajectory")
    assert made.texts["experience.jsonl"].splitlines() == LAMPS_LINES[:1]
    text = """
    (:trajectory

    (:state (beside a1 b) (heat-0 a1) (heat-2 b))

    (:action ( press a1))

    (:state (beside a1 b) (heat-1 a1) (heat-2 b) (on a1))

    )
    """
    Path("n.trajectory").write_text(text)
    assert cleancli.convert(LAMPS, problem, "n.trajectory").texts == made.texts


PDDL = """
(define (domain stacks)
  (:types block - object)
  (:predicates (on-table ?b - block) (painted ?b - block))
  (:action pick-up :parameters (?b - block) :precondition (on-table ?b) :effect (not (on-table ?b))))
"""


def test_experience_of_a_pddl_domain_is_of_the_domain_that_it_becomes() -> None:
    Path("stacks.pddl").write_text(PDDL)
    Path("one.trajectory").write_text(
        "(trajectory (:objects block-1 - block) (:init (on-table block-1) (painted block-1))"
        " (:action (pick-up block-1)) (:state (painted block-1)))"
    )
    made = cleancli.convert("stacks.pddl", "one.trajectory")
    assert list(made.texts) == ["stacks.nid", "experience.jsonl"]
    assert json.loads(made.texts["experience.jsonl"]) == {
        "action": "pick_up", "arguments": ["block_1"], "objects": {"block_1": "block"},
        "before": [["on_table", ["block_1"], True]], "after": [],
    }  # fmt: skip
    assert "left out: predicates that the domain lacks: painted" in made.notes
    made.write("out")
    converted = load_domain(Source("stacks.nid", made.domain))
    assert [each.action for each in read_experience("out/experience.jsonl", converted)] == ["pick_up"]


# ---- mistakes


@pytest.mark.parametrize(
    ("old", "new", "code", "message"),
    [
        ("(heat-0 A1)", "(heat-0 c)", "E916", "unknown object `c`"),
        ("(heat-0 A1)", "(heat-0 A1) (heat-1 A1)", "E916", "`heat(A1)` is `0` and `1` at once"),
        ("(heat-0 A1)", "(heat-0 A1 b)", "E916", "`heat` takes 1 object, not 2"),
        ("(heat-0 A1)", "(hot A1)", "E916", "unknown predicate `hot`"),
        ("(heat-0 A1)", "(= (heat A1) 3)", "E916", "`heat` is no function of `lamps` that has this value"),
        ("(heat-0 A1)", "heat-0", "E915", "expected a fact, but there is `heat-0`"),
        ("(press b)", "(push b)", "E916", "unknown action `push`"),
        ("(press b)", "(press)", "E916", "`press` takes 1 object, not 0"),
        ("(:action (press b))\n", "", "E915", "expected `(:action ...)` or `(operator: ...)`"),
        ("(:action (press A1))", "(:state)", "E915", "expected `(:action ...)` or `(operator: ...)`"),
        (" - lamp", " - bulb", "E916", "`lamps` has no type `bulb`"),
        ("A1 b - lamp", "A1 a1 b - lamp", "E916", "the object `a1` is listed twice"),
        ("(:state (beside A1 b) (beside b A1) (heat-0 b) (heat-1 A1))", "", "E915", "no state stands behind"),
    ],
)
def test_mistakes_are_located(old: str, new: str, code: str, message: str) -> None:
    text = LAMPS_TRAJECTORY.replace(old, new, 1)
    assert text != LAMPS_TRAJECTORY
    with pytest.raises(Refused) as refused:
        experience(text)
    found = [each for each in refused.value.diagnostics if message in each.message]
    assert [each.code for each in found] == [code], str(refused.value)
    assert found[0].span is not None
    assert found[0].span.path == "lamps.trajectory"
    assert 0 <= found[0].span.start < len(text)


def test_an_object_of_another_type_is_refused() -> None:
    text = "(:trajectory (:objects b - box s - shelf) (:init (open s)) (:action (ring)) (:state))"
    with pytest.raises(Refused, match="`s` is of type `shelf`, and `open` is for `box`"):
        experience(text, domain=EVERYTHING)


PIECES = ("", "(", ")", "(:state", " - ", "?", ";", "not", "\x01", "é", "((((", "1e9", "=")


def test_damaged_files_are_refused_or_read() -> None:
    assert count_read(experience, LAMPS_TRAJECTORY, PIECES, times=400, seed=3) > 5


def test_what_makes_no_sense_is_told() -> None:
    Path("two.jsonl").write_text("\n".join(LAMPS_LINES) + "\n")
    Path("two.trajectory").write_text(LAMPS_TRAJECTORY)
    with pytest.raises(BadOption, match="RDDL has no files of experience"):
        cleancli.convert(LAMPS, "two.jsonl", to="rddl")
    with pytest.raises(BadOption, match=r"trajectories and data.dat become experience"):
        cleancli.convert(LAMPS, "two.trajectory", to="ppddl")
    with pytest.raises(BadOption, match="say what to write"):
        cleancli.convert(LAMPS, "two.jsonl")
    with pytest.raises(BadOption, match="give one domain"):
        cleancli.convert("two.trajectory")
    Path("bad.jsonl").write_text('{"action": "press"}\n')
    with pytest.raises(Refused, match="E701"):
        cleancli.convert(LAMPS, "bad.jsonl", to="ppddl")


def test_the_command_takes_experience_there_and_back(capsys: pytest.CaptureFixture[str]) -> None:
    Path("lamps.nid").write_text(LAMPS)
    Path("two.jsonl").write_text(f"{LAMPS_LINES[0]}\n{LAMPS_LINES[0]}\n")
    assert run(["convert", "lamps.nid", "two.jsonl", "--to", "ppddl", "--out", "out"]) == 0
    assert "out/two-1.trajectory and out/two-2.trajectory" in capsys.readouterr().out
    traced = ["out/two-1.trajectory", "out/two-2.trajectory"]
    assert run(["convert", "lamps.nid", *traced, "--out", "back", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["domain"], data["problems"]) == (None, [])
    assert data["experience"] == [str(Path("back", "experience.jsonl"))]
    assert Path("back", "experience.jsonl").read_text() == f"{LAMPS_LINES[0]}\n{LAMPS_LINES[0]}\n"
    assert run(["learn", "lamps.nid", "back/experience.jsonl"]) == 0
