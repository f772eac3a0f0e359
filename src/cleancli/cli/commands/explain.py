"""`cleancli explain`: which rule covers an action, and if none does, what each of its rules lacks."""

from __future__ import annotations

import json

import click

from cleancli.api.explanations import explanation
from cleancli.cli import options
from cleancli.cli.command_table import command_of
from cleancli.cli.echo import echo
from cleancli.cli.inputs import open_given
from cleancli.cli.progress import working


@command_of("explain")
@click.option(
    "--after",
    metavar="ACTIONS",
    default="",
    help='Explain it in the state after others, like "fill(jug)": each has its likeliest change.',
)
@options.as_json("Print the explanation as JSON.")
def command(domain: str, problem: str, action: str, after: str, as_data: bool) -> None:
    """Say what ACTION, like "pour(jug, glass)", would do in the initial state of PROBLEM, and by which rule.

    If no rule covers it, say of each of its rules which literals fail, and what holds instead. For a scene,
    the state is that of one look at its table.
    """
    given = open_given(domain, problem)
    with working("looking at the table", quiet=not given.is_scene):
        found = explanation(given, action, after)
    if as_data:
        click.echo(json.dumps(found.to_dict(), indent=2))
    else:
        echo(str(found))
