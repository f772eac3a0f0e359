"""Our lexer reads what the contextual one of lark reads, and refuses what that one refuses, and why."""

from __future__ import annotations

import functools
import random
from pathlib import Path

import pytest
from lark import Lark, Token, UnexpectedInput, UnexpectedToken

from cleancli.language.parsing.grammar import grammar
from cleancli.resources import shipped

FILES = [*shipped("domains").glob("*.nid"), *Path(__file__).parents[1].rglob("*.nid")]
TEXTS = sorted({path.read_bytes().decode("utf-8", "replace") for path in FILES if path.stat().st_size < 2000})
BITS = (
    *(
        "not",
        "priorx",
        "prior0.3",
        "640x480",
        "m",
        "x",
        "then",
        "rest",
        "nothingx",
        "s",
        "1/4",
        "1.5.2",
        "<=",
    ),
    *("+=", "..", "@", "?", "é", "mü", "#c\n", '"'),
)
"""What is put into texts: words that begin with a reserved one, units, signs that begin another one."""


@functools.cache
def reference() -> Lark:
    text = (shipped("grammar") / "nid.lark").read_text(encoding="utf-8")
    return Lark(text, parser="lalr", propagate_positions=True, maybe_placeholders=True)


def read_by(parser: Lark, text: str) -> list[object]:
    """The tokens that the parser takes, then what it says of the whole text."""
    steps = parser.parse_interactive(text)
    found: list[object] = []
    try:
        found += [_shown(token) for token in steps.iter_parse()]
        found.append(parser.parse(text))
    except UnexpectedInput:
        with pytest.raises(UnexpectedInput) as error:
            parser.parse(text)
        found.append(_said(error.value))
    return found


def _shown(token: Token) -> tuple[object, ...]:
    return token.type, str(token), token.start_pos, token.end_pos


def _said(error: UnexpectedInput) -> tuple[object, ...]:
    if isinstance(error, UnexpectedToken):
        return _shown(error.token), frozenset(error.accepts)
    return type(error).__name__, error.pos_in_stream


def damaged(text: str, rng: random.Random) -> str:
    """The text with a bit put in, cut out, or copied from elsewhere."""
    at, there = rng.randrange(len(text) + 1), rng.randrange(len(text) + 1)
    length = rng.randint(1, 12)
    return rng.choice(
        [
            text[:at] + rng.choice(BITS) + text[at:],
            text[:at] + text[at + length :],
            text[:at] + text[there : there + length] + text[at:],
        ]
    )


def test_there_are_texts() -> None:
    assert len(TEXTS) > 100


def test_texts_are_read_as_lark_reads_them() -> None:
    for text in TEXTS:
        assert read_by(grammar(), text) == read_by(reference(), text), text


@pytest.mark.parametrize("seed", range(4))
def test_damaged_texts_are_read_as_lark_reads_them(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(150):
        text = damaged(rng.choice(TEXTS), rng)
        assert read_by(grammar(), text) == read_by(reference(), text), text
