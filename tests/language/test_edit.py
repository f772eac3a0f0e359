"""Edits change what they name and nothing else; a write replaces the file whole or not at all."""

from __future__ import annotations

import os
import random
import stat
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.files.replace import Replacement, replace_file, write_all, write_atomically
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.text_edit import Edit, apply_edits
from cleancli.language.load import load_domain, read_source
from cleancli.language.model import Outcome
from cleancli.language.parsing.trivia import tokens_of
from cleancli.resources import shipped

HERE = Path(__file__).parent
DOMAINS = [read_source(path).text for path in [*sorted(shipped("domains").glob("*.nid")), HERE / "small.nid"]]


def _edit(start: int, end: int, text: str) -> Edit:
    return Edit(Span("x", start, end), text)


def test_edits_mean_the_old_offsets() -> None:
    assert apply_edits("abcdef", [_edit(4, 5, "EE"), _edit(0, 1, ""), _edit(2, 2, "-")]) == "b-cdEEf"
    assert apply_edits("abc", []) == "abc"
    assert apply_edits("abc", [_edit(1, 2, "x"), _edit(2, 3, "y")]) == "axy"


@pytest.mark.parametrize(
    "edits",
    [
        [_edit(0, 2, ""), _edit(1, 3, "")],
        [_edit(1, 1, "a"), _edit(1, 1, "b")],
        [_edit(2, 9, "")],
        [_edit(-1, 1, "")],
        [_edit(2, 1, "")],
    ],
)
def test_impossible_edits_are_refused(edits: list[Edit]) -> None:
    with pytest.raises(ValueError, match=r"overlap|outside"):
        apply_edits("abcd", edits)


@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_only_the_probability_differs(tmp_path: Path, line_end: str) -> None:
    text = (HERE / "small.nid").read_text(encoding="utf-8").replace("0.8:", "0.80  [ seen 3 ]   :")
    path = tmp_path / "small.nid"
    path.write_bytes(text.replace("\n", line_end).encode())
    source = read_source(path)
    outcome = load_domain(source).rules[0].outcomes[0]
    assert outcome.probability_span is not None
    assert outcome.weight_span is not None
    assert source.text[outcome.weight_span.start : outcome.weight_span.end] == "0.80  [ seen 3 ]"
    write_atomically(path, apply_edits(source.text, [Edit(outcome.probability_span, "0.75")]), source.text)
    assert path.read_bytes() == text.replace("0.80 ", "0.75 ").replace("\n", line_end).encode()


def _numbers_of(text: str) -> list[Span]:
    """Where the numbers of outcomes stand, one list for all rules."""
    outcomes: list[Outcome] = [o for rule in load_domain(Source("x", text)).rules for o in rule.outcomes]
    return [o.probability_span for o in outcomes if o.probability_span is not None and not o.is_rest]


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(DOMAINS), st.integers(0, 2**32), st.sampled_from(["\n", "\r\n", "\r"]))
def test_an_edit_of_probabilities_changes_those_tokens_alone(text: str, seed: int, line_end: str) -> None:
    """Whatever the spacing: all that stands between tokens stays, and so do all other tokens."""
    generator = random.Random(seed)
    gaps = [
        " ",
        "   ",
        "\t ",
        f" {line_end}",
        line_end * 2,
        f"  # 0.5: {line_end}\t",
        f"{line_end}# é𝄞{line_end}",
    ]
    text = "".join(token.text + generator.choice(gaps) for token in tokens_of(text))
    spans = _numbers_of(text)
    chosen = generator.sample(spans, generator.randint(1, len(spans)))
    edits = [Edit(span, generator.choice(["0.123456", "1/7", "0", "1"])) for span in chosen]
    new = apply_edits(text, edits)
    by_start = {edit.span.start: edit for edit in edits}
    moved = 0
    for old, now in zip(tokens_of(text), tokens_of(new), strict=True):
        edit = by_start.get(old.start)
        assert now.text == (old.text if edit is None else edit.replacement)
        assert (now.above, now.remarks, now.start - old.start) == (old.above, old.remarks, moved)
        moved += len(now.text) - len(old.text)
    back = [Edit(_moved(edit, edits), text[edit.span.start : edit.span.end]) for edit in edits]
    assert apply_edits(new, back) == text


def _moved(edit: Edit, edits: list[Edit]) -> Span:
    """Where a replacement stands in the new text."""
    before = [e for e in edits if e.span.start < edit.span.start]
    start = edit.span.start + sum(len(e.replacement) - (e.span.end - e.span.start) for e in before)
    return Span(edit.span.path, start, start + len(edit.replacement))


def test_several_files_change_together_or_not_at_all(tmp_path: Path) -> None:
    one, other, new = (tmp_path / name for name in ("one.nid", "other.nid", "new.nid"))
    one.write_text("1")
    other.write_text("2, but another has been here")
    with pytest.raises(Refused) as refused:
        write_all([Replacement(one, "one", "1"), Replacement(other, "two", "2"), Replacement(one, "", "x")])
    assert [d.message.split("`")[1] for d in refused.value.diagnostics] == [str(other), str(one)]
    assert one.read_text() == "1"
    write_all([Replacement(one, "one", "1"), Replacement(new, "three", None)])
    assert (one.read_text(), new.read_text()) == ("one", "three")


@pytest.mark.parametrize("obstacle", ["read-only", "no folder"])
def test_an_obstacle_to_one_file_spares_all(obstacle: str, tmp_path: Path) -> None:
    one, other = tmp_path / "one.nid", tmp_path / "other.nid"
    one.write_text("1")
    other.write_text("2")
    last = Replacement(other, "two", "2")
    if obstacle == "read-only":
        other.chmod(0o444)
    else:
        last = Replacement(tmp_path / "none" / "new.nid", "two", None)
    with pytest.raises(OSError, match=r"read-only|No such file"):
        write_all([Replacement(one, "one", "1"), last])
    assert (one.read_text(), other.read_text()) == ("1", "2")
    assert sorted(os.listdir(tmp_path)) == ["one.nid", "other.nid"]


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.nid"
    path.write_text("old")

    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        write_atomically(path, "new", "old")
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.nid"]


def test_a_file_changed_meanwhile_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.nid"
    path.write_text("theirs")
    with pytest.raises(Refused) as refused:
        write_atomically(path, "ours", "old")
    assert refused.value.diagnostics[0].code == "E006"
    assert path.read_text() == "theirs"
    assert os.listdir(tmp_path) == ["a.nid"]


def test_a_new_file_must_be_new(tmp_path: Path) -> None:
    path = tmp_path / "a.nid"
    write_atomically(path, "first", None)
    assert path.read_text() == "first"
    with pytest.raises(Refused, match="already exists"):
        write_atomically(path, "second", None)


def test_permissions_and_links_stay(tmp_path: Path) -> None:
    target, link = tmp_path / "target.nid", tmp_path / "link.nid"
    target.write_text("old")
    target.chmod(0o640)
    link.symlink_to(target)
    write_atomically(link, "new", "old")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640


def test_a_folder_that_does_not_exist(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        replace_file(tmp_path / "none" / "a.nid", "text")
