"""The commands: what each says of itself in a line, its arguments, and what the shell offers for them.

A completion answers while a person waits, and the help lists all commands: neither imports any of them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import click

from cleancli.cli.completion import (
    Completer,
    actions,
    check_files,
    domains,
    nid_files,
    problems,
    renamable,
    studies,
)
from cleancli.cli.options import FOLDER


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a command: what completes it, how many values it has (-1: any number), and whatever
    else click may be told of it."""

    name: str
    complete: Completer | None = None
    count: int = 1
    settings: Mapping[str, Any] = field(default_factory=dict)

    def parameter(self) -> click.Argument:
        """The argument for click."""
        return click.Argument(
            [self.name], nargs=self.count, shell_complete=self.complete, **{"required": True, **self.settings}
        )


@dataclass(frozen=True, slots=True)
class CommandRow:
    """A command; `options_first`: its arguments cannot be completed before the options are read."""

    summary: str
    arguments: tuple[Argument, ...] = ()
    options_first: bool = False

    def parameters(self) -> list[click.Parameter]:
        """The arguments for click."""
        return [argument.parameter() for argument in self.arguments]


_DOMAIN, _PROBLEM = Argument("domain", domains), Argument("problem", problems)
_MAYBE: Mapping[str, Any] = {"required": False}

COMMANDS: Mapping[str, CommandRow] = MappingProxyType(
    {
        "init": CommandRow(
            "Write a small domain and a problem to start from.",
            (Argument("folder", settings={"type": FOLDER, "default": Path(), "required": False}),),
        ),
        "check": CommandRow(
            "Report every mistake in domain, problem, scene and study files.",
            (Argument("files", check_files, -1, {"metavar": "FILE..."}),),
        ),
        "fmt": CommandRow(
            "Lay files out in the one canonical way, comments kept.",
            (Argument("files", nid_files, -1, {"metavar": "FILE..."}),),
        ),
        "show": CommandRow(
            "Types, rules and groundings of a domain.",
            (_DOMAIN, Argument("problem", problems, settings=_MAYBE)),
        ),
        "compile": CommandRow("The grounded task, as text or JSON.", (_DOMAIN, _PROBLEM)),
        "explain": CommandRow(
            "Which rule covers an action, and if none does, why.",
            (_DOMAIN, _PROBLEM, Argument("action", actions)),
        ),
        "rename": CommandRow(
            "Rename a declared thing in a domain and its problems.",
            (
                Argument("old", renamable),
                Argument("new"),
                Argument("problem_files", problems, -1, {"metavar": "[PROBLEM]...", "required": False}),
            ),
            options_first=True,
        ),
        "plan": CommandRow(
            "Plan for a problem, or for what the camera sees of a scene.", (_DOMAIN, _PROBLEM)
        ),
        "simulate": CommandRow(
            "How well planners do in the symbolic world, over many episodes.", (_DOMAIN, _PROBLEM)
        ),
        "execute": CommandRow(
            "Clean a simulated table, or carry out a problem by its rules: look, plan, act.",
            (Argument("domain", domains, settings=_MAYBE), Argument("problem", problems, settings=_MAYBE)),
        ),
        "experiment": CommandRow(
            "Carry out a study: many episodes, here or on a cluster, and a row of each.",
            (Argument("study", studies, settings=_MAYBE),),
        ),
        "report": CommandRow(
            "A run or a series as a page, or several runs compared.",
            (Argument("folders", None, -1, {"metavar": "RUN...", "type": click.Path(path_type=Path)}),),
        ),
        "scene": CommandRow(
            "What a scene holds, how it looks, what its robot reaches.", (Argument("scene", problems),)
        ),
        "calibrate": CommandRow("Adjust perception to a clean surface.", (Argument("scene", problems),)),
        "cell": CommandRow("Where a real cell's camera and robot stand: the board, touches, checks."),
        "perceive": CommandRow(
            "What is seen of a scene, or in recorded frames, step by step.",
            (Argument("scene_or_folder", problems, settings={"metavar": "SCENE|RECORDING"}),),
        ),
        "act": CommandRow(
            "Try one action many times, and count how it truly ends.",
            (Argument("scene", problems), Argument("action")),
        ),
        "learn": CommandRow(
            "Improve a domain's probabilities from recorded experience.",
            (
                Argument("domain", domains, settings=_MAYBE),
                Argument(
                    "experience",
                    None,
                    -1,
                    {"metavar": "EXPERIENCE...", "required": False, "type": click.Path(path_type=Path)},
                ),
            ),
        ),
        "compare-rules": CommandRow(
            "Two domains side by side: which rules say the same, and where they differ.",
            (
                Argument("first", domains),
                Argument("second", domains),
                Argument(
                    "experience",
                    None,
                    -1,
                    {
                        "metavar": "[EXPERIENCE]...",
                        "required": False,
                        "type": click.Path(path_type=Path),
                    },
                ),
            ),
        ),
        "convert": CommandRow(
            "Files of PDDL, PPDDL and libPRADA as .nid files, and the other way; RDDL too.",
            (Argument("files", None, -1, {"metavar": "FILE... | FOLDER"}),),
        ),
        "robot": CommandRow(
            "A robot at the end of a socket: serve a simulated one, check and re-arm others."
        ),
        "lsp": CommandRow("Serve editors: mistakes while typing, completion, rename."),
    }
)
"""In the order of the help. Each lives in the module of the same name in `cli.commands`, with `_` for `-`, as
`command`."""


def command_of(name: str) -> Callable[[Callable[..., Any]], click.Command]:
    """Makes a function the command of a row; its options stand at the function."""
    row = COMMANDS[name]
    return click.command(name, short_help=row.summary, params=row.parameters())


def group_of(name: str) -> Callable[[Callable[..., Any]], click.Group]:
    """The same for a command that has commands of its own."""
    return click.group(name, short_help=COMMANDS[name].summary, no_args_is_help=False)


def light_command(name: str) -> click.Command | None:
    """A command's arguments without the command, while the shell completes a line that has no options."""
    row = COMMANDS[name]
    if "_CLEANCLI_COMPLETE" not in os.environ or row.options_first or not row.arguments:
        return None
    if any(word.startswith("-") for word in os.environ.get("COMP_WORDS", "").split()):
        return None
    parameters = row.parameters()
    for parameter in parameters:
        parameter.required = False  # the line is not complete yet
    return click.Command(name, params=parameters)
