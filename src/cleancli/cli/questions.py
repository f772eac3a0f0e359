"""Questions to a person at the terminal."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import click

from cleancli.files.interrupt import interruptible

_Answer = TypeVar("_Answer")


def answer(ask: Callable[[], _Answer]) -> _Answer | None:
    """What a person answers to one of click's prompts; None where there is no more input. Raises
    KeyboardInterrupt on Ctrl-C, without waiting for the end of the line."""
    with interruptible():
        try:
            return ask()
        except click.Abort as error:  # click makes one of both
            if isinstance(error.__context__, KeyboardInterrupt):
                raise KeyboardInterrupt from None
            return None
