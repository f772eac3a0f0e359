"""A person as the teacher: asked at the terminal for an action, until it is one."""

from __future__ import annotations

import click

from cleancli.cli.echo import echo
from cleancli.cli.questions import answer
from cleancli.execution.episode_state import Move
from cleancli.execution.teaching import Question
from cleancli.language.calls import read_action
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.diagnostics.render import render


def ask(asked: Question) -> Move | None:
    """What a person shows; None for an empty line, or where there is no more input."""
    echo(str(asked), err=True)
    while True:
        said: str | None = answer(
            lambda: click.prompt(
                "what to do, or nothing to end here", default="", show_default=False, err=True
            )
        )
        if said is None:
            echo(err=True)
        if not (text := said or "").strip():
            return None
        try:
            return Move(*read_action(text, asked.domain, asked.problem))
        except Refused as refused:
            echo(render(refused.diagnostics, refused.sources), err=True)
