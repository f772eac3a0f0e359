"""The outline of a file: its sections, and what each declares."""

from __future__ import annotations

from dataclasses import dataclass

from cleancli.editor.library import Document
from cleancli.language import syntax
from cleancli.language.diagnostics.diagnostic import Span
from cleancli.language.refactoring.name_index import Kind, Occurrence


@dataclass(frozen=True, slots=True)
class Entry:
    """A line of the outline: its name, a word on what it is, all its text, what to select, what is in it."""

    name: str
    detail: str
    kind: Kind
    span: Span
    selection: Span
    entries: tuple[Entry, ...] = ()


def symbols(asked: Document) -> tuple[Entry, ...]:
    """The outline of a text; empty where it could not be read."""
    root = asked.root
    if root is None:
        return ()
    if isinstance(root, syntax.SceneNode | syntax.StudyNode):
        inner = tuple(_section(entry) for entry in root.entries if isinstance(entry, syntax.Section))
    else:
        inner = tuple(entry for section in root.sections for entry in _declared(section, asked))
    kind = asked.names[0].meaning.kind
    # Where the last brace is missing, the parser has read one behind the text.
    whole = Span(root.span.path, root.span.start, min(root.span.end, len(asked.source.text)))
    return (Entry(root.name.text, kind.value, kind, whole, root.name.span, inner),)


def _section(section: syntax.Section) -> Entry:
    inner = tuple(_section(entry) for entry in section.entries if isinstance(entry, syntax.Section))
    return Entry(section.name.text, "section", Kind.SECTION, section.span, section.name.span, inner)


def _declared(section: syntax.Node, asked: Document) -> tuple[Entry, ...]:
    """A rule is an entry of its own; any other section one that holds what it declares."""
    inside = [o for o in asked.declared() if section.span.start <= o.span.start < section.span.end]
    entries = tuple(_entry(o, inside) for o in inside if o.meaning.kind not in (Kind.VARIABLE, Kind.VALUE))
    if isinstance(section, syntax.RuleNode):
        return entries
    word = asked.source.text[section.span.start : section.span.end].split("{")[0].split()[0]
    selection = Span(section.span.path, section.span.start, section.span.start + len(word))
    return (Entry(word, "section", Kind.SECTION, section.span, selection, entries),) if entries else ()


def _entry(occurrence: Occurrence, inside: list[Occurrence]) -> Entry:
    meaning, node = occurrence.meaning, occurrence.node
    whole = occurrence.span if isinstance(node, syntax.Group) else node.span
    values = tuple(
        Entry(o.meaning.name, "value", Kind.VALUE, o.span, o.span)
        for o in inside
        if o.meaning.kind is Kind.VALUE and o.node is node
    )
    detail = node.action.text if isinstance(node, syntax.RuleNode) else meaning.kind.value
    return Entry(meaning.name, detail, meaning.kind, whole, occurrence.span, values)
