"""Whatever has been typed so far, every question is answered: no exception, and no place outside the text."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cleancli.editor.colours import colours
from cleancli.editor.completion import completions
from cleancli.editor.formatting import formatting
from cleancli.editor.hover import hover
from cleancli.editor.library import Library, document
from cleancli.editor.mistakes import mistakes
from cleancli.editor.navigation import CannotRename, definition, references, rename
from cleancli.editor.positions import Positions
from cleancli.editor.symbols import Entry, symbols
from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.text_edit import apply_edits
from support.editor_texts import DOMAIN, FOLDER, OPEN, PROBLEM, SCENE, SHIPPED

CUTS = 25
"""Prefixes of each shipped file."""


def ask_everything(path: str, text: str, offset: int) -> None:
    """Every function of the package about one place of a text."""
    library = Library({**OPEN.open, path: text})
    asked = document(Source(path, text))
    spans = [d.span for d in mistakes(asked, library) if d.span is not None]
    shown = hover(asked, offset, library)
    spans += [shown.span] if shown else []
    target = definition(asked, offset, library)
    spans += [target] if target else []
    spans += references(asked, offset, library)
    try:
        edits = rename(asked, offset, "quite_new", library)
    except CannotRename:
        edits = {}
    for name, changes in edits.items():
        held = library.document(name)
        assert held is not None
        assert apply_edits(held.source.text, changes) != held.source.text
    assert all(0 <= completion.start <= offset for completion in completions(asked, offset, library))
    spans += [edit.span for edit in formatting(asked)]
    spans += [span for entry in symbols(asked) for span in spans_of(entry)]
    spans += [Span(path, colour.start, colour.end) for colour in colours(asked, library)]
    positions = Positions(text)
    for span in spans:
        if span.path == path:
            assert 0 <= span.start <= span.end <= len(text)
            assert positions.place(span.start) <= positions.place(span.end)


def spans_of(entry: Entry) -> list[Span]:
    """The places of an outline; what is selected lies in what is covered, or editors refuse the outline."""
    assert entry.span.start <= entry.selection.start <= entry.selection.end <= entry.span.end
    assert entry.name
    return [entry.span, entry.selection, *(span for inner in entry.entries for span in spans_of(inner))]


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: p.stem)
def test_prefixes_of_shipped_files(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    for cut in [*range(0, len(text), max(1, len(text) // CUTS)), len(text)]:
        ask_everything(str(path), text[:cut], cut)


@settings(max_examples=150, deadline=None)
@given(
    st.sampled_from([("tables.nid", DOMAIN), ("two.nid", PROBLEM), ("little.nid", SCENE)]),
    st.integers(0, 2000),
    st.integers(0, 60),
    st.text(st.sampled_from("a?(){}[]:=-,#.9 \n🧽"), max_size=6),
)
def test_pieces_replaced(file: tuple[str, str], start: int, length: int, typed: str) -> None:
    name, text = file
    start = min(start, len(text))
    ask_everything(
        str(FOLDER / name), text[:start] + typed + text[start + length :], min(start + len(typed), len(text))
    )


@pytest.mark.parametrize(
    "text",
    ["", "#", "domain", "domain d", "domain {", "domain rule { }", "problem p {}", "}", "scene s { a { b {"],
)
def test_beginnings(text: str) -> None:
    ask_everything("/somewhere/new.nid", text, len(text))


def test_what_stands_between_sections_hides_none() -> None:
    for typed in ("rule r: ", "rule r: push(?a", "predicates", "}", "rule"):
        text = DOMAIN.replace("  reward ", f"  {typed}\n  reward ")
        names = {o.meaning.name for o in document(Source("/t.nid", text)).declared()}
        assert {"dirt", "push", "push_small"} <= names, typed
    text = PROBLEM.replace("1 + dirty_areas", "1 +")
    assert document(Source("/p.nid", text)).domain_name() == "tables"
