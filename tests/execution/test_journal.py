"""Records of a journal as lines, and what a crash or an editor may have left of them."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as some

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.model import Fact
from cleancli.recording import journal
from cleancli.recording.folder import JOURNAL
from cleancli.recording.journal import (
    Acted,
    AreaEntry,
    Chance,
    Ended,
    Expected,
    Failed,
    Interrupted,
    Looked,
    Planned,
    Record,
    Resumed,
    Spent,
    Started,
    StepEntry,
    decode,
    encode,
    read_journal,
)

# What docs/runs.md says that numbers may be.
numbers = some.floats(allow_nan=False, allow_infinity=False)
times = some.floats(0, 1e9)
metres, lengths = some.floats(-1e3, 1e3), some.floats(0, 1e3)
shares = some.floats(0, 1)
kinds = some.sampled_from(["change", "nothing", "noise"])
names = some.text(max_size=8)
facts = some.builds(
    journal.FactEntry, names, some.lists(names).map(tuple), some.booleans() | some.integers(0, 9) | names
)
seconds = some.dictionaries(names, times)
centres, axes = some.tuples(metres, metres), some.tuples(lengths, lengths)
areas = some.builds(AreaEntry, names, centres, axes, some.floats(-10, 10), lengths, some.booleans())
chances = some.builds(Chance, shares, kinds, some.lists(facts).map(tuple))
expected = some.builds(Expected, some.none() | names, some.lists(chances, max_size=3).map(tuple))
arguments = some.lists(names, max_size=3).map(tuple)
steps = some.lists(some.builds(StepEntry, names, arguments, expected), max_size=3).map(tuple)
count = some.integers(0, 99)
records: some.SearchStrategy[Record] = some.one_of(
    some.builds(
        Looked,
        times,
        times,
        some.lists(areas, max_size=3).map(tuple),
        some.dictionaries(names, names),
        some.lists(facts).map(tuple),
        names,
    ),
    some.builds(Planned, names, times, numbers, names, some.none() | shares, steps),
    some.builds(Started, count, names, arguments, expected),
    some.builds(
        Acted,
        count,
        names,
        arguments,
        times,
        seconds,
        some.none() | names,
        some.none() | count,
        some.lists(facts).map(tuple),
    ),
    some.builds(Failed, count, names, arguments, times, seconds, names),
    some.builds(Spent, seconds),
    some.builds(Resumed, count, count),
    some.builds(Interrupted, times),
    some.builds(Ended, times, names, some.booleans(), count, seconds),
)


def written(*lines: str) -> Source:
    return Source("journal.jsonl", "".join(line + "\n" for line in lines))


def outcomes_were_expected(some_records: list[Record]) -> bool:
    """Whether each outcome counts among those that its action was expected to have."""
    steps = [step for record in some_records if isinstance(record, Planned) for step in record.steps]
    if any(step.follows is not None and step.follows >= len(step.expected.outcomes) for step in steps):
        return False
    pairs = [r for r in some_records if isinstance(r, Started | Acted | Failed)]
    return all(
        not isinstance(start, Started)
        or not isinstance(end, Acted)
        or end.outcome is None
        or end.outcome < len(start.expected.outcomes)
        for start, end in pairwise(pairs)
    )


@given(some.lists(records, max_size=4).filter(outcomes_were_expected))
def test_records_are_read_as_written(some_records: list[Record]) -> None:
    found = decode(written(*map(encode, some_records)))
    assert found.records == tuple(some_records)
    assert not found.cut


def test_every_record_has_a_name() -> None:
    assert set(journal.EVENTS.values()) == set(get_args(Record))


@given(records, some.data())
def test_a_last_line_may_be_cut_anywhere(record: Record, data: some.DataObject) -> None:
    line = encode(record)
    kept = data.draw(some.integers(1, len(line)))
    source = Source("x", encode(Resumed(2, 1)) + "\n" + line[:kept])
    assert decode(source) == journal.Journal((Resumed(2, 1),), cut=True)


def test_a_field_more_is_passed_over() -> None:
    line = {**json.loads(encode(Resumed(3, 0))), "since": "a later version"}
    assert decode(written(json.dumps(line))).records == (Resumed(3, 0),)


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("{", "truncated"),
        ("[]", "Expected `object`"),
        ('{"event": "danced"}', "'danced' is no event"),
        ('{"after": 1}', "None is no event"),
        ('{"event": ["looked"]}', "is no event"),
        ('{"event": "resumed", "after": "two", "dropped": 0}', r"Expected `int`, got `str` - at `\$.after`"),
        ('{"event": "resumed", "after": 2}', "missing required field `dropped`"),
        ("[" * 100_000, "recursion|truncated|depth|Expected"),
    ],
)
def test_what_is_no_record_is_refused_with_its_place(line: str, reason: str) -> None:
    source = written(encode(Resumed(1, 0)), line, encode(Resumed(2, 0)), line)
    with pytest.raises(Refused, match=reason) as refused:
        decode(source)
    first, second = refused.value.diagnostics
    assert first.code == second.code == "E702"
    assert first.span is not None
    assert source.text[first.span.start : first.span.end] == line
    assert refused.value.sources == (source,)


@pytest.mark.parametrize(
    ("record", "field"),
    [
        (Spent({"actions": -1.0}), "$.seconds[...]"),
        (Spent({"actions": 1e300}), "$.seconds[...]"),
        (Interrupted(-2.0), "$.clock"),
        (Failed(10**30, "push", (), 0.0, {}, ""), "$.number"),
        (Acted(1, "push", (), 0.0, {}, None, -1, ()), "$.outcome"),
        (Started(1, "push", (), Expected(None, (Chance(1.5, "change", ()),))), "$.expected.outcomes[0].prob"),
        (
            Started(1, "push", (), Expected(None, (Chance(1.0, "miracle", ()),))),  # type: ignore[arg-type]
            "$.expected.outcomes[0].kind",
        ),
        (Looked(0, 0, (AreaEntry("a1", (1e9, 0), (1, 1), 0, 0),), {}, ()), "$.areas[0].centre[0]"),
    ],
)
def test_numbers_that_no_run_has_are_refused_with_their_field(record: Record, field: str) -> None:
    with pytest.raises(Refused) as refused:
        decode(written(encode(Resumed(1, 0)), json.dumps(json.loads(encode(record)))))
    (found,) = refused.value.diagnostics
    assert found.code == "E702"
    assert field in found.message
    assert found.span is not None


def test_an_outcome_that_the_action_was_not_expected_to_have_is_refused() -> None:
    begun = Started(1, "push", (), Expected("r", (Chance(1.0, "change", ()),)))
    acted = Acted(1, "push", (), 0.0, {}, "r", 1, ())
    with pytest.raises(Refused, match="outcome 1 of an action that was expected to have 1"):
        decode(written(encode(begun), encode(acted)))
    planned = Planned("exact", 0.0, 1.0, "policy", None, (StepEntry("push", (), begun.expected, 1),))
    with pytest.raises(Refused, match="outcome 1 of an action that was expected to have 1"):
        decode(written(encode(planned)))
    without: dict[str, Any] = json.loads(encode(planned))
    del without["steps"][0]["follows"]  # as runs of earlier versions have it
    (read,) = decode(written(json.dumps(without))).records
    assert isinstance(read, Planned)
    assert read.steps[0].follows is None


def test_a_folder_without_a_journal_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_journal(tmp_path)
    (tmp_path / JOURNAL).write_text(encode(Interrupted(4.5)) + "\n", encoding="utf-8")
    assert read_journal(tmp_path).records == (Interrupted(4.5),)


def test_the_facts_of_a_state_are_written_in_order() -> None:
    """Same seed, same bytes: a set of texts has another order in every process."""
    state = frozenset(Fact("size", (f"a{n}",), size) for n, size in enumerate(("small", "big") * 20))
    state |= {Fact("dirt", (f"a{n}",)) for n in range(40)}
    written = [(entry.symbol, entry.objects, entry.value) for entry in journal.facts(state)]
    assert written == sorted(written, key=lambda entry: entry[:2])
    assert set(written) == {(fact.symbol, fact.objects, fact.value) for fact in state}
