"""The index of names covers the whole syntax, and knows what belongs together."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Iterator

import pytest

from cleancli.language import syntax
from cleancli.language.refactoring.name_index import DECLARED, USED, Kind
from support.editor_texts import DOMAIN, at, marked, opened


def parts_of(kind: object) -> Iterator[object]:
    """A type and all that it is made of."""
    yield kind
    for part in typing.get_args(kind):
        yield from parts_of(part)


def name_fields() -> list[tuple[type[syntax.Node], str]]:
    """Every field of the syntax tree that holds a name, but those that `names` reads by where they stand."""
    nodes = [n for _, n in inspect.getmembers(syntax, inspect.isclass) if issubclass(n, syntax.Node)]
    found = []
    for node in nodes:
        for field, kind in typing.get_type_hints(node).items():
            if syntax.Name in parts_of(kind) and (node, field) != (syntax.Group, "names"):
                found.append((node, field))
    return found


def test_every_name_of_the_syntax_has_a_row() -> None:
    fields = set(name_fields())
    assert len(fields) > 15
    assert fields <= {*DECLARED, *USED}
    words = {(syntax.Setting, "value"), (syntax.Listed, "values")}
    assert {*DECLARED, *USED} - fields == words, "values of settings may be words"


def test_every_word_of_the_index_is_what_stands_there() -> None:
    for name in ("tables.nid", "two.nid", "little.nid"):
        asked = opened(name)
        for occurrence in asked.names:
            text = asked.source.text[occurrence.span.start : occurrence.span.end]
            assert text.removeprefix("?") == occurrence.meaning.name


@pytest.mark.parametrize(
    ("mark", "kind", "home"),
    [
        ("size(?x) = |small", Kind.VALUE, "size"),
        ("size(?a - area): |small", Kind.VALUE, "size"),
        ("weight(?a - area): |small", Kind.VALUE, "weight"),
        ("|bin - container", Kind.OBJECT, ""),
        ("traversal(?x, |bin", Kind.OBJECT, ""),
        ("rule push_small: |push", Kind.ACTION, ""),
        ("decrease(|dirty_areas", Kind.COUNT, ""),
    ],
)
def test_what_a_name_means(mark: str, kind: Kind, home: str) -> None:
    asked, offset = at("tables.nid", mark)
    found = asked.at(offset)
    assert found is not None
    assert (found.meaning.kind, found.meaning.home) == (kind, home)


def test_objects_belong_to_their_problem_and_constants_to_the_domain() -> None:
    asked, offset = at("two.nid", "near(|a1")
    own = asked.at(offset)
    shared = asked.at(at("two.nid", "traversal(a1, |bin")[1])
    assert own is not None
    assert shared is not None
    assert (own.meaning.home, shared.meaning.home) == (asked.source.path, "")


def test_a_quantifier_binds_its_own_variable() -> None:
    text = DOMAIN.replace("0.1: size(?x) := medium", "0.1: forall ?m - area: near(?x, |?m) => not dirt(?m)")
    asked, offset, _ = marked("tables.nid", text)
    found = asked.at(offset)
    assert found is not None
    same = [o for o in asked.names if o.meaning == found.meaning]
    assert len(same) == 3, "those of the other outcome are another variable"
    assert [o.declares for o in same] == [True, False, False]


def test_a_reference_binds_for_the_whole_rule() -> None:
    text = DOMAIN.replace(
        "size(?x) = small\n    then", "size(?x) = small\n    with ?r - area: near(?x, ?r)\n    then"
    ).replace("0.1: size(?x) := medium", "0.1: not dirt(|?r)")
    asked, offset, _ = marked("tables.nid", text)
    found = asked.at(offset)
    assert found is not None
    assert [o.declares for o in asked.names if o.meaning == found.meaning] == [True, False, False]


def test_a_quantified_condition_binds_only_there() -> None:
    text = DOMAIN.replace(
        "when dirt(?x), size", "when exists ?q - area: near(?x, ?q), not exists ?q - area: dirt(|?q), size"
    )
    asked, offset, _ = marked("tables.nid", text)
    found = asked.at(offset)
    assert found is not None
    assert [o.declares for o in asked.names if o.meaning == found.meaning] == [True, False]


def test_a_broken_section_hides_no_names_of_the_others() -> None:
    asked, _, _ = marked("tables.nid", DOMAIN.replace("0.9: not", "0.9 not") + "|")
    declared = {o.meaning.name for o in asked.declared()}
    assert "push_small" in declared
    assert "join_two" not in declared
