"""The server as an editor meets it: a process, spoken to by a client over standard input and output."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest
from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

from cleancli import __version__
from cleancli.editor.colours import MODIFIERS, TYPES
from support.editor_texts import DOMAIN, PROBLEM


class Client(LanguageClient):
    """An editor that remembers the mistakes it was told of."""

    def __init__(self) -> None:
        super().__init__("test editor", "1")
        self.told: asyncio.Queue[lsp.PublishDiagnosticsParams] = asyncio.Queue()
        self.left: int | None = None

        def told(params: lsp.PublishDiagnosticsParams) -> None:
            self.told.put_nowait(params)

        self.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(told)

    async def server_exit(self, server: asyncio.subprocess.Process) -> None:
        """Remember the exit code."""
        self.left = server.returncode

    async def mistakes(self, uri: str) -> list[lsp.Diagnostic]:
        """The next list of mistakes of a text."""
        while True:
            params = await self.told.get()
            if params.uri == uri:
                return list(params.diagnostics)

    def open(self, path: Path, text: str) -> lsp.TextDocumentIdentifier:
        """Open a text that need not be saved."""
        item = lsp.TextDocumentItem(path.as_uri(), "nid", 1, text)
        self.text_document_did_open(lsp.DidOpenTextDocumentParams(item))
        return lsp.TextDocumentIdentifier(item.uri)

    def change(self, uri: str, text: str) -> None:
        """Type a whole new text."""
        changes = [lsp.TextDocumentContentChangeWholeDocument(text)]
        self.text_document_did_change(
            lsp.DidChangeTextDocumentParams(lsp.VersionedTextDocumentIdentifier(2, uri), changes)
        )


def place(text: str, mark: str) -> lsp.Position:
    """The position, in UTF-16 units, of the `|` in a piece of the text."""
    before = text[: text.index(mark.replace("|", "")) + mark.index("|")]
    line = before.rpartition("\n")[2]
    return lsp.Position(before.count("\n"), len(line.encode("utf-16-le")) // 2)


def talk(
    folder: Path, say: Callable[[Client], Awaitable[None]], *encodings: str, options: object = None
) -> None:
    """Start a server for a folder, say something to it, and see it leave in good order.

    `encodings` are those that the client offers to count in; without any it is UTF-16. `options` are those of
    the initialization.
    """

    async def session() -> None:
        client = Client()
        await client.start_io(sys.executable, "-m", "cleancli.cli.main", "lsp")
        folders = [lsp.WorkspaceFolder(folder.as_uri(), "test")]
        general = lsp.GeneralClientCapabilities(position_encodings=list(encodings) or None)
        params = lsp.InitializeParams(
            lsp.ClientCapabilities(general=general), workspace_folders=folders, initialization_options=options
        )
        answer = await client.initialize_async(params)
        assert answer.server_info == lsp.ServerInfo("cleancli", __version__)
        client.initialized(lsp.InitializedParams())
        await say(client)
        await client.shutdown_async(None)
        client.exit(None)
        await client.stop()  # type: ignore[no-untyped-call]
        assert client.left == 0

    asyncio.run(asyncio.wait_for(session(), 60))


def test_mistakes_come_while_typing(tmp_path: Path) -> None:
    async def say(client: Client) -> None:
        domain = client.open(tmp_path / "tables.nid", DOMAIN)
        assert await client.mistakes(domain.uri) == []
        problem = client.open(tmp_path / "two.nid", PROBLEM)
        assert await client.mistakes(problem.uri) == []
        text = DOMAIN.replace("0.9: not", "0.8: not").replace("when dirt(?x)", "when dirty(?x)")
        client.change(domain.uri, text)
        unknown, missing = await client.mistakes(domain.uri)
        assert (unknown.code, missing.code) == ("E203", "E301")
        assert unknown.range == lsp.Range(place(text, "when |dirty"), place(text, "when dirty|"))
        assert "did you mean `dirt`" in unknown.message
        assert unknown.severity is lsp.DiagnosticSeverity.Error
        (spoilt,) = await client.mistakes(problem.uri)
        assert "2 mistakes" in spoilt.message
        client.change(domain.uri, DOMAIN)
        assert await client.mistakes(domain.uri) == []
        assert await client.mistakes(problem.uri) == []

    talk(tmp_path, say)


def test_of_very_many_mistakes_as_many_are_told_as_by_check(tmp_path: Path) -> None:
    unknown = " ".join(f"dirt(b{number})," for number in range(150))
    text = PROBLEM.replace("dirt(a1),", f"dirt(a1), {unknown}", 1)

    async def say(client: Client) -> None:
        client.open(tmp_path / "tables.nid", DOMAIN)
        problem = client.open(tmp_path / "two.nid", text)
        *told, more = await client.mistakes(problem.uri)
        assert len(told) == 100
        assert {each.code for each in told} == {"E205"}
        assert more.message.startswith("50 more mistakes")
        assert more.severity is lsp.DiagnosticSeverity.Information
        assert more.range == told[-1].range

    talk(tmp_path, say)


@pytest.mark.parametrize(("encodings", "units"), [((), 6), (("utf-16",), 6), (("utf-8", "utf-16"), 9)])
def test_places_are_counted_as_the_editor_counts(
    encodings: tuple[str, ...], units: int, tmp_path: Path
) -> None:
    comment = "# 🧽 é"

    async def say(client: Client) -> None:
        document = client.open(tmp_path / "tables.nid", DOMAIN.replace("domain", f"{comment}\ndomain", 1))
        colours = await client.text_document_semantic_tokens_full_async(lsp.SemanticTokensParams(document))
        assert colours is not None
        assert list(colours.data[5:10]) == [2, 0, units, TYPES.index("comment"), 0]
        # An edit behind the character is made where the editor means it, and not one further.
        spot = lsp.Position(2, units)
        edit = lsp.TextDocumentContentChangePartial(lsp.Range(spot, spot), "!")
        version = lsp.VersionedTextDocumentIdentifier(2, document.uri)
        client.text_document_did_change(lsp.DidChangeTextDocumentParams(version, [edit]))
        colours = await client.text_document_semantic_tokens_full_async(lsp.SemanticTokensParams(document))
        assert colours is not None
        assert colours.data[7] == units + 1

    talk(tmp_path, say, *encodings)


def test_every_question_is_answered(tmp_path: Path) -> None:
    (tmp_path / "tables.nid").write_text(DOMAIN, encoding="utf-8")

    async def say(client: Client) -> None:
        problem = client.open(tmp_path / "two.nid", PROBLEM)
        assert await client.mistakes(problem.uri) == []
        domain_uri = (tmp_path / "tables.nid").as_uri()
        spot = place(PROBLEM, "|near(a1")

        hover = await client.text_document_hover_async(lsp.HoverParams(problem, spot))
        assert hover is not None
        assert isinstance(hover.contents, lsp.MarkupContent)
        assert "predicate near(?a ?b - area) [symmetric]" in hover.contents.value
        assert "two areas\nside by side" in hover.contents.value

        found = await client.text_document_completion_async(
            lsp.CompletionParams(problem, place(PROBLEM, "size(a1) = |small"))
        )
        assert isinstance(found, list)
        assert [item.label for item in found] == ["small", "medium", "big"]

        target = await client.text_document_definition_async(lsp.DefinitionParams(problem, spot))
        assert isinstance(target, lsp.Location)
        assert target == lsp.Location(
            domain_uri, lsp.Range(place(DOMAIN, "|near(?a ?b"), place(DOMAIN, "near|(?a ?b"))
        )

        context = lsp.ReferenceContext(include_declaration=True)
        uses = await client.text_document_references_async(lsp.ReferenceParams(context, problem, spot))
        assert uses is not None
        assert sorted(use.uri for use in uses) == [domain_uri, domain_uri, problem.uri]

        ready = await client.text_document_prepare_rename_async(lsp.PrepareRenameParams(problem, spot))
        assert ready == lsp.Range(spot, place(PROBLEM, "near|(a1"))
        edit = await client.text_document_rename_async(lsp.RenameParams(problem, spot, "beside"))
        assert edit is not None
        assert edit.changes is not None
        assert {uri: len(edits) for uri, edits in edit.changes.items()} == {domain_uri: 2, problem.uri: 1}
        with pytest.raises(JsonRpcException, match="already a symbol `dirt`"):
            await client.text_document_rename_async(lsp.RenameParams(problem, spot, "dirt"))

        outline = await client.text_document_document_symbol_async(lsp.DocumentSymbolParams(problem))
        assert outline is not None
        assert [entry.name for entry in outline] == ["two"]

        colours = await client.text_document_semantic_tokens_full_async(lsp.SemanticTokensParams(problem))
        assert colours is not None
        first = TYPES.index("keyword"), TYPES.index("namespace"), 1 << MODIFIERS.index("declaration")
        assert list(colours.data[:10]) == [0, 0, 7, first[0], 0, 0, 8, 3, first[1], first[2]]

    talk(tmp_path, say)


INCLUDING = """domain tables {
  include "sub/base.nid"
  include ""
  include "../outside.nid"
  reward { goal }
}
"""


def _with_folders(folder: Path) -> Path:
    """The path of a domain among files that it may include, and some that it may not."""
    texts = {"outside": "domain outside { }", "top/two": PROBLEM, "top/sub/base": "domain base { }"}
    for name in ("top/sub/deep/er", "top/.hidden/h", "top/also"):
        texts[name] = "# Also here.\ndomain also { }"
    for name, text in texts.items():
        (folder / f"{name}.nid").parent.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.nid").write_text(text, encoding="utf-8")
    (folder / "top" / "link.nid").symlink_to(folder / "outside.nid")
    return folder / "top" / "tables.nid"


def test_an_include_leads_to_its_file(tmp_path: Path) -> None:
    path = _with_folders(tmp_path)

    async def say(client: Client) -> None:
        domain = client.open(path, INCLUDING)
        for mark in ('|"sub/', "/ba|se", "incl|ude"):
            spot = place(INCLUDING, mark)
            found = await client.text_document_definition_async(lsp.DefinitionParams(domain, spot))
            start = lsp.Position(0, 0)
            uri = (path.parent / "sub" / "base.nid").as_uri()
            assert found == lsp.Location(uri, lsp.Range(start, start))
        nowhere = lsp.DefinitionParams(domain, place(INCLUDING, '"|"'))
        assert await client.text_document_definition_async(nowhere) is None
        shown = await client.text_document_hover_async(lsp.HoverParams(domain, place(INCLUDING, "/ba|se")))
        assert shown is not None
        assert isinstance(shown.contents, lsp.MarkupContent)
        assert "domain base" in shown.contents.value

    talk(tmp_path, say)


async def _offered(client: Client, uri: str, mark: str) -> dict[str, lsp.Range]:
    """What is offered at a mark of the text, and what it replaces."""
    text = lsp.TextDocumentIdentifier(uri)
    spot = place(INCLUDING, mark)
    found = await client.text_document_completion_async(lsp.CompletionParams(text, spot))
    assert isinstance(found, list)
    return {item.label: item.text_edit.range for item in found if isinstance(item.text_edit, lsp.TextEdit)}


@pytest.mark.parametrize(
    ("options", "above", "linked", "codes"),
    [
        ({"includeOutside": True}, ["outside.nid", "top/"], ["link.nid"], ["E002"]),
        ({"includeOutside": False}, ["top/"], [], ["E002", "E109"]),
        ({"includeOutside": "yes"}, ["top/"], [], ["E002", "E109"]),
        (None, ["top/"], [], ["E002", "E109"]),
        ([3], ["top/"], [], ["E002", "E109"]),
    ],
)
def test_paths_of_includes_are_completed(
    options: object, above: list[str], linked: list[str], codes: list[str], tmp_path: Path
) -> None:
    path = _with_folders(tmp_path)

    async def say(client: Client) -> None:
        domain = client.open(path, INCLUDING)
        assert [found.code for found in await client.mistakes(domain.uri)] == codes
        beside = await _offered(client, domain.uri, 'include "|"')
        assert list(beside) == ["also.nid", *linked, "sub/"]
        spot = place(INCLUDING, 'include "|"')
        assert all(replaced == lsp.Range(spot, spot) for replaced in beside.values())
        below = await _offered(client, domain.uri, "sub/ba|se")
        assert list(below) == ["base.nid", "deep/"]
        assert below["deep/"] == lsp.Range(place(INCLUDING, "sub/|base"), place(INCLUDING, "sub/ba|se"))
        assert list(await _offered(client, domain.uri, '"../|outside')) == above
        assert list(await _offered(client, domain.uri, 'include |"sub')) == []

    talk(tmp_path, say, options=options)


def test_formatting_of_an_untidy_text(tmp_path: Path) -> None:
    async def say(client: Client) -> None:
        document = client.open(tmp_path / "tables.nid", DOMAIN.replace("# two areas\n", "# two areas   \n"))
        options = lsp.FormattingOptions(tab_size=2, insert_spaces=True)
        edits = await client.text_document_formatting_async(lsp.DocumentFormattingParams(document, options))
        assert edits
        client.change(document.uri, "domain d {")
        assert (
            await client.text_document_formatting_async(lsp.DocumentFormattingParams(document, options)) == ()
        )

    talk(tmp_path, say)


def test_closing_clears_the_list(tmp_path: Path) -> None:
    async def say(client: Client) -> None:
        document = client.open(tmp_path / "bad.nid", "domain bad { }")
        (missing,) = await client.mistakes(document.uri)
        assert missing.code == "E219"
        client.text_document_did_close(lsp.DidCloseTextDocumentParams(document))
        assert await client.mistakes(document.uri) == []

    talk(tmp_path, say)


def test_without_pygls_the_command_says_what_to_install(tmp_path: Path) -> None:
    code = "raise ModuleNotFoundError('not installed', name='pygls')\n"
    (tmp_path / "pygls.py").write_text(code, encoding="utf-8")
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    result = subprocess.run(
        [sys.executable, "-m", "cleancli.cli.main", "lsp"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        timeout=60,
        stdin=subprocess.DEVNULL,
    )
    assert result.returncode == 4
    assert "pip install 'pygls>=2.0'" in result.stderr
    assert "Traceback" not in result.stderr


def test_an_editor_that_is_cut_off_is_told_why(tmp_path: Path) -> None:
    result = subprocess.run(
        [sys.executable, "-m", "cleancli.cli.main", "lsp"],
        input=f"Content-Length: {10**12}\r\n\r\n",
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=60,
    )
    assert result.returncode == 5
    assert result.stderr.startswith("error: ")
    assert result.stderr.endswith(": the editor was cut off\n")
    assert "Traceback" not in result.stderr
