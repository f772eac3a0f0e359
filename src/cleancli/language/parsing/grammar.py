"""The parser of grammar/nid.lark, built once for each user: building it takes longer than checking a file.

What lark makes of the grammar is kept in the user's cache folder. It is a pickle, and a pickle can run code:
so it is read only from a file that belongs to this user and that nobody else may write, and only if its
checksum fits. The name holds the versions and the text that it was made from; a file that is missing, old,
foreign or damaged is built again, and where no file can be kept the parser still works.
"""

from __future__ import annotations

import functools
import hashlib
import io
import os
import stat
import sys
from contextlib import suppress
from pathlib import Path

import lark
from lark import Lark
from lark.lexer import PatternStr

from cleancli.files.replace import replace_file
from cleancli.language.parsing.lexer import ContextLexer
from cleancli.resources import shipped

_DIGEST = hashlib.sha256


@functools.cache
def grammar() -> Lark:
    """The parser, from the cache where it is there."""
    text = (shipped("grammar") / "nid.lark").read_text(encoding="utf-8")
    path = _path(text)
    parser = None if path is None else read_cached(path)
    if parser is None:
        parser = Lark(
            text, parser="lalr", lexer=ContextLexer, propagate_positions=True, maybe_placeholders=True
        )
        if path is not None:
            write_cached(path, parser)
    return parser


@functools.cache
def keywords() -> dict[str, str]:
    """The words and signs that stand in the grammar as they are, by the name of their terminal."""
    return {
        terminal.name: terminal.pattern.value
        for terminal in grammar().terminals
        if isinstance(terminal.pattern, PatternStr)
    }


def _path(text: str) -> Path | None:
    """Where the parser of this grammar is kept; None without a folder for it."""
    made_from = "\0".join([text, lark.__version__, sys.version, "2"])
    name = f"nid-{_DIGEST(made_from.encode()).hexdigest()[:16]}.parser"
    named = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    try:
        folder = Path(named) if named else Path.home() / ".cache"
    except RuntimeError:  # a user without a home
        return None
    return folder / "cleancli" / name if folder.is_absolute() else None


def read_cached(path: Path) -> Lark | None:
    """The parser kept at `path`; None for a file that is missing, damaged or open to others."""
    try:
        with path.open("rb") as file:
            if not _is_ours_alone(os.fstat(file.fileno())):
                return None
            digest, data = file.read(_DIGEST().digest_size), file.read()
        return Lark.load(io.BytesIO(data)) if _DIGEST(data).digest() == digest else None
    except Exception:  # unpickling may raise anything; the grammar itself is always there
        return None


def _is_ours_alone(status: os.stat_result) -> bool:
    if os.name != "posix":
        return True
    return status.st_uid == os.getuid() and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def write_cached(path: Path, parser: Lark) -> None:
    """Keep the parser at `path`, in one step; does nothing where the file cannot be written."""
    data = io.BytesIO()
    parser.save(data)
    with suppress(OSError):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(path, _DIGEST(data.getvalue()).digest() + data.getvalue(), mode=0o600)
