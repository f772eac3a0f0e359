"""E604 for instances that are few and long: just as many literals and effects as fit, and one fewer."""

from __future__ import annotations

import domain_texts
import pytest

from cleancli.compiler import count
from cleancli.compiler.ground import ground
from cleancli.language.diagnostics import Refused

TEXT = """domain d {
  types { area }
  predicates { dirt(?a - area)  wet(?a - area)  near(?a ?b - area) }
  derived {
    dirty := count ?a - area: dirt(?a)
    beset(?a - area) := exists ?b - area: (near(?a, ?b), dirt(?b))
    doubly(?a - area) := beset(?a), exists ?b - area: (wet(?b), near(?b, ?a))
  }
  actions { wipe(?a - area)  link(?a ?b - area) }
  rule wiped: wipe(?a) { when dirt(?a)%s then 0.5: not dirt(?a)%s  0.25: wet(?a)%s  rest: noise }
  rule linked: link(?a, ?b) { when wet(?a) then 1: near(?a, ?b) }
  reward { decrease(dirty) }
}"""
AREAS = "objects { a b c d - area } init { dirt(a), dirt(b), dirt(c), wet(d) }"
FORALL = ", forall ?m - area: near(?a, ?m) => wet(?m)"


@pytest.mark.parametrize(
    ("when", "first", "second", "each"),
    [
        ("", FORALL, "", 4),
        ("", FORALL, FORALL, 8),
        ("", FORALL.replace("?m", "?k"), FORALL, 8),
        (", exists ?m - area: near(?a, ?m)", "", "", 4),
        (", exists ?m ?k - area: (near(?m, ?k), dirt(?k))", "", "", 16),
        (", exists ?m - area: (near(?a, ?m), wet(?m))", FORALL, "", 8),
        (", beset(?a)", "", "", 5),
        (", doubly(?a)", "", "", 10),
    ],
)
def test_parts_are_counted(
    when: str, first: str, second: str, each: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    checked = domain_texts.checked(TEXT % (when, first, second), AREAS)
    monkeypatch.setattr(count, "PART_LIMIT", 4 * each)
    ground(*checked)
    monkeypatch.setattr(count, "PART_LIMIT", 4 * each - 1)
    with pytest.raises(Refused) as refused:
        ground(*checked)
    (said,) = refused.value.diagnostics
    assert said.code == "E604"
    assert f"up to {4 * each:,} literals and effects" in said.message


def test_a_rule_without_such_parts_is_not_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(count, "PART_LIMIT", 0)
    ground(*domain_texts.checked(TEXT % ("", "", ""), AREAS))


@pytest.mark.parametrize(("most", "refused"), [(20, False), (19, True)])
def test_just_as_many_groundings_as_fit(most: int, refused: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Four of `wiped` and sixteen of `linked`."""
    checked = domain_texts.checked(TEXT % ("", "", ""), AREAS)
    monkeypatch.setattr(count, "RULE_LIMIT", most)
    if not refused:
        ground(*checked)
        return
    with pytest.raises(Refused) as said:
        ground(*checked)
    assert [d.code for d in said.value.diagnostics] == ["E604"]
    assert (
        "rule `linked` has 16 groundings of 20 in all; 19 are the most" in said.value.diagnostics[0].message
    )


def test_groundings_are_counted_exactly_where_that_is_quick() -> None:
    domain, problem = domain_texts.checked(TEXT % ("", "", ""), AREAS)
    assert [(each.name, each.count, each.exact) for each in count.count_groundings(domain, problem)] == [
        ("wiped", 4, True),
        ("linked", 16, True),
    ]
