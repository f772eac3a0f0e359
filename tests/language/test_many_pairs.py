"""Pairs of rules that are looked at and do not overlap use up nothing of what is reported."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.diagnostic import Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain, load_domain

RULES_OF_AN_ACTION = 8
"""So few are compared each with each: 28 pairs an action."""


def domain(actions: int, *more: str) -> str:
    """For each action rules for each value of a number, of which no two overlap; and what is added."""
    names = [f"act{number}" for number in range(actions)]
    rules = [
        f"rule {name}_{value}: {name}(?a) {{ when load(?a) = {value} then 1: not dirt(?a) }}"
        for name in names
        for value in range(RULES_OF_AN_ACTION)
    ]
    declared = " ".join(f"{name}(?a - area)" for name in [*names, "wipe"])
    return f"""domain many {{
  types {{ area }}  predicates {{ dirt(?a - area)  wet(?a - area) }}
  functions {{ load(?a - area): 0..{RULES_OF_AN_ACTION} }}
  derived {{ dirty := count ?a - area: dirt(?a) }}
  actions {{ {declared} }}
  {" ".join([*rules, *more])}
  reward {{ decrease(dirty) }}
}}"""


def codes(text: str) -> list[str]:
    with pytest.raises(Refused) as refused:
        load_domain(Source("many.nid", text))
    return [diagnostic.code for diagnostic in refused.value.diagnostics]


def test_an_overlap_after_many_pairs_that_exclude_each_other_is_found() -> None:
    load_domain(Source("many.nid", domain(4)))
    overlap = (
        "rule one: wipe(?a) { when dirt(?a) then 1: not dirt(?a) }",
        "rule other: wipe(?a) { when wet(?a) then 1: not dirt(?a) }",
    )
    assert codes(domain(4, *overlap)) == ["E307"]


def test_fifty_overlaps_are_reported_and_no_more() -> None:
    overlapping = [
        f"rule r{n}: wipe(?a) {{ when dirt(?a) then 0.5: wet(?a) rest: noise }}" for n in range(12)
    ]
    assert codes(domain(0, *overlapping)) == ["E307"] * 50
    assert codes(domain(0, *overlapping[:10])) == ["E307"] * 45


@pytest.mark.parametrize("objects", [2, 60])
def test_where_the_search_is_given_up_the_rules_may_overlap(objects: int) -> None:
    """W307, which refuses nothing: grounding decides. Where it is not given up they do (E307)."""
    names = [f"?o{number}" for number in range(objects)]
    several = f"exists {' '.join(names)} - area: ({', '.join(f'wet({name})' for name in names)})"
    text = domain(
        1,
        f"rule some: wipe(?a) {{ when {several} then 1: not dirt(?a) }}",
        "rule dirty: wipe(?a) { when dirt(?a) then 1: not dirt(?a) }",
    )
    found = checked_domain(Source("many.nid", text)).diagnostics
    overlaps = [each.code for each in found if each.code in ("E307", "W307")]
    assert overlaps == ["E307" if objects == 2 else "W307"]
