"""The `cleancli` command: finds the subcommand, runs it, and turns every failure into a message and a code.

Subcommands are modules that are imported only when called; a module may import what it needs at its top.
"""

from __future__ import annotations

import difflib
import gc
import importlib
import signal
import sys
from collections.abc import Sequence
from types import FrameType

import click

from cleancli import __version__
from cleancli.cli.command_table import COMMANDS, light_command
from cleancli.cli.exit_codes import ExitCode, MissingPart, Stopped
from cleancli.cli.streams import NoReader, finish, prepare
from cleancli.compiler.collector import paused_collector
from cleancli.files.interrupt import ENDING
from cleancli.language.diagnostics.diagnostic import printable
from cleancli.language.diagnostics.refused import Refused
from cleancli.world.errors import MissingPhysics, RobotError

_OF_PROBLEMS = {"--horizon": "horizon = 10", "--discount": "discount = 0.95"}
"""What a problem says, as somebody may look for it among the options."""


class _Commands(click.Group):
    """A group that imports a subcommand only to run it, and lists them all without importing any."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in COMMANDS:
            return None
        light = light_command(cmd_name)
        if light is not None:
            return light
        return _imported(cmd_name)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does; where there is no such command, the message names the near ones."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            raise click.UsageError(f"{error.message.rstrip('.')}. {_meant(args[0])}", ctx) from None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, row.summary) for name, row in COMMANDS.items()])


@paused_collector()
def _imported(name: str) -> click.Command:
    """The command, with all that its module imports. Python's collector would find nothing in that, and is
    kept from looking for it, now and while the command runs."""
    command = importlib.import_module(f"cleancli.cli.commands.{name.replace('-', '_')}").command
    assert isinstance(command, click.Command)
    if not gc.get_freeze_count():  # else it was told already
        gc.freeze()
    return command


def _meant(word: str) -> str:
    if word.endswith(".nid"):
        return f"A file stands behind a command: `cleancli check {word}`."
    near = difflib.get_close_matches(word.lower(), COMMANDS, n=2, cutoff=0.6)
    if near:
        return f"Did you mean {' or '.join(f'`{name}`' for name in near)}?"
    return "`cleancli --help` lists the commands."


@click.command(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="cleancli")
@click.option("--include-outside", is_flag=True, help="Let domains include files from outside their folder.")
def cli(include_outside: bool) -> None:
    """Teach a robot to clean: probabilistic rules in, motion out, better rules back.

    Rules of any other domain can be written, planned with, simulated and learned as well.

    DOMAIN, PROBLEM, SCENE and STUDY are paths of .nid files, or the bare names of those that ship with
    cleancli: try `cleancli execute cleaning two_groups --seed 1`.
    """


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with a documented code; no input ends in a traceback."""
    prepare()
    for number in ENDING:
        if signal.getsignal(number) is signal.SIG_DFL:  # else it is ignored, as nohup wants it
            signal.signal(number, _end)
    code = run(sys.argv[1:] if arguments is None else arguments)
    if "ompl" not in sys.modules:  # whose bindings would tell of all that is left then, as leaks
        gc.freeze()  # else Python looks through all that is left before it ends: a tenth of a second
    sys.exit(code)


def _end(number: int, _: FrameType | None) -> None:
    raise KeyboardInterrupt


def run(arguments: Sequence[str]) -> int:
    """The exit code for a command line; messages go to standard error."""
    code = _run(arguments)
    unwritten = finish()
    if unwritten is not None and code == ExitCode.DONE:
        return _of_disk(unwritten)
    return code


def _run(arguments: Sequence[str]) -> int:
    try:
        # Who only says the name wants to know what there is.
        result = cli.main(args=list(arguments) or ["--help"], prog_name="cleancli", standalone_mode=False)
        return result if isinstance(result, int) else ExitCode.DONE
    except Refused as refused:
        _print_refused(refused)
        return ExitCode.REFUSED
    except (MissingPart, MissingPhysics) as missing:
        click.echo(f"error: {missing}", err=True)
        return ExitCode.MISSING_PART
    except RobotError as error:
        click.echo(f"error: {printable(str(error))}", err=True)
        return ExitCode.ROBOT
    except click.NoSuchOption as error:
        _located(error).show()
        return ExitCode.USAGE
    except click.ClickException as error:
        # It may quote what a file says.
        error.message = printable(error.message)  # type: ignore[misc]  # final is what subclasses may not change
        error.show()
        return ExitCode.USAGE
    except Stopped as stopped:
        click.echo(f"interrupted: {printable(str(stopped))}", err=True)
        return ExitCode.INTERRUPTED
    except (click.Abort, KeyboardInterrupt):
        click.echo("interrupted", err=True)
        return ExitCode.INTERRUPTED
    except (OSError, NoReader) as error:
        return _of_disk(error)


def _located(error: click.NoSuchOption) -> click.UsageError:
    """The mistake, with where it is said what was looked for among the options."""
    if error.option_name not in _OF_PROBLEMS:
        return error
    setting = _OF_PROBLEMS[error.option_name]
    return click.UsageError(
        f"No such option '{error.option_name}'. The problem's file says it: `{setting}`.", error.ctx
    )


def _of_disk(error: Exception) -> ExitCode:
    """Say which file could not be written or read, and why; nothing of a reader that has gone. Errors of our
    own say both in their message."""
    if isinstance(error, OSError):
        named = f"{error.filename}: {error.strerror}" if error.filename is not None else str(error)
        click.echo(f"error: {printable(named)}", err=True)
    return ExitCode.FILES


def _print_refused(refused: Refused) -> None:
    """Imported here because most runs never need the renderer."""
    from cleancli.cli.echo import echo_refused

    echo_refused(refused)


if __name__ == "__main__":
    main()
