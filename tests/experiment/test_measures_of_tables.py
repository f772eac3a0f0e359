"""What is told of tables alone is refused of problems, for which it would be 0 throughout."""

from __future__ import annotations

import pytest

from cleancli.language.diagnostics.refused import Refused
from cleancli.study.row import MEASURES
from support.studies import opened, rows_here

OF_TABLES = [name for name, measure in MEASURES.items() if measure.of_tables]
MIXED = """study s {{
  part table   {{ scene = two_groups }}
  part problem {{ scene = three_areas }}
  strategy = plan_1, plan_2
  compare c {{ measure = score  part = {part}  first {{ strategy = plan_1 }}  {beside} }}
}}"""


def refused_at(text: str) -> str:
    with pytest.raises(Refused) as error:
        opened(text)
    (found,) = error.value.diagnostics
    assert found.code == "E523"
    assert found.span is not None
    return text[found.span.start : found.span.end]


@pytest.mark.parametrize("measure", OF_TABLES)
def test_it_is_refused_where_the_study_names_it(measure: str) -> None:
    assert refused_at(f"study s {{ scene = three_areas  measure = {measure} }}") == measure
    assert opened(f"study s {{ scene = two_groups  measure = {measure} }}")


def test_a_comparison_is_refused_by_the_rows_that_it_selects() -> None:
    for beside in ("second { strategy = plan_2 }", "limit = 0.5"):
        assert refused_at(MIXED.format(part="problem", beside=beside)) == "score"
        assert opened(MIXED.format(part="table", beside=beside))


def test_those_that_are_left_out_are_0_of_problems_and_no_others_are() -> None:
    """But `unknown` and `learning`, which are 0 where nothing is learned."""
    rows = rows_here(opened("study s { scene = three_areas  samples = 100  runs = 1  estimator = m }"))
    assert all(MEASURES[name].of(row) == 0 for row in rows for name in OF_TABLES)
    for name in ("moving", "actions", "acting", "clean"):
        assert all(MEASURES[name].of(row) > 0 for row in rows), name
