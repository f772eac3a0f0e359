"""Commands run in this process, and what they say."""

from __future__ import annotations

import json
from typing import Any

import pytest

from cleancli.cli.main import run


def said(capsys: pytest.CaptureFixture[str], *words: object, code: int = 0) -> str:
    """What a command that must end with `code` says: on standard output, and on standard error as well where
    the code is not 0."""
    ended = run([str(word) for word in words])
    captured = capsys.readouterr()
    assert ended == code, captured.err
    return captured.out if code == 0 else captured.out + captured.err


def data(capsys: pytest.CaptureFixture[str], *words: object) -> Any:
    """What it says with `--json`."""
    return json.loads(said(capsys, *words, "--json"))
