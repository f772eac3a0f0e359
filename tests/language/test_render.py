"""The renderer: carets under tabs and wide characters, colour on request, hostile text, JSON."""

from __future__ import annotations

import json
from pathlib import PurePath
from typing import Any

import pytest

from cleancli import __version__
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source, Span
from cleancli.language.diagnostics.render import as_json, as_sarif, render
from cleancli.language.diagnostics.source_lines import Lines


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


SARIF: dict[str, Any] = {
    "$schema": str,
    "version": "2.1.0",
    "runs": [
        {
            "tool": {"driver": {"name": "cleancli", "version": __version__, "rules": [{"id": str}]}},
            "columnKind": "unicodeCodePoints",
            "newlineSequences": [str],
            "results": [
                {
                    "ruleId": str,
                    "ruleIndex": int,
                    "level": str,
                    "message": {"text": str},
                    "locations?": [
                        {
                            "physicalLocation": {
                                "artifactLocation": {"uri": str},
                                "region?": {
                                    "startLine": int,
                                    "startColumn": int,
                                    "endLine": int,
                                    "endColumn": int,
                                },
                            }
                        }
                    ],
                }
            ],
        }
    ],
}
"""What a run may hold, after the standard: a type or value for each key, `?` behind what may be left out."""


def _assert_fits(data: object, shape: object, where: str = "sarif") -> None:
    if isinstance(shape, dict):
        assert isinstance(data, dict), where
        needed = {key for key in shape if not key.endswith("?")}
        assert needed <= data.keys() <= {key.removesuffix("?") for key in shape}, where
        for key, value in data.items():
            _assert_fits(value, shape.get(key, shape.get(f"{key}?")), f"{where}.{key}")
    elif isinstance(shape, list):
        assert isinstance(data, list), where
        for item in data:
            _assert_fits(item, shape[0], f"{where}[]")
    else:
        assert isinstance(data, shape) if isinstance(shape, type) else data == shape, where


def _sarif_run(diagnostics: list[Diagnostic], source: Source) -> dict[str, Any]:
    data = as_sarif(diagnostics, [source], PurePath("/work"))
    assert json.loads(json.dumps(data)) == data
    _assert_fits(data, SARIF)
    run: dict[str, Any] = data["runs"][0]
    for result in run["results"]:
        assert run["tool"]["driver"]["rules"][result["ruleIndex"]]["id"] == result["ruleId"]
        assert result["level"] in {"none", "note", "warning", "error"}
    return run


def test_sarif() -> None:
    source = Source("/work/a b/é.nid", "one\r\n𝛼 two\rthree")
    start = source.text.index("two")
    found = [
        Diagnostic("E2", "m", Span(source.path, start, len(source.text)), "label", "advice"),
        Diagnostic("E1", "n", None, level=Level.WARNING),
        Diagnostic("E2", "o", Span("elsewhere.nid", 3, 4)),
    ]
    run = _sarif_run(found, source)
    assert [rule["id"] for rule in run["tool"]["driver"]["rules"]] == ["E1", "E2"]
    first, second, third = run["results"]
    assert first["message"]["text"] == "m\nlabel\nhelp: advice"
    place = first["locations"][0]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == "a%20b/%C3%A9.nid"
    assert place["region"] == {"startLine": 2, "startColumn": 3, "endLine": 3, "endColumn": 6}
    assert (second["level"], "locations" in second) == ("warning", False)
    assert "region" not in third["locations"][0]["physicalLocation"]


@pytest.mark.parametrize(
    ("name", "uri"),
    [
        ("sub/x.nid", "sub/x.nid"),
        ("/work/x.nid", "x.nid"),
        ("/other/x.nid", "file:///other/x.nid"),
        ("<stdin>", "%3Cstdin%3E"),
        ("a#b%.nid", "a%23b%25.nid"),
    ],
)
def test_sarif_names_files_relative_to_the_folder(name: str, uri: str) -> None:
    run = _sarif_run([Diagnostic("E1", "m", Span(name, 0, 1))], Source(name, "x"))
    assert run["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == uri


def test_sarif_without_results_is_a_run_too() -> None:
    assert _sarif_run([], Source("x", ""))["results"] == []
