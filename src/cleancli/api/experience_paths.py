"""The experience files that a path leads to: itself, that of a run, or those of the runs in a folder."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from cleancli.files.numbered import by_numbers
from cleancli.files.plain import open_plain
from cleancli.language.diagnostics.plural import plural
from cleancli.language.model import Domain
from cleancli.learning.experience import LONGEST
from cleancli.learning.gathered import GivenFile
from cleancli.recording.folder import EXPERIENCE, RUN, check_folder
from cleancli.recording.series import SERIES

ROWS = "episodes.jsonl"
"""What the folder of a study has in place of experience: who reads it says so."""


class GivenFiles(NamedTuple):
    """Experience files, and notes on what was passed over."""

    files: list[GivenFile]
    notes: list[str]


def experience_files(experience: Iterable[Path], domain: Domain) -> GivenFiles:
    """Those that paths lead to: a file, that of a run's folder, or those of all runs and series in a folder
    but for runs of another domain, if there are any of this one.

    Raises Refused (E705) for a run's folder that is not as a run leaves it.
    """
    files, notes = list[GivenFile](), list[str]()
    for path in experience:
        found = list(_files_of(path))
        own = [file for file in found if _may_be_of(domain, file.path)]
        if own and len(own) < len(found):
            others = plural(len(found) - len(own), "run")
            notes.append(f"{path}: {others} passed over, of actions that `{domain.name}` has not")
        files += own or found
    return GivenFiles(files, notes)


def _may_be_of(domain: Domain, path: Path) -> bool:
    """Whether the first line of an experience file is of an action of the domain, as far as it can be read:
    what is wrong with a file is said by who reads it."""
    try:
        with open_plain(path) as file:
            first = json.loads(file.readline(LONGEST + 1) or b"{}")
    except (OSError, ValueError, RecursionError):
        return True
    named = first.get("action") if isinstance(first, dict) else None
    return not isinstance(named, str) or named in {action.name for action in domain.actions}


def _files_of(path: Path) -> Iterator[GivenFile]:
    if not path.is_dir():
        yield GivenFile(str(path), path)
        return
    for folder in [path] if (path / RUN).exists() else list(_runs_in(path)) or [path]:
        check_folder(folder)
        is_study = not (folder / EXPERIENCE).exists() and (folder / ROWS).exists()
        yield GivenFile(str(folder), folder / (ROWS if is_study else EXPERIENCE))


def _runs_in(path: Path) -> Iterator[Path]:
    """The run folders in a folder, and in those of series in it, as they are numbered: old examples may count
    for less."""
    series = sorted((found.parent for found in path.glob(f"*/{SERIES}")), key=by_numbers)
    for folder in (path, *series):
        yield from sorted((run.parent for run in folder.glob(f"*/{RUN}")), key=by_numbers)
