"""Where the files that come with the program are: in the wheel, or in the source checkout around it."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def shipped(kind: str) -> Path:
    """The folder of shipped files of one kind: "grammar", "domains", "problems" or "studies".

    Raises FileNotFoundError where an installation lacks it.
    """
    for folder in (_PACKAGE / "shipped" / kind, _PACKAGE.parents[1] / kind):
        if folder.is_dir():
            return folder
    raise FileNotFoundError(f"this installation has no folder of shipped {kind}")


def shipped_names(kind: str) -> tuple[str, ...]:
    """The bare names of the shipped files of one kind, sorted."""
    return tuple(sorted(path.stem for path in shipped(kind).glob("*.nid")))
