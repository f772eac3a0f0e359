"""Finds the file that is meant by a path or by the name of a shipped one."""

from __future__ import annotations

import difflib
from pathlib import Path

from cleancli.language.diagnostics.diagnostic import Diagnostic
from cleancli.language.diagnostics.refused import Refused
from cleancli.resources import shipped, shipped_names

_ONE = {"domains": "domain", "problems": "problem", "studies": "study"}
"""What a file of each shipped folder is."""


def find(name_or_path: str, *kinds: str, folder: Path | None = None) -> Path:
    """A file that exists as it is given, else the shipped file of that name, with or without `.nid`.

    `kinds` are the folders to seek a bare name in, in order; what lies in `folder` goes by its name too, and
    is suggested where it is near. A folder that happens to have the name of a shipped file does not hide it.
    Raises Refused (E001) that lists near names, paths of near files in the folder of the path, and all
    shipped ones; E003 for a path that cannot be looked at.
    """
    path = Path(name_or_path)
    try:
        if path.is_file():
            return path
    except (OSError, ValueError):
        # Imported here because the parser loads lark, and commands seek names without it.
        from cleancli.language.parsing.read import refused_as

        with refused_as(name_or_path):
            raise
    bare = name_or_path.removesuffix(".nid")
    for kind in kinds:
        if bare in shipped_names(kind):
            return shipped(kind) / f"{bare}.nid"
    if path.exists():
        return path
    names = [name for kind in kinds for name in shipped_names(kind)]
    own = [] if folder is None else sorted(each.stem for each in folder.glob("*.nid"))
    known = {name: name for name in (*own, *names)} | _like(path)
    near = [known[name] for name in difflib.get_close_matches(path.stem, known, n=3, cutoff=0.5)]
    beside = Path(f"{name_or_path}.nid")
    if beside.is_file():  # a bare name is that of a shipped file, and one's own file goes by its path
        near = [str(beside)]
    meant = f"did you mean {' or '.join(f'`{name}`' for name in near)}? " if near else ""
    *others, last = (_ONE[kind] for kind in kinds)
    what = f"{', '.join(others)} or {last}" if others else last
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


def _like(path: Path) -> dict[str, str]:
    """The files in the folder of a path that end as it does, by their stems; none for a bare name."""
    if not path.suffix:
        return {}
    alike = (each for each in sorted(path.parent.glob("*")) if each.suffix == path.suffix)
    return {each.stem: str(each) for each in alike if each.is_file()}


def find_beside(path: Path, name: str, kind: str) -> Path:
    """`NAME.nid` in the folder of a file that names it, else what `find` finds. Raises Refused (E001)."""
    beside = path.parent / f"{name}.nid"
    return beside if beside.is_file() else find(name, kind)
