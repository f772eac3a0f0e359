"""Which experience is counted: each transition once, and nothing that was counted is lost unsaid."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from cleancli.api.learned import LearningResult
from cleancli.api.lessons import learn
from cleancli.api.structures import learn_structure
from cleancli.cli.main import run
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import load_domain, read_source

TEXT = """domain coins {
  types { coin }
  predicates { heads(?c - coin) }
  derived { up := count ?c - coin: heads(?c) }
  actions { flip(?c - coin) }
  rule flip_it: flip(?c) {
    when not heads(?c)
    then 0.5: heads(?c)
         rest: nothing
  }
  reward { decrease(up) }
}
"""
HEADS, TAILS = (
    json.dumps(
        {
            "action": "flip",
            "arguments": ["c"],
            "objects": {"c": "coin"},
            "before": [],
            "after": after,
            "number": 1,
        }
    )
    + "\n"
    for after in ([["heads", ["c"], True]], [])
)


@pytest.fixture
def domain(tmp_path: Path) -> Path:
    path = tmp_path / "coins.nid"
    path.write_text(TEXT, encoding="utf-8")
    return path


def experience(folder: Path, name: str, *lines: str) -> Path:
    path = folder / name
    path.write_text("".join(lines), encoding="utf-8")
    return path


def seen(path: Path) -> list[float]:
    """How often each outcome was seen, by what the text says."""
    return [float(outcome.seen or 0) for outcome in load_domain(read_source(path)).rules[0].outcomes]


def counted(path: Path) -> dict[str, int]:
    """The experience that the text names, with its number of transitions."""
    noted = load_domain(read_source(path)).learned
    return {} if noted is None else {Path(each.name).name: each.transitions for each in noted.experience}


def notes(result: LearningResult, about: str) -> list[str]:
    return [note for note in result.notes if about in note]


def test_the_file_says_what_its_counts_rest_on(domain: Path, tmp_path: Path) -> None:
    learn(domain, experience(tmp_path, "a.jsonl", HEADS, TAILS, HEADS), estimator="m", m=4.0, write=True)
    assert seen(domain) == [2, 1]
    assert counted(domain) == {"a.jsonl": 3}
    noted = load_domain(read_source(domain)).learned
    assert noted is not None
    assert (noted.estimator, noted.m, noted.match) == ("m", 4, "shared")
    # Learning again from the same changes nothing, and goes by what the file says of how to.
    assert learn(domain, tmp_path / "a.jsonl").diff == ""


def test_what_was_counted_is_not_dropped_unless_that_is_asked_for(domain: Path, tmp_path: Path) -> None:
    first = experience(tmp_path, "a.jsonl", HEADS, HEADS)
    second = experience(tmp_path, "b.jsonl", TAILS)
    learn(domain, first, write=True)
    before = domain.read_text(encoding="utf-8")
    with pytest.raises(Refused) as refused:
        learn(domain, second, write=True)
    (told,) = refused.value.diagnostics
    assert (told.code, "a.jsonl (2 transitions, " in told.message) == ("E707", True)
    assert "--add" in str(told.help)
    assert domain.read_text(encoding="utf-8") == before
    learn(domain, second, replace=True, write=True)
    assert (seen(domain), counted(domain)) == ([0, 1], {"b.jsonl": 1})


def test_adding_counts_on_and_counts_nothing_twice(domain: Path, tmp_path: Path) -> None:
    first = experience(tmp_path, "a.jsonl", HEADS, HEADS)
    second = experience(tmp_path, "b.jsonl", TAILS)
    learn(domain, first, write=True)
    learn(domain, second, add=True, write=True)
    assert (seen(domain), counted(domain)) == ([2, 1], {"a.jsonl": 2, "b.jsonl": 1})
    both = domain.read_text(encoding="utf-8")
    again = learn(domain, first, second, add=True, write=True)
    assert len(notes(again, "counted already")) == 2
    assert domain.read_text(encoding="utf-8") == both
    # All at once says the same.
    domain.write_text(TEXT, encoding="utf-8")
    learn(domain, first, second, write=True)
    assert domain.read_text(encoding="utf-8") == both


def test_a_file_that_has_grown_is_known_again(domain: Path, tmp_path: Path) -> None:
    path = experience(tmp_path, "a.jsonl", HEADS, HEADS)
    learn(domain, path, write=True)
    experience(tmp_path, "a.jsonl", HEADS, HEADS, TAILS, TAILS)
    learn(domain, path, add=True, write=True)
    assert (seen(domain), counted(domain)) == ([2, 2], {"a.jsonl": 4})
    # Without --add as well: what was counted is among what is given.
    experience(tmp_path, "a.jsonl", HEADS, HEADS, TAILS, TAILS, HEADS)
    learn(domain, path, write=True)
    assert (seen(domain), counted(domain)) == ([3, 2], {"a.jsonl": 5})


def test_the_same_experience_counts_once(domain: Path, tmp_path: Path) -> None:
    long = experience(tmp_path, "a.jsonl", HEADS, TAILS, TAILS)
    same = Path(shutil.copy(long, tmp_path / "b.jsonl"))
    beginning = experience(tmp_path, "c.jsonl", HEADS, TAILS)
    for given in ([long, same, beginning], [beginning, same, long]):
        result = learn(domain, *given)
        assert [outcome.seen for outcome in result.rules[0].outcomes] == [1, 2]
        assert len(notes(result, "given twice")) == 1
        assert len(notes(result, "the beginning of another")) == 1


def test_a_cut_line_and_an_empty_file_are_told(domain: Path, tmp_path: Path) -> None:
    cut = experience(tmp_path, "a.jsonl", HEADS, "\n", TAILS[:30])
    empty = experience(tmp_path, "b.jsonl", "\n")
    result = learn(domain, cut, empty, write=True)
    assert len(notes(result, "a.jsonl: the last line has no end")) == 1
    assert len(notes(result, "b.jsonl: there is no transition in it")) == 1
    assert counted(domain) == {"a.jsonl": 1}


def test_a_line_that_contradicts_itself_is_refused(domain: Path, tmp_path: Path) -> None:
    twice = HEADS.replace('"before": []', '"before": [["heads", ["c"], true], ["heads", ["c"], false]]')
    with pytest.raises(Refused) as refused:
        learn(domain, experience(tmp_path, "a.jsonl", HEADS, twice))
    assert "before gives heads(c) two values" in refused.value.diagnostics[0].message


def test_counts_that_come_from_nowhere_are_told_of(domain: Path, tmp_path: Path) -> None:
    domain.write_text(TEXT.replace("0.5:", "0.5 [prior 0.5, seen 7]:"), encoding="utf-8")
    given = experience(tmp_path, "a.jsonl", HEADS)
    assert len(notes(learn(domain, given), "does not say which experience")) == 1
    added = learn(domain, given, add=True)
    assert not notes(added, "does not say")
    assert added.rules[0].outcomes[0].seen == 8


def test_a_copy_is_written_and_the_domain_stays(domain: Path, tmp_path: Path) -> None:
    given = experience(tmp_path, "a.jsonl", HEADS)
    copy = tmp_path / "learned.nid"
    words = ["learn", str(domain), str(given), "--output", str(copy)]
    assert run(words) == 0
    assert domain.read_text(encoding="utf-8") == TEXT
    assert seen(copy) == [1, 0]
    once = copy.read_text(encoding="utf-8")
    assert run(words) == 1, "nothing is written over"
    assert copy.read_text(encoding="utf-8") == once
    assert run([*words, "--write"]) == 2


def test_experience_that_rules_were_learned_whole_from_is_said_to_count_twice(
    domain: Path, tmp_path: Path
) -> None:
    """docs/learning.md: they note no counts; given again, what they were learned from counts twice."""
    first = experience(tmp_path, "a.jsonl", *[HEADS, HEADS, TAILS] * 40)
    text = learn_structure(domain, first, vocabulary=True).changes[0].after
    domain.write_text(text, encoding="utf-8")
    assert counted(domain) == {"a.jsonl": 120}
    assert "[prior" not in text
    assert "seen" not in text
    grown = experience(tmp_path, "grown.jsonl", *[HEADS, HEADS, TAILS] * 40, HEADS)
    for given in ([first], [grown], [first, experience(tmp_path, "b.jsonl", TAILS)]):
        for replace in (False, True):
            assert notes(learn(domain, *given, replace=replace), "it counts twice") != []
    assert domain.read_text(encoding="utf-8") == text
    assert notes(learn(domain, first, add=True), "counted already")
    assert notes(learn(domain, grown, add=True, write=True), "counts twice") == []
    assert sum(seen(domain)) == 1, "only what is new"
    assert sum(counted(domain).values()) == 121, "the first file is the beginning of the grown one"
