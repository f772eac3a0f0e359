"""The kept parser: used when it is whole and ours alone, and never needed."""

from __future__ import annotations

import os
import pickle
import re
from pathlib import Path

import pytest
from lark import UnexpectedToken

from cleancli.language.diagnostics.sink import RESERVED
from cleancli.language.find import find
from cleancli.language.parsing.grammar import grammar, keywords, read_cached, write_cached

TEXT = find("cleaning", "domains").read_text(encoding="utf-8")


@pytest.fixture
def kept(tmp_path: Path) -> Path:
    path = tmp_path / "new" / "nid.parser"
    write_cached(path, grammar())
    return path


def test_a_kept_parser_gives_the_same_trees_and_errors(kept: Path) -> None:
    parser = read_cached(kept)
    assert parser is not None
    assert parser.parse(TEXT) == grammar().parse(TEXT)
    with pytest.raises(UnexpectedToken) as unexpected:
        parser.parse("domain d { types { a - } }")
    assert unexpected.value.accepts == {"NAME"}


def test_a_damaged_or_missing_file_is_not_used(kept: Path) -> None:
    whole = kept.read_bytes()
    for damaged in (b"", whole[:40], whole[:-1], whole[:-1] + bytes([whole[-1] ^ 1]), pickle.dumps({})):
        kept.write_bytes(damaged)
        assert read_cached(kept) is None
    assert read_cached(kept.with_name("missing")) is None


@pytest.mark.skipif(os.name != "posix", reason="permissions are those of POSIX")
@pytest.mark.parametrize("mode", [0o620, 0o602])
def test_a_file_that_others_may_write_is_not_used(kept: Path, mode: int) -> None:
    kept.chmod(mode)
    assert read_cached(kept) is None


def test_a_file_that_is_kept_is_ours_alone_whatever_was_there(kept: Path) -> None:
    kept.chmod(0o666)
    before = os.umask(0)
    try:
        write_cached(kept, grammar())
        write_cached(kept.with_name("other.parser"), grammar())
    finally:
        os.umask(before)
    assert read_cached(kept) is not None
    assert read_cached(kept.with_name("other.parser")) is not None


def test_where_nothing_can_be_kept_nothing_is_left(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    write_cached(tmp_path / "file" / "nid.parser", grammar())
    (tmp_path / "taken" / "entry").mkdir(parents=True)
    write_cached(tmp_path / "taken", grammar())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "taken"]


@pytest.mark.parametrize("named", [True, False], ids=["XDG_CACHE_HOME", "HOME"])
def test_the_parser_is_kept_in_the_users_cache_folder(
    named: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("LOCALAPPDATA", raising=False)
    if named:
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "elsewhere"))
    else:
        monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    grammar.__wrapped__()
    (kept,) = tmp_path.rglob("*.parser")
    assert kept.parent == tmp_path / ("elsewhere" if named else ".cache") / "cleancli"


@pytest.mark.parametrize("folder", ["relative", os.devnull])
def test_the_parser_is_built_without_a_folder(folder: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", folder)
    assert grammar.__wrapped__().parse(TEXT) == grammar().parse(TEXT)


def test_words_that_may_stand_where_a_name_may_are_reserved() -> None:
    """Else a name that is one of them could be declared, and would mean something else where it stands.
    Words of rewards are no names of counts (E214); those of scenes, of studies and of what was learned stand
    beside names of other things."""
    states = grammar().parse_interactive("").parser_state.parse_conf.states
    words = {word for word in keywords().values() if word.isalpha()}
    beside = {
        keywords()[terminal]
        for accepted in states.values()
        if "NAME" in accepted
        for terminal in accepted
        if keywords().get(terminal) in words
    }
    of_blocks = {"compare", "cost", "decrease", "duration", "experience", "goal", "grasp", "part", "x"}
    assert beside - RESERVED == of_blocks
    assert words >= RESERVED


def test_the_page_lists_the_reserved_words() -> None:
    page = (Path(__file__).parents[2] / "docs" / "language.md").read_text(encoding="utf-8")
    (listed,) = re.findall(r"^(`.*`) are reserved\.$", page, re.M)
    assert set(re.findall(r"`(\w+)`", listed)) == RESERVED
