"""docs/language.md of a `forall` beside other effects: it counts for `check` as if some object fitted it."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.diagnostic import Level, Source
from cleancli.language.load import checked_domain

DOMAIN = """domain d {
  types { area }
  predicates { dirt(?a - area) mark(?a - area) }
  functions { load(): 0..10 }
  derived { n := count ?a - area: dirt(?a) }
  actions { go(?a - area) }
  %s
  reward { decrease(n) }
}
"""


def codes(rules: str) -> list[str]:
    found = checked_domain(Source("d.nid", DOMAIN % rules)).diagnostics
    return [each.code for each in found if each.level is Level.ERROR]


@pytest.mark.parametrize(
    ("effects", "refused"),
    [
        ("load() := 0, forall ?m - area: dirt(?m) => load() := 3", True),
        ("forall ?m - area: dirt(?m) => load() := 3, load() := 0", True),
        ("load() += 1, forall ?m - area: dirt(?m) => load() := 3", True),
        ("load() := 0, forall ?m - area: dirt(?m) => load() += 1", True),
        ("mark(?a), forall ?m - area: dirt(?m) => not mark(?a)", True),
        ("forall ?m - area: dirt(?m) => (mark(?m), not mark(?m))", True),
        ("load() := 3, forall ?m - area: dirt(?m) => load() := 3", False),
        ("load() += 1, forall ?m - area: dirt(?m) => load() -= 1", False),
        ("mark(?a), forall ?m - area: dirt(?m) => not mark(?m)", False),  # where ?m is ?a: E602
    ],
)
def test_a_forall_counts_as_if_some_object_fitted_it(effects: str, refused: bool) -> None:
    assert codes(f"rule r: go(?a) {{ then 1: {effects} }}") == ["E308"] * refused


def test_two_rules_say_what_the_page_advises() -> None:
    some, none = "exists ?m - area: dirt(?m)", "not exists ?m - area: dirt(?m)"
    rules = f"rule r: go(?a) {{ when {some} then 1: load() := 3 }}"
    assert codes(f"{rules} rule s: go(?a) {{ when {none} then 1: load() := 0 }}") == []
