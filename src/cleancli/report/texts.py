"""The texts that went into a run, read anew from their copies in its folder (docs/runs.md)."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

from cleancli.language.diagnostics.diagnostic import Diagnostic, Source
from cleancli.language.diagnostics.refused import Refused
from cleancli.language.load import checked_domain
from cleancli.language.model import Domain
from cleancli.recording.folder import read_inside, refused
from cleancli.report.run import InputFile, Run


def domain_of(sources: Sequence[Source]) -> Domain:
    """The domain that the first of the texts is. Raises Refused."""
    return checked_domain(sources[0], True, lambda path: _included(path, sources)).get()


def _included(path: Path, sources: Sequence[Source]) -> Source:
    """The text of a file that the domain includes. Raises Refused (E001) for one that did not go in."""
    for source in sources:
        if source.path == str(path):
            return source
    raise Refused([Diagnostic("E001", f"`{path}` is not among the files that went into the run", None)])


def text_of(run: Run, file: InputFile) -> Source:
    """A text that went in, from its copy. Raises Refused (E705) where that has changed."""
    return Source(file.path, copy_of(run, file).decode("utf-8"))


def copy_of(run: Run, file: InputFile) -> bytes:
    """A file that went in, from its copy. Raises Refused (E705) where that has changed or is no text."""
    path, help = run.folder / file.copy, "put it back, or start a new run"
    try:
        data = read_inside(run.folder, file.copy)
    except FileNotFoundError:
        raise refused(path, "it is missing", help) from None
    if hashlib.sha256(data).hexdigest() != file.sha256:
        message = f"`{path}` is not the text any more that the run began with"
        raise Refused([Diagnostic("E705", message, None, help=help)])
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        raise refused(path, "it is no UTF-8 text", help) from None
    return data
