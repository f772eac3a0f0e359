"""An environment that holds the wheel of this tree and what it asks for, and nothing else."""

from __future__ import annotations

import subprocess
import sys
import venv
from importlib.metadata import Distribution, distribution, distributions
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]


def install(folder: Path, extra: str) -> Path:
    """Make an environment in a folder with the wheel and this extra; the folder of its programs.

    What the wheel asks for is linked from the environment of the tests, package by package, so that a package
    that nothing asks for is not there.
    """
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check"]
    built = [*pip, "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", "wheels", str(ROOT)]
    subprocess.run(built, check=True, cwd=folder)
    (wheel,) = (folder / "wheels").glob("cleancli-*.whl")
    environment = folder / "environment"
    venv.create(environment, with_pip=False, symlinks=True)
    python = environment / "bin" / "python"
    into = [*pip, "--python", str(python), "install", "-q", "--no-deps", "--no-index", str(wheel)]
    subprocess.run(into, check=True, cwd=folder)
    (site,) = environment.glob("lib/python*/site-packages")
    (installed,) = (each for each in distributions(path=[str(site)]) if each.name == "cleancli")
    for needed in asked_for(installed, {extra}):
        for part in {file.parts[0] for file in needed.files or ()} - {"..", "__pycache__"}:
            (site / part).symlink_to(str(needed.locate_file(part)))
    return environment / "bin"


def asked_for(first: Distribution, extras: set[str]) -> list[Distribution]:
    """The installed packages that one asks for with its extras, and those that these ask for in turn."""
    found = dict[str, Distribution]()
    waiting = [(first, extras)]
    while waiting:
        asking, chosen = waiting.pop()
        for requirement in map(Requirement, asking.requires or ()):
            marker, name = requirement.marker, canonicalize_name(requirement.name)
            if marker is not None and not any(marker.evaluate({"extra": extra}) for extra in chosen | {""}):
                continue
            if name not in found:
                found[name] = distribution(name)
                waiting.append((found[name], set(requirement.extras)))
    return list(found.values())
