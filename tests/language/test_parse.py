"""Text to syntax tree: a golden tree, layout, recovery, and a builder for every grammar rule."""

from __future__ import annotations

import contextlib
import dataclasses
import gc
import os
import re
import time
from pathlib import Path

import pytest
from lark import Tree

from cleancli.language.diagnostics.diagnostic import Source, Span
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.parsing.ast_builder import Builder
from cleancli.language.parsing.grammar import grammar
from cleancli.language.parsing.parse import kind_of, parse
from cleancli.resources import shipped

HERE = Path(__file__).parent
SHIPPED = sorted([*shipped("domains").glob("*.nid"), *shipped("problems").glob("*.nid")])


def _read(path: Path) -> Source:
    with path.open(newline="", encoding="utf-8") as file:
        return Source(path.name, file.read())


def _dump(node: object, text: str, depth: int = 0) -> str:
    """One line a node, with the text its span covers."""
    margin = "  " * depth
    if isinstance(node, tuple):
        return "".join(_dump(item, text, depth) for item in node)
    if not dataclasses.is_dataclass(node):
        return f"{margin}{node!r}\n"
    parts = {field.name: getattr(node, field.name) for field in dataclasses.fields(node)}
    span = parts.pop("span")
    covered = " ".join(text[span.start : span.end].split())
    shown = covered if len(covered) < 60 else f"{covered[:28]} ... {covered[-27:]}"
    children = [_dump(part, text, depth + 1) for part in parts.values()]
    return f"{margin}{type(node).__name__}: {shown}\n{''.join(children)}"


def _rules_of_grammar() -> set[str]:
    return {str(rule.alias or rule.origin.name) for rule in grammar().rules}


def test_every_rule_of_the_grammar_has_a_builder_and_every_builder_a_rule() -> None:
    rules = {name for name in _rules_of_grammar() if not name.startswith("_")}
    builders = {name.removeprefix("build_") for name in dir(Builder) if name.startswith("build_")}
    assert builders == rules


def test_a_rule_without_a_builder_is_refused() -> None:
    with pytest.raises(LookupError, match="frobnicate"):
        Builder("x").build(Tree("frobnicate", []))


def test_tree_of_the_small_domain() -> None:
    source = _read(HERE / "small.nid")
    expected = HERE / "small.tree.txt"
    found = _dump(parse(source).root, source.text)
    if os.environ.get("CLEANCLI_REGENERATE"):
        expected.write_text(found, encoding="utf-8")
    assert found == expected.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_line_ends_and_blanks_change_spans_only(path: Path) -> None:
    source = _read(path)
    plain = parse(source)
    assert plain.diagnostics == ()
    for text in (
        source.text.replace("\n", "\r\n"),
        source.text.replace("\n", "\r"),
        "\ufeff" + source.text,
        re.sub(r"#.*", "", source.text).replace("\n", " "),
    ):
        assert parse(Source("other", text)).root == plain.root


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_cut_and_every_lost_character_is_survived(path: Path) -> None:
    text = _read(path).text
    places = range(0, len(text), max(1, len(text) // 40))
    for place in places:
        for broken in (text[:place], text[:place] + text[place + 1 :], text[:place] + "}" + text[place:]):
            try:
                found = parse(Source("x", broken)).diagnostics
            except Refused as refused:
                found = refused.diagnostics
            for diagnostic in found:
                assert diagnostic.span is not None
                assert 0 <= diagnostic.span.start <= diagnostic.span.end <= len(broken)


@pytest.mark.parametrize("end", ["\n", "\r", "\r\n"])
def test_indentation_means_nothing_where_the_braces_match(end: str) -> None:
    lines = ["scene s {", "    dirt {", "group {", "count = 1", "}", "  group { count = 2 }", "}", "}"]
    result = parse(Source("x", end.join(lines)))
    assert result.diagnostics == ()
    assert result.root == parse(Source("x", " ".join(lines))).root


def test_each_block_is_parsed_on_its_own() -> None:
    text = _read(HERE / "small.nid").text
    broken = text.replace("rest: noise", "rest noise").replace("1/3: size", "1/3; size")
    result = parse(Source("x", broken.replace("[symmetric]", "[symmetric")))
    assert [d.code for d in result.diagnostics] == ["E104", "E104", "E104"]
    assert result.broken == {"predicates", "rule"}
    assert result.root is not None


def test_no_more_than_twenty_syntax_errors() -> None:
    rules = "".join(f"rule r{i}: a() {{ then oops }}\n" for i in range(30))
    assert len(parse(Source("x", f"domain d {{\n{rules}}}")).diagnostics) == 20


def test_collecting_goes_on_after_a_parse() -> None:
    for text in ("domain d { }", "nothing"):
        with contextlib.suppress(Refused):
            parse(Source("x", text))
        assert gc.isenabled()


def test_kind() -> None:
    assert kind_of(Source("x", "# domain\n\n  scene s { }")) == "scene"
    with pytest.raises(Refused) as refused:
        kind_of(Source("x", "  problm p {}"))
    assert refused.value.diagnostics[0].span == Span("x", 2, 8)


@pytest.mark.parametrize("line", ["a {", "a {\n", "rule {\n", "}\n"])
@pytest.mark.parametrize("kind", ["domain", "scene"])
def test_very_many_braces_are_refused_soon(kind: str, line: str) -> None:
    """Of those that follow from one another nobody reads more than a few, and no more are looked at."""
    text = f"{kind} d {{\n" + line * (4_000_000 // len(line))
    begun = time.process_time()
    found = parse(Source("many.nid", text)).diagnostics
    assert 1 <= len(found) <= 100
    assert time.process_time() - begun < 5
