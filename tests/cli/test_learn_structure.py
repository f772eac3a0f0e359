"""`cleancli learn --structure`: what it prints, writes and keeps, and what it refuses."""

from __future__ import annotations

import hashlib
import itertools
import json
import re
from pathlib import Path

import numpy as np
import pytest

import cleancli
from cleancli.cli.main import run
from cleancli.compiler.fluents import Fluent
from cleancli.language.model import Object, Value
from cleancli.language.printing.formatter import layout
from cleancli.learning.experience import Transition, encode
from support.hidden_rules import TEXTS, domain_of, starts
from support.walks import flickering, walks

WRONG = """  # mine
  rule mine: slam(?d) {
    then 1: nothing
  }
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The domain of locks with one wrong rule, and experience of the right ones."""
    monkeypatch.chdir(tmp_path)
    text = TEXTS["locks"]
    start, end = text.index("  rule slam_open"), text.index("  reward")
    Path("locks.nid").write_text(layout(text[:start] + WRONG + text[end:]), encoding="utf-8")
    first, last = text.index("  rule"), text.index("  reward")
    Path("bare.nid").write_text(layout(text[:first] + text[last:]), encoding="utf-8")
    rng = np.random.default_rng(3)
    drawn = itertools.islice(walks(domain_of("locks"), starts("locks", rng), rng), 600)
    Path("seen.jsonl").write_text("".join(f"{encode(each, {})}\n" for each in drawn), encoding="utf-8")
    return tmp_path


def said(capsys: pytest.CaptureFixture[str], command: str, code: int = 0) -> str:
    assert run(command.split()) == code
    return capsys.readouterr().out


def test_rules_from_nothing_are_written_and_learning_again_changes_nothing(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = said(capsys, "learn --structure bare.nid seen.jsonl --output new.nid")
    assert text.splitlines()[0].split() == [
        "action", "transitions", "rules", "literals", "log-likelihood", "score", "held", "out,", "each"
    ]  # fmt: skip
    assert text.splitlines()[-2] == "600 transitions of 3 actions: 4 rules learned, 0 rules dropped"
    new = Path("new.nid").read_text(encoding="utf-8")
    assert layout(new) == new
    assert [line.split()[1] for line in new.splitlines() if line.startswith("  rule")] == [
        "unlock:", "grab:", "slam_jammed:", "slam_not_jammed:"
    ]  # fmt: skip
    said(capsys, "check new.nid")
    text = said(capsys, "learn --structure new.nid seen.jsonl --write")
    assert "0 rules learned, 0 rules dropped" in text
    assert Path("new.nid").read_text(encoding="utf-8") == new
    assert said(capsys, "learn --structure --vocabulary new.nid seen.jsonl --diff").startswith("action")


COUNTED = """
  learned {
    estimator = m
    m         = 3
    match     = shared
    experience "older.jsonl" [sha256 = "8580901dd31dcd79", transitions = 893]
  }
"""


@pytest.mark.parametrize("block", ["", COUNTED])
def test_a_file_learned_from_nothing_names_its_own_experience(
    folder: Path, capsys: pytest.CaptureFixture[str], block: str
) -> None:
    """docs/learning.md: the new file rests on what it was learned from, and on nothing that the vocabulary
    had counted, so that no experience counts twice and none is asked for that has no part in it."""
    text = Path("locks.nid").read_text(encoding="utf-8")
    end = text.rindex("}")
    Path("locks.nid").write_text(text[:end] + block + text[end:], encoding="utf-8")
    said(capsys, "learn --structure --vocabulary locks.nid seen.jsonl --output mine.nid")
    mine = Path("mine.nid").read_text(encoding="utf-8")
    digest = hashlib.sha256(Path("seen.jsonl").read_bytes()).hexdigest()[:16]
    assert re.findall(r"experience .*", mine) == [
        f'experience "seen.jsonl" [sha256 = "{digest}", transitions = 600]'
    ]
    assert ("m         = 3" in mine) == bool(block)
    assert "it is counted already, as seen.jsonl" in said(capsys, "learn mine.nid seen.jsonl --add")
    assert "600 transitions" in said(capsys, "learn mine.nid seen.jsonl")
    Path("more.jsonl").write_text(Path("seen.jsonl").read_text(encoding="utf-8").split("\n", 1)[1], "utf-8")
    assert run(["learn", "mine.nid", "more.jsonl"]) == 1
    assert "seen.jsonl (600 transitions" in capsys.readouterr().err
    assert said(capsys, "learn --structure mine.nid seen.jsonl").startswith("action")


def test_durations_of_a_file_learned_from_nothing_are_counted_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = """domain lamp {
  types { lamp }
  predicates { lit(?l - lamp) }
  actions { switch(?l - lamp) [duration = 4 s [prior 2 s, seen 7]] }
  reward { - cost }
"""
    Path("lamp.nid").write_text(f"{text}{COUNTED}}}\n", encoding="utf-8")
    line = {"action": "switch", "arguments": ["l"], "objects": {"l": "lamp"}, "seconds": 3, "transit": 0}
    switched = json.dumps({**line, "before": [], "after": [["lit", ["l"], True]]})
    Path("seen.jsonl").write_text(f"{switched}\n" * 20, encoding="utf-8")
    said(capsys, "learn --structure --vocabulary lamp.nid seen.jsonl --output mine.nid")
    mine = Path("mine.nid").read_text(encoding="utf-8")
    assert "older.jsonl" not in mine
    assert "prior 2 s, seen 20]" in mine


def test_what_outcomes_of_dropped_rules_paid_is_told(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/learning.md: no transition says what was paid, so a note names it."""
    text = Path("locks.nid").read_text(encoding="utf-8")
    paid = text.replace("then 1: nothing", "then 0.75: reward += 5\n         rest: reward += 5, cost += 1/3")
    Path("paid.nid").write_text(paid, encoding="utf-8")
    told = (
        "slam: outcomes of its %s paid `reward += 5`, `cost += 1/3`, and those of the new ones pay"
        " nothing, because experience does not tell what was paid: write it into them again"
    )
    assert told % "old rules" in said(capsys, "learn --structure paid.nid seen.jsonl").splitlines()
    vocabulary = "learn --structure --vocabulary paid.nid seen.jsonl --json"
    assert told % "rules that were left aside" in json.loads(said(capsys, vocabulary))["notes"]
    assert "paid" not in said(capsys, "learn --structure locks.nid seen.jsonl")


def test_the_truth_scores_better_than_nothing_where_nothing_is_likeliest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/learning.md: what is held out has a proper score. By the total variation from what happened a rule
    of 3 in 10 is worse than no rule: 0.42 to 0.3."""
    monkeypatch.chdir(tmp_path)
    bare = "types { spot } predicates { clean(?s - spot) } actions { rub(?s - spot) } reward { - cost }"
    Path("rub.nid").write_text(f"domain rub {{ {bare} }}\n", encoding="utf-8")
    line = {"action": "rub", "arguments": ["s"], "objects": {"s": "spot"}, "before": []}
    lines = [json.dumps({**line, "after": [["clean", ["s"], True]] * (n % 10 < 3)}) for n in range(1000)]
    Path("seen.jsonl").write_text("".join(f"{each}\n" for each in lines), encoding="utf-8")
    text = said(capsys, "learn --structure rub.nid seen.jsonl")
    assert (
        "held out, each: the mean log-likelihood of 200 transitions that were held out, by the rules as they"
        " were, and by rules that were learned from the others; nearer to 0 is better"
    ) in text.splitlines()
    found = json.loads(said(capsys, "learn --structure rub.nid seen.jsonl --json"))["together"]
    held = np.random.default_rng(0).permutation(1000)[:200]
    share, learned = float((held % 10 < 3).mean()), (300 - (held % 10 < 3).sum()) / 800
    foretold = share * np.log(learned) + (1 - share) * np.log(1 - learned)
    assert found["after"]["held_out_log_likelihood"] == pytest.approx(foretold, abs=1e-3)
    assert found["before"]["held_out_log_likelihood"] < foretold


def test_rules_that_explain_as_well_stay_with_their_comments(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = said(capsys, "learn --structure locks.nid seen.jsonl")
    assert text.startswith("--- locks.nid\n+++ locks.nid (learned)\n")
    assert "-  # mine\n-  rule mine: slam(?d) {\n" in text
    assert "+  rule slam_jammed: slam(?d) {\n" in text
    data = json.loads(said(capsys, "learn --structure locks.nid seen.jsonl --json"))
    slam = next(each for each in data["actions"] if each["action"] == "slam")
    assert not slam["kept"]
    assert slam["after"]["score"] > slam["before"]["score"]
    assert slam["after"]["held_out_log_likelihood"] > slam["before"]["held_out_log_likelihood"]
    assert data["together"]["transitions"] == 600
    assert data["together"]["kept"] == ["unlock", "grab"]


def test_of_three_rules_of_an_action_the_wrong_one_gives_way(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = layout(TEXTS["locks"]).replace("0.3: not jammed(?d)", "0.3: open(?d)  # a guess")
    Path("guess.nid").write_text(text.replace("  rule slam_open", "  # shuts it\n  rule slam_open"))
    said(capsys, "learn --structure guess.nid seen.jsonl --write")
    lines = Path("guess.nid").read_text(encoding="utf-8").splitlines()
    assert [line.strip() for line in lines if line.strip().startswith(("rule", "#"))] == [
        "rule unlock: unlock(?d) {",
        "rule grab: grab(?k) {",
        "# shuts it",
        "rule slam_open: slam(?d) {",
        "rule slam_jammed: slam(?d) {",
    ]
    assert not any("a guess" in line for line in lines)


def test_how_much_is_left_unexplained_is_told(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """About as many as were seen wrongly, where one fact in a hundred is."""
    rng = np.random.default_rng(3)
    drawn = list(itertools.islice(walks(domain_of("locks"), starts("locks", rng), rng), 400))
    seen = list(flickering(domain_of("locks"), drawn, 0.01, rng))
    Path("wrong.jsonl").write_text("".join(f"{encode(each, {})}\n" for each in seen), encoding="utf-8")
    wrong = sum(one.after != other.after for one, other in zip(drawn, seen, strict=True))
    text = said(capsys, "learn --structure bare.nid wrong.jsonl --output new.nid")
    ((number, share),) = re.findall(r"^in (\d+) transitions \(([\d.]+)%\) something happened", text, re.M)
    assert 0.8 * wrong <= int(number) <= 1.2 * wrong
    assert float(share) == pytest.approx(100 * int(number) / 400, abs=0.06)
    assert "something happened" not in said(capsys, "learn --structure bare.nid seen.jsonl --output own.nid")


def test_only_asked_for_actions_and_none_with_fixed_rules_change(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "rule mine" not in said(capsys, "learn --structure --action grab locks.nid seen.jsonl")
    text = Path("locks.nid").read_text(encoding="utf-8")
    Path("locks.nid").write_text(text.replace("mine: slam(?d) {", "mine: slam(?d) [fixed] {"))
    text = said(capsys, "learn --structure --vocabulary locks.nid seen.jsonl --diff")
    assert "slam: a rule of it is fixed, so all stay\n" in text
    assert "slam_jammed" not in text


def test_the_seed_says_what_is_held_out_and_python_says_the_same(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [
        json.loads(said(capsys, f"learn --structure bare.nid seen.jsonl --json --seed {seed}"))["together"]
        for seed in (0, 0, 1)
    ]
    assert rows[0] == rows[1] != rows[2]
    assert {**rows[0], "after": None, "before": None} == {**rows[2], "after": None, "before": None}
    found = cleancli.learn_structure("bare.nid", "seen.jsonl", seed=1)
    assert found.to_dict()["together"] == rows[2]
    found.write()
    assert Path("bare.nid").read_text(encoding="utf-8") == found.text


def test_the_search_of_2007_finds_the_same_rules(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = said(capsys, "learn --structure --search pasula bare.nid seen.jsonl")
    assert "600 transitions of 3 actions: 4 rules learned" in text
    one, other = (
        cleancli.learn_structure("bare.nid", "seen.jsonl", search=each) for each in ("tree", "pasula")
    )
    assert [row.after.rules for row in one.actions] == [row.after.rules for row in other.actions]
    with pytest.raises(ValueError, match="'greedy' is not one of 'tree', 'pasula'"):
        cleancli.learn_structure("bare.nid", "seen.jsonl", search="greedy")


def test_rules_of_a_vocabulary_are_left_aside(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With rules or without, in front of the experience or behind it, the same rules are found."""
    for number, command in enumerate(
        ["--vocabulary locks.nid seen.jsonl", "seen.jsonl --vocabulary bare.nid", "bare.nid seen.jsonl"]
    ):
        said(capsys, f"learn --structure {command} --output new{number}.nid")
    rules = [
        text[text.index("  rule") : text.index("  reward")].split()
        for text in (Path(f"new{number}.nid").read_text(encoding="utf-8") for number in range(3))
    ]
    assert rules[0] == rules[1] == rules[2]


def test_any_number_of_processes_learns_the_same(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one, other = (
        said(capsys, f"learn --structure bare.nid seen.jsonl --diff --json --jobs {jobs}") for jobs in (1, 2)
    )
    assert one == other


def test_a_shipped_domain_is_not_written(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["learn", "--structure", "cleaning", "seen.jsonl", "--write"]) == 2
    capsys.readouterr()


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("--structure locks.nid seen.jsonl --add", "leave out --estimator"),
        ("--structure locks.nid seen.jsonl --m 3", "leave out --estimator"),
        ("--structure locks.nid seen.jsonl --explain", "leave out --estimator"),
        ("seen.jsonl --vocabulary locks.nid", "are for --structure: add it"),
        ("locks.nid seen.jsonl --search tree", "are for --structure: add it"),
        ("locks.nid seen.jsonl --seed 3", "are for --structure: add it"),
        ("--structure --vocabulary locks.nid", "Missing argument 'EXPERIENCE...'"),
        ("--structure locks.nid", "Missing argument 'EXPERIENCE...'"),
        ("--structure", "Missing argument 'DOMAIN'"),
        ("--structure bare.nid seen.jsonl --vocabulary locks.nid", "stands in place of DOMAIN"),
        ("--structure locks.nid seen.jsonl --action wipe", "no action `wipe`; it has unlock, grab, slam"),
    ],
)
def test_what_makes_no_sense_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], command: str, message: str
) -> None:
    assert run(["learn", *command.split()]) == 2
    assert message in capsys.readouterr().err


def test_experience_without_transitions_leaves_the_rules(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("empty.jsonl").write_text("", encoding="utf-8")
    text = said(capsys, "learn --structure locks.nid empty.jsonl --diff")
    assert "grab: the experience has no transition of it, so its rules stay as they are" in text
    assert "---" not in text


def test_a_condition_that_is_never_violated_is_dropped_and_found_from_vain_actions(tmp_path: Path) -> None:
    """As docs/learning.md tells of a good planner's own experience."""
    own, vain = tmp_path / "own.jsonl", tmp_path / "vain.jsonl"
    cleancli.simulate("cleaning", "three_areas", episodes=60, seed=1, record=own)
    done = [json.loads(line) for line in own.read_text(encoding="utf-8").splitlines()]
    assert {each["action"] for each in done} == {"moveToContainerStraight"}
    with vain.open("w", encoding="utf-8") as file:
        for each in done:
            state = [fact for fact in each["before"] if fact[:2] != ["dirt", each["arguments"]]]
            file.write(json.dumps({**each, "before": state, "after": state}) + "\n")

    def conditions(*experience: Path) -> list[str]:
        learned = cleancli.learn_structure("cleaning", *experience, vocabulary=True)
        rules = re.findall(r"^ *rule \w+: moveToContainerStraight.*?^  \}", learned.text, re.M | re.S)
        assert rules
        return [rule.partition("then")[0] for rule in rules]

    assert not any("dirt(?a)" in each for each in conditions(own))
    assert all("dirt(?a)" in each for each in conditions(own, vain))


def test_conditions_that_nothing_violated_are_named_where_rules_that_had_them_go(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """docs/learning.md, "Experience to learn rules from": the door is free of jams in all that was seen."""
    domain = """
      domain doors {
        types      { door }
        predicates { shut(?d - door)  jammed(?d - door)  red(?d - door) }
        derived    { closed := count ?d - door: shut(?d) }
        actions    { pull(?d - door)  push(?d - door) }
        rule pull_it: pull(?x) { when shut(?x), not jammed(?x)  then 1: jammed(?x) }
        rule push_it: push(?d) { when not jammed(?d)  then 1: shut(?d) }
        reward     { decrease(closed) }
      }"""
    Path("doors.nid").write_text(layout(domain), encoding="utf-8")
    objects, lines = (Object("d", "door"),), []
    for shut in (True, False):
        before: dict[Fluent, Value] = {("shut", ("d",)): True} if shut else {}
        seen = Transition("pull", ("d",), objects, before, {})
        lines += [f"{encode(seen, {'number': number})}\n" for number in range(20)]
    Path("doors.jsonl").write_text("".join(lines), encoding="utf-8")
    text = said(capsys, "learn --structure doors.nid doors.jsonl")
    assert "not jammed(?x)" not in text.split("+  rule")[1].split("action ")[0]
    assert (
        "pull: its old rules ask for `not jammed(?x)`, and the new ones do not, because it held before every"
        " transition: add experience in which it does not, or write it into them"
    ) in text
    assert "push: its old rules" not in text, "which stay"
    text = said(capsys, "learn --structure --vocabulary doors.nid doors.jsonl --action pull")
    assert "pull: its rules that were left aside ask for `not jammed(?x)`" in text
    assert "its old rules" not in said(capsys, "learn --structure locks.nid seen.jsonl --action unlock")


@pytest.mark.parametrize(
    ("jammed", "opened", "told"),
    [
        (3, 0, "in only 3 of 93 transitions it did not hold where they apply: add experience in which it"),
        (3, 1, None),  # it is seen not to matter
        (60, 0, None),  # it is seen to matter
    ],
)
def test_a_condition_that_few_transitions_speak_for_is_named_where_the_new_rules_lack_it(
    folder: Path, capsys: pytest.CaptureFixture[str], jammed: int, opened: int, told: str | None
) -> None:
    """docs/learning.md, "Experience to learn rules from": of 90 pulls of doors without jams 30 open them, and
    a few more were of jammed ones."""
    domain = """
      domain doors {
        types      { door }
        predicates { shut(?d - door)  jammed(?d - door) }
        derived    { closed := count ?d - door: shut(?d) }
        actions    { pull(?d - door) }
        rule pull: pull(?d) { when not jammed(?d) then 0.3: not shut(?d) 0.7: nothing }
        reward     { decrease(closed) }
      }"""
    Path("doors.nid").write_text(layout(domain), encoding="utf-8")
    shut: dict[Fluent, Value] = {("shut", ("d",)): True}
    stuck: dict[Fluent, Value] = {("jammed", ("d",)): True}
    seen = [(shut, dict[Fluent, Value]())] * 30 + [(shut, shut)] * 60
    seen += [(shut | stuck, stuck)] * opened + [(shut | stuck, shut | stuck)] * (jammed - opened)
    lines = (
        encode(Transition("pull", ("d",), (Object("d", "door"),), before, after), {"number": number})
        for number, (before, after) in enumerate(seen)
    )
    Path("doors.jsonl").write_text("\n".join(lines) + "\n", encoding="utf-8")
    text = said(capsys, "learn --structure --vocabulary doors.nid doors.jsonl")
    if told is None:
        assert "left aside ask for" not in text
    else:
        start = (
            "pull: its rules that were left aside ask for `not jammed(?d)`, and the new ones do not, because "
        )
        assert start + told + " does not, or write it into them" in text


def test_the_example_from_an_empty_file_to_a_plan(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Followed as docs/learning.md shows it; only how long planning took is left out there."""
    page = (Path(__file__).parents[2] / "docs" / "learning.md").read_text(encoding="utf-8")
    section = page[page.index("## From an empty file to a plan") :]
    section = section[: section.index("\n## ")]
    blocks = re.findall(r"^```(nid|python|console)\n(.*?)^```$", section, re.M | re.S)
    assert [kind for kind, _ in blocks] == ["nid", "python", "console", "nid", "nid", "console"]
    vocabulary, program, learning, rules, problem, planning = (text for _, text in blocks)
    monkeypatch.chdir(tmp_path)
    Path("breakfast.nid").write_text(vocabulary, encoding="utf-8")
    Path("two_cups.nid").write_text(problem, encoding="utf-8")
    exec(compile(program, "record.py", "exec"), {"__name__": "record"})
    for shown in (learning, planning):
        command, _, expected = shown.partition("\n")
        assert run(command.removeprefix("$ cleancli ").split()) == 0
        printed = capsys.readouterr().out
        assert printed.partition("seconds: ")[0] == expected
        assert rules in Path("learned.nid").read_text(encoding="utf-8")


@pytest.mark.parametrize("own", ["--vocabulary locks.nid", "bare.nid", "bare.nid --action grab"])
def test_without_a_transition_there_is_nothing_to_learn_from(
    folder: Path, capsys: pytest.CaptureFixture[str], own: str
) -> None:
    """E708; nothing is written."""
    lines = Path("seen.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
    others = "".join(line for line in lines if '"grab"' not in line)
    Path("few.jsonl").write_text(others if "--action" in own else "", encoding="utf-8")
    assert run(f"learn --structure {own} few.jsonl --output new.nid".split()) == 1
    assert "error[E708]: the experience has no transition of" in capsys.readouterr().err
    assert not Path("new.nid").exists()


@pytest.mark.parametrize("how", ["--structure bare.nid", "--structure --vocabulary locks.nid", "locks.nid"])
def test_a_file_that_exists_is_refused_before_anything_is_learned(
    folder: Path, capsys: pytest.CaptureFixture[str], how: str
) -> None:
    before = Path("bare.nid").read_bytes()
    assert run(f"learn {how} seen.jsonl --output bare.nid".split()) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert "error[E006]: `bare.nid` already exists" in err
    assert Path("bare.nid").read_bytes() == before


def test_where_nothing_is_new_no_byte_changes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Another layout than that of `fmt`, and other ends of lines."""
    said(capsys, "learn --structure bare.nid seen.jsonl --output new.nid")
    odd = Path("new.nid").read_text(encoding="utf-8").replace("  rule", " rule").replace("\n", "\r\n")
    Path("new.nid").write_bytes(odd.encode())
    out = said(capsys, "learn --structure new.nid seen.jsonl --write")
    assert "4 kept" in out
    assert "0 rules learned, 0 rules dropped" in out
    assert "nothing new" in out
    assert Path("new.nid").read_bytes() == odd.encode()
    assert said(capsys, "learn --structure new.nid seen.jsonl --output copy.nid")
    assert Path("copy.nid").read_bytes() == odd.encode()


def test_a_vocabulary_has_no_rule_of_what_was_never_done(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = Path("seen.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
    Path("few.jsonl").write_text("".join(each for each in lines if '"grab"' in each), encoding="utf-8")
    text = said(capsys, "learn --structure --vocabulary locks.nid few.jsonl --output new.nid")
    assert "slam: the experience has no transition of it, so it has no rule" in text
    assert "slam" not in Path("new.nid").read_text(encoding="utf-8").split("actions")[1].split("}", 1)[1]
