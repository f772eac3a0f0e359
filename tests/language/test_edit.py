"""Edits change what they name and nothing else; a write replaces the file whole or not at all."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from cleancli.language.diagnostics import Refused, Span
from cleancli.language.edit import Edit, apply_edits, replace_file, write_atomically
from cleancli.language.load import load_domain, read_source

HERE = Path(__file__).parent


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
