"""What `cleancli simulate` prints: a row per planner, or everything as data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict

import click
from rich.table import Table

from cleancli.cli.tables import plain_table, print_table
from cleancli.simulation.episode import Episode
from cleancli.simulation.runs import Setup
from cleancli.simulation.summary import Estimate, Summary


def print_summaries(summaries: Sequence[Summary]) -> None:
    """The table, and why episodes ended."""
    print_table(_table(summaries))
    click.echo(
        f"means of {summaries[0].episodes} episodes, with 95 % intervals (success: Wilson's; others: t)"
    )
    for summary in summaries:
        reasons = ", ".join(f"{reason.value} {number}" for reason, number in summary.reasons.items())
        click.echo(f"{summary.planner} ended: {reasons}")


def _table(summaries: Sequence[Summary]) -> Table:
    compared = len(summaries) > 1
    columns = ["return", "undiscounted", "actions", "robot s", "success", "plan s median", "95th"]
    if compared:
        columns.insert(1, "more than first")
    table = plain_table("planner", *columns)
    for s in summaries:
        gain = [_text(s.gain)] if compared else []
        found = [_text(each) for each in (s.plain, s.actions, s.seconds, s.success)]
        table.add_row(
            s.planner, _text(s.discounted), *gain, *found, *map(_seconds, (s.planning_median, s.planning_95))
        )
    return table


def _text(estimate: Estimate | None) -> str:
    if estimate is None:
        return "-"
    if estimate.low is None:
        return f"{estimate.mean:.3f}"
    return f"{estimate.mean:.3f} [{estimate.low:.3f}, {estimate.high:.3f}]"


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.4f}"


def as_data(
    setup: Setup,
    summaries: Sequence[Summary],
    episodes: Sequence[Sequence[Episode]],
    options: Mapping[str, object],
) -> dict[str, object]:
    """Everything that was asked for and found."""
    return {
        "problem": setup.problem.name,
        "domain": setup.domain.name,
        "world": setup.world.name,
        "objective": "time" if setup.timed else "reward",
        "options": dict(options),
        "limits": {"max_actions": setup.limits.max_actions, "commit": setup.limits.commit},
        "planners": [
            {**_summary(summary), "rows": [_row(each) for each in rows]}
            for summary, rows in zip(summaries, episodes, strict=True)
        ],
    }


def _summary(summary: Summary) -> dict[str, object]:
    data = asdict(summary)
    data["reasons"] = {reason.value: number for reason, number in summary.reasons.items()}
    return data


def _row(episode: Episode) -> dict[str, object]:
    data = asdict(episode)
    data["reason"] = episode.reason.value
    data["actions"] = [str(action) for action in episode.actions]
    data["planning"] = list(episode.planning)
    return data
