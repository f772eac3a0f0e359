"""The renderer: carets under tabs and wide characters, colour on request, hostile text, JSON."""

from __future__ import annotations

import json

from cleancli.language.diagnostics import Diagnostic, Level, Source, Span
from cleancli.language.lines import Lines
from cleancli.language.render import as_json, render


def _shown(text: str, part: str) -> list[str]:
    start = text.index(part)
    diagnostic = Diagnostic("E999", "message", Span("f", start, start + len(part)), "label", "advice")
    return render([diagnostic], [Source("f", text)]).splitlines()


def test_layout() -> None:
    assert _shown("one\ntwo three\n", "three") == [
        "f:2:5: error[E999]: message",
        "  |",
        "2 | two three",
        "  |     ^^^^^ label",
        "  = help: advice",
    ]


def test_carets_follow_tabs_and_wide_characters() -> None:
    assert _shown("a\tbad", "bad")[2:4] == ["1 | a   bad", "  |     ^^^ label"]
    assert _shown("見る bad", "bad")[2:4] == ["1 | 見る bad", "  |      ^^^ label"]
    assert _shown("e\u0301 bad", "bad")[3] == "  |   ^^^ label"
    assert _shown("見る", "見")[3] == "  | ^^ label"


def test_a_span_over_lines_is_marked_to_the_end_of_the_first() -> None:
    assert _shown("ab cd\r\nef", "cd\r\nef")[3] == "  |    ^^ label"


def test_long_lines_are_cut_around_the_place() -> None:
    lines = _shown("x" * 1000 + "bad" + "y" * 1000, "bad")
    assert len(lines[2]) < 200
    column = lines[3].index("^")
    assert lines[2][column : column + 3] == "bad"


def test_control_characters_do_not_reach_the_terminal() -> None:
    assert "\x1b" not in "".join(_shown("\x1b[31m bad", "bad"))
    assert "\x1b[31m" in render([Diagnostic("E1", "m", None)], [], colour=True)


def test_places_with_every_line_end() -> None:
    lines = Lines("a\r\nb\rc\nd")
    assert [lines.place(i) for i in (0, 3, 5, 7, 8)] == [(1, 1), (2, 1), (3, 1), (4, 1), (4, 2)]
    assert [lines.line(n) for n in (1, 2, 3, 4)] == ["a", "b", "c", "d"]


def test_json() -> None:
    source = Source("f", "one\ntwo")
    located = Diagnostic("E1", "m", Span("f", 4, 7), help="h", level=Level.WARNING)
    data = as_json([located, Diagnostic("E2", "n", None)], [source])
    assert json.loads(json.dumps(data)) == data
    assert data[0] == {
        "code": "E1",
        "level": "warning",
        "message": "m",
        "path": "f",
        "line": 2,
        "column": 1,
        "end_line": 2,
        "end_column": 4,
        "label": "",
        "help": "h",
    }
    assert data[1]["line"] is None
