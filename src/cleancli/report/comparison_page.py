"""Runs side by side, as one page of HTML."""

from __future__ import annotations

from collections.abc import Sequence

from cleancli.report.account import RunRow, colour_of, name_of
from cleancli.report.page import bars, templates
from cleancli.report.timeline import in_order


def comparison_page(rows: Sequence[RunRow]) -> str:
    """A page that sets runs side by side; all bars have one scale."""
    longest = max((row.total for row in rows), default=0.0)
    kinds = in_order({kind: 0.0 for row in rows for kind in row.seconds})
    return (
        templates()
        .get_template("compare.html")
        .render(
            rows=[(row, bars(row.seconds, longest)) for row in rows],
            kinds=[(kind, name_of(kind), colour_of(kind)) for kind in kinds],
            first=rows[0],
        )
    )
