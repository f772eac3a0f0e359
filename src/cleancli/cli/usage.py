"""Options that make no sense, told as the command line tells it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import click
from click.core import ParameterSource

from cleancli.planning.plan import BadOption


@contextmanager
def usage_errors() -> Iterator[None]:
    """Raise UsageError for BadOption, or BadParameter where it is of one option; also as a decorator."""
    try:
        yield
    except BadOption as error:
        if error.option:
            raise click.BadParameter(str(error), param_hint=f"'{error.option}'") from None
        raise click.UsageError(str(error)) from None


def is_given(name: str) -> bool:
    """Whether the user has said this parameter of the command under way, in place of its default."""
    source = click.get_current_context().get_parameter_source(name)
    return source not in (ParameterSource.DEFAULT, None)
