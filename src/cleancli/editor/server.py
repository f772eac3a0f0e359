"""The language server: an editor's requests in, answers of the pure functions of this package out (LSP 3.17).

The only place that knows the protocol. Nothing is kept between requests but the texts that pygls holds.
"""

from __future__ import annotations

import asyncio
import functools
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import BinaryIO, cast

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path

from cleancli import __version__
from cleancli.editor import colours as colouring
from cleancli.editor.completion import completions
from cleancli.editor.formatting import formatting
from cleancli.editor.hover import hover
from cleancli.editor.library import Document, Library, document
from cleancli.editor.messages import Limited
from cleancli.editor.mistakes import mistakes
from cleancli.editor.navigation import CannotRename, definition, references, renamable, rename
from cleancli.editor.positions import UTF_16, Positions
from cleancli.editor.symbols import Entry, symbols
from cleancli.language.diagnostics.diagnostic import Diagnostic, Level, Source, Span
from cleancli.language.diagnostics.messages import Excerpt, excerpt
from cleancli.language.diagnostics.text_edit import Edit
from cleancli.language.refactoring.name_index import Kind

_PAUSE = 0.15
"""Seconds without a key press before a text is checked."""

_COMPLETED = {
    Kind.DOMAIN: lsp.CompletionItemKind.Module,
    Kind.TYPE: lsp.CompletionItemKind.Class,
    Kind.OBJECT: lsp.CompletionItemKind.Constant,
    Kind.SYMBOL: lsp.CompletionItemKind.Function,
    Kind.VALUE: lsp.CompletionItemKind.EnumMember,
    Kind.COUNT: lsp.CompletionItemKind.Property,
    Kind.PARAMETER: lsp.CompletionItemKind.Property,
    Kind.ACTION: lsp.CompletionItemKind.Method,
    Kind.VARIABLE: lsp.CompletionItemKind.Variable,
    Kind.MARK: lsp.CompletionItemKind.Property,
    Kind.SECTION: lsp.CompletionItemKind.Module,
    Kind.KEY: lsp.CompletionItemKind.Property,
    Kind.WORD: lsp.CompletionItemKind.Value,
    Kind.FILE: lsp.CompletionItemKind.File,
    Kind.FOLDER: lsp.CompletionItemKind.Folder,
}
_OUTLINED = {
    Kind.DOMAIN: lsp.SymbolKind.Module,
    Kind.PROBLEM: lsp.SymbolKind.Module,
    Kind.SCENE: lsp.SymbolKind.Module,
    Kind.STUDY: lsp.SymbolKind.Module,
    Kind.TYPE: lsp.SymbolKind.Class,
    Kind.OBJECT: lsp.SymbolKind.Constant,
    Kind.SYMBOL: lsp.SymbolKind.Function,
    Kind.VALUE: lsp.SymbolKind.EnumMember,
    Kind.COUNT: lsp.SymbolKind.Property,
    Kind.PARAMETER: lsp.SymbolKind.Property,
    Kind.ACTION: lsp.SymbolKind.Method,
    Kind.RULE: lsp.SymbolKind.Event,
    Kind.SECTION: lsp.SymbolKind.Namespace,
}


class RequestFailed(JsonRpcException):
    """The request is in order, and cannot be met; the editor shows the message."""

    CODE = lsp.LSPErrorCodes.RequestFailed.value


class Server(LanguageServer):
    """pygls' server with the texts as this package reads them."""

    def __init__(self) -> None:
        super().__init__("cleancli", __version__)
        self.versions: dict[str, int] = {}
        """How often each text has changed, to tell when it has rested."""
        self.include_outside = False
        """Whether domains may include files from outside their folder."""

    @property
    def library(self) -> Library:
        """All open texts and the folders of the editor, now."""
        texts = {_path(uri): text.source for uri, text in self.workspace.text_documents.items()}
        folders = (to_fs_path(folder.uri) for folder in self.workspace.folders.values())
        roots = tuple(Path(folder).resolve() for folder in folders if folder)
        return Library(texts, roots, self.include_outside)

    def document(self, uri: str) -> Document:
        """An open text."""
        return document(Source(_path(uri), self.workspace.get_text_document(uri).source))

    def positions(self, text: str) -> Positions:
        """The text's positions in the encoding agreed on with the editor."""
        agreed = self.workspace.position_encoding
        return _positions(text, UTF_16 if agreed is None else str(lsp.PositionEncodingKind(agreed).value))

    def offset(self, uri: str, position: lsp.Position) -> int:
        """The offset that a position means."""
        return self.positions(self.document(uri).source.text).offset(position.line, position.character)

    def range(self, span: Span) -> lsp.Range:
        """A span as the editor counts."""
        found = self.library.document(span.path)
        positions = self.positions("" if found is None else found.source.text)
        return lsp.Range(lsp.Position(*positions.place(span.start)), lsp.Position(*positions.place(span.end)))

    def location(self, span: Span) -> lsp.Location:
        """A span with its file."""
        return lsp.Location(self.uri(span.path), self.range(span))

    def uri(self, path: str) -> str:
        """The address of a file, in the editor's own spelling where it is open."""
        for uri in self.workspace.text_documents:
            if _path(uri) == path:
                return str(uri)
        address: str | None = from_fs_path(path)
        return address or path

    def edits(self, edits: Iterable[Edit]) -> list[lsp.TextEdit]:
        """Edits as the editor makes them."""
        return [lsp.TextEdit(self.range(edit.span), edit.replacement) for edit in edits]


@functools.lru_cache(maxsize=64)
def _positions(text: str, encoding: str) -> Positions:
    """Kept, because an answer asks for hundreds of places in one text."""
    return Positions(text, encoding)


@functools.lru_cache(maxsize=1024)
def _path(uri: str) -> str:
    """The path of a file, links resolved; the address itself for a text that is in no file."""
    path = to_fs_path(uri) if uri.startswith("file:") else None
    return uri if path is None else str(Path(path).resolve())


server = Server()


def serve() -> str:
    """Answer an editor over standard input and output until it closes them; says why, if it was cut off."""
    messages = Limited(sys.stdin.buffer)
    # pygls closes what it writes to; the command still flushes its own standard output when it ends.
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as stream:
        server.start_io(stdin=cast(BinaryIO, messages), stdout=stream)
    return messages.refused


@server.feature(lsp.INITIALIZE)
def started(ls: Server, params: lsp.InitializeParams) -> None:
    """Take the option that an editor may give, `includeOutside`."""
    options = params.initialization_options
    given = options.get("includeOutside") if isinstance(options, Mapping) else None
    ls.include_outside = given is True


# ---- mistakes


@server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
def opened(ls: Server, params: lsp.DidOpenTextDocumentParams) -> None:
    """Check a text at once."""
    _publish(ls, params.text_document.uri)


@server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
async def changed(ls: Server, params: lsp.DidChangeTextDocumentParams) -> None:
    """Check a text, and what depends on it, when the keys have rested."""
    uri = params.text_document.uri
    version = ls.versions[uri] = ls.versions.get(uri, 0) + 1
    await asyncio.sleep(_PAUSE)
    if ls.versions.get(uri) == version and uri in ls.workspace.text_documents:
        _publish(ls, uri)


@server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
def closed(ls: Server, params: lsp.DidCloseTextDocumentParams) -> None:
    """Take a text's mistakes off the editor's list."""
    ls.versions.pop(params.text_document.uri, None)
    ls.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(params.text_document.uri, []))


def _publish(ls: Server, uri: str) -> None:
    """Send the mistakes of a text, and of the open texts that include it or are problems for it."""
    asked = ls.document(uri)
    library = ls.library
    texts = [uri]
    if asked.kind == "domain":
        texts += [
            other for other in ls.workspace.text_documents if _is_for(ls.document(other), asked, library)
        ]
    for text in texts:
        part = excerpt(mistakes(ls.document(text), library))
        found = [_diagnostic(ls, d) for d in part.shown]
        if part.left_out:
            found.append(_more(part, found[-1].range))
        ls.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(text, found))


def _is_for(other: Document, domain: Document, library: Library) -> bool:
    """Whether the mistakes of another text depend on a domain: it includes that, or is a problem for it."""
    if other.kind not in ("domain", "problem"):
        return False
    found = library.domain_of(other)
    files = () if found is None else (found, *library.included(found))
    is_needed = any(place.source.path == domain.source.path for place in files)
    return other.source.path != domain.source.path and (found is None or is_needed)


def _more(part: Excerpt, place: lsp.Range) -> lsp.Diagnostic:
    """Says, where the last mistake of those that are told stands, how many are not."""
    message = f"{part.note}: `cleancli check --all` shows all"
    return lsp.Diagnostic(place, message, lsp.DiagnosticSeverity.Information, source="cleancli")


def _diagnostic(ls: Server, found: Diagnostic) -> lsp.Diagnostic:
    place = (
        ls.range(found.span) if found.span is not None else lsp.Range(lsp.Position(0, 0), lsp.Position(0, 0))
    )
    message = found.message + (f" ({found.label})" if found.label else "")
    return lsp.Diagnostic(
        range=place,
        message=f"{message}\n{found.help}" if found.help else message,
        severity=lsp.DiagnosticSeverity.Error
        if found.level is Level.ERROR
        else lsp.DiagnosticSeverity.Warning,
        code=found.code,
        source="cleancli",
    )


# ---- what stands at a place


@server.feature(lsp.TEXT_DOCUMENT_HOVER)
def hovered(ls: Server, params: lsp.HoverParams) -> lsp.Hover | None:
    """Say what stands at a place."""
    uri = params.text_document.uri
    found = hover(ls.document(uri), ls.offset(uri, params.position), ls.library)
    if found is None:
        return None
    return lsp.Hover(lsp.MarkupContent(lsp.MarkupKind.Markdown, found.text), ls.range(found.span))


@server.feature(
    lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=["?", "(", "=", "[", '"', "/"])
)
def completed(ls: Server, params: lsp.CompletionParams) -> list[lsp.CompletionItem]:
    """List what may be written at a place."""
    uri = params.text_document.uri
    asked, offset = ls.document(uri), ls.offset(uri, params.position)
    return [
        lsp.CompletionItem(
            label=found.text,
            kind=lsp.CompletionItemKind.Keyword if found.kind is None else _COMPLETED[found.kind],
            detail=found.detail,
            documentation=found.about or None,
            sort_text=f"{index:04}",
            text_edit=lsp.TextEdit(ls.range(Span(asked.source.path, found.start, offset)), found.text),
        )
        for index, found in enumerate(completions(asked, offset, ls.library))
    ]


@server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
def defined(ls: Server, params: lsp.DefinitionParams) -> lsp.Location | None:
    """Go to a declaration."""
    uri = params.text_document.uri
    span = definition(ls.document(uri), ls.offset(uri, params.position), ls.library)
    return None if span is None else ls.location(span)


@server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
def referred(ls: Server, params: lsp.ReferenceParams) -> list[lsp.Location]:
    """List the occurrences of a name."""
    uri = params.text_document.uri
    offset = ls.offset(uri, params.position)
    spans = references(ls.document(uri), offset, ls.library, params.context.include_declaration)
    return [ls.location(span) for span in spans]


@server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
def rename_prepared(ls: Server, params: lsp.PrepareRenameParams) -> lsp.Range:
    """Say what would be renamed, or why nothing can be."""
    uri = params.text_document.uri
    try:
        return ls.range(renamable(ls.document(uri), ls.offset(uri, params.position), ls.library).span)
    except CannotRename as reason:
        raise RequestFailed(str(reason)) from None


@server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
def renamed(ls: Server, params: lsp.RenameParams) -> lsp.WorkspaceEdit:
    """Rename a thing in its domain and all its problems."""
    uri = params.text_document.uri
    try:
        edits = rename(ls.document(uri), ls.offset(uri, params.position), params.new_name, ls.library)
    except CannotRename as reason:
        raise RequestFailed(str(reason)) from None
    return lsp.WorkspaceEdit(changes={ls.uri(path): ls.edits(changes) for path, changes in edits.items()})


# ---- the whole text


@server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
def formatted(ls: Server, params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
    """Give a text its canonical layout."""
    return ls.edits(formatting(ls.document(params.text_document.uri)))


@server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
def outlined(ls: Server, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
    """List what a text declares."""
    return [_symbol(ls, entry) for entry in symbols(ls.document(params.text_document.uri))]


def _symbol(ls: Server, entry: Entry) -> lsp.DocumentSymbol:
    return lsp.DocumentSymbol(
        name=entry.name,
        detail=entry.detail,
        kind=_OUTLINED[entry.kind],
        range=ls.range(entry.span),
        selection_range=ls.range(entry.selection),
        children=[_symbol(ls, inner) for inner in entry.entries],
    )


@server.feature(
    lsp.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL,
    lsp.SemanticTokensLegend(list(colouring.TYPES), list(colouring.MODIFIERS)),
)
def coloured(ls: Server, params: lsp.SemanticTokensParams) -> lsp.SemanticTokens:
    """Say what each word of a text is."""
    asked = ls.document(params.text_document.uri)
    found = colouring.colours(asked, ls.library)
    return lsp.SemanticTokens(_numbers(found, ls.positions(asked.source.text), asked.source.text))


def _numbers(found: Sequence[colouring.Colour], positions: Positions, text: str) -> list[int]:
    """Five numbers a word: lines and units from the word before, length, type, modifiers as bits."""
    numbers: list[int] = []
    line, unit = 0, 0
    for colour in found:
        next_line, next_unit = positions.place(colour.start)
        bits = sum(1 << colouring.MODIFIERS.index(modifier) for modifier in colour.modifiers)
        numbers += [
            next_line - line,
            next_unit - unit if next_line == line else next_unit,
            positions.units(text[colour.start : colour.end]),
            colouring.TYPES.index(colour.type),
            bits,
        ]
        line, unit = next_line, next_unit
    return numbers
