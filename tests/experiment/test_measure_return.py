"""`measure = return` (docs/experiments.md): what problems pay, and how it is compared."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, sqrt
from pathlib import Path
from statistics import fmean, stdev

import pytest

from cleancli.experiment.rows import read_rows, write_rows
from cleancli.language.diagnostics.refused import Refused
from cleancli.results.judged import judged
from cleancli.results.page import reason
from cleancli.statistics.verdict import Bounds, Verdict
from cleancli.study.model import Comparison
from support.studies import opened, rows_here
from support.study_rows import row

FISHING = """
domain fishing {
  types      { pond }
  predicates { caught(?p - pond) }
  actions    { cast(?p - pond) [cost = 1] }
  rule cast_it: cast(?p) {
    when not caught(?p)
    then 0.4: caught(?p), reward += 4
         rest: reward -= 0.5
  }
  reward { - cost }
}
"""
MORNING = """
problem morning {
  domain   = fishing
  objects  { lake - pond }
  goal     { caught(lake) }
  horizon  = 9
  discount = 0.8
}
"""
RUNS = 150


def test_it_is_the_discounted_sum_of_what_is_paid(tmp_path: Path) -> None:
    (tmp_path / "fishing.nid").write_text(FISHING, encoding="utf-8")
    (tmp_path / "morning.nid").write_text(MORNING, encoding="utf-8")
    rows = rows_here(
        opened(
            f'study s {{ domain = "{tmp_path}/fishing.nid"  scene = "{tmp_path}/morning.nid"  planner = exact'
            f"  measure = return  max_actions = 9  runs = {RUNS} }}"
        )
    )
    for each in rows:
        steps = [0.8**k * (-1.5) for k in range(each.actions)]
        if each.clean:
            steps[-1] = 0.8 ** (each.actions - 1) * 3
        assert each.paid == pytest.approx(sum(steps))
    paid = [each.paid or 0.0 for each in rows]
    expected = sum((0.8 * 0.6) ** k * (0.4 * 3 - 0.6 * 1.5) for k in range(9))
    assert abs(fmean(paid) - expected) <= 3 * stdev(paid) / sqrt(RUNS)
    write_rows(tmp_path, rows)
    assert read_rows(tmp_path / "rows.parquet") == tuple(rows)


def test_it_is_refused_of_tables_where_the_study_names_it() -> None:
    text = "study s { scene = three_areas, two_groups  measure = return }"
    with pytest.raises(Refused) as error:
        opened(text)
    (found,) = error.value.diagnostics
    assert found.code == "E523"
    assert found.span is not None
    assert text[found.span.start : found.span.end] == "return"
    assert found.message == "`return` is told of problems alone, and `two_groups` is a table"
    assert "`seconds`" in found.help
    assert opened("study s { scene = three_areas  measure = return }")


@pytest.mark.parametrize(
    ("expect", "factor", "margin", "won"),
    [
        ("more", 1.0, 0.0, True),
        ("less", 1.0, 0.0, False),
        ("equal", 1.0, 0.1, False),
        ("equal", 1.0, 0.5, True),
        ("more", 2.0, 0.0, True),
        ("less", 0.5, 0.0, True),
    ],
)
def test_what_may_be_negative_is_compared_by_differences(
    expect: str, factor: float, margin: float, won: bool
) -> None:
    """A return of -3 is more than one of -4, though its ratio to that is less than 1."""
    paid = {
        "plan-1": [-3.0, -3.1, -2.9, -3.2, -3.0, -2.8],
        "plan-2": [-4.0, -4.2, -3.9, -4.1, -4.0, -4.1],
    }
    rows = [
        replace(row({"strategy": name, "simulator": "symbolic"}, run, 1.0, run % 2 == 0), paid=value)
        for name, values in paid.items()
        for run, value in enumerate(values, 1)
    ]
    first, second = {"strategy": ("plan-1",)}, {"strategy": ("plan-2",)}
    said = Comparison("c", "", "return", expect, first, second, factor=factor, margin=margin)
    (found,) = judged([said], rows)
    differences = [a - factor * b for a, b in zip(*paid.values(), strict=True)]
    assert found.estimate.value == pytest.approx(fmean(differences))
    assert found.estimate.low <= fmean(differences) <= found.estimate.high
    assert found.verdict is (Verdict.WON if won else Verdict.LOST)
    if expect == "equal":
        assert found.bounds.high == pytest.approx(margin * 4.05)
        assert found.bounds.low == -found.bounds.high
    else:
        assert found.bounds in (Bounds(low=0.0), Bounds(high=0.0))
    assert found.sides is not None
    assert isnan(found.sides.paired.ratio.value)
    assert found.sides.first.count == 6, "also those that did not finish"
    assert "of the first less " in reason(found)
