"""Commands and the Python interface take PPDDL files as they are, and tell mistakes at their places there."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

import cleancli
from cleancli.cli.main import run

TIDY = Path(__file__).parent.parent / "conversion" / "tidy"
FILES = ("tidy.pddl", "tidy_two.pddl")


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in FILES:
        shutil.copy(TIDY / name, tmp_path)
    monkeypatch.chdir(tmp_path)


def changed(name: str, old: str, new: str) -> None:
    text = Path(name).read_text(encoding="utf-8")
    assert old in text
    Path(name).write_text(text.replace(old, new), encoding="utf-8")


@pytest.mark.parametrize(
    "line",
    [
        "check {0} {1}",
        "check {1}",
        "check {0}",
        "show {0}",
        "show {0} {1}",
        "compile {0} {1}",
        "plan {0} {1}",
    ],
)
def test_commands_take_the_files(line: str) -> None:
    assert run(line.format(*FILES).split()) == 0


@pytest.mark.parametrize("folders", [("", ""), ("domains/", "problems/")])
def test_a_problem_is_checked_with_its_domain_by_either_suffix(
    folders: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    named = [
        f"{folder}{name.replace('.pddl', '.ppddl')}" for folder, name in zip(folders, FILES, strict=True)
    ]
    for old, new in zip(FILES, named, strict=True):
        Path(new).parent.mkdir(exist_ok=True)
        Path(old).rename(new)
    for files in (named, named[::-1], ["."]):
        assert run(["check", *files]) == 0
        assert capsys.readouterr().out.endswith("in 2 files\n")


def test_a_domain_that_is_given_goes_before_one_that_lies_beside_a_problem(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """docs/commands.md: of folders that are given, each problem has the domain beside it."""
    for folder in ("one", "two"):
        Path(folder).mkdir()
        for name in FILES:
            Path(folder, name).write_text(Path(name).read_text(encoding="utf-8"), encoding="utf-8")
    changed("one/tidy.pddl", "(dirt ?", "(dust ?")
    told = "the predicate `dirt` is not declared"
    files = ["one/tidy.pddl", "two/tidy_two.pddl"]
    for given, is_told in ((["two"], False), (["one/tidy.pddl", "two"], False), (files, True)):
        run(["check", *given])
        shown = "".join(capsys.readouterr()).splitlines()
        assert any(told in line for line in shown if line.startswith("two/")) == is_told


def test_mistakes_are_found_in_folders(capsys: pytest.CaptureFixture[str]) -> None:
    changed("tidy_two.pddl", "(dirt a2)", "(dirt a5)")
    assert run(["check", "."]) == 1
    assert "tidy_two.pddl:4:26: error[E916]: unknown object `a5`" in capsys.readouterr().out


def test_what_is_planned_is_what_is_planned_for_converted_files(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["convert", *FILES, "--out", "out"]) == 0
    capsys.readouterr()
    plans = []
    for files in (FILES, ("out/tidy.nid", "out/two.nid"), ("tidy.pddl", "out/two.nid")):
        assert run(["plan", *files, "--json"]) == 0
        told = json.loads(capsys.readouterr().out)
        plans.append((told["plan"], told["value"], told["problem"]))
    assert plans[0] == plans[1] == plans[2]


REWARDED = """(define (domain lamps) (:requirements :typing :rewards :probabilistic-effects) (:types lamp)
  (:predicates (lit ?l - lamp))
  (:action press :parameters (?l - lamp) :precondition (not (lit ?l))
    :effect (probabilistic 0.5 (and (lit ?l) (increase (reward) 1)))))
(define (problem two) (:domain lamps) (:objects a b - lamp) (:init) (:metric maximize (reward)))
"""


def test_a_horizon_that_no_text_states_is_told_as_a_guess(capsys: pytest.CaptureFixture[str]) -> None:
    Path("lamps.pddl").write_text(REWARDED, encoding="utf-8")
    guess = "the horizon of 40 actions is a guess, because PPDDL has none: `cleancli convert` makes"
    assert run(["plan", "lamps.pddl", "lamps.pddl"]) == 0
    assert guess in capsys.readouterr().out
    assert run(["convert", "lamps.pddl", "--out", "out"]) == 0
    capsys.readouterr()
    for files in (FILES, ("out/lamps.nid", "out/two.nid"), ("lamps.pddl", "out/two.nid")):
        assert run(["plan", *files]) == 0
        assert "guess" not in capsys.readouterr().out


def test_a_goal_gets_the_horizon_that_is_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    """docs/commands.md: then the goal is worth as much as `:goal-reward` says, less what actions cost."""
    changed("tidy_two.pddl", "(:metric", "(:goal-reward 50) (:metric")
    assert run(["convert", *FILES, "--out", "out", "--horizon", "8"]) == 0
    assert "horizon  = 8\n" in Path("out/two.nid").read_text(encoding="utf-8")
    assert "50 * goal - cost" in Path("out/tidy.nid").read_text(encoding="utf-8")
    capsys.readouterr()
    assert run(["plan", "out/tidy.nid", "out/two.nid", "--planner", "likeliest"]) == 0
    assert "within 8 actions" in capsys.readouterr().out


def test_one_file_may_hold_both(capsys: pytest.CaptureFixture[str]) -> None:
    both = "".join(Path(name).read_text(encoding="utf-8") for name in FILES)
    Path("both.pddl").write_text(both, encoding="utf-8")
    assert run(["check", "both.pddl"]) == 0
    assert run(["explain", "both.pddl", "both.pddl", "move(a1, a2)"]) == 0
    assert "move" in capsys.readouterr().out


def test_python_takes_paths_and_texts() -> None:
    texts = [Path(name).read_text(encoding="utf-8") for name in FILES]
    of_texts = cleancli.plan(*texts)
    of_paths = cleancli.plan(*map(Path, FILES))
    assert of_texts.plan == of_paths.plan
    assert str(cleancli.load_domain(texts[0])) == texts[0]
    loaded = cleancli.load_domain("tidy.pddl")
    assert cleancli.plan(loaded, "tidy_two.pddl").plan == of_paths.plan


def test_chance_for_each_object_needs_the_problem(capsys: pytest.CaptureFixture[str]) -> None:
    old = "(probabilistic 0.1 (forall (?m - area) (when (next-to ?a ?m) (wet ?m))))"
    changed("tidy.pddl", old, "(forall (?m - area) (probabilistic 0.1 (wet ?m)))")
    assert run(["plan", *FILES]) == 0
    assert run(["show", "tidy.pddl"]) == 1
    assert "tidy.pddl:15:20: error[E917]" in capsys.readouterr().err


POST = """
(define (domain post)
  (:types box)
  (:predicates (is-empty ?b - box) (at-box ?b - box))
  (:functions (total-cost) (walk-time ?b - box))
  (:action walk-to
    :parameters (?from ?to - box)
    :precondition (and (at-box ?from) (not (= ?from ?to)))
    :effect (and (increase (total-cost) (walk-time ?to))
                 (probabilistic 0.9 (and (not (at-box ?from)) (at-box ?to)))))
  (:action empty-box
    :parameters (?b - box)
    :precondition (at-box ?b)
    :effect (and (increase (total-cost) 1) (probabilistic 0.4 (is-empty ?b)))))
"""
BOXES = """
(define (problem boxes) (:domain post)
  (:objects mill lane - box)
  (:init (at-box mill) (= (total-cost) 0) (= (walk-time mill) 3) (= (walk-time lane) 5))
  (:goal (and (is-empty mill) (is-empty lane)))
  (:metric minimize (total-cost)))
"""


def test_a_domain_may_leave_values_to_its_problems_where_it_is_checked(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """docs/commands.md, PDDL and PPDDL: costs by static functions, whose values a problem states."""
    Path("pair").mkdir()
    Path("pair/post.pddl").write_text(POST, encoding="utf-8")
    Path("pair/boxes.pddl").write_text(BOXES, encoding="utf-8")
    for files in (["pair"], ["pair/post.pddl", "pair/boxes.pddl"], ["pair/post.pddl"]):
        assert run(["check", *files]) == 0
        assert capsys.readouterr().out.startswith("0 mistakes in")
    assert run(["convert", "pair/post.pddl", "pair/boxes.pddl", "--out", "nid"]) == 0
    assert run(["convert", "nid/post.nid", "nid/boxes.nid", "--to", "ppddl", "--out", "back"]) == 0
    assert run(["check", "back"]) == 0
    capsys.readouterr()
    assert run(["show", "pair/post.pddl"]) == 1
    assert "give the problem too" in capsys.readouterr().err
    changed("pair/boxes.pddl", "(walk-time lane) 5", "(walk-time lake) 5")
    changed("pair/post.pddl", "(walk-time ?to)", "(walk-time ?too)")
    assert run(["check", "pair"]) == 1
    told = capsys.readouterr().out
    assert "post.pddl:9:52: error[E916]: the variable `?too` is not bound" in told


def test_a_condition_that_asks_for_one_of_several_is_taken(capsys: pytest.CaptureFixture[str]) -> None:
    """docs/from-pddl.md: `or` is a part of a condition, whether files are converted or not."""
    spill = "(probabilistic 0.1 (forall (?m - area) (when (next-to ?a ?m) (wet ?m))))"
    changed("tidy.pddl", f"(when (wet ?a)\n                   {spill})", "")
    assert run(["convert", *FILES, "--out", "out"]) == 0
    assert "(not wet(?a) or not full(bin))" in Path("out/tidy.nid").read_text(encoding="utf-8")
    assert run(["check", *FILES]) == 0
    capsys.readouterr()
    plans = []
    for files in (FILES, ("out/tidy.nid", "out/two.nid")):
        assert run(["plan", *files, "--json"]) == 0
        told = json.loads(capsys.readouterr().out)
        plans.append((told["plan"], told["value"]))
    assert plans[0] == plans[1]


def test_chance_for_each_object_is_no_mistake_of_a_domain_that_is_checked() -> None:
    old = "(probabilistic 0.1 (forall (?m - area) (when (next-to ?a ?m) (wet ?m))))"
    changed("tidy.pddl", old, "(forall (?m - area) (probabilistic 0.1 (wet ?m)))")
    assert run(["check", *FILES]) == 0
    assert run(["check", FILES[0]]) == 0


def test_mistakes_are_told_where_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    changed("tidy.pddl", "(dirt ?from)\n", "(dirtt ?from)\n")
    changed("tidy_two.pddl", "(dirt a2)", "(dirt a5)")
    assert run(["plan", *FILES]) == 1
    told = capsys.readouterr().err
    assert "tidy.pddl:19:20: error[E916]: unknown predicate `dirtt`" in told
    assert "tidy_two.pddl:4:26: error[E916]: unknown object `a5`" in told


def test_what_later_stages_find_has_a_place_too(capsys: pytest.CaptureFixture[str]) -> None:
    changed("tidy_two.pddl", "(dirt a1) (dirt a2)", "")
    changed("tidy.pddl", "(dirt ?to)", "(wet ?to)")
    assert run(["check", *FILES]) == 0
    assert "tidy_two.pddl:1:18: warning[W402]: `dirt" in capsys.readouterr().out


def test_goals_that_are_never_reached_are_told(capsys: pytest.CaptureFixture[str]) -> None:
    changed(
        "tidy_two.pddl",
        "(:goal (forall (?a - area) (not (dirt ?a))))",
        "; (:goal (dirt a2))\n  (:goal (and (full bin) (next-to a1 a2)))",
    )
    assert run(["plan", *FILES]) == 0
    assert "tidy_two.pddl:6:4: warning[W403]" in capsys.readouterr().err


EASY = """(define (problem easy) (:domain tidy) (:objects a1 - area) (:init (dirt a1)) (:goal (dirt a1))
(:metric minimize (total-cost))) """


@pytest.mark.parametrize("beside", ["", EASY])
def test_a_check_tells_of_goals_that_are_never_reached(
    beside: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/diagnostics.md, W403: at the goal that it is about, whichever problem of the file that is of."""
    changed("tidy_two.pddl", "(define", f"{beside}(define")
    changed("tidy_two.pddl", "(:goal (forall (?a - area) (not (dirt ?a))))", "(:goal (colour a2))")
    assert run(["check", *FILES]) == 0
    line = 6 if beside else 5
    assert f"tidy_two.pddl:{line}:4: warning[W403]: the goal of `two`" in capsys.readouterr().out


@pytest.mark.parametrize("text", ["", " \n", "; nothing yet\n", ")", "domain d { }"])
def test_what_is_called_pddl_is_read_as_that(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    """So that what is missing is told in its words: an empty file was to hold `domain NAME { ... }`."""
    Path("tidy.pddl").write_text(text, encoding="utf-8")
    for line in ("check {0}", "show {0}", "plan {0} {1}", "convert {0} {1} --out out"):
        assert run(line.format(*FILES).split()) == 1
        said = "".join(capsys.readouterr())
        assert "tidy.pddl:1:1: error[E915]" in said
        assert "{" not in said.partition("= help")[2]


def test_a_mistake_that_hides_the_domain_is_told_when_files_are_written(
    capsys: pytest.CaptureFixture[str],
) -> None:
    changed("tidy.pddl", "(domain tidy)", "(domain -)")
    assert run(["convert", *FILES, "--to", "ppddl", "--out", "out"]) == 1
    assert "tidy.pddl:2:17: error[E915]: expected a name" in capsys.readouterr().err


def test_a_file_beside_a_problem_that_is_no_text_hides_its_domain_from_no_check(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with Path("large.pddl").open("wb") as file:
        file.truncate(1 << 30)
    Path("latin.pddl").write_bytes("(define (domain küche))".encode("latin-1"))
    assert run(["check", FILES[1]]) == 0
    Path("empty.pddl").touch()
    assert run(["check", "empty.pddl"]) == 1
    assert "empty.pddl:1:1: error[E915]: no domain is defined" in capsys.readouterr().out
    Path(FILES[0]).unlink()
    assert run(["check", FILES[1]]) == 1
    out = capsys.readouterr().out
    assert "tidy_two.pddl:2:12: error[E916]: unknown domain `tidy`" in out
    assert "error[E005]: `large.pddl` is larger than 8 MiB" in out


@pytest.mark.parametrize(
    ("named", "told"),
    [
        ("(:domain tidyy)", "tidy_two.pddl:2:12: error[E916]: unknown domain `tidyy`"),
        ("", "tidy_two.pddl:1:1: error[E915]: this problem names no domain"),
    ],
)
def test_a_problem_whose_domain_is_not_found_says_which(
    named: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    changed("tidy_two.pddl", "(:domain tidy)", named)
    assert run(["check", *FILES]) == 1
    out = capsys.readouterr().out
    assert told in out
    assert ("did you mean `tidy`?" in out) == bool(named)


def test_a_path_that_leads_nowhere_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """By commands and in Python alike, and it is no advice to itself."""
    long = f"{'a' * 300}.pddl"
    Path("nowhere.pddl").symlink_to("gone.pddl")
    for files in ((long, FILES[1]), (FILES[0], long)):
        assert run(["plan", *files]) == 1
        assert f"error[E003]: cannot read `{long}`" in capsys.readouterr().err
        with pytest.raises(cleancli.Refused):
            cleancli.plan(*files)
    assert run(["plan", "nowhere.pddl", FILES[1]]) == 1
    assert "did you mean `nowhere.pddl`" not in capsys.readouterr().err


def test_a_goal_of_many_variables_neither_stalls_nor_fills_memory(capsys: pytest.CaptureFixture[str]) -> None:
    """A check leaves what is large to `plan`, and that says what is too large (E604)."""
    variables = [f"?v{number}" for number in range(30)]
    never = " ".join(f"(not (dirt {each}))" for each in variables)
    goal = f"(:goal (forall ({' '.join(variables)} - area) (or {never})))"
    changed("tidy_two.pddl", "(:goal (forall (?a - area) (not (dirt ?a))))", goal)
    assert run(["check", *FILES]) == 0
    assert run(["plan", *FILES]) == 1
    assert "error[E604]: the goal of `two` asks for 1,073,741,824 bindings" in capsys.readouterr().err


FERRY = """(define (domain ferry)
  (:predicates (at ?p) (next ?p ?q))
  (:action go :parameters (?p ?q) :precondition (and (at ?p) (next ?p ?q))
   :effect (and (not (at ?p)) (at ?q) (increase (reward) 1))))
"""


def test_a_check_tells_of_guessed_horizons_that_are_too_short(capsys: pytest.CaptureFixture[str]) -> None:
    """docs/diagnostics.md, W404: PPDDL can state no other."""
    places = [f"p{number}" for number in range(43)]
    steps = " ".join(f"(next {one} {other})" for one, other in pairwise(places))
    Path("ferry.pddl").write_text(
        f"{FERRY}(define (problem far) (:domain ferry)\n (:objects {' '.join(places)})"
        f" (:init (at p0) {steps})"
        "\n (:goal (at p42)) (:goal-reward 100) (:metric maximize (reward)))",
        encoding="utf-8",
    )
    assert run(["check", "ferry.pddl"]) == 0
    out = capsys.readouterr().out
    assert "ferry.pddl:7:3: warning[W404]: the goal of `far` takes at least 42 actions" in out
    assert "so this is a guess: `cleancli convert --horizon 84` states another" in out
    assert run(["convert", "ferry.pddl", "--horizon", "84", "--out", "out"]) == 0
    assert run(["check", "out"]) == 0
    assert "W404" not in capsys.readouterr().out


@pytest.mark.parametrize("mark", ["\ufeff", "\ufeff; a comment\r\n", "; a comment\r"])
def test_files_may_begin_with_a_byte_order_mark(mark: str, capsys: pytest.CaptureFixture[str]) -> None:
    """As .nid files may: editors of Windows write one. Lines may end as they do there, or as on old Macs."""
    for name in FILES:
        Path(name).write_text(mark + Path(name).read_text(encoding="utf-8"), encoding="utf-8", newline="")
    for line in ("check {0} {1}", "plan {0} {1}", "convert {0} {1} --out out"):
        assert run(line.format(*FILES).split()) == 0, capsys.readouterr().err
    changed("tidy_two.pddl", "(dirt a2)", "(dirt a5)")
    assert run(["check", *FILES]) == 1
    where = 5 if "comment" in mark else 4
    assert f"tidy_two.pddl:{where}:26: error[E916]" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["plan", "simulate"])
def test_what_a_planner_refuses_is_told_as_for_converted_files(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    changed("tidy_two.pddl", "(:metric minimize (total-cost))", "(:metric maximize (goal-probability))")
    assert run(["convert", *FILES, "--out", "out"]) == 0
    capsys.readouterr()
    told = []
    for files in (FILES, ("out/tidy.nid", "out/two.nid")):
        assert run([command, *files, "--planner", "prada"]) == 1
        told.append(capsys.readouterr().err)
    of_pddl, of_nid = (each.splitlines() for each in told)
    assert of_pddl[0].startswith("tidy_two.pddl:1:18: error[E903]: this cannot be planned")
    assert of_pddl[0].split(": ", 1)[1] == of_nid[0].split(": ", 1)[1]
    assert of_pddl[-1:] == of_nid[-1:]
    assert run([command, *FILES, "--planner", "exact", "--objective", "time"]) == 1
    assert "error[E902]: time is to discount, but `move` has no duration" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words", [["learn", "tidy.pddl", "experience.jsonl"], ["execute", *FILES, "--learn"]]
)
def test_what_is_learned_has_no_place(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    Path("experience.jsonl").write_text("", encoding="utf-8")
    assert run(words) == 1
    assert "cleancli convert" in capsys.readouterr().err


def test_the_domain_has_to_be_in_pddl_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", "cleaning", "tidy_two.pddl"]) == 1
    assert "tidy_two.pddl:1:1: error[E106]" in capsys.readouterr().err
    assert run(["plan", "tidy.pddl", "tidy.pddl"]) == 1
    assert "no problem is defined" in capsys.readouterr().err


def test_who_plans_for_nid_files_does_not_load_the_converter() -> None:
    code = (
        "import sys; from cleancli.cli.main import run;"
        "run(['plan', 'cleaning', 'three_areas', '--seed', '1']);"
        "sys.exit('cleancli.conversion.pddl.models' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], stdout=subprocess.DEVNULL).returncode == 0


PRINTROOM = """
(define (domain print-room)
  (:types job printer)
  (:predicates (done ?j - job) (jammed-up ?p - printer))
  (:action print-job
    :parameters (?j - job ?p - printer)
    :precondition (and (not (done ?j)) (not (jammed-up ?p)))
    :effect (probabilistic 0.7 (done ?j) 0.2 (jammed-up ?p)))
  (:action un-jam
    :parameters (?p - printer)
    :precondition (jammed-up ?p)
    :effect (not (jammed-up ?p))))
"""
JOBS = """
(define (problem two-jobs) (:domain print-room)
  (:objects j1 j-2 - job p-1 - printer)
  (:init)
  (:goal (and (done j1) (done j-2))))
"""


def print_room(domain: str = PRINTROOM) -> None:
    Path("room.pddl").write_text(domain, encoding="utf-8")
    Path("jobs.pddl").write_text(JOBS, encoding="utf-8")


def test_a_probability_that_is_none_hides_no_other_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    print_room(
        PRINTROOM.replace("0.2", "0.6").replace(
            "(not (jammed-up ?p)))\n    :eff", "(not (jamed ?p)))\n    :eff"
        )
    )
    assert run(["check", "room.pddl"]) == 1
    told = capsys.readouterr().out
    assert "error[E918]: the probabilities sum to 1.3" in told
    assert "error[E916]: unknown predicate `jamed`" in told
    assert "2 mistakes in 1 file" in told


def test_actions_may_be_named_as_the_files_name_them(capsys: pytest.CaptureFixture[str]) -> None:
    """docs/from-pddl.md: a hyphen is an underscore in what the files become."""
    print_room()
    told = []
    for action in (
        "print-job(j-2, p-1)",
        "print--job(j-2, p-1)",
        "print_job(j_2, p_1)",
        "(print-job j-2 p-1)",
        "( print_job j_2 p_1 )",
        "(Print-Job J-2 p-1)",
    ):
        assert run(["explain", "room.pddl", "jobs.pddl", action]) == 0
        told.append(capsys.readouterr().out)
    assert set(told) == {told[0]}
    assert told[0].startswith("print_job(j_2, p_1): covered by rule print_job")
    steps = cleancli.explain("room.pddl", "jobs.pddl", "print-job(j1 p-1)")
    assert str(steps).startswith("print_job(j1, p_1): ")
    assert run(["explain", "room.pddl", "jobs.pddl", "Print-Job(j1, p-1)"]) == 1  # as .nid files write it
    assert run(["explain", "room.pddl", "jobs.pddl", "print-jop(j1, p-1)"]) == 1
    assert "did you mean `print_job`?" in capsys.readouterr().err


def test_actions_may_be_written_as_in_pddl(capsys: pytest.CaptureFixture[str]) -> None:
    """docs/from-pddl.md: `(print-job j1 p-1)`; mistakes stand at their place."""
    print_room()
    files = ("room.pddl", "jobs.pddl")
    one, other = "(print-job j1 p-1)", "(print-job j-2 p-1)"
    after = cleancli.explain(*files, one, after=f"{other} {other}")
    assert [done.action for done in after.after] == ["print_job(j_2, p_1)"] * 2
    for text, code, marked in (
        ("(print-job j1 p-9)", "E205", "p-9"),
        ("(print-job j1)", "E208", "(print-job j1)"),
        ("(print-jop j1 p-1)", "E206", "print-jop"),
    ):
        assert run(["explain", *files, text]) == 1
        told = capsys.readouterr().err
        assert f"error[{code}]" in told
        line, marks = (each.partition("| ")[2] for each in told.splitlines()[2:4])
        assert line == text
        assert line[marks.index("^") : marks.rindex("^") + 1] == marked
    assert run(["explain", *files, "(print-job j1 p-1"]) == 1
    assert "error[E104]" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("domain", "problem"), [("room.pddl", "jobs.pddl"), ("cleaning", "three_areas"), ("sweeping", "rim")]
)
def test_files_in_the_wrong_order_are_told_so(
    domain: str, problem: str, capsys: pytest.CaptureFixture[str]
) -> None:
    print_room()
    assert run(["plan", problem, domain]) == 2
    error = capsys.readouterr().err
    assert f"`{problem}` is a problem, and `{domain}` its domain: name the domain first" in error
