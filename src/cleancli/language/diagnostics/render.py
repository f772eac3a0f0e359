"""Diagnostics as text for people and as data for programs."""

from __future__ import annotations

import os
import unicodedata
from collections.abc import Callable, Iterable
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

from cleancli import __version__
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source, Span, printable
from cleancli.language.diagnostics.source_lines import Lines

_TAB = 4
_WIDEST = 160
_MOST_CARETS = 76
_LONGEST = 2000
"""Characters of a message."""
_RED, _YELLOW, _CYAN, _BOLD, _PLAIN = "\x1b[31m", "\x1b[33m", "\x1b[36m", "\x1b[1m", "\x1b[0m"


def render(diagnostics: Iterable[Diagnostic], sources: Iterable[Source], colour: bool = False) -> str:
    """All diagnostics with their source lines; `colour` adds ANSI codes."""
    lines = {source.path: Lines(source.text) for source in sources}
    return "\n".join(_one(diagnostic, lines, colour) for diagnostic in diagnostics)


def _one(diagnostic: Diagnostic, lines: dict[str, Lines], colour: bool) -> str:
    paint = _painter(colour)
    tone = _RED if diagnostic.level is Level.ERROR else _YELLOW
    title = paint(f"{diagnostic.level.value}[{diagnostic.code}]", tone)
    head = f"{title}: {paint(_safe(diagnostic.message), _BOLD)}"
    span = diagnostic.span
    gutter = "  "
    parts = []
    if span is None:
        parts.append(f"{head}\n")
    elif span.path not in lines:
        parts.append(f"{_safe(span.path)}: {head}\n")
    else:
        line, column = lines[span.path].place(span.start)
        parts.append(f"{_safe(span.path)}:{line}:{column}: {head}\n")
        gutter = " " * (len(str(line)) + 1)
        source, carets = _excerpt(lines[span.path], span)
        label = f" {_safe(diagnostic.label)}" if diagnostic.label else ""
        parts.append(f"{gutter}|\n{line} | {source}\n{gutter}| {carets[0]}{paint(carets[1] + label, tone)}\n")
    if diagnostic.help:
        parts.append(f"{gutter}= {paint('help', _CYAN)}: {_safe(diagnostic.help)}\n")
    return "".join(parts)


def _painter(colour: bool) -> Callable[[str, str], str]:
    return (lambda text, tone: f"{tone}{text}{_PLAIN}") if colour else (lambda text, tone: text)


def _excerpt(lines: Lines, span: Span) -> tuple[str, tuple[str, str]]:
    """The source line as shown, and the blanks before and the carets under the span's first line."""
    number, column = lines.place(span.start)
    last, end = lines.place(span.end)
    raw = lines.line(number)
    first = column - 1
    stop = end - 1 if last == number else len(raw)
    cut = max(0, first - _WIDEST // 2)
    shown, widths = _expand(raw[cut : cut + _WIDEST])
    first, stop = first - cut, min(stop - cut, len(widths))
    before = sum(widths[:first])
    return shown, (" " * before, "^" * min(max(1, sum(widths[first:stop])), _MOST_CARETS))


def _expand(text: str) -> tuple[str, list[int]]:
    """The text fit for a terminal, and how many columns each of its characters takes there."""
    shown: list[str] = []
    widths: list[int] = []
    for character in text:
        if character == "\t":
            width = _TAB - sum(widths) % _TAB
            shown.append(" " * width)
        else:
            shown.append(printable(character))
            width = sum(map(_width, shown[-1]))
        widths.append(width)
    return "".join(shown), widths


def _width(character: str) -> int:
    if unicodedata.combining(character) or unicodedata.category(character) in ("Cf", "Me", "Mn"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1


def _safe(text: str) -> str:
    """A message, or a part of one, as a terminal may have it; a name of a million letters is cut."""
    return printable(
        text if len(text) <= _LONGEST else f"{text[: _LONGEST // 2]} ... {text[-_LONGEST // 2 :]}"
    )


def as_json(
    diagnostics: Iterable[Diagnostic], sources: Iterable[Source], left_out: int = 0
) -> list[dict[str, str | int | None]]:
    """Diagnostics as dictionaries; lines and columns from 1, the end exclusive, None without a place.

    Where some are left out, the last dictionary is a note that says how many.
    """
    lines = {source.path: Lines(source.text) for source in sources}
    found = [_as_dict(diagnostic, lines) for diagnostic in diagnostics]
    if left_out:
        note = _as_dict(Diagnostic("", _left_out(left_out), None), lines)
        found.append({**note, "level": "note", "left_out": left_out})
    return found


def _left_out(number: int) -> str:
    return f"{number} more {'is' if number == 1 else 'are'} left out: `cleancli check --all` gives all"


def _as_dict(diagnostic: Diagnostic, lines: dict[str, Lines]) -> dict[str, str | int | None]:
    span = diagnostic.span
    located = span is not None and span.path in lines
    line, column = lines[span.path].place(span.start) if span is not None and located else (None, None)
    end_line, end_column = lines[span.path].place(span.end) if span is not None and located else (None, None)
    return {
        "code": diagnostic.code,
        "level": diagnostic.level.value,
        "message": diagnostic.message,
        "path": None if span is None else span.path,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
        "label": diagnostic.label,
        "help": diagnostic.help,
    }


def as_sarif(
    diagnostics: Iterable[Diagnostic],
    sources: Iterable[Source],
    folder: PurePath | None = None,
    left_out: int = 0,
) -> dict[str, Any]:
    """Diagnostics as one run of SARIF 2.1.0, the format in which code hosts and editors take results.

    Lines and columns are those of `as_json`. Files are named as the sources are, but those below `folder`
    relative to it, and other absolute paths as file URIs. A notification says how many are left out.
    """
    found = tuple(diagnostics)
    lines = {source.path: Lines(source.text) for source in sources}
    codes = sorted({diagnostic.code for diagnostic in found})
    driver = {"name": "cleancli", "version": __version__, "rules": [{"id": code} for code in codes]}
    run: dict[str, Any] = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "newlineSequences": ["\r\n", "\n", "\r"],
        "results": [_as_result(diagnostic, codes, lines, folder) for diagnostic in found],
    }
    if left_out:
        note = {"level": "note", "message": {"text": _left_out(left_out)}}
        run["invocations"] = [{"executionSuccessful": True, "toolExecutionNotifications": [note]}]
        run["properties"] = {"leftOut": left_out}
    return {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [run],
    }


def _as_result(
    diagnostic: Diagnostic, codes: list[str], lines: dict[str, Lines], folder: PurePath | None
) -> dict[str, Any]:
    said = (diagnostic.message, diagnostic.label, diagnostic.help and f"help: {diagnostic.help}")
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": codes.index(diagnostic.code),
        "level": diagnostic.level.value,
        "message": {"text": "\n".join(part for part in said if part)},
    }
    span = diagnostic.span
    if span is not None:
        location: dict[str, Any] = {"artifactLocation": {"uri": _uri(span.path, folder)}}
        if span.path in lines:
            location["region"] = _region(span, lines[span.path])
        result["locations"] = [{"physicalLocation": location}]
    return result


def _region(span: Span, lines: Lines) -> dict[str, int]:
    line, column = lines.place(span.start)
    end_line, end_column = lines.place(span.end)
    return {"startLine": line, "startColumn": column, "endLine": end_line, "endColumn": end_column}


def _uri(name: str, folder: PurePath | None) -> str:
    path = PurePath(name)
    if folder is not None and path.is_relative_to(folder):
        path = path.relative_to(folder)
    return path.as_uri() if path.is_absolute() else quote(os.fsencode(path.as_posix()))
