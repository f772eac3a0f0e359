"""The files for editors are valid, and the TextMate grammar knows every word of the language."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest

from cleancli.language.parsing.parse import KINDS
from support.editor_texts import ROOT

EDITORS = ROOT / "editors"
GRAMMAR = json.loads((EDITORS / "textmate" / "nid.tmLanguage.json").read_text(encoding="utf-8"))
LARK = re.sub(r"//.*", "", (ROOT / "grammar" / "nid.lark").read_text(encoding="utf-8"))
COLOURED = ("keyword.", "storage.", "constant.language.")


def dictionaries(value: object) -> Iterator[dict[str, Any]]:
    """Every JSON object inside one."""
    if isinstance(value, dict):
        yield value
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from dictionaries(inner)


PATTERNS = [
    (entry, key) for entry in dictionaries(GRAMMAR) for key in ("match", "begin", "end") if key in entry
]


def coloured(text: str) -> Iterator[tuple[str, str]]:
    """The pieces of a text that any pattern names, each with its scope."""
    for entry, key in PATTERNS:
        scopes = {number: c["name"] for number, c in entry.get("captures", {}).items()}
        if "name" in entry:
            scopes["0"] = entry["name"]
        for match in re.finditer(entry[key], text):
            for number, scope in scopes.items():
                if match[int(number)]:
                    yield match[int(number)], scope


def sample(word: str) -> str:
    """A word as the grammar lets it stand: what it puts behind it is part of the sample."""
    if word in KINDS and f'"{word}" NAME "{{"' in LARK:
        return f"{word} name {{"
    if word in ("grasp", "part", "compare"):
        return f"  {word} name {{"
    if word == "rule":
        return "rule name: action(?a)"
    if word == "x":
        return "640 x 480"
    following = re.search(rf'"{word}" "(\{{|=)"', LARK)
    return f"  {word} {following[1]} " if following else f" {word} "


def words() -> list[str]:
    return sorted(set(re.findall(r'"([a-z][a-z0-9]*)"', LARK)))


def test_files_are_json() -> None:
    files = sorted(EDITORS.rglob("*.json"))
    assert len(files) >= 3
    for path in files:
        assert json.loads(path.read_text(encoding="utf-8")), path.name


def test_every_regular_expression_compiles_and_every_include_leads_somewhere() -> None:
    assert len(PATTERNS) > 15
    for entry, key in PATTERNS:
        re.compile(entry[key])
    for entry in dictionaries(GRAMMAR):
        if "include" in entry:
            assert entry["include"].removeprefix("#") in GRAMMAR["repository"]


@pytest.mark.parametrize("word", words())
def test_every_word_of_the_grammar_is_coloured(word: str) -> None:
    found = [scope for piece, scope in coloured(sample(word)) if word in piece.split() or piece == word]
    assert any(scope.startswith(COLOURED) or word == "x" for scope in found), sample(word)


def test_every_unit_is_coloured() -> None:
    units = re.search(r"^UNIT\S*: /\(([a-z|]+)\)", LARK, re.M)
    assert units is not None
    for unit in units[1].split("|"):
        assert (unit, "keyword.other.unit.nid") in coloured(f"width = 12 {unit}")


def test_an_unknown_word_is_not_coloured() -> None:
    assert not [scope for piece, scope in coloured(" whenever ") if scope.startswith(COLOURED)]


def test_the_extension_names_files_that_exist() -> None:
    folder = EDITORS / "vscode"
    package = json.loads((folder / "package.json").read_text(encoding="utf-8"))
    (language,) = package["contributes"]["languages"]
    (grammar,) = package["contributes"]["grammars"]
    assert (folder / package["main"]).exists()
    assert (folder / language["configuration"]).exists()
    assert grammar["scopeName"] == GRAMMAR["scopeName"]
    copied = "../textmate/nid.tmLanguage.json"
    assert copied in package["scripts"]["vscode:prepublish"]
    assert (folder / copied).exists()
    assert grammar["path"].removeprefix("./") in package["scripts"]["vscode:prepublish"]


def test_what_an_outcome_pays_is_coloured() -> None:
    found = set(coloured("then 1: reward += 2 + 1/3 * far(?a, bin)"))
    assert found >= {
        ("reward", "storage.modifier.nid"),
        ("+=", "keyword.operator.assignment.nid"),
        ("2", "constant.numeric.nid"),
        ("+", "keyword.operator.arithmetic.nid"),
        ("1/3", "constant.numeric.rational.nid"),
        ("*", "keyword.operator.arithmetic.nid"),
        ("far", "entity.name.function.nid"),
        ("?a", "variable.parameter.nid"),
    }
