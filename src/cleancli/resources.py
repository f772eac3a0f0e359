"""Where the files that come with the program are: in the wheel, or in the source checkout around it."""

from __future__ import annotations

import difflib
from pathlib import Path

from cleancli.language.diagnostics.diagnostic import Diagnostic, Refused

_PACKAGE = Path(__file__).resolve().parent


def shipped(kind: str) -> Path:
    """The folder of shipped files of one kind: "grammar", "domains" or "problems".

    Raises FileNotFoundError where an installation lacks it.
    """
    for folder in (_PACKAGE / "shipped" / kind, _PACKAGE.parents[1] / kind):
        if folder.is_dir():
            return folder
    raise FileNotFoundError(f"this installation has no folder of shipped {kind}")


def shipped_names(kind: str) -> tuple[str, ...]:
    """The bare names of the shipped files of one kind, sorted."""
    return tuple(sorted(path.stem for path in shipped(kind).glob("*.nid")))


def find(name_or_path: str, *kinds: str) -> Path:
    """A file that exists as it is given, else the shipped file of that name, with or without `.nid`.

    `kinds` are the folders to seek a bare name in, in order. A folder that happens to have the name of a
    shipped file does not hide it. Raises Refused (E001) that lists near names and all shipped ones.
    """
    path = Path(name_or_path)
    if path.is_file():
        return path
    bare = name_or_path.removesuffix(".nid")
    for kind in kinds:
        if bare in shipped_names(kind):
            return shipped(kind) / f"{bare}.nid"
    if path.exists():
        return path
    names = [name for kind in kinds for name in shipped_names(kind)]
    near = difflib.get_close_matches(path.stem, names, n=3, cutoff=0.5)
    meant = f"did you mean {' or '.join(f'`{name}`' for name in near)}? " if near else ""
    what = " or ".join(kind.removesuffix("s") for kind in kinds)
    raise Refused(
        [
            Diagnostic(
                "E001",
                f"no file `{name_or_path}`, and no shipped {what} of that name",
                None,
                help=f"{meant}shipped: {', '.join(names)}",
            )
        ]
    )
