"""What `cleancli simulate` prints: a row per planner, or everything as data."""

from __future__ import annotations

import json

import click

from cleancli.api.simulation_result import SimulationResult
from cleancli.cli.views.tables import print_table, table_of


def echo_simulation(result: SimulationResult, as_data: bool) -> None:
    """The table, and why episodes ended."""
    if as_data:
        click.echo(json.dumps(result.to_dict(), indent=2))
        return
    print_table(table_of(result.table()))
    for line in result.ending():
        click.echo(line)
