"""What lexemes look like agrees with the grammar, wherever a text can be parsed."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.parsing.grammar import grammar
from cleancli.language.parsing.lexemes import COMMENT, LEXEME, NAME, LexemeKind, lexemes
from cleancli.language.parsing.parse import parse
from cleancli.language.parsing.trivia import tokens_of
from cleancli.resources import shipped

FILES = [*shipped("domains").glob("*.nid"), *Path(__file__).parents[1].rglob("*.nid")]
TEXTS = sorted({path.read_bytes().decode("utf-8", "replace") for path in FILES if path.stat().st_size < 2000})


@pytest.mark.parametrize(("terminal", "pattern"), [("NAME", NAME), ("COMMENT", COMMENT)])
def test_patterns_are_those_of_the_grammar(terminal: str, pattern: str) -> None:
    line_ends = {r"\r": "\r", r"\n": "\n"}
    plain = re.sub(r"\\[rn]", lambda escape: line_ends[escape[0]], pattern)
    assert grammar().get_terminal(terminal).pattern.value == plain


def test_lexemes_of_a_text_that_parses_are_its_tokens_or_some_that_touch() -> None:
    parsed = 0
    for text in TEXTS:
        try:
            tokens = tokens_of(text)
        except Refused:
            continue
        parsed += 1
        found = [lexeme for lexeme in lexemes(text) if lexeme.kind is not LexemeKind.COMMENT]
        starts = {lexeme.start for lexeme in found}
        assert starts <= {token.start for token in tokens}, text
        apart = (b.start for a, b in pairwise(tokens[:-1]) if b.start > a.start + len(a.text))
        assert starts.issuperset(apart), text
    assert parsed > 50


def test_strings_that_nothing_closes() -> None:
    text = 'include "base }\n{'
    assert [lexeme.text for lexeme in lexemes(text)] == ["include", '"base }', "{"]
    assert [match[0] for match in LEXEME.finditer(text)] == ["include", '"', "base", "}", "{"]


def unclosed(header: str) -> list[str]:
    """What is said of a block that is not closed."""
    source = Source("f", f"domain d {{\n  {header} {{\n  types {{ a }}\n}}\n")
    return [diagnostic.message for diagnostic in parse(source).diagnostics if diagnostic.code == "E102"]


@pytest.mark.parametrize(("header", "name"), [("fläche", "fläche"), ("?tray", "tray")])
def test_a_block_is_named_by_the_whole_word_before_it(header: str, name: str) -> None:
    assert unclosed(header) == [f"the `{name}` block is never closed"]


@pytest.mark.parametrize("header", ["12", "1.5", "..", '"tray"'])
def test_a_block_without_a_word_before_it_has_no_name(header: str) -> None:
    assert unclosed(header) == ["this block is never closed"]


def test_a_half_written_header_hides_none_of_the_next_sections() -> None:
    text = "domain d {\n  types ?a { a }\n  predicates { p(?x - a) }\n}\n"
    parsed = parse(Source("f", text))
    assert parsed.root is not None
    assert len(parsed.diagnostics) == 2
