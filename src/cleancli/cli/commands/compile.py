"""`cleancli compile`: the grounded task of a problem, for reading and for comparing."""

from __future__ import annotations

import json

import click

from cleancli.cli.command_table import command_of
from cleancli.cli.observe import open_both
from cleancli.compiler.dump import as_data, dump
from cleancli.compiler.ground import ground
from cleancli.language.load import located_in


@command_of("compile")
@click.option("--format", "style", type=click.Choice(["text", "json"]), default="text", show_default=True)
@click.option("--json", "style", flag_value="json", help="The same as --format json.")
def command(domain: str, problem: str, style: str) -> None:
    """Ground DOMAIN for PROBLEM and print what a planner gets: variables, actions, rules, reward.

    Everything is sorted, so that two tasks can be compared line by line. For a scene, the task is that of
    one look at its table.
    """
    sources, model, given = open_both(domain, problem)
    with located_in(*sources):
        task = ground(model, given)
    click.echo(json.dumps(as_data(task), indent=2) + "\n" if style == "json" else dump(task), nl=False)
