"""Names are found by what they mean, and a rename changes those tokens alone."""

from __future__ import annotations

import dataclasses
import re
import typing
from pathlib import Path

import pytest

from cleancli.language import syntax
from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.text_edit import apply_edits
from cleancli.language.find import find
from cleancli.language.load import load_domain, load_problem, read_source
from cleancli.language.model import Horizon
from cleancli.language.refactoring import name_index
from cleancli.language.refactoring.name_index import Kind, Occurrence, names_in
from cleancli.language.refactoring.rename import rename
from cleancli.resources import shipped

HERE = Path(__file__).parent
DOMAIN = read_source(find("cleaning", "domains"))
PROBLEM = read_source(find("three_areas", "problems"))
SCENE = read_source(find("two_groups", "problems"))
TANGLED = Source(
    "tangled",
    """domain tangled {
  types      { wet; cup - wet }
  constants  { dry - cup }
  predicates { wet(?wet - cup) }
  functions  { heat(?c - cup): low < wet   load(?c - cup): low < full }
  derived    { total := count ?wet - cup: wet(?wet) }
  actions    { dry(?c - cup) }
  rule low: dry(?wet) {
    when wet(?wet), heat(?wet) = wet, load(dry) != low
    then 1: not wet(?wet), forall ?c - cup: wet(?c) => heat(?c) := low
  }
  reward { decrease(total) }  # wet
}
""",
)


def _renamed(source: Source, old: str, new: str, kind: Kind | None = None) -> str:
    return apply_edits(source.text, rename([source], old, new, kind)[source.path])


def occurrences(source: Source, offset: int) -> list[Occurrence]:
    """All occurrences of what is named at an offset."""
    names = names_in(source)
    meanings = [name.meaning for name in names if name.span.start <= offset < name.span.end]
    return [name for name in names if name.meaning in meanings]


def _changed_lines(old: str, new: str) -> list[str]:
    return [b.strip() for a, b in zip(old.splitlines(), new.splitlines(), strict=True) if a != b]


FISHING = Source(
    "fishing",
    """domain fishing {
  types      { pond; boat }
  predicates { at(?b - boat ?p - pond) }
  functions  { size(?p - pond): 0..9 [static] }
  actions    { cast(?p - pond) [cost = 1 + 2 * size(?p)] }
  rule cast_it: cast(?p) {
    with ?b - boat: at(?b, ?p)
    then 0.5: reward += 2 + 0.5 * size(?p), cost += size(?p) + 3 * size(?p)
         rest: nothing
  }
  reward { - cost }
}
""",
)


def test_a_function_is_renamed_in_what_is_paid_and_so_are_its_variables() -> None:
    wider = _renamed(FISHING, "size", "width")
    assert "cost = 1 + 2 * width(?p)" in wider
    assert "reward += 2 + 0.5 * width(?p), cost += width(?p) + 3 * width(?p)" in wider
    assert "size" not in wider
    offset = FISHING.text.index("?p), cost")
    assert len(occurrences(FISHING, offset)) == 5  # those of the rule
    assert load_domain(Source("fishing", wider)).rules[0].outcomes[0].reward.parts[0].symbol == "width"


def test_every_name_in_the_tree_has_a_meaning() -> None:
    """A node that the grammar gains must say what its names stand for."""
    known = {*name_index.DECLARED, *name_index.USED, (syntax.Group, "names")}
    for node in vars(syntax).values():
        if isinstance(node, type) and issubclass(node, syntax.Node):
            hints = typing.get_type_hints(node)
            for field in dataclasses.fields(node):
                if re.search(r"\bName\b", str(hints[field.name]).replace("syntax.", " ")):
                    assert (node, field.name) in known, f"{node.__name__}.{field.name}"


@pytest.mark.parametrize(
    "path", sorted(shipped("domains").glob("*.nid")) + sorted(shipped("problems").glob("*.nid"))
)
def test_spans_hold_the_names(path: Path) -> None:
    source = read_source(path)
    for name in names_in(source):
        mark = "?" if name.meaning.kind is Kind.VARIABLE else ""
        assert source.text[name.span.start : name.span.end] == mark + name.meaning.name


@pytest.mark.parametrize(
    ("old", "kind", "lines"),
    [
        ("wet", Kind.TYPE, ["types      { new; cup - new }"]),
        (
            "wet",
            Kind.SYMBOL,
            [
                "predicates { new(?wet - cup) }",
                "derived    { total := count ?wet - cup: new(?wet) }",
                "when new(?wet), heat(?wet) = wet, load(dry) != low",
                "then 1: not new(?wet), forall ?c - cup: new(?c) => heat(?c) := low",
            ],
        ),
        (
            "dry",
            Kind.OBJECT,
            ["constants  { new - cup }", "when wet(?wet), heat(?wet) = wet, load(new) != low"],
        ),
        ("dry", Kind.ACTION, ["actions    { new(?c - cup) }", "rule low: new(?wet) {"]),
        ("low", Kind.RULE, ["rule new: dry(?wet) {"]),
        (
            "heat.low",
            None,
            [
                "functions  { heat(?c - cup): new < wet   load(?c - cup): low < full }",
                "then 1: not wet(?wet), forall ?c - cup: wet(?c) => heat(?c) := new",
            ],
        ),
        (
            "total",
            None,
            ["derived    { new := count ?wet - cup: wet(?wet) }", "reward { decrease(new) }  # wet"],
        ),
    ],
)
def test_only_names_of_the_kind_change(old: str, kind: Kind | None, lines: list[str]) -> None:
    new = _renamed(TANGLED, old, "new", kind)
    assert _changed_lines(TANGLED.text, new) == lines
    load_domain(Source("renamed", new))
    assert (
        _renamed(Source("tangled", new), "heat.new" if "." in old else "new", old.split(".")[-1])
        == TANGLED.text
    )


def test_a_rename_reaches_the_problems() -> None:
    edits = rename([DOMAIN, PROBLEM, SCENE], "dirty_areas", "left")
    assert set(edits) == {DOMAIN.path, PROBLEM.path}
    domain = load_domain(Source("d", apply_edits(DOMAIN.text, edits[DOMAIN.path])))
    problem = load_problem(Source("p", apply_edits(PROBLEM.text, edits[PROBLEM.path])), domain)
    assert domain.counts[0].name == "left"
    assert isinstance(problem.horizon, Horizon)
    assert problem.horizon.count == "left"


@pytest.mark.parametrize(
    ("old", "new", "kind", "code", "words"),
    [
        ("wett", "a", None, "E801", "did you mean `wet`"),
        ("wet", "a", Kind.RULE, "E801", "no rule `wet`"),
        ("c", "a", None, "E801", "`c`"),
        ("wet", "a", None, "E802", "the type and the symbol and the value `heat.wet`"),
        ("low", "a", Kind.VALUE, "E802", "the value `heat.low` and the value `load.low`"),
        ("cup", "wet", None, "E803", "already a type"),
        ("total", "heat", None, "E803", "already a symbol"),
        ("heat.low", "wet", None, "E803", "already a value"),
        ("total", "forall", None, "E804", "word of the language"),
        ("total", "2nd", None, "E804", "no name"),
        ("total", "größe", None, "E804", "no name"),
    ],
)
def test_refusals(old: str, new: str, kind: Kind | None, code: str, words: str) -> None:
    with pytest.raises(Refused) as refused:
        rename([TANGLED], old, new, kind)
    (diagnostic,) = refused.value.diagnostics
    assert diagnostic.code == code
    assert words in f"{diagnostic.message} {diagnostic.help}"


def test_a_name_of_one_kind_may_be_that_of_another() -> None:
    load_domain(Source("d", _renamed(TANGLED, "total", "low")))


def test_occurrences_of_what_is_under_the_cursor() -> None:
    text = TANGLED.text
    found = occurrences(TANGLED, text.index("heat(?wet)"))
    assert [name.declares for name in found] == [True, False, False]
    assert {name.meaning.name for name in found} == {"heat"}
    assert occurrences(TANGLED, text.index("# wet")) == []
    assert [name.meaning.kind for name in occurrences(TANGLED, text.index("low: dry"))] == [Kind.RULE]


def test_variables_belong_to_what_binds_them() -> None:
    text = TANGLED.text
    rule = text.index("rule low")
    in_rule = occurrences(TANGLED, text.index("?wet", rule))
    assert len(in_rule) == 4
    assert all(name.span.start > rule for name in in_rule)
    assert len(occurrences(TANGLED, text.index("?c - cup: wet"))) == 3
    assert len(occurrences(TANGLED, text.index("?wet - cup: wet"))) == 2


def test_half_a_text_still_has_names() -> None:
    text = DOMAIN.text
    for end in range(0, len(text), 331):
        if text[:end].strip() and "domain" in text[:end]:
            names_in(Source("half", text[:end]))
