"""What a domain says of where its numbers come from: the `learned` block (docs/language.md)."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.language.checking.learned import WORDS
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.text_edit import Edit, apply_edits
from cleancli.language.load import checked_domain, load_domain, read_source
from cleancli.language.model import Domain, Experience, Knowledge
from cleancli.language.printing.formatter import layout
from cleancli.language.printing.learned_edits import learned_edits
from cleancli.language.printing.printer import print_experience, print_learned
from cleancli.language.refactoring.rename import rename
from cleancli.learning.estimate import ESTIMATORS
from support.random_texts import comments_of

TEXT = """\
domain d {
  types      { area }
  predicates { dirt(?a - area) }
  derived    { n := count ?a - area: dirt(?a) }
  actions    { wipe(?a - area) }
  rule wiped: wipe(?a) {
    when dirt(?a)
    then 0.8: not dirt(?a)
         rest: noise
  }
  reward { decrease(n) }  # what pays
  # the end
}
# behind it
"""
OWN = "learned { estimator = m  m = 3  match = strict }"
OTHER = "learned { estimator = likelihood  m = 0  match = shared }"

NAMES = st.text(st.characters(exclude_categories=("Cc", "Cf", "Cs", "Zl", "Zp"), exclude_characters='"'))
HASHES = st.text("0123456789abcdef", min_size=16, max_size=16)
KNOWLEDGE = st.builds(
    Knowledge,
    st.sampled_from(["decreasing_m", "m", "likelihood"]),
    st.floats(0, 1_000_000),
    st.sampled_from(["shared", "strict"]),
    st.lists(
        st.builds(Experience, NAMES, HASHES, st.integers(1, 1_000_000_000)),
        max_size=4,
        unique_by=lambda each: each.sha256,
    ).map(tuple),
    st.floats(0, 0.5),
)


def read(text: str) -> Domain:
    return load_domain(Source("d.nid", text))


def with_block(learned: Knowledge) -> str:
    """The text with a block at the end of its domain."""
    end = read(TEXT).end
    assert end is not None
    return apply_edits(TEXT, [Edit(end, print_learned(learned))])


@settings(max_examples=40, deadline=None)
@given(KNOWLEDGE, KNOWLEDGE)
def test_a_printed_block_reads_as_what_was_printed(learned: Knowledge, later: Knowledge) -> None:
    text = with_block(learned)
    found = read(text).learned
    assert found == learned
    assert found.span is not None
    replaced = apply_edits(text, [Edit(found.span, print_learned(later).strip())])
    assert read(replaced).learned == later
    for each in (text, replaced):
        assert layout(each) == each, "the block has the layout of fmt"
        assert each.startswith(TEXT[: TEXT.index("}\n# behind")])
        assert each.endswith("}\n# behind it\n")


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ('6" rag.jsonl', "6' rag.jsonl"),
        ("two\nlines\r", r"two\x0alines\x0d"),
        ("no\0text\udcff", r"no\x00text\xff"),
        ("turned\u202e", r"turned\u202e"),
    ],
)
def test_signs_that_cannot_stand_in_quotation_marks_are_written_out(name: str, written: str) -> None:
    learned = Knowledge("m", 10.0, "shared", (Experience(name, "0123456789abcdef", 1),))
    text = with_block(learned)
    assert text.encode("utf-8")
    found = read(text).learned
    assert found is not None
    assert [each.name for each in found.experience] == [written]


def test_signs_that_steer_a_terminal_are_written_out_when_they_are_read() -> None:
    experience = 'experience "a\x1b[2J" [sha256 = "0123456789abcdef", transitions = 1]'
    learned = read(TEXT.replace("  # the end", f"  {OWN[:-1]} {experience} }}")).learned
    assert learned is not None
    assert [each.name for each in learned.experience] == [r"a\x1b[2J"]
    assert read(with_block(learned)).learned == learned


COMMENTED = """\
  learned {
    match     = shared        # how
    # why
    estimator = decreasing_m
    m         = 10.0
    # the first run
    experience "a" [sha256 = "000000000000000a", transitions = 1]
    experience "b" [sha256 = "000000000000000b", transitions = 2]  # the second run

    # the third run
    experience "c" [sha256 = "000000000000000c", transitions = 3]
  }
"""
A, B, C, D = (Experience(name, f"000000000000000{name}", 1 + n) for n, name in enumerate("abcd"))


def edited(text: str, learned: Knowledge) -> str:
    """The text after it was made to say what is known now."""
    source = Source("d.nid", text)
    return apply_edits(text, learned_edits(load_domain(source), source, learned))


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(
    ("counted", "lost"),
    [
        ((A, B, C), ()),
        ((A, B, C, D), ()),
        ((B, C), ('"a"',)),
        ((A, C, D), ('"b"',)),
        ((D,), ('"a"', '"b"', '"c"')),
    ],
)
def test_a_block_changes_by_what_is_new_and_comments_stay(
    counted: tuple[Experience, ...], lost: tuple[str, ...], line_end: str
) -> None:
    before = TEXT.replace("  # the end\n", COMMENTED).replace("\n", line_end)
    learned = Knowledge("decreasing_m", 10.0, "strict", counted)
    forgetful = dataclasses.replace(learned, forgetting=0.25)
    remembering = edited(edited(before, forgetful), learned)
    assert read(edited(before, forgetful)).learned == forgetful
    assert read(remembering).learned == learned
    assert comments_of(remembering) == comments_of(before)
    after = edited(before, learned)
    assert read(after).learned == learned
    assert comments_of(after) == comments_of(before)
    gone = [name for name in lost if name != '"b"']  # whose comment keeps its line
    assert after.count(line_end) == before.count(line_end) + (D in counted) - len(gone)
    assert "m         = 10.0" in after, "what has not changed stays as it is written"
    assert not set(lost) & set(after.split())
    assert edited(after, learned) == after


@pytest.mark.parametrize("block", ["", OTHER, OTHER.replace("}", f"{print_experience([B])[0]} }}")])
def test_a_text_on_one_line_gets_lines_of_its_own(block: str) -> None:
    learned = Knowledge("m", 2.5, "strict", (B, D))
    after = edited(
        f'domain d {{ include "base.nid" {block} }}'.replace('include "base.nid"', "reward { cost }"), learned
    )
    assert read(after).learned == learned
    assert layout(layout(after)) == layout(after)


def test_the_block_of_an_included_file_stays(tmp_path: Path) -> None:
    base, top = tmp_path / "base.nid", tmp_path / "top.nid"
    base.write_text(TEXT.replace("  # the end", f"  {OTHER}"), encoding="utf-8")
    top.write_text('domain top {\n  include "base.nid"\n}\n', encoding="utf-8")
    learned = Knowledge("m", 2.5, "strict", (A,))
    edits = learned_edits(load_domain(read_source(top)), read_source(top), learned)
    assert {Path(edit.span.path) for edit in edits} == {top}
    top.write_text(apply_edits(top.read_text(encoding="utf-8"), edits), encoding="utf-8")
    assert load_domain(read_source(top)).learned == learned


def test_every_estimator_can_be_said() -> None:
    assert {name.replace("-", "_") for name in ESTIMATORS} <= {*WORDS["estimator"]}


def test_what_a_domain_does_not_say_is_not_known() -> None:
    assert read(TEXT).learned is None


def test_rename_leaves_the_block_alone() -> None:
    text = TEXT.replace("wipe", "estimator").replace("n :=", "m :=").replace("(n)", "(m)")
    text = text.replace("  # the end", f"  {OWN}")
    for old, new in (("estimator", "clean"), ("m", "left")):
        edits = rename([Source("d.nid", text)], old, new)["d.nid"]
        changed = apply_edits(text, edits)
        assert OWN in changed
        assert read(changed).learned == read(text).learned


def test_the_block_of_the_file_that_is_asked_for_counts(tmp_path: Path) -> None:
    (tmp_path / "base.nid").write_text(TEXT.replace("  # the end", f"  {OTHER}"), encoding="utf-8")
    top = tmp_path / "top.nid"
    top.write_text(f'domain top {{ include "base.nid" {OWN} }}', encoding="utf-8")
    learned = load_domain(read_source(top)).learned
    assert learned == Knowledge("m", 3.0, "strict", ())
    assert learned.span is not None
    assert Path(learned.span.path) == top


def test_without_one_of_its_own_that_of_the_included_file_does(tmp_path: Path) -> None:
    (tmp_path / "base.nid").write_text(TEXT.replace("  # the end", f"  {OTHER}"), encoding="utf-8")
    top = tmp_path / "top.nid"
    top.write_text('domain top { include "base.nid" }', encoding="utf-8")
    domain = load_domain(read_source(top))
    assert domain.learned == Knowledge("likelihood", 0.0, "shared", ())
    assert domain.learned.span is not None
    assert Path(domain.learned.span.path).name == "base.nid"
    # A new block goes into the file that was asked for, and then counts.
    assert domain.end is not None
    assert Path(domain.end.path) == top
    top.write_text(apply_edits(top.read_text(), [Edit(domain.end, OWN)]), encoding="utf-8")
    assert load_domain(read_source(top)).learned == Knowledge("m", 3.0, "strict", ())


def test_two_included_blocks_need_one_in_the_including_file(tmp_path: Path) -> None:
    (tmp_path / "one.nid").write_text(TEXT.replace("  # the end", f"  {OTHER}"), encoding="utf-8")
    (tmp_path / "two.nid").write_text(f"domain two {{ {OTHER} }}", encoding="utf-8")
    top = tmp_path / "top.nid"
    both = 'include "one.nid" include "two.nid"'
    top.write_text(f"domain top {{ {both} }}", encoding="utf-8")
    (found,) = checked_domain(read_source(top)).diagnostics
    assert (found.code, found.message) == ("E216", "a second `learned` is included")
    top.write_text(f"domain top {{ {both} {OWN} }}", encoding="utf-8")
    assert checked_domain(read_source(top)).diagnostics == ()
