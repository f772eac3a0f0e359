"""`cleancli compare-rules`: which rules of two domains say the same, and where they differ."""

from __future__ import annotations

import json
from pathlib import Path

import click

from cleancli.api.rule_comparisons import DRAWN, comparison
from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.exit_codes import ExitCode
from cleancli.cli.inputs import open_loaded
from cleancli.cli.progress import working
from cleancli.cli.usage import usage_errors


@command_of("compare-rules")
@click.option(
    "--states",
    type=click.IntRange(min=1),
    default=DRAWN,
    show_default=True,
    help="How many states are drawn where no EXPERIENCE is given.",
)
@options.seed("the states that are drawn", "0")
@click.option(
    "--limit",
    type=click.FloatRange(min=0, max=1),
    help="Exit with 1 if the total variation (TV) is more than this in the mean.",
)
@options.as_json("Print the comparison as JSON.")
def command(
    first: str,
    second: str,
    experience: tuple[Path, ...],
    states: int,
    seed: int | None,
    limit: float | None,
    as_data: bool,
) -> int:
    """Say which rules of two domains say the same, and in which states they foretell what differs.

    They are compared in the states of EXPERIENCE (experience.jsonl files, run folders, or folders of runs),
    or in states that are drawn. Both domains must declare the same types, constants, symbols and actions.
    """
    both = open_loaded(first), open_loaded(second)
    with working("comparing"), usage_errors():
        found = comparison(*both, experience, states, seed or 0)
    if as_data:
        click.echo(json.dumps(found.to_dict(), indent=2))
    else:
        echo(str(found))
    return ExitCode.REFUSED if limit is not None and found.variation > limit else ExitCode.DONE
