"""What `cleancli simulate` prints: a row per planner, or everything as data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict

import click
from rich.table import Table

from cleancli.cli.views.tables import plain_table, print_table
from cleancli.language.diagnostics.plural import plural
from cleancli.simulation.batch import Batch
from cleancli.simulation.episode import Episode
from cleancli.simulation.summary import Estimate, Summary


def print_summaries(summaries: Sequence[Summary]) -> None:
    """The table, and why episodes ended."""
    print_table(_table(summaries))
    episodes = plural(summaries[0].episodes, "episode")
    click.echo(f"means of {episodes}; ± and to: 95 % intervals (Student's t, Wilson's)")
    for summary in summaries:
        reasons = ", ".join(f"{reason.value} {number}" for reason, number in summary.reasons.items())
        click.echo(f"{summary.planner} ended: {reasons}")


def _table(summaries: Sequence[Summary]) -> Table:
    compared = len(summaries) > 1
    columns = ["return", "plain", "actions", "robot s", "success %", "ms/plan", "95 %"]
    if compared:
        columns.insert(1, "over first")
    table = plain_table("planner", *columns)
    for s in summaries:
        gain = [_mean(s.gain, 3)] if compared else []
        found = [_mean(s.plain, 3), _mean(s.actions, 2), _mean(s.seconds, 1), _share(s.success)]
        planning = [_milliseconds(spent) for spent in (s.planning_median, s.planning_95)]
        table.add_row(s.planner, _mean(s.discounted, 3), *gain, *found, *planning)
    return table


def _mean(estimate: Estimate | None, digits: int) -> str:
    if estimate is None:
        return "-"
    half = "" if estimate.high is None else f" ± {estimate.high - estimate.mean:.{digits}f}"
    return f"{estimate.mean:.{digits}f}{half}"


def _share(estimate: Estimate | None) -> str:
    """Not symmetric, so with both ends."""
    if estimate is None or estimate.low is None or estimate.high is None:
        return "-"
    return f"{100 * estimate.mean:.1f} ({100 * estimate.low:.1f} to {100 * estimate.high:.1f})"


def _milliseconds(seconds: float | None) -> str:
    return "-" if seconds is None else f"{1000 * seconds:.1f}"


def as_data(
    setup: Batch,
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
