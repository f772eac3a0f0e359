"""W301, an effect that changes nothing: not where another effect of the outcome may be about the same."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics import Source
from cleancli.language.load import checked_domain

DOMAIN = """domain d {
  types { area }
  predicates { dirt(?a - area) mark(?a - area) }
  functions { load(?a - area): 0..3 }
  derived { n := count ?a - area: dirt(?a) }
  actions { go(?a ?b - area) }
  rule r: go(?a, ?b) { when %s then 0.4: %s 0.6: not dirt(?a) }
  reward { decrease(n) }
}
"""


@pytest.mark.parametrize(
    ("condition", "effects", "idle"),
    [
        ("dirt(?a), not mark(?b)", "mark(?a), not mark(?b)", 0),  # they conflict where ?a = ?b
        ("dirt(?a), load(?b) = 3", "load(?b) := 3, load(?a) += 1", 0),
        ("dirt(?a), load(?b) = 3", "load(?b) := 3, load(?a) := 1", 0),
        ("dirt(?a), not mark(?b)", "not mark(?a), not mark(?b)", 1),
        ("dirt(?a), not mark(?b)", "not dirt(?b), not mark(?b)", 1),
        ("dirt(?a), load(?b) = 3", "load(?b) := 3, mark(?a)", 1),
    ],
)
def test_an_effect_is_idle_only_where_no_other_is_about_the_same(
    condition: str, effects: str, idle: int
) -> None:
    found = checked_domain(Source("d.nid", DOMAIN % (condition, effects)))
    assert [each.code for each in found.diagnostics].count("W301") == idle
