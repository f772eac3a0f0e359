"""Outline, colours and layout of a text."""

from __future__ import annotations

from cleancli.editor.colours import MODIFIERS, TYPES, colours
from cleancli.editor.formatting import formatting
from cleancli.editor.library import document
from cleancli.editor.symbols import Entry, symbols
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.text_edit import apply_edits
from cleancli.language.printing.formatter import layout
from support.editor_texts import DOMAIN, OPEN, marked, opened


def names(entries: tuple[Entry, ...]) -> list[object]:
    return [[entry.name, *names(entry.entries)] if entry.entries else entry.name for entry in entries]


def test_outline_of_a_domain() -> None:
    assert names(symbols(opened("tables.nid"))) == [
        [
            "tables",
            ["types", "place", "area", "container"],
            ["constants", "bin"],
            ["predicates", "dirt", "near", "traversal"],
            ["functions", ["size", "small", "medium", "big"], ["weight", "small", "large"]],
            ["derived", "dirty_areas"],
            ["actions", "push", "join"],
            "push_small",
            "join_two",
        ]
    ]


def test_outline_of_a_problem_and_a_scene() -> None:
    assert names(symbols(opened("two.nid"))) == [["two", ["objects", "a1", "a2"]]]
    assert names(symbols(opened("little.nid"))) == [["little", "rag", ["dirt", "group"]]]


def coloured(name: str, text: str) -> list[tuple[str, str]]:
    asked, _, library = marked(name, text + "|")
    source = asked.source.text
    return [(source[c.start : c.end], c.type) for c in colours(asked, library)]


def test_colours_tell_words_apart_that_look_alike() -> None:
    found = coloured("two.nid", "problem dirt { domain = tables init { dirt(a1) size(a1) = small } }")
    assert found == [
        ("problem", "keyword"),
        ("dirt", "namespace"),
        ("domain", "keyword"),
        ("tables", "namespace"),
        ("init", "keyword"),
        ("dirt", "function"),
        ("a1", "variable"),
        ("size", "function"),
        ("a1", "variable"),
        ("small", "enumMember"),
    ]


def test_colours_of_what_is_paid() -> None:
    paid = "reward -= 2 + 1/3 * far(?a), cost += far(bin)"
    text = f"domain tables {{ rule r: push(?a) {{ then 1: {paid} }} }}"
    assert coloured("tables.nid", text)[-8:] == [
        ("reward", "modifier"),
        ("2", "number"),
        ("1/3", "number"),
        ("far", "function"),
        ("?a", "parameter"),
        ("cost", "modifier"),
        ("far", "function"),
        ("bin", "variable"),
    ]


def test_a_section_that_cannot_be_read_keeps_its_colours() -> None:
    whole = dict(coloured("tables.nid", DOMAIN))
    broken = dict(coloured("tables.nid", DOMAIN.replace("0.9: not", "0.9 not")))
    for word in ("near", "push", "when", "bin", "?a", "0.9", "nothing"):
        assert whole[word] == broken[word], word


def test_declarations_and_constants_are_marked() -> None:
    asked = opened("tables.nid")
    first = next(c for c in colours(asked, OPEN) if asked.source.text[c.start : c.end] == "bin")
    assert first.modifiers == MODIFIERS
    assert {c.type for c in colours(asked, OPEN)} <= set(TYPES)


def test_layout_is_one_small_edit_and_then_none() -> None:
    for text in (
        DOMAIN.replace("# two areas\n", "# two areas  \n"),
        DOMAIN.replace("\n", " \r\n"),
        # Line ends that differ: the edit may begin or end beside a line end, never within one.
        layout(DOMAIN).replace("\n", "\r\n").replace("# two areas\r\n", "# two areas\n"),
        layout(DOMAIN).replace("# two areas\n", "# two areas\r\n"),
        DOMAIN.rstrip(),
    ):
        (edit,) = formatting(document(Source("/t.nid", text)))
        assert "\r\n" not in (text[edit.span.start - 1 :][:2], text[edit.span.end - 1 :][:2])
        laid = apply_edits(text, [edit])
        assert laid == layout(text)
        assert formatting(document(Source("/t.nid", laid))) == ()
    spoilt = layout(DOMAIN).replace("# two areas\n", "# two areas  \n")
    (edit,) = formatting(document(Source("/t.nid", spoilt)))
    assert edit.span.end - edit.span.start < 40


def test_a_text_with_a_syntax_error_is_not_laid_out() -> None:
    assert formatting(document(Source("/t.nid", DOMAIN.replace("0.9: not", "0.9 not  \n")))) == ()
